"""From the provenance of a body to the body: data read, fitted, checked, its volumes. Without Qt; it runs in a process.

The same provenance makes the same body to the last bit, as long as its source holds the data that it held then.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.settings import BodySettings
from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite
from geofit.data.progress import Progress, tell
from geofit.data.stale import StaleCause
from geofit.data.verdict import Verdict, verdict_of
from geofit.implicit.mesh import TriangleMesh
from geofit.project.body_record import (
    BetweenHorizons,
    BodyProvenance,
    BodySource,
    ClosedMesh,
    Intervals,
    MorphFrame,
    Outlines,
    SurfacePicks,
)
from geofit.project.body_sources import file_digest, read_body_source
from geofit.project.mesh_body import MeshBody, read_mesh_body

if TYPE_CHECKING:
    from geofit.bodies.accuracy import BodyAccuracy
    from geofit.bodies.body import BodyFit
    from geofit.bodies.questions import Question
    from geofit.bodies.simulate import BodyVolumes
    from geofit.bodies.strata import StratumVolume
    from geofit.bodies.violations import Violation
    from geofit.data.prediction import LeftOutBody
    from geofit.data.site import Ground
    from geofit.morphing.body import MorphBody

__all__ = [
    "BodyResult",
    "end_shape",
    "made_body",
    "make_body",
    "measured_strata",
    "origin_text",
]

Floats = NDArray[np.float64]
#: How a body came here: fitted in this session, made again as a project names it, or read from the project's file.
Origin = Literal["fitted", "again", "read back"]


@dataclass(frozen=True, eq=False)
class BodyResult:
    """A body with what was found out about it.

    ``strata`` are its volumes between horizons, ``divided_by`` the surfaces that were available for them by name,
    ``questions`` what outlines on sections leave open, ``left_out`` how well its holes predict each other.
    ``origin`` is how it came here; ``difference`` the largest distance in metres between a body made again and the
    triangles that the project held, nan where nothing was compared. ``stale`` lists what has changed since it was made,
    where that was looked for.
    """

    body: BodyFit | MorphBody | MeshBody
    volumes: BodyVolumes | None = None
    strata: tuple[StratumVolume, ...] = ()
    divided_by: tuple[str, ...] = ()
    violations: tuple[Violation, ...] = ()
    questions: tuple[Question, ...] = ()
    left_out: LeftOutBody | None = None
    origin: Origin = "fitted"
    difference: float = np.nan
    stale: tuple[StaleCause, ...] = ()

    @property
    def accuracy(self) -> BodyAccuracy | None:
        """The check of a fitted body; None of others."""
        return getattr(self.body, "accuracy", None)

    @property
    def warnings(self) -> tuple[Message, ...]:
        """What limits the use of the body."""
        return getattr(self.body, "notes", ()) if self.accuracy is None else self.accuracy.warnings

    @property
    def verdict(self) -> Verdict | None:
        """The verdict of a fitted body with its three lamps; None of others."""
        return None if self.accuracy is None else verdict_of(self.accuracy, self.left_out)

    @property
    def fitted(self) -> BodyFit | None:
        """The body if it was fitted to data and has its field; None of others."""
        from geofit.bodies.body import BodyFit

        return self.body if isinstance(self.body, BodyFit) else None

    @property
    def mesh(self) -> TriangleMesh:
        """Closed triangles about the local origin."""
        return self.body.overview

    @property
    def volume(self) -> float:
        """The volume that is reported, m3: that of the fitted field, or of the triangles of others."""
        return self.mesh.volume if self.volumes is None else self.volumes.best


def make_body(
    source: BodySource,
    settings: BodySettings,
    name: str,
    campaigns: Sequence[Any],
    folder: Path,
    horizons: Mapping[str, Any],
    progress: Progress | None = None,
    ground: Ground | None = None,
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
    ground : Ground, optional
        The ground of the open site: bodies between horizons end at it.

    Raises
    ------
    GeofitError
        As :func:`geofit.fit_body`, :func:`geofit.io.read_body` and :func:`geofit.morph`.
    """
    tell(progress, "read", 0.0)
    match source:
        case Intervals() | Outlines() | SurfacePicks():
            result, given = _fitted(source, settings, name, campaigns, folder, progress)
        case ClosedMesh(file):
            result, given = BodyResult(read_mesh_body(folder / file, name)), file_digest(folder / file)
        case BetweenHorizons(upper, lower):
            from geofit.project.horizon_body import horizon_body

            closed = horizon_body(upper, lower, name, horizons, ground)
            result, given = BodyResult(closed), closed.digest
        case MorphFrame():
            made = [
                make_body(end.source, end.settings, one, campaigns, folder, horizons, None, ground)
                for end, one in zip(source.ends, source.names, strict=True)
            ]
            tell(progress, "morph", 0.4)
            result = BodyResult(frame_of(source, [one.body for _, one in made], name, progress))
            given = hashlib.sha256(" ".join(provenance.given for provenance, _ in made).encode()).hexdigest()[:16]
    tell(progress, "strata", 0.85)
    return BodyProvenance(source, settings, given), measured_strata(result, horizons)


def _fitted(
    source: Intervals | Outlines | SurfacePicks,
    settings: BodySettings,
    name: str,
    campaigns: Sequence[Any],
    folder: Path,
    progress: Progress | None,
) -> tuple[BodyResult, str]:
    """Fit a body to what its source holds; return also the hash of it."""
    from geofit.bodies.crossval import left_out_body
    from geofit.bodies.fit import fit_body
    from geofit.bodies.questions import section_questions
    from geofit.bodies.violations import violations

    read = read_body_source(source, settings, campaigns, folder, progress)
    tell(progress, "fit", 0.1)
    body = fit_body(read.data, settings, name=name)
    tell(progress, "volumes", 0.5)
    volumes = body.volumes()
    tell(progress, "holes left out", 0.65)
    questions = section_questions(read.outlines, body) if read.outlines else ()
    found = BodyResult(body, volumes, violations=violations(body), questions=questions, left_out=left_out_body(body))
    return found, read.given


def made_body(
    source: BodySource, settings: BodySettings, name: str, campaigns: Sequence[Any], folder: Path,
    horizons: Mapping[str, Any], ground: Ground | None, *, progress: Progress,
) -> tuple[BodyProvenance, BodyResult]:  # fmt: skip
    """Make a body, with progress by keyword; see :func:`make_body`."""
    return make_body(source, settings, name, campaigns, folder, horizons, progress, ground)


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

    shapes = [end_shape(end) for end in ends]
    way: dict[str, Any] = {
        "mode": source.mode,
        "pace": source.pace,
        "dates": source.dates or None,
        "seeds": source.seeds,
        "names": source.names,
    }
    made = morph(*shapes, cells=source.cells, progress=progress, **way)
    body = replace(made(source.tau), name=name)
    _ = body.overview  # here, not in the window
    return body


def end_shape(body: Any) -> Any:
    """Return a body as :func:`geofit.morph` takes it: triangles of a file in map coordinates, others as they are."""
    if isinstance(body, MeshBody) and body.closed is not None:
        return body.closed
    if isinstance(body, MeshBody):
        return TriangleMesh(body.overview.vertices + body.origin, body.overview.triangles)
    return body


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
