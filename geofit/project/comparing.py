"""The work of comparing two states of a site: surfaces made, compared, and the files that tell of it."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geofit.data.errors import InputError, SettingsError
from geofit.data.files import file_stems, folder_for, replacing
from geofit.data.languages import EN, Language, translate
from geofit.data.messages import Message, Untranslated, message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell
from geofit.data.site import ImportIssue
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

Listed = Callable[[Path, Sequence[ImportIssue]], object]


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


@dataclass(frozen=True, eq=False)
class _State:
    """The surfaces of a state: by name each with its points and its horizon, of which it may be a fault block.

    ``points`` are those too that the fit left out; ``horizons`` has all of each horizon. ``failures`` gives by horizon
    why it could not be fitted.
    """

    path: Path
    surfaces: Mapping[str, tuple[HorizonFit, PointSet]]
    horizon: Mapping[str, str]
    horizons: Mapping[str, PointSet]
    failures: Mapping[str, Message]


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
        If a file cannot be used, or a horizon of a site file cannot be fitted.
    GeofitError
        If a horizon of a project cannot be fitted.
    """
    state = _state(path, horizons, progress, lambda *_: None)
    for reason in state.failures.values():
        raise InputError(reason, file=str(path))
    return dict(state.surfaces)


def _state(path: Path, horizons: Sequence[str], progress: Progress | None, listed: Listed) -> _State:
    if not is_project(path):
        from geofit.io.site_file import read_site
        from geofit.site.fit_site import fit_site

        site = read_site(path)
        listed(path, site.issues)
        fits = fit_site(site, [name for name in site.horizons if not horizons or name in horizons], None, progress)
        surfaces = {name: (surface, site.horizons.get(name, surface.points)) for name, surface in fits.surfaces.items()}
        return _State(path, surfaces, fits.horizon, site.horizons, fits.failures)
    opened = read_project(path)
    for text in opened.lost:
        _LOG.warning(text)
    state, site = opened.state, opened.state.shaped(opened.site)
    listed(path, site.issues)
    points = site_with_blocks(site, state.parts).horizons
    horizon = {name: state.parts[name].horizon if name in state.parts else name for name in state.order}
    found = {}
    for name in state.order:
        if horizons and name not in horizons and horizon[name] not in horizons:
            continue
        excluded = tuple(sorted(state.excluded.get(name, ())))
        given = fingerprint(points[name], state.as_read(site))
        present = Provenance(name, state.settings[name], given, excluded, part=state.parts.get(name))
        fitted = state.provenances.get(name)
        # A surface of other data cannot be made again; its settings and rows can be used.
        provenance = fitted if fitted is not None and fitted.given == given else present
        found[name] = (make(provenance, given_of(site, provenance), progress), points[name])
    return _State(path, found, horizon, site.horizons, {})


def compare_states(
    old: Path,
    new: Path,
    horizons: Sequence[str] = (),
    epsilon: float | None = None,
    progress: Progress | None = None,
    *,
    reported: Callable[[Message], object] = _LOG.warning,
    listed: Listed = lambda *_: None,
) -> dict[str, Comparison]:
    """Compare the horizons that two states of a site have in common; of faulted ones the blocks on the same side.

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
    reported : callable, optional
        Gets a message for what is not compared, an error where a horizon could not be fitted, and for each block that
        has another name in the earlier state.
    listed : callable, optional
        Called as ``listed(path, issues)`` with what the readers of each state found.

    Raises
    ------
    InputError
        If a file cannot be used, or the states have no horizon in common that can be fitted.
    GeofitError
        If a horizon of a project cannot be fitted.
    """
    tell(progress, "fit the earlier state", 0.0)
    before = _state(old, horizons, progress, listed)
    tell(progress, "fit the later state", 0.4)
    after = _state(new, horizons, progress, listed)
    pairs = _pairs(before, after)
    if not pairs:
        for state in (before, after):
            for reason in state.failures.values():
                raise InputError(reason, file=str(state.path))
        raise InputError(
            message("project.states-without-common-horizon", "The two states have no horizon in common"),
            message(
                "project.horizons-of-states", "The earlier state has {old}; the later one has {new}.",
                old=", ".join(before.horizons) or "-", new=", ".join(after.horizons) or "-",
            ),
            file=str(new),
        )  # fmt: skip
    for text in _not_compared(before, after, pairs):
        reported(text)
    found = {}
    for k, (name, earlier, later_name) in enumerate(pairs):
        tell(progress, "compare", 0.8 + 0.2 * k / len(pairs))
        (surface, known), (later, points) = before.surfaces[earlier], after.surfaces[later_name]
        if earlier != later_name:
            reported(
                message(
                    "project.block-compared",
                    "{later} is compared with {earlier} of the earlier state: they lie on the same side",
                    later=later_name,
                    earlier=earlier,
                )
            )
        if epsilon is not None:
            later = later.with_(settings=replace(later.settings, epsilon=epsilon))
        # A point that the fault puts into another block now is known all the same.
        known = before.horizons.get(before.horizon[earlier], known)
        try:
            one = compare_fits(surface, later, known, points)
        except SettingsError as reason:
            # A vertical fault covers nothing of the plan: the others are compared all the same.
            if len(pairs) == 1:
                raise
            reported(
                message(
                    "project.horizon-not-compared", "{name} is not compared: {reason}", name=name, reason=reason.message
                ).with_severity("warning")
            )
            continue
        found[name] = replace(one, change=replace(one.change, name=name), test=replace(one.test, name=name))
    return found


def _pairs(before: _State, after: _State) -> list[tuple[str, str, str]]:
    """Return what is compared: a name, the earlier surface and the later one.

    Blocks are named by their numbers of points, which new holes change: each is compared with the block of the other
    state that reaches most of its points.
    """
    pairs = []
    for horizon in dict.fromkeys(before.horizon[name] for name in before.surfaces):
        first, second = ([n for n in one.surfaces if one.horizon[n] == horizon] for one in (before, after))
        split, other, blocks = (before, after, first) if len(first) > len(second) else (after, before, second)
        whole = second if split is before else first
        if len(blocks) == 1 == len(whole):
            pairs.append((blocks[0], whole[0], blocks[0]) if split is after else (whole[0], blocks[0], whole[0]))
            continue
        for name in blocks if whole else ():
            xy = split.surfaces[name][0].points.xyz[:, :2].T
            reach = {one: float(np.isfinite(other.surfaces[one][0].elevation(*xy)).mean()) for one in whole}
            nearest = max(whole, key=lambda one: reach[one])
            if reach[nearest] > 0:
                pairs.append((name, nearest, name) if split is after else (name, name, nearest))
    return pairs


def _not_compared(before: _State, after: _State, pairs: Sequence[tuple[str, str, str]]) -> Iterator[Message]:
    """Yield what one state alone has, and what could not be fitted."""
    for state in (before, after):
        for name, reason in state.failures.items():
            yield message(
                "project.state-not-fitted",
                "{file}: {name} could not be fitted: {reason}",
                file=Untranslated(state.path.name),
                name=name,
                reason=reason,
            ).with_severity("error")
    for state, other, place in ((before, after, 1), (after, before, 2)):
        compared = {pair[place] for pair in pairs}
        alone = [name for name in state.surfaces if name not in compared and state.horizon[name] not in other.failures]
        if alone:
            yield message(
                "project.horizons-of-one-state",
                "Not compared, for {file} alone has them: {names}",
                file=Untranslated(str(state.path)),
                names=", ".join(alone),
            ).with_severity("warning")


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
