"""Documents and project files: what is written, what is read, what has changed since."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from geofit.checks.check import check
from geofit.data.errors import GeofitError, InputError
from geofit.data.files import file_stems
from geofit.data.messages import Message, message
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.implicit.mesh import TriangleMesh
from geofit.io.project import (
    Edit,
    Project,
    ProjectResult,
    ProjectSource,
    load_surfaces,
    open_project,
    save_project,
)
from geofit.io.project_files import sha256_of
from geofit.io.site_file import load_site, read_site
from geofit.io.snapshot import read_snapshot, write_snapshot
from geofit.project.body_building import BodyResult
from geofit.project.body_record import BodyProvenance
from geofit.project.body_saving import SavedBody, bodies_of, read_bodies, records_of
from geofit.project.building import with_site_checks
from geofit.project.fault_blocks import site_with_blocks
from geofit.project.horizon_edits import HorizonEdit, shaped
from geofit.project.named_points import NO_NAMES, NamedPoint, Names, excluded_names, found_again, reopened
from geofit.project.provenance import Earlier, Part, Provenance, Row, corners_from, data_digest, without_rows
from geofit.project.state import State

__all__ = [
    "Opened",
    "SiteFileGoneError",
    "Written",
    "earlier_data",
    "project_of",
    "read_again",
    "read_project",
    "read_saved_surfaces",
    "save_state",
    "saved_data",
    "site_for_work",
    "state_of",
]

_SITE = "site"


@dataclass(frozen=True, eq=False)
class Opened:
    """A project that was read: its site, the work on it, and what is "missing" or "changed" since, by path.

    ``data`` are the earlier data of the site that the work names, ``bodies`` those whose triangles the project holds,
    as they were saved. ``saved`` is the state as the file has it, ``state`` with its excluded rows where their points
    are now: ``moved`` is how many are on other lines, ``lost`` lists what does not survive. ``digest`` is the SHA-256
    of the project file.
    """

    site: Site
    site_file: Path
    state: State
    project: Project
    changed: Mapping[str, str]
    data: tuple[Site, ...] = ()
    bodies: Mapping[BodyProvenance, BodyResult] = field(default_factory=dict)
    saved: State = field(default_factory=State)
    moved: int = 0
    lost: tuple[Message, ...] = ()
    digest: str = ""


class SiteFileGoneError(InputError):
    """A project's site file is not where the project names it: :func:`read_project` takes its new place."""


def read_project(path: Path, progress: Progress | None = None, *, site_file: Path | None = None) -> Opened:
    """Read a project file and its site; the surfaces are read by :func:`saved_surfaces`.

    Parameters
    ----------
    path : Path
        The project file.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.
    site_file : Path, optional
        Where the site file is now; by default where the project names it.

    Raises
    ------
    SiteFileGoneError
        If the site file is not there.
    InputError
        If a file cannot be used, or the project names no site file.
    """
    tell(progress, "read the project", 0.0)
    project, digest = open_project(path), sha256_of(path)
    source = next((source for source in project.sources if source.role == _SITE), None)
    if source is None:
        raise InputError(
            message("project.no-site-file", "The project names no site file"),
            message("project.open-site-file", "Open the site file (site.toml) instead."),
            file=str(path),
        )
    named, elsewhere = path.parent / source.path, site_file is not None
    site_file = _resolved(site_file or named)
    if not site_file.is_file():
        raise SiteFileGoneError(
            message("project.site-file-gone", "The project's site file no longer exists"),
            message("project.put-site-file-back", "Put it back, or open the site file where it is now."),
            file=str(site_file),
        )
    site = site_for_work(site_file, _added(project), progress=progress)
    hashes = {source.path: source.sha256 for source in project.sources}
    other = [
        name for name, now in site.inputs.items() if hashes.get(_relative(named.parent / name, path.parent)) != now
    ]
    saved = state_of(project, site)
    state, carried = reopened(saved, _names(project), saved.shaped(site), other)
    if elsewhere:
        # The file names a site file that is not there: whatever the work, the project is to be saved.
        saved = State()
        changed = replace(project, sources=()).changed(path.parent) | dict.fromkeys(other, "changed")
    else:
        changed = project.changed(path.parent)
    data = saved_data(state, path)
    for digest in earlier_data(state):
        if digest not in data:
            file = _data_file(path, digest)
            changed[_relative(file, path.parent)] = "changed" if file.is_file() else "missing"
    bodies = read_bodies(project, path.parent, changed)
    return Opened(
        site, site_file, state, project, changed, tuple(data.values()), bodies, saved, carried.moved, carried.lost,
        digest,
    )  # fmt: skip


def read_again(site_file: Path, added: tuple[str, ...], *, progress: Progress | None = None) -> Site:
    """Read a site file as it is now, with the tables of files that were added to it."""
    return site_for_work(site_file, added, progress=progress)


def site_for_work(file: Path, added: tuple[str, ...] = (), *, progress: Progress | None = None) -> Site:
    """Read a site that has something to work on: horizons, or anything that bodies lie in or are made from.

    Raises
    ------
    InputError
        As :func:`geofit.io.read_site`.
    """
    site = load_site(file, progress, added=added)
    if not (site.horizons or site.holes or site.sections) and site.ground is None and site.boundary is None:
        # The reader of sites with horizons knows what to say.
        return read_site(file, progress, added=added)
    return site


