"""The work of comparing two states of a site: surfaces made, compared, and the files that tell of it."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from geofit.data.errors import InputError
from geofit.data.files import file_stems, folder_for, replacing
from geofit.data.languages import EN, Language, translate
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell
from geofit.fitting.horizon_fit import HorizonFit
from geofit.io.project import is_project
from geofit.project.building import Given, given_of, make
from geofit.project.fault_blocks import site_with_blocks
from geofit.project.provenance import Provenance, fingerprint
from geofit.project.saving import read_project
from geofit.report.change_blocks import contact_rows
from geofit.site.states import Comparison, compare_fits

__all__ = ["compare_states", "made_comparison", "state_surfaces", "write_comparisons"]

_LOG = logging.getLogger(__name__)


def made_comparison(
    pair: tuple[Provenance, Provenance],
    given: Given,
    surface: HorizonFit | None,
    after: HorizonFit,
    found: PointSet,
    *,
    progress: Progress,
) -> tuple[tuple[Provenance, Provenance], Comparison]:
    """Compare a surface with that of an earlier provenance, which is made again where it is not available."""
    before = surface if surface is not None and surface.model is not None else make(pair[0], given, progress)
    known = given.site.horizons[pair[0].horizon]
    return pair, compare_fits(before, after, known, found, progress=progress)


def state_surfaces(
    path: Path, horizons: Sequence[str] = (), progress: Progress | None = None
) -> dict[str, tuple[HorizonFit, PointSet]]:
    """Make the surfaces of a state: of a project those that were fitted last, with its settings and edits.

    Parameters
    ----------
    path : Path
        A project (``*.geofit``) or a site file.
    horizons : sequence of str
        Which; empty: all.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    dict
        By horizon the surface, and all points of the horizon, those too that the fit left out.

    Raises
    ------
    InputError
        If a file cannot be used.
    GeofitError
        If a horizon cannot be fitted.
    """
    if not is_project(path):
        from geofit.io.site_file import read_site
        from geofit.site.fit_site import fit_site

        site = read_site(path)
        fits = fit_site(site, [name for name in site.horizons if not horizons or name in horizons], None, progress)
        for reason in fits.failures.values():
            raise InputError(reason, file=str(path))
        return {name: (surface, site.horizons.get(name, surface.points)) for name, surface in fits.surfaces.items()}
    opened = read_project(path)
    for text in opened.lost:
        _LOG.warning(text)
    state, site = opened.state, opened.state.shaped(opened.site)
    points = site_with_blocks(site, state.parts).horizons
    found = {}
    for name in state.order:
        if horizons and name not in horizons:
            continue
        excluded = tuple(sorted(state.excluded.get(name, ())))
        given = fingerprint(points[name], state.as_read(site))
        present = Provenance(name, state.settings[name], given, excluded, part=state.parts.get(name))
        fitted = state.provenances.get(name)
        # A surface of other data cannot be made again; its settings and rows can be used.
        provenance = fitted if fitted is not None and fitted.given == given else present
        found[name] = (make(provenance, given_of(site, provenance), progress), points[name])
    return found


def compare_states(
    old: Path, new: Path, horizons: Sequence[str] = (), epsilon: float | None = None, progress: Progress | None = None
) -> dict[str, Comparison]:
    """Compare the horizons that two states of a site have in common.

    Parameters
    ----------
    old, new : Path
        Projects or site files.
    horizons : sequence of str
        Which; empty: all that both have.
    epsilon : float, optional
        What counts as moved, metres; by default the control error of the later fit.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    InputError
        If a file cannot be used, or the states have no horizon in common.
    GeofitError
        If a horizon cannot be fitted.
    """
    tell(progress, "fit the earlier state", 0.0)
    before = state_surfaces(old, horizons)
    tell(progress, "fit the later state", 0.4)
    after = state_surfaces(new, horizons)
    common = [name for name in before if name in after]
    if not common:
        raise InputError(
            message("project.states-without-common-horizon", "The two states have no horizon in common"),
            message(
                "project.horizons-of-states", "The earlier state has {old}; the later one has {new}.",
                old=", ".join(before) or "-", new=", ".join(after) or "-",
            ),
            file=str(new),
        )  # fmt: skip
    found = {}
    for k, name in enumerate(common):
        tell(progress, "compare", 0.8 + 0.2 * k / len(common))
        (surface, known), (later, points) = before[name], after[name]
        if epsilon is not None:
            later = later.with_(settings=replace(later.settings, epsilon=epsilon))
        found[name] = compare_fits(surface, later, known, points)
    return found


def write_comparisons(found: dict[str, Comparison], out: Path, t: Language = EN) -> tuple[Path, ...]:
    """Write what comparisons found: of each horizon a map, a grid and a table of the new contacts.

    Returns the files: ``NAME_moved.png``, ``NAME_moved.asc`` (ESRI ASCII grid of the difference, metres), and
    ``NAME_new_contacts.csv``.
    """
    import csv

    from geofit.io.export.grids import write_esri
    from geofit.report.pictures import draw_change

    folder_for(out)
    files = []
    for one, stem in zip(found.values(), file_stems(found).values(), strict=True):
        picture, grid, table = (out / f"{stem}{end}" for end in ("_moved.png", "_moved.asc", "_new_contacts.csv"))
        with replacing(picture) as part:
            part.write_bytes(draw_change(one, t))
        if one.change.area:
            write_esri(one.change.difference, grid)
            files.append(grid)
        header, rows = contact_rows(one.test)
        with replacing(table) as part, part.open("w", encoding="utf-8-sig", newline="") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow([translate(word, t) for word in header])
            writer.writerows(rows)
        files += [picture, table]
    return tuple(files)
