"""Documents and project files: what is written, what is read, what has changed since."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from geofit.checks.check import check
from geofit.data.errors import InputError
from geofit.data.files import file_stems
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.implicit.mesh import TriangleMesh
from geofit.io.project import Edit, Project, ProjectSource, load_surfaces, open_project, save_project
from geofit.io.site_file import read_site
from geofit.io.snapshot import read_snapshot, write_snapshot
from geofit.project.body_building import BodyResult
from geofit.project.body_record import BodyProvenance
from geofit.project.body_saving import SavedBody, bodies_of, read_bodies, records_of
from geofit.project.building import beside
from geofit.project.fault_blocks import site_with_blocks
from geofit.project.horizon_edits import HorizonEdit, shaped
from geofit.project.provenance import Earlier, Part, Provenance, Row, corners_from, data_digest, without_rows
from geofit.project.state import State

__all__ = [
    "Opened",
    "Written",
    "earlier_data",
    "project_of",
    "read_again",
    "read_project",
    "read_saved_surfaces",
    "save_state",
    "saved_data",
    "state_of",
]

_SITE = "site"


@dataclass(frozen=True, eq=False)
class Opened:
    """A project that was read: its site, the work on it, and what is "missing" or "changed" since, by path.

    ``data`` are the earlier data of the site that the work names, ``bodies`` those whose triangles the project holds,
    as they were saved.
    """

    site: Site
    site_file: Path
    state: State
    project: Project
    changed: Mapping[str, str]
    data: tuple[Site, ...] = ()
    bodies: Mapping[BodyProvenance, BodyResult] = field(default_factory=dict)


def read_project(path: Path, progress: Progress | None = None) -> Opened:
    """Read a project file and its site; the surfaces are read by :func:`saved_surfaces`.

    Raises
    ------
    InputError
        If a file cannot be used, or the project names no site file.
    """
    tell(progress, "read the project", 0.0)
    project = open_project(path)
    source = next((source for source in project.sources if source.role == _SITE), None)
    if source is None:
        raise InputError(
            message("project.no-site-file", "The project names no site file"),
            message("project.open-site-file", "Open the site file (site.toml) instead."),
            file=str(path),
        )
    site_file = (path.parent / source.path).resolve()
    if not site_file.is_file():
        raise InputError(
            message("project.site-file-gone", "The project's site file is not there any more"),
            message("project.put-site-file-back", "Put it back, or open the site file where it is now."),
            file=str(site_file),
        )
    site = read_site(site_file, progress, added=_added(project))
    state, changed = state_of(project, site), project.changed(path.parent)
    data = saved_data(state, path)
    for digest in earlier_data(state):
        if digest not in data:
            file = _data_file(path, digest)
            changed[_relative(file, path.parent)] = "changed" if file.is_file() else "missing"
    bodies = read_bodies(project, path.parent, changed)
    return Opened(site, site_file, state, project, changed, tuple(data.values()), bodies)


def read_again(site_file: Path, added: tuple[str, ...], *, progress: Progress | None = None) -> Site:
    """Read a site file as it is now, with the tables of files that were added to it."""
    return read_site(site_file, progress, added=added)


@dataclass(frozen=True, eq=False)
class Written:
    """What was saved, and where."""

    path: Path
    state: State
    project: Project


def save_state(
    state: State,
    site: Site,
    site_file: Path,
    path: Path,
    surfaces: Mapping[Provenance, HorizonFit],
    same: bool,
    data: Mapping[str, Site] | None = None,
    bodies: Mapping[str, SavedBody] | None = None,
    *,
    progress: Progress,
) -> Written:
    """Write a state as a project; ``same`` if it replaces the project that was opened, whose surfaces may stay.

    ``data`` are the earlier data that the state names, by their names; ``bodies`` are those available, by name.
    """
    former = None
    if same and path.is_file():
        try:
            former = open_project(path)
        except InputError:
            former = None  # whatever is there is replaced
    project = project_of(state, site, site_file, path, former)
    project = replace(project, bodies=bodies_of(state, bodies or {}, former, path.parent))
    tell(progress, "write", 0.3)
    for digest, earlier in (data or {}).items():
        if not _data_file(path, digest).is_file():
            write_snapshot(earlier, _data_file(path, digest))
    meshes = {name: body.mesh for name, body in (bodies or {}).items()}
    return Written(path, state, write_project(project, path, new_surfaces(project, surfaces), meshes))


def read_saved_surfaces(
    project: Project, folder: Path, site: Site, *, progress: Progress
) -> dict[Provenance, HorizonFit]:
    """Read and check the surfaces of a project whose horizons the site still has."""
    tell(progress, "read STEP", 0.0)
    found = saved_surfaces(project, folder)
    tell(progress, "check", 0.7)
    return {
        provenance: beside(checked(surface, provenance, site), provenance, site)
        for provenance, surface in found.items()
        if len(site.horizons.get(provenance.horizon, ()))
    }


def saved_surfaces(project: Project, folder: Path) -> dict[Provenance, HorizonFit]:
    """Read the surfaces that a project names and that are there, by their provenances; without their models."""
    there = tuple(result for result in project.results if result.provenance and (folder / result.surface).is_file())
    surfaces = load_surfaces(replace(project, results=there), folder)
    return {Provenance.from_data(result.provenance): surfaces[result.horizon] for result in there}


def checked(surface: HorizonFit, provenance: Provenance, site: Site) -> HorizonFit:
    """Return a surface that was read from a file, with its points and its check."""
    points = without_rows(site.horizons[provenance.horizon], provenance.excluded)
    known = surface.with_(points=points, settings=provenance.settings, core=np.zeros(len(points), bool))
    return known.with_(accuracy=check(known))


def state_of(project: Project, site: Site) -> State:
    """Return the work that a project holds, as far as its site still has the horizons."""
    data = data_digest(site)
    area = next((corners_from(edit.values["corners"]) for edit in project.edits if edit.kind == "area"), None)
    horizons = tuple(HorizonEdit.from_data(edit.values) for edit in project.edits if edit.kind == "horizons")
    site = shaped(site, area, horizons)
    parts = {edit.horizon: Part.from_data(edit.values) for edit in project.edits if edit.kind == "part"}
    parts = {name: part for name, part in parts.items() if part.horizon in site.horizons}
    whole = State.of_site(site).settings
    default = {**whole, **{name: whole[part.horizon] for name, part in parts.items()}}
    excluded: dict[str, frozenset[Row]] = {}
    order = tuple(site_with_blocks(site, parts).horizons)
    for edit in project.edits:
        if edit.kind == "exclude" and edit.horizon in default:
            excluded[edit.horizon] = excluded.get(edit.horizon, frozenset()) | {Row(**edit.values)}
        elif edit.kind == "order":
            named = [name for name in edit.values["horizons"] if name in order]
            order = (*named, *(name for name in order if name not in named))
    settings = {name: project.settings.get(name, known) for name, known in default.items()}
    provenances = {
        result.horizon: Provenance.from_data(result.provenance)
        for result in project.results
        if result.provenance and result.horizon in order
    }
    earlier = {
        edit.horizon: Earlier.from_data(edit.values)
        for edit in project.edits
        if edit.kind == "earlier" and edit.horizon in order
    }
    return State(
        project.name, order, settings, excluded, provenances, parts, data, _added(project), earlier, area, horizons,
        records_of(project),
    )  # fmt: skip


def _added(project: Project) -> tuple[str, ...]:
    """Return the tables of files that the project adds to its site file."""
    return tuple(edit.values["tables"] for edit in project.edits if edit.kind == "add")


def saved_data(state: State, project_file: Path) -> dict[str, Site]:
    """Return the earlier data that a state names and whose files are with the project, whole, by their names."""
    found = {}
    for digest in earlier_data(state):
        with suppress(InputError):
            found[digest] = read_snapshot(_data_file(project_file, digest))
    return found


def earlier_data(state: State) -> tuple[str, ...]:
    """Return the names of the earlier data that a state compares with."""
    return tuple(dict.fromkeys(one.data for one in state.earlier.values()))


def _data_file(project_file: Path, digest: str) -> Path:
    """Return the file that holds earlier data of the site, next to the project."""
    return project_file.with_name(f"{project_file.stem}_data") / f"{file_stems([digest])[digest]}.npz"


def project_of(state: State, site: Site, site_file: Path, target: Path, former: Project | None) -> Project:
    """Return what is saved: results of ``former`` whose provenances still hold need not be written again."""
    folder = target.parent
    sources = [ProjectSource(path=_relative(site_file, folder), role=_SITE)]
    for name, digest in site.inputs.items():
        file = site_file.parent / name
        if file.is_file() and file != site_file:
            path = _relative(file, folder)
            sources.append(ProjectSource(path=path, role="table", sha256=digest))
    edits = [
        Edit(kind="exclude", horizon=name, values=asdict(row))
        for name, rows in state.excluded.items()
        for row in sorted(rows)
    ]
    edits += [Edit(kind="add", values={"tables": tables}) for tables in state.added]
    edits += [Edit(kind="horizons", values=one.to_data()) for one in state.horizons]
    if state.area is not None:
        edits.append(Edit(kind="area", values={"corners": [list(corner) for corner in state.area]}))
    edits += [Edit(kind="earlier", horizon=name, values=one.to_data()) for name, one in state.earlier.items()]
    edits += [Edit(kind="part", horizon=name, values=part.to_data()) for name, part in state.parts.items()]
    edits.append(Edit(kind="order", values={"horizons": list(state.order)}))
    kept = () if former is None else tuple(
        result
        for result in former.results
        if result.provenance
        and state.provenances.get(result.horizon) == Provenance.from_data(result.provenance)
        and (folder / result.surface).is_file()
    )  # fmt: skip
    return Project(
        name=state.name, crs=site.crs, sources=tuple(sources), settings=state.settings, edits=tuple(edits), results=kept
    )


def write_project(
    project: Project,
    path: Path,
    surfaces: Mapping[Provenance, HorizonFit],
    meshes: Mapping[str, TriangleMesh] | None = None,
) -> Project:
    """Write a project file, the surfaces that are new to it, and the triangles of bodies."""
    by_horizon = {provenance.horizon: surface for provenance, surface in surfaces.items()}
    provenances = {provenance.horizon: provenance.to_data() for provenance in surfaces}
    return save_project(project, path, by_horizon, provenances, meshes)


def new_surfaces(project: Project, surfaces: Mapping[Provenance, HorizonFit]) -> dict[Provenance, HorizonFit]:
    """Return the surfaces that the project does not have yet."""
    there = {Provenance.from_data(result.provenance) for result in project.results}
    return {provenance: surface for provenance, surface in surfaces.items() if provenance not in there}


def _relative(file: Path, folder: Path) -> str:
    """Return the path from the folder, with forward slashes; absolute on another drive of Windows."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return file.as_posix()
