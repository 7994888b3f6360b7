"""What the commands read: a site file or a table of points, and the horizon that is meant of several."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message

if TYPE_CHECKING:
    from geofit.data.site import ImportIssue, Site

__all__ = ["pick", "read_source"]


def read_source(
    source: Path, columns: dict[str, str | None], boundary: Path | None, orientations: Path | None = None
) -> Site:
    """Read a site file, or a table of points with the columns that the user names (None: guessed) and one of dips."""
    from dataclasses import replace

    from geofit.data.legible import legible
    from geofit.data.site import Site
    from geofit.io.boundary import read_boundary
    from geofit.io.crs import require_grid
    from geofit.io.orientations import read_orientations
    from geofit.io.picks import read_points
    from geofit.io.site_file import read_site

    area = None if boundary is None else read_boundary(boundary)
    if source.suffix.casefold() == ".toml":
        given = [f"--{name}" for name, value in columns.items() if value is not None]
        given += ["--orientations"] if orientations is not None else []
        if given:
            raise InputError(
                message("cli.option-for-tables", "{option} is for tables of points", option=given[0]),
                message("cli.site-file-has-columns", "Leave it out: a site file names its own columns."),
                file=str(source),
            )
        site = read_site(source)
        return site if area is None else replace(site, boundary=area)
    crs = columns.get("crs") or ""
    require_grid(crs, source.name)
    picks = read_points(
        source,
        x=columns.get("x"),
        y=columns.get("y"),
        z=columns.get("z"),
        surface=columns.get("surface"),
        section=columns.get("section"),
        sep=columns.get("sep"),
        decimal=columns.get("decimal"),
        crs=columns.get("crs"),
        unit=columns.get("unit"),
    )
    only = next(iter(picks.horizons)) if len(picks.horizons) == 1 else ""
    dips, listed = (None, ()) if orientations is None else read_orientations(orientations, only)
    return Site(
        name=legible(source.stem),
        horizons=picks.horizons,
        boundary=area,
        crs=crs,
        issues=(*_like_collars(source, columns), *picks.issues, *listed),
        orientations=dips,
        counts=picks.counts,
        inputs=picks.inputs,
    )


def _like_collars(source: Path, columns: Mapping[str, str | None]) -> tuple[ImportIssue, ...]:
    """Warn of a table of collars read as points: its elevations are those of the ground, not of a horizon."""
    from geofit.data.site import ImportIssue
    from geofit.io.preview import preview_file

    if columns.get("z") is not None or [one.kind for one in preview_file(source)] != ["collar"]:
        return ()
    return (
        ImportIssue(
            source.name,
            0,
            "",
            "",
            "warning",
            message(
                "cli.points-look-like-collars",
                "The table looks like collars: their elevations are those of the ground, not of a horizon",
            ),
            message(
                "cli.import-collars",
                "Combine collars and logs with geofit import, or name the column of the elevations with --z.",
            ),
        ),
    )


def pick(kind: str, found: Mapping[str, Any], wanted: str | None, file: Path) -> tuple[str, Any]:
    """Return the named one of several horizons or surfaces, or the only one."""
    if len(found) == 1 and (wanted is None or kind == "surface"):
        return next(iter(found.items()))
    if wanted is not None and wanted in found:
        return wanted, found[wanted]
    if wanted:
        reason = message("cli.not-in-file", "There is no {kind} '{name}'", kind=kind, name=Untranslated(wanted))
    elif kind == "surface":
        reason = message("cli.surfaces-in-file", "The file has {count} surfaces; one is needed", count=len(found))
    else:
        reason = message("cli.horizons-in-file", "The file has {count} horizons; one is needed", count=len(found))
    remedy = message("cli.choose-with-horizon", "Choose with --horizon: {names}.", names=", ".join(found))
    raise InputError(reason, remedy, file=str(file))
