"""From the provenance of a body to the body: data read, fitted, checked, its volumes. Without Qt; it runs in a process.

The same provenance makes the same body to the last bit, as long as its source holds the data that it held then.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.settings import BodySettings
from geofit.data.errors import InputError
from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite
from geofit.data.progress import Progress, tell
from geofit.implicit.mesh import TriangleMesh
from geofit.project.body_record import BodyProvenance, BodySource, ClosedMesh, Intervals, MorphFrame

if TYPE_CHECKING:
    from geofit.bodies.accuracy import BodyAccuracy
    from geofit.bodies.body import BodyFit
    from geofit.bodies.simulate import BodyVolumes
    from geofit.bodies.strata import StratumVolume
    from geofit.bodies.violations import Violation
    from geofit.data.site import Site
    from geofit.morphing.body import MorphBody

__all__ = [
    "BodyResult",
    "MeshBody",
    "given_of_logs",
    "interval_codes",
    "made_body",
    "make_body",
    "measured_strata",
    "origin_text",
    "site_codes",
]

Floats = NDArray[np.float64]
#: How a body came here: fitted in this session, made again as a project names it, or read from the project's file.
Origin = Literal["fitted", "again", "read back"]


@dataclass(frozen=True, eq=False)
class MeshBody:
    """Closed triangles about a local origin: a body of a file. Nothing was fitted, so nothing is judged."""

    name: str
    origin: Floats
    overview: TriangleMesh
    contacts: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    epsilon: float = 0.5

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners (3,) of a box around the body about the local origin."""
        return self.overview.vertices.min(axis=0), self.overview.vertices.max(axis=0)

    def local_mesh(self, spacing: float) -> TriangleMesh:
        """Return the triangles as they are: a mesh of a file has no other spacing."""
        return self.overview


@dataclass(frozen=True, eq=False)
class BodyResult:
    """A body with what was found out about it.

    ``strata`` are its volumes between horizons, ``divided_by`` the surfaces that were available for them by name.
    ``origin`` is how it came here; ``difference`` the largest distance in metres between a body made again and the
    triangles that the project held, nan where nothing was compared.
    """

    body: BodyFit | MorphBody | MeshBody
    volumes: BodyVolumes | None = None
    strata: tuple[StratumVolume, ...] = ()
    divided_by: tuple[str, ...] = ()
    violations: tuple[Violation, ...] = ()
    origin: Origin = "fitted"
    difference: float = np.nan

    @property
    def accuracy(self) -> BodyAccuracy | None:
        """The check of a fitted body; None of others."""
        return getattr(self.body, "accuracy", None)

    @property
    def fitted(self) -> BodyFit | None:
        """The body if it was fitted to data and has its field; None of others."""
        from geofit.bodies.body import BodyFit

        return self.body if isinstance(self.body, BodyFit) else None

    @property
    def mesh(self) -> TriangleMesh:
        """Closed triangles about the local origin."""
        return self.body.overview


def interval_codes(campaigns: Sequence[Any]) -> dict[str, int]:
    """Return the codes of interval tables with how often each occurs, the most frequent first."""
    counts: dict[str, int] = {}
    for log in (log for campaign in campaigns for log in campaign.logs):
        for code, count in zip(*np.unique(log.code, return_counts=True), strict=True):
            if code:
                counts[str(code)] = counts.get(str(code), 0) + int(count)
    return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


def given_of_logs(campaigns: Sequence[Any]) -> str:
    """Return a hash of all intervals and paths that a body of logged intervals depends on."""
    digest = hashlib.sha256()
    for campaign in campaigns:
        for hole, path in campaign.paths.items():
            digest.update(hole.encode())
            for array in (path.depth, path.xyz):
                digest.update(np.ascontiguousarray(array, np.float64).tobytes())
        for log in campaign.logs:
            digest.update("\n".join([*log.hole.tolist(), *log.code.tolist()]).encode())
            for array in (log.top, log.base):
                digest.update(np.ascontiguousarray(array, np.float64).tobytes())
    return digest.hexdigest()[:16]


def site_codes(file: Path, *, progress: Progress) -> dict[str, int]:
    """Read the site of another file, and return the codes of its interval tables.

    Raises
    ------
    InputError
        If the file cannot be read, or its site has no interval tables.
    """
    return interval_codes(_campaigns(file, progress))


