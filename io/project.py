"""The project file (``*.geofit``): JSON text with the work on a site; its surfaces are next to it as STEP.

::

    {
      "format": "geofit project",
      "version": 4,
      "name": "Dam site",
      "crs": "EPSG:32648",
      "sources": [{"path": "data/collar.csv", "role": "collar", "sha256": "...", "mapping": {...}}],
      "settings": {"T2-T1": {"epsilon": 0.25, ...}},
      "edits": [{"kind": "exclude", "horizon": "T2-T1", "values": {"file": "picks.csv", "row": 17, "turn": 0,
                 "point": {"kind": "borehole", "hole": "ZK3", "section": "", "place": [x, y, z], "rank": 0}}}],
      "results": [{"horizon": "T2-T1", "surface": "site_surfaces/T2-T1-1f00c3a2.step", "sha256": "...", ...}],
      "bodies": [{"name": "ORE", "record": {...}, "mesh": "site_surfaces/ORE-77a01b9c.ply", "sha256": "...", ...}]
    }

A project without bodies has no such list. ``point`` is who an excluded point is: it is found again where its file has
changed. The file of a surface or a body carries the start of its hash in its name, and the project file is replaced
last: whenever a save is interrupted, the project file on the disk names files that are there and whole.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, fields, replace
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from geofit import __version__
from geofit.data.accuracy import plain
from geofit.data.errors import InputError, SettingsError
from geofit.data.files import replacing
from geofit.data.given import arguments_checked
from geofit.data.legible import legible
from geofit.data.messages import message
from geofit.data.numbers import is_finite, shown
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.implicit.mesh import TriangleMesh
from geofit.io.parser_errors import parser_message
from geofit.io.project_files import BODY_FILE, SURFACE_FILE, file_folder, sha256_of, write_body_file, write_surface_file
from geofit.io.source import Source

__all__ = [
    "ENDING",
    "VERSION",
    "Edit",
    "Project",
    "ProjectBody",
    "ProjectResult",
    "ProjectSource",
    "is_project",
    "load_surfaces",
    "open_project",
    "save_project",
]

_Entry = TypeVar("_Entry", "ProjectSource", "Edit", "ProjectResult", "ProjectBody")

FORMAT = "geofit project"
#: Name of the folder of surfaces and bodies, on every system: no separator, no drive, nothing hidden.
_SURFACE_FOLDER = re.compile(r"[^/\\:\0]+_surfaces")
_TYPES: dict[str, tuple[type, ...]] = {
    "str": (str,),
    "int": (int,),
    "float | None": (float, int, type(None)),
    "bool | None": (bool, type(None)),
    "Mapping[str, Any]": (Mapping,),
}
#: Version of the layout. A change that an older reader would misread makes it one more, with a migration.
VERSION = 4
#: Ending of project files; case does not count.
ENDING = ".geofit"


@dataclass(frozen=True, kw_only=True)
class ProjectSource:
    """A file that was read: its path, what it is read as, its SHA-256, and how its columns are understood."""

    path: str
    role: str = ""
    sha256: str = ""
    mapping: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Edit:
    """A manual edit, in the order it was made: what was done, to which horizon, with which values."""

    kind: str
    horizon: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class ProjectResult:
    """A surface that was fitted: its STEP file and hash, its figures, and the version that made it.

    ``provenance`` holds from what it was made (settings, excluded rows, manual edits) where the writer knows it.
    """

    horizon: str
    surface: str
    sha256: str
    n: int = 0
    sigma: float | None = None
    passed: bool | None = None
    geofit: str = ""
    provenance: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class ProjectBody:
    """A body: its ``record`` (what it is made from, how it is drawn), and its triangles and figures as last made.

    ``mesh`` and ``sha256`` are empty where the body was not available when the project was saved; lengths in metres,
    ``volumes`` are P10, P50, P90 and that of the body, m3, or empty.
    """

    name: str
    record: Mapping[str, Any]
    mesh: str = ""
    sha256: str = ""
    n: int = 0
    sigma: float | None = None
    passed: bool | None = None
    volumes: Mapping[str, Any] = field(default_factory=dict)
    geofit: str = ""


@dataclass(frozen=True, kw_only=True)
class Project:
    """The work on one site. Paths are relative to the project file, with forward slashes, or absolute."""

    name: str
    crs: str = ""
    sources: tuple[ProjectSource, ...] = ()
    settings: Mapping[str, FitSettings] = field(default_factory=dict)
    edits: tuple[Edit, ...] = ()
    results: tuple[ProjectResult, ...] = ()
    bodies: tuple[ProjectBody, ...] = ()

    def changed(self, folder: str | PathLike[str]) -> dict[str, str]:
        """Return sources and surfaces that are "missing" or "changed" since the project was saved, by path."""
        found = {}
        for path, expected in (
            *((source.path, source.sha256) for source in self.sources),
            *((result.surface, result.sha256) for result in self.results),
            *((body.mesh, body.sha256) for body in self.bodies if body.mesh),
        ):
            file = Path(folder) / path
            if not file.is_file():
                found[path] = "missing"
            elif expected and sha256_of(file) != expected:
                found[path] = "changed"
        return found


@arguments_checked
def save_project(
    project: Project,
    path: str | PathLike[str],
    surfaces: Mapping[str, HorizonFit] | None = None,
    provenances: Mapping[str, Mapping[str, Any]] | None = None,
    meshes: Mapping[str, TriangleMesh] | None = None,
) -> Project:
    """Write a project file, and the surfaces that are given, as STEP, into ``NAME_surfaces`` beside it.

    Parameters
    ----------
    project : Project
        What to save. Sources without a hash get theirs.
    path : path
        The file, usually ``*.geofit``.
    surfaces : mapping of str to HorizonFit, optional
        Surfaces by horizon; each takes the place of its horizon's former result.
    provenances : mapping of str to mapping, optional
        From what each surface was made, by horizon, as JSON holds it.
    meshes : mapping of str to TriangleMesh, optional
        Triangles of bodies in map coordinates, by name; each takes the place of its body's former file.

    Returns
    -------
    Project
        What was written, with hashes and results.

    Raises
    ------
    InputError
        If a file cannot be written.
    StitchError
        If patches do not make one valid shell; the project file on the disk stays as it was.

    Notes
    -----
    Layout of the file: ``docs/formats_out.md``, "The project file".
    """
    target = Path(path)
    before = _written(target)
    former = {result.surface for result in (*project.results, *before.results)}
    former |= {body.mesh for body in (*project.bodies, *before.bodies)}
    results = {result.horizon: result for result in project.results}
    for name, surface in (surfaces or {}).items():
        results[name] = replace(
            _write_surface(name, surface, target), provenance=plain((provenances or {}).get(name, {}))
        )
    drawn = meshes or {}
    bodies = tuple(
        _with_mesh(body, drawn[body.name], target) if body.name in drawn else body for body in project.bodies
    )
    sources = tuple(_hashed(source, target.parent) for source in project.sources)
    saved = Project(
        name=project.name,
        crs=project.crs,
        sources=sources,
        settings=dict(project.settings),
        edits=project.edits,
        results=tuple(results.values()),
        bodies=bodies,
    )
    data = {"format": FORMAT, "version": VERSION} | plain(asdict(saved))
    if not bodies:
        del data["bodies"]
    text = json.dumps(data, ensure_ascii=False, indent=1, allow_nan=False)
    try:
        with replacing(target) as part:
            part.write_text(text + "\n", encoding="utf-8", newline="\n")
    except OSError as error:
        raise InputError(
            message(
                "io.project-not-written",
                "The project cannot be written: {error}",
                error=error.strerror or str(error),
            ),
            message("data.make-or-name-folder", "Make the folder, or name another."),
            file=str(target),
        ) from None
    for old_file in former - {result.surface for result in saved.results} - {body.mesh for body in bodies}:
        # Only what this project wrote itself, never a file from elsewhere.
        folder, _, name = old_file.partition("/")
        if folder == file_folder(target).name and (SURFACE_FILE.fullmatch(name) or BODY_FILE.fullmatch(name)):
            # Another program may have it open; the project is saved all the same.
            with suppress(OSError):
                (file_folder(target) / name).unlink(missing_ok=True)
    return saved


def is_project(path: Path) -> bool:
    """Whether a file is a project by its ending."""
    return path.suffix.lower() == ENDING


@arguments_checked
def open_project(path: str | PathLike[str]) -> Project:
    """Read a project file of this or any older version.

    Parameters
    ----------
    path : path
        A ``*.geofit`` file.

    Returns
    -------
    Project
        Sources, settings, edits and results; :mod:`geofit.io.project` loads the surfaces.

    Raises
    ------
    InputError
        If there is no such file, it is not a project file, or a newer geofit wrote it.

    Notes
    -----
    Layout of the file: ``docs/formats_out.md``, "The project file".
    """
    source = Path(path)
    try:
        data = json.loads(Source(path=source, name=legible(str(source))).read().decode("utf-8"))
    except (ValueError, RecursionError) as error:
        what, line = parser_message(error)
        raise InputError(
            message("io.project-invalid", "This is not a valid project file: {error}", error=what),
            message("io.open-or-correct-project", "Open a *.geofit file, or correct its JSON."),
            file=str(source),
            row=line,
        ) from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(
            message("io.format-not-stated", "The file does not state the format '{format}'", format=FORMAT),
            message("io.open-project-file", "Open a *.geofit file."),
            file=str(source),
        )
    version = data.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version < 0:
        raise InputError(
            message("io.version-missing", "The project has no version"),
            message("io.give-version-number", "Give it as a number up to {known}.", known=VERSION),
            file=str(source),
        )
    if version > VERSION:
        raise InputError(
            message(
                "io.version-too-new",
                "The project was saved by a newer geofit: its version is {version}, this geofit ({program}) "
                "reads up to {known}",
                version=version,
                program=__version__,
                known=VERSION,
            ),
            message("io.use-newer-geofit-for-project", "Open it with the geofit that saved it, or with a newer one."),
            file=str(source),
        )
    try:
        for older in range(version, VERSION):
            data = MIGRATIONS[older](data)
        return _project(data)
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError, SettingsError) as error:
        raise InputError(
            message(
                "io.project-incomplete",
                "The project does not contain what version {version} requires: {error}",
                version=version,
                error=parser_message(error)[0] if isinstance(error, KeyError) else str(error),
            ),
            message("data.undo-last-edit", "Undo the last manual edit, or open a copy."),
            file=str(source),
        ) from None


def load_surfaces(project: Project, folder: str | PathLike[str]) -> dict[str, HorizonFit]:
    """Read the surfaces of a project by horizon; errors as :func:`geofit.cad.step.read_step`."""
    from geofit.cad.step import read_step

    found = {}
    for result in project.results:
        surface = next(iter(read_step(Path(folder) / result.surface).values()))
        settings = project.settings.get(result.horizon, FitSettings())
        found[result.horizon] = HorizonFit(surface, settings=settings, name=result.horizon)
    return found


def _project(data: Mapping[str, Any]) -> Project:
    unknown = set(data) - {"format", "version"} - {f.name for f in fields(Project)}
    if unknown:
        raise ValueError(f"unknown key '{min(unknown)}'")
    if not isinstance(data["name"], str) or not isinstance(data.get("crs", ""), str):
        raise TypeError("name and crs must be text")
    return Project(
        name=data["name"],
        crs=data.get("crs", ""),
        sources=tuple(_entry(ProjectSource, entry) for entry in data.get("sources", [])),
        settings={name: _settings(values) for name, values in data.get("settings", {}).items()},
        edits=tuple(_entry(Edit, entry) for entry in data.get("edits", [])),
        results=tuple(_entry(ProjectResult, entry) for entry in data.get("results", [])),
        bodies=tuple(_entry(ProjectBody, entry) for entry in data.get("bodies", [])),
    )


def _entry(kind: type[_Entry], values: Mapping[str, Any]) -> _Entry:
    """Return an entry of a list of the file, each value of the type that it should have."""
    entry = kind(**values)
    for one in fields(kind):
        value = getattr(entry, one.name)
        allowed = _TYPES[str(one.type)]
        if not isinstance(value, allowed) or (isinstance(value, bool) and bool not in allowed):
            raise TypeError(f"{one.name} is {shown(value):.60}")
        if isinstance(value, (int, float)) and not isinstance(value, bool) and not is_finite(value):
            raise ValueError(f"{one.name} is {shown(value):.60}")
        if one.name == "path" and "\0" in str(value):
            raise ValueError("a path has a NUL character")
    if isinstance(entry, ProjectResult):
        # Another name could lead anywhere on the disk, from where a surface is read and where an old one is removed.
        folder, _, name = entry.surface.partition("/")
        if not (_SURFACE_FOLDER.fullmatch(folder) and SURFACE_FILE.fullmatch(name)):
            raise ValueError(f"the surface file is {entry.surface!r:.60}")
    if isinstance(entry, ProjectBody) and entry.mesh:
        folder, _, name = entry.mesh.partition("/")
        if not (_SURFACE_FOLDER.fullmatch(folder) and BODY_FILE.fullmatch(name)):
            raise ValueError(f"the file of a body is {entry.mesh!r:.60}")
    return entry


def _settings(values: Mapping[str, Any]) -> FitSettings:
    core = values.get("core")
    if isinstance(core, list):
        values = {**values, "core": tuple((float(x), float(y)) for x, y in core)}
    return FitSettings(**values)


def _from_0(data: Mapping[str, Any]) -> dict[str, Any]:
    """Version 0 had a title, a flat list of files with hashes, and one epsilon a horizon."""
    return {
        "format": FORMAT,
        "version": 1,
        "name": data["title"],
        "sources": [{"path": path, "sha256": digest} for path, digest in data["files"].items()],
        "settings": {name: {"epsilon": epsilon} for name, epsilon in data["epsilon"].items()},
    }


#: Keys of version 1 that have another name since, and kinds of edits.
_RENAMED = {"recipe": "provenance", "conflict_distance": "coincidence_distance"}
_RENAMED_KINDS = {"apart": "separate"}


def _from_1(data: Mapping[str, Any]) -> dict[str, Any]:
    """Version 1 had other names for the provenance, the coincidence distance, and the separation of horizons."""

    def renamed(value: Any, key: str = "") -> Any:
        if isinstance(value, Mapping):
            return {_RENAMED.get(name, name): renamed(inner, name) for name, inner in value.items()}
        if isinstance(value, list):
            return [renamed(inner) for inner in value]
        return _RENAMED_KINDS.get(value, value) if key == "kind" else value

    # Sources come from the user: a mapping names columns of his files.
    changed = {key: renamed(data[key]) for key in ("settings", "edits", "results") if key in data}
    return {**data, **changed, "version": 2}


def _from_2(data: Mapping[str, Any]) -> dict[str, Any]:
    """Version 2 had no bodies, no files in addition to those of the site file, and no earlier data."""
    if "bodies" in data:
        raise ValueError("unknown key 'bodies'")
    return {**data, "version": 3}


def _from_3(data: Mapping[str, Any]) -> dict[str, Any]:
    """Version 3 had excluded rows without their points."""
    return {**data, "version": 4}


#: What turns version k into version k + 1.
MIGRATIONS: dict[int, Callable[[Mapping[str, Any]], dict[str, Any]]] = {
    0: _from_0,
    1: _from_1,
    2: _from_2,
    3: _from_3,
}


def _written(target: Path) -> Project:
    """Return the project that is where another is to be written; an empty one if there is none."""
    if not target.is_file():
        return Project(name="")
    try:
        return open_project(target)
    except InputError:
        return Project(name="")  # no project, or a broken one: nothing in it can be trusted


def _write_surface(name: str, surface: HorizonFit, target: Path) -> ProjectResult:
    file, digest = write_surface_file(name, surface, target)
    accuracy = surface.accuracy
    return ProjectResult(
        horizon=name,
        surface=file,
        sha256=digest,
        n=len(surface.points),
        sigma=None if accuracy is None else accuracy.sigma,
        passed=None if accuracy is None else accuracy.passed,
        geofit=__version__,
    )


def _with_mesh(body: ProjectBody, mesh: TriangleMesh, target: Path) -> ProjectBody:
    file, digest = write_body_file(body.name, mesh, target)
    return replace(body, mesh=file, sha256=digest)


def _hashed(source: ProjectSource, folder: Path) -> ProjectSource:
    file = folder / source.path
    if source.sha256 or not file.is_file():
        return source
    return ProjectSource(path=source.path, role=source.role, sha256=sha256_of(file), mapping=dict(source.mapping))
