"""New files for a site that is open: sorted by what they hold, and added to what its site file names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.data.site import ImportIssue, Site
from geofit.io.added_tables import tables_text, with_tables
from geofit.io.horizons import HorizonNames
from geofit.io.import_plan import ImportPlan, complete, look_at
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping
from geofit.io.site_file import build_site, read_site
from geofit.io.source import Source
from geofit.project.import_tables import Tables, site_tables

__all__ = ["Added", "add_files"]


@dataclass(frozen=True, eq=False)
class Added:
    """The ``site`` with the new files, all ``tables`` that its site file does not have (TOML), what was not used."""

    site: Site
    tables: tuple[str, ...]
    issues: tuple[ImportIssue, ...]


def add_files(
    files: Sequence[Path],
    site_file: Path,
    site: Site,
    added: Sequence[str] = (),
    mappings: Sequence[ColumnMapping] = (),
    *,
    progress: Progress | None = None,
) -> Added:
    """Read a site with more files.

    Parameters
    ----------
    files : sequence of path
        Tables, drawings and grids; a horizon that the site does not have yet is a new one.
    site_file : path
        The site file; it is not changed.
    site : Site
        The site as it is.
    added : sequence of str
        Tables that were added before.
    mappings : sequence of ColumnMapping
        How tables are read where a guess would be wrong.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    InputError
        If no file can be used, with the reason for the first; or if a file cannot be read.
    """
    plan, folder = ImportPlan(), site_file.resolve().parent
    known = {(folder / name).resolve() for name in site.inputs}
    for k, file in enumerate(files):
        tell(progress, "inspect files", 0.3 * k / len(files))
        if file.resolve() in known:
            raise InputError(
                message("project.file-added-already", "The file belongs to the site already"),
                message("project.reload-where-changed", "If the site has changed, reload it."),
                file=file.name,
            )
        look_at(file.resolve(), folder, mappings, site.crs, plan)
    complete(plan)
    tables = site_tables(plan, {}, [], stated=True)
    if not tables:
        first = plan.issues[0] if plan.issues else None
        raise InputError(
            first.reason if first else message("project.no-file-given", "No file is given"),
            first.remedy if first else message("project.choose-files", "Choose the files to add."),
            file=first.file if first else None,
        )
    text = tables_text([*tables, *_new_horizons(tables, site_file, site, added)])
    tell(progress, "read the site", 0.5)
    return Added(read_site(site_file, progress, added=(*added, text)), (*added, text), tuple(plan.issues))


def _new_horizons(tables: Tables, site_file: Path, site: Site, added: Sequence[str]) -> Tables:
    """Return a [[horizon]] table for each name that only the new files have.

    Beside [[horizon]] tables only listed names are read; without any, every name makes a horizon.
    """
    stated = with_tables(Source(path=site_file).read(), added, site_file.name)
    if "horizon" not in stated:
        return []
    top: dict[str, Any] = {"site": {"crs": site.crs}} if site.crs else {}
    for head, table in tables:
        # Limits of codes are asked for by the site file alone.
        if head != "[[boreholes]]":
            key = head.strip("[]")
            top[key] = [*top.get(key, []), table] if head.startswith("[[") else table
    try:
        names = build_site(top, site_file, Journal(), mappings=()).horizons
    except InputError:
        return []  # reported when the whole site is read
    known = HorizonNames(list(site.horizons))
    return [("[[horizon]]", {"name": name}) for name in names if known.match(name) is None]