def make_body(
    source: BodySource,
    settings: BodySettings,
    name: str,
    campaigns: Sequence[Any],
    folder: Path,
    horizons: Mapping[str, Any],
    progress: Progress | None = None,
) -> tuple[BodyProvenance, BodyResult]:
    """Make a body, and find out everything about it that a window shows.

    Parameters
    ----------
    source, settings
        What it is made from, and how it is fitted and judged.
    name : str
        Name of the body.
    campaigns : sequence
        Boreholes with logs of the open site.
    folder : Path
        Folder of the open site: files of sources are relative to it.
    horizons : mapping of str to surface
        Those that may cut it.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    GeofitError
        As :func:`geofit.fit_body`, :func:`geofit.io.read_body` and :func:`geofit.morph`.
    """
    tell(progress, "read", 0.0)
    match source:
        case Intervals(codes, file):
            from geofit.bodies.fit import fit_body
            from geofit.bodies.intervals import from_intervals
            from geofit.bodies.violations import violations

            holes = _campaigns(folder / file, progress) if file else campaigns
            data = from_intervals(holes, codes, settings.step)
            tell(progress, "fit", 0.1)
            body = fit_body(data, settings, name=name)
            tell(progress, "volumes", 0.5)
            result = BodyResult(body, body.volumes(), violations=violations(body))
            given = given_of_logs(holes)
        case ClosedMesh(file):
            result, given = BodyResult(read_mesh_body(folder / file, name)), _file_digest(folder / file)
        case MorphFrame():
            made = [
                make_body(end.source, end.settings, one, campaigns, folder, {}, None)
                for end, one in zip(source.ends, source.names, strict=True)
            ]
            tell(progress, "morph", 0.4)
            result = BodyResult(frame_of(source, [one.body for _, one in made], name, progress))
            given = hashlib.sha256(" ".join(provenance.given for provenance, _ in made).encode()).hexdigest()[:16]
    tell(progress, "strata", 0.85)
    return BodyProvenance(source, settings, given), measured_strata(result, horizons)


def made_body(
    source: BodySource, settings: BodySettings, name: str, campaigns: Sequence[Any], folder: Path,
    horizons: Mapping[str, Any], *, progress: Progress,
) -> tuple[BodyProvenance, BodyResult]:  # fmt: skip
    """Make a body, with progress by keyword; see :func:`make_body`."""
    return make_body(source, settings, name, campaigns, folder, horizons, progress)


def measured_strata(result: BodyResult, horizons: Mapping[str, Any], *, progress: Progress | None = None) -> BodyResult:
    """Return a fitted body's result with its volume in each stratum, of the horizons that reach all over it."""
    from geofit.bodies.strata import strata_table
    from geofit.project.single_reports import reaching

    body = result.fitted
    if body is None:
        return result
    tell(progress, "strata", 0.1)
    over = reaching(body, horizons)
    return replace(result, strata=strata_table(body, over) if over else (), divided_by=tuple(over))


def frame_of(source: MorphFrame, ends: Sequence[Any], name: str, progress: Progress | None = None) -> MorphBody:
    """Return the frame of a metamorphosis between bodies."""
    from geofit.morphing.morph import morph

    shapes = [_end(end) for end in ends]
    way: dict[str, Any] = {
        "mode": source.mode,
        "pace": source.pace,
        "dates": source.dates or None,
        "seeds": source.seeds,
    }
    made = morph(*shapes, cells=source.cells, progress=progress, **way)
    body = replace(made(source.tau), name=name)
    _ = body.overview  # here, not in the window
    return body


def _end(body: Any) -> Any:
    """Return a body as :func:`geofit.morph` takes it: triangles of a file in map coordinates, others as they are."""
    if isinstance(body, MeshBody):
        return TriangleMesh(body.overview.vertices + body.origin, body.overview.triangles)
    return body


def read_mesh_body(file: Path, name: str) -> MeshBody:
    """Read a closed body from a file.

    Raises
    ------
    InputError
        If the file cannot be read.
    MorphError
        If the mesh is open or inconsistent; the error names edges.
    """
    from geofit.io.bodies import read_body
    from geofit.morphing.ends import require_closed

    mesh = read_body(file)
    require_closed(mesh, name)
    origin = np.round((mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2, -1)
    return MeshBody(name, origin, TriangleMesh(mesh.vertices - origin, mesh.triangles))


def _campaigns(file: Path, progress: Progress | None) -> Sequence[Any]:
    from geofit.io.site_file import load_site

    site: Site = load_site(file, progress)
    if not any(campaign.logs for campaign in site.boreholes):
        raise InputError(
            message("project.site-without-logs", "The site has no interval tables"),
            message("project.give-site-with-logs", "Give a site file whose [boreholes] names interval tables."),
            file=str(file),
        )
    return site.boreholes


def _file_digest(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()[:16]


def origin_text(result: BodyResult) -> Message:
    """Return in words how a body came here."""
    if result.origin == "read back":
        return message("project.body-read-back", "Read from the project file; it has not been made again.")
    if result.origin == "fitted":
        return message("project.body-made-now", "Made in this session.")
    if not is_finite(result.difference):
        return message("project.body-made-again", "Made again from the same data.")
    if result.difference == 0:
        return message("project.body-made-again-same", "Made again from the same data: the same as the project's file.")
    return message(
        "project.body-made-again-other",
        "Made again from the same data; it differs from the project's file by up to {difference:.3g} m.",
        difference=result.difference,
    )