@dataclass(frozen=True, eq=False)
class Written:
    """What was saved, and where; ``digest`` is the SHA-256 of the project file."""

    path: Path
    state: State
    project: Project
    digest: str


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

    Of the ``site`` as it is worked on its name, its inputs and the horizons with excluded rows are needed. ``data`` are
    the earlier data that the state names, by their names; ``bodies`` are those available, by name.

    Raises
    ------
    InputError
        If the folder is gone, or a file cannot be written.
    """
    if not path.parent.is_dir():
        # Made anew, it would have a project without its site.
        raise InputError(
            message("project.folder-gone", "The project's folder no longer exists"),
            message("project.save-elsewhere", "Put it back, or save the project under another name."),
            file=str(path),
        )
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
    written = write_project(project, path, new_surfaces(project, surfaces), meshes)
    return Written(path, state, written, sha256_of(path))


def read_saved_surfaces(
    project: Project, folder: Path, site: Site, *, progress: Progress
) -> dict[Provenance, HorizonFit]:
    """Read and check the surfaces of a project whose horizons the site still has."""
    tell(progress, "read STEP", 0.0)
    found = saved_surfaces(project, folder)
    tell(progress, "check", 0.7)
    names = _names(project)
    return {
        provenance: with_site_checks(checked(surface, provenance, site, names), provenance, site)
        for provenance, surface in found.items()
        if len(site.horizons.get(provenance.horizon, ()))
    }


def saved_surfaces(project: Project, folder: Path) -> dict[Provenance, HorizonFit]:
    """Read the surfaces of a project, without their models, by their provenances.

    One whose file is missing, damaged or another's is left out: it is made again from its provenance.
    """
    found = {}
    for result in project.results:
        if result.provenance and _is_whole(result, folder):
            with suppress(GeofitError):
                (surface,) = load_surfaces(replace(project, results=(result,)), folder).values()
                found[Provenance.from_data(result.provenance)] = surface
    return found


def checked(surface: HorizonFit, provenance: Provenance, site: Site, names: Names = NO_NAMES) -> HorizonFit:
    """Return a surface that was read from a file, with its points and its check.

    Rows that were excluded are found by the ``names`` of their points: their lines may be others' now.
    """
    given, named = site.horizons[provenance.horizon], names.get(provenance.horizon, {})
    now = found_again(named, given)
    points = without_rows(given, [now.get(row, row) for row in provenance.excluded if row in now or row not in named])
    known = surface.with_(points=points, settings=provenance.settings, core=np.zeros(len(points), bool))
    return known.with_(accuracy=check(known))


def state_of(project: Project, site: Site) -> State:
    """Return the work that a project holds, as far as its site still has the horizons; rows by their former lines."""
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
            excluded[edit.horizon] = excluded.get(edit.horizon, frozenset()) | {_row(edit)}
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


def _row(edit: Edit) -> Row:
    """Return the row that an edit excludes."""
    return Row(**{key: value for key, value in edit.values.items() if key != "point"})


def _names(project: Project) -> dict[str, dict[Row, NamedPoint]]:
    """Return who the excluded points of a project are, where it knows."""
    names: dict[str, dict[Row, NamedPoint]] = {}
    for edit in project.edits:
        if edit.kind == "exclude" and "point" in edit.values:
            names.setdefault(edit.horizon, {})[_row(edit)] = NamedPoint.from_data(edit.values["point"])
    return names


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
    """Return what is saved: results of ``former`` whose provenances still hold need not be written again.

    ``site`` as :func:`save_state` takes it.
    """
    folder = target.parent
    # The hashes are those of what was read: a file may have changed since, or be gone.
    sources = [ProjectSource(path=_relative(site_file, folder), role=_SITE, sha256=site.inputs.get(site_file.name, ""))]
    for name, digest in site.inputs.items():
        if name != site_file.name:
            path = _relative(site_file.parent / name, folder)
            sources.append(ProjectSource(path=path, role="table", sha256=digest))
    names = excluded_names(state, site)
    edits = [
        Edit(kind="exclude", horizon=name, values=asdict(row) | _point(names.get(name, {}).get(row)))
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
        and _is_whole(result, folder)
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


def _point(name: NamedPoint | None) -> dict[str, Any]:
    return {} if name is None else {"point": asdict(name)}


def _is_whole(result: ProjectResult, folder: Path) -> bool:
    """Whether the file of a surface is there, with the bytes that were written."""
    file = folder / result.surface
    return file.is_file() and (not result.sha256 or sha256_of(file) == result.sha256)


def _resolved(file: Path) -> Path:
    """Return the path of a file without links in its folders; what the file itself links to has other neighbours."""
    return file.parent.resolve() / file.name


def _relative(file: Path, folder: Path) -> str:
    """Return the path from the folder, with forward slashes; absolute on another drive of Windows.

    Both are freed of links first: the system resolves these before it goes up.
    """
    file = _resolved(file)
    try:
        return Path(os.path.relpath(file, folder.resolve())).as_posix()
    except ValueError:
        return file.as_posix()
