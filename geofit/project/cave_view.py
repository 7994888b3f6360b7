"""A survey of passages for looking at: centre line, stations, loops and walls in space, body and files on request."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError
from geofit.data.files import file_stems
from geofit.data.languages import EN, Language
from geofit.data.progress import Progress, tell
from geofit.project.cave_run import CaveRun, cut_passages, measure_passages, read_survey, write_passages

if TYPE_CHECKING:
    from geofit.caves.adjust import AdjustedSurvey
    from geofit.caves.body import PassageBody
    from geofit.caves.survey import Survey
    from geofit.surfaces.protocol import HasElevation

__all__ = [
    "WallRings", "cut_view", "measured_view", "passage_mesh", "read_adjusted", "shot_states", "view_files",
    "wall_distance_counts", "wall_rings", "write_view",
]  # fmt: skip

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Corners of the drawn section.
SIDES = 32


@dataclass(frozen=True, eq=False)
class WallRings:
    """Sections of passages as closed lines: corners (k, SIDES, 3), metres; (k,) whether all walls were measured."""

    corners: Floats
    measured: NDArray[np.bool_]


def read_adjusted(path: Path, *, progress: Progress | None = None) -> AdjustedSurvey:
    """Read a survey and adjust it.

    Raises
    ------
    InputError
        If the file is missing, or is not a survey.
    SurveyError
        If stations are unconnected.
    """
    from geofit.caves.adjust import adjust_survey

    tell(progress, "read", 0.0)
    survey = read_survey(path)
    try:
        return adjust_survey(survey)
    except GeofitError as error:
        # Rows that are not used may be why stations are unconnected.
        error.issues = error.issues or survey.issues
        raise


def wall_distance_counts(survey: Survey) -> bool:
    """Return whether a wall distance has an effect: no station has walls at its sides, or none has roof and floor."""
    pairs = survey.walls[:, :2], survey.walls[:, 2:]
    # Two walls of 0 were not measured.
    return not all(np.isfinite(pair[(pair != 0).any(axis=1)]).any() for pair in pairs)


def measured_view(
    survey: Survey, radius: float | None, horizons: Mapping[str, HasElevation], *, progress: Progress | None = None
) -> CaveRun:
    """Make the passages a body, as :func:`geofit.project.cave_run.measure_passages`."""
    return measure_passages(survey, radius=radius, horizons=horizons, progress=progress)


def cut_view(run: CaveRun, horizons: Mapping[str, HasElevation], *, progress: Progress | None = None) -> CaveRun:
    """Return the run with its passages cut by horizons; without horizons, uncut."""
    return cut_passages(run, horizons, progress) if horizons else replace(run, strata=())


def write_view(
    run: CaveRun, folder: Path, report: bool = False, t: Language = EN, *, progress: Progress | None = None
) -> CaveRun:
    """Write the files of a run, or its report alone; return the run with what was written."""
    from geofit.project.cave_report import write_cave_report

    tell(progress, "files", 0.0)
    return replace(run, files=write_cave_report(run, folder, t)) if report else write_passages(run, folder)


def view_files(run: CaveRun, folder: Path, report: bool = False) -> tuple[Path, ...]:
    """Return the files that :func:`write_view` writes."""
    name = Path(run.adjusted.survey.name).stem
    endings = (
        ["_report.html", "_report.pdf"] if report else [".json", "_stations.csv", "_loops.csv", "_filled_walls.csv"]
    )
    if not report:
        endings += ["_strata.csv"] if run.strata else []
        endings += ["_clearance.csv"] if run.clearance is not None else []
        endings += [".stl", ".stl.origin.txt", ".vtp"] if len(run.triangles.triangles) else []
    stem = file_stems([name])[name]
    return tuple(folder / f"{stem}{ending}" for ending in endings)


def passage_mesh(run: CaveRun, file: Path, *, progress: Progress | None = None) -> Path:
    """Write the body of the passages as PLY in double precision, in map coordinates; return the file."""
    from geofit.geometry.mesh import Mesh
    from geofit.io.export.triangles import write_ply

    tell(progress, "files", 0.0)
    triangles = run.triangles
    count = len(triangles.triangles)
    patch, uv = np.zeros(count, np.int64), np.zeros((count, 3, 2))
    write_ply({file.stem: Mesh(triangles.vertices, triangles.triangles, patch, uv, np.zeros(3), (file.stem,))}, file)
    return file


def shot_states(adjusted: AdjustedSurvey) -> Ints:
    """Return how far each shot (m,) is checked: 0 by no loop, 1 by a loop that closes, 2 by one to be checked."""
    survey = adjusted.survey
    number = {name: k for k, name in enumerate(survey.stations)}
    shots: dict[tuple[int, int], list[int]] = {}
    for k, (a, b) in enumerate(zip(survey.start.tolist(), survey.end.tolist(), strict=True)):
        shots.setdefault((min(a, b), max(a, b)), []).append(k)
    states = np.zeros(len(survey.start), np.int64)
    for loop in adjusted.loops:
        round_ = [number[name] for name in loop.stations]
        for a, b in zip(round_, [*round_[1:], round_[0]], strict=True):
            for k in shots.get((min(a, b), max(a, b)), ()):
                states[k] = max(states[k], 2 if loop.suspicious else 1)
    return states


def wall_rings(body: PassageBody) -> WallRings:
    """Return the sections at both ends of each shot, made of four quarter ellipses."""
    sweeps, found = body.sweeps, body.sections
    turn = np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
    c, s = np.cos(turn), np.sin(turn)
    left, right, up, down = (sweeps.walls[:, :, k, None] for k in range(4))
    across, upwards = np.where(c >= 0, right, left) * c, np.where(s >= 0, up, down) * s
    along = np.stack([np.zeros_like(sweeps.length), sweeps.length], axis=1)
    centre = sweeps.origin[:, None] + along[..., None] * sweeps.along[:, None]
    corners = (
        centre[:, :, None]
        + across[..., None] * sweeps.right[:, None, None]
        + upwards[..., None] * sweeps.up[:, None, None]
    )
    measured = found.measured[found.source].all(axis=2)
    return WallRings(corners.reshape(-1, SIDES, 3), measured.ravel())
