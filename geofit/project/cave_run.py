"""From a survey or a centre line to the files of its passages: loops, stations, filled walls, volume, triangles."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geofit.data.accuracy import plain
from geofit.data.files import file_stems, folder_for, replacing, spreadsheet_cell
from geofit.data.progress import Progress, tell
from geofit.project.body_files import write_figures, write_triangles

if TYPE_CHECKING:
    from geofit.caves.adjust import AdjustedSurvey
    from geofit.caves.body import PassageBody
    from geofit.caves.clearance import Clearance
    from geofit.caves.strata import Stratum
    from geofit.caves.survey import Survey
    from geofit.caves.uncertainty import VolumeEstimate
    from geofit.data.messages import Message
    from geofit.implicit.mesh import TriangleMesh
    from geofit.surfaces.protocol import HasElevation

__all__ = ["CaveRun", "cut_passages", "measure_passages", "read_survey", "write_passages"]

#: Code of the reader's warning of shots that are used without a correction.
UNCORRECTED = "io.shots-uncorrected"
#: Spacing of the triangles, in units of the spacing that resolves most sections; where they miss more than this share
#: of the volume, they become finer, up to about so many triangles.
COARSER, MISSED, MOST_TRIANGLES = 3.0, 0.01, 400_000
#: Share of what may be missed that a finer spacing aims at, and how often one is tried.
AIM, ROUNDS = 0.7, 3


@dataclass(frozen=True, eq=False)
class CaveRun:
    """Passages of a survey, their volume, their triangles with the spacing (metres), and the files.

    ``strata`` are the parts between horizons, ``clearance`` the distances of a planned excavation, if asked for.
    """

    body: PassageBody
    volume: VolumeEstimate
    spacing: float
    triangles: TriangleMesh
    files: tuple[Path, ...]
    strata: tuple[Stratum, ...] = ()
    clearance: Clearance | None = None

    @property
    def adjusted(self) -> AdjustedSurvey:
        """Stations and loops."""
        return self.body.adjusted

    @property
    def uncorrected(self) -> tuple[Message, ...]:
        """Warnings of shots that are used without a correction: their directions or lengths are as measured."""
        return tuple(one.reason for one in self.adjusted.survey.issues if one.reason.code == UNCORRECTED)

    def figures(self) -> dict[str, Any]:
        """Return everything that the JSON file has, as plain data; metres."""
        from geofit import __version__

        survey = self.adjusted.survey
        loops = [
            {
                "stations": list(loop.stations),
                "length": loop.length,
                "misclosure": loop.distance,
                "percent": loop.percent,
                "expected": loop.expected,
                "suspicious": loop.suspicious,
            }
            for loop in self.adjusted.loops
        ]
        estimate = self.volume
        return {
            "survey": survey.name,
            "stations": len(survey.stations),
            "shots": len(survey.start),
            "length": survey.length,
            "uncorrected": plain(self.uncorrected),
            "loops": plain(loops),
            "filled_walls": plain(self.body.sections.filled),
            "volume": {**plain(estimate), "sigma": estimate.sigma, "p10": estimate.p10, "p90": estimate.p90},
            "strata": plain(self.strata),
            "clearance": None if self.clearance is None else _nearest(self.clearance),
            "mesh_spacing": self.spacing,
            "mesh_volume": self.triangles.volume,
            "thinner_than_mesh": [list(shot) for shot in self.body.thinner_than(self.spacing)],
            "version": __version__,
        }


def _nearest(clearance: Clearance) -> dict[str, Any]:
    n = clearance.nearest
    return {
        "least": clearance.least,
        "sigma": float(clearance.sigma[n]),
        "station": clearance.station[n],
        "point": clearance.points[n].tolist(),
        "wall": clearance.wall[n].tolist(),
    }


def read_survey(path: Path) -> Survey:
    """Read a Compass file (.dat), a Survex file (.svx), or any other file as a table of a centre line.

    Raises
    ------
    InputError
        If the file is missing, or has no survey.
    """
    from geofit.io.centreline import read_centreline
    from geofit.io.compass import read_compass
    from geofit.io.survex import read_survex

    match path.suffix.casefold():
        case ".dat":
            return read_compass(path)
        case ".svx":
            return read_survex(path)
        case _:
            return read_centreline(path)


def measure_passages(
    survey: Survey,
    *,
    radius: float | None = None,
    spacing: float | None = None,
    excavation: Survey | None = None,
    horizons: Mapping[str, HasElevation] | None = None,
    progress: Progress | None = None,
) -> CaveRun:
    """Adjust a survey and make its passages a body.

    Parameters
    ----------
    survey : Survey
        What was measured.
    radius : float, optional
        Distance of the walls of a survey without walls, metres.
    spacing : float, optional
        Spacing of the triangles, metres; by default three eighths of the median diameter, and less where the
        triangles would miss more than 1 % of the volume.
    excavation : Survey, optional
        A planned excavation with the size of its section, whose distance from the passages is wanted.
    horizons : mapping of str to surface, optional
        Horizons from the top down that cut the passages into strata.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    SurveyError, SettingsError
        As for :func:`geofit.centreline_body`.
    """
    from geofit.caves.adjust import adjust_survey
    from geofit.caves.body import centreline_body
    from geofit.caves.clearance import clearance, excavation_points
    from geofit.caves.uncertainty import volume_estimate

    tell(progress, "adjust", 0.0)
    adjusted = adjust_survey(survey)
    body = centreline_body(adjusted, radius=radius)
    tell(progress, "volume", 0.1)
    volume = volume_estimate(body)
    tell(progress, "triangles", 0.5)
    step, triangles = _triangles(body, volume.volume) if spacing is None else (spacing, body.triangulate(spacing))
    away = None
    if excavation is not None:
        tell(progress, "clearance", 0.8)
        points, size = excavation_points(adjust_survey(excavation))
        away = clearance(body, points, polyline=False, radius=size)
    run = CaveRun(body, volume, step, triangles, (), (), away)
    return cut_passages(run, horizons, progress) if horizons else run


def _triangles(body: PassageBody, volume: float) -> tuple[float, TriangleMesh]:
    """Return triangles that have the volume of the passages, and their spacing."""
    step = COARSER * body.fine
    triangles = body.triangulate(step)
    for _ in range(ROUNDS):
        missed = abs(triangles.volume - volume) / max(volume, 1e-300)
        # What is missed falls with the square of the spacing, and the triangles grow with it.
        finer = max(np.sqrt(AIM * MISSED / max(missed, MISSED)), np.sqrt(len(triangles.triangles) / MOST_TRIANGLES))
        if missed <= MISSED or finer >= 1:
            break
        step = float(finer) * step
        triangles = body.triangulate(step)
    return step, triangles


def cut_passages(run: CaveRun, horizons: Mapping[str, HasElevation], progress: Progress | None = None) -> CaveRun:
    """Return the run with its passages cut by horizons, from the top down.

    Raises
    ------
    SettingsError
        If no horizon is given.
    """
    from geofit.caves.strata import strata

    tell(progress, "strata", 0.85)
    return replace(run, strata=strata(run.body, horizons))


def write_passages(run: CaveRun, out: Path) -> CaveRun:
    """Write the files of a run; return the run with them.

    The files: ``NAME_stations.csv``, ``NAME_loops.csv``, ``NAME_filled_walls.csv``, the body as ``NAME.stl`` and
    ``.vtp``, and ``NAME.json`` with the figures; ``NAME_strata.csv`` with horizons, ``NAME_clearance.csv`` with an
    excavation.

    Parameters
    ----------
    run : CaveRun
    out : Path
        Folder for the files; created if missing. Each file is whole or absent.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    name = Path(run.adjusted.survey.name).stem
    stem = folder_for(out) / file_stems([name])[name]
    tables = (*_write_tables(run.body, stem), *_write_cuts(run.strata, run.clearance, stem))
    figures = stem.with_name(f"{stem.name}.json")
    files = (figures, *tables, *write_triangles(run.triangles, stem))
    write_figures(run.figures(), figures)
    return replace(run, files=files)


def _write_tables(body: PassageBody, stem: Path) -> tuple[Path, ...]:
    adjusted = body.adjusted
    stations = zip(adjusted.survey.stations, adjusted.xyz.tolist(), adjusted.sigma.tolist(), strict=True)
    loops = (
        (*(f"{x:.3f}" for x in (loop.length, loop.distance, loop.percent, loop.expected)),
         "yes" if loop.suspicious else "no", " ".join(loop.stations))
        for loop in adjusted.loops
    )  # fmt: skip
    return (
        _table(
            stem.with_name(f"{stem.name}_stations.csv"),
            ("station", "x", "y", "z", "sigma_x_m", "sigma_y_m", "sigma_z_m"),
            ((name, *(f"{value:.4f}" for value in (*xyz, *sigma))) for name, xyz, sigma in stations),
        ),
        _table(
            stem.with_name(f"{stem.name}_loops.csv"),
            ("length_m", "misclosure_m", "misclosure_percent", "expected_m", "suspicious", "stations"),
            loops,
        ),
        _table(
            stem.with_name(f"{stem.name}_filled_walls.csv"),
            ("station", "wall", "distance_m"),
            ((filled.station, filled.wall, f"{filled.distance:.3f}") for filled in body.sections.filled),
        ),
    )


def _write_cuts(parts: Sequence[Stratum], away: Clearance | None, stem: Path) -> tuple[Path, ...]:
    files = []
    if parts:
        rows = ((p.top, p.base, "yes" if p.known else "no", f"{p.length:.3f}", f"{p.volume:.3f}") for p in parts)
        path = stem.with_name(f"{stem.name}_strata.csv")
        files.append(_table(path, ("top", "base", "known", "length_m", "volume_m3"), rows))
    if away is not None:
        places = zip(away.points.tolist(), away.distance.tolist(), away.wall.tolist(), strict=True)
        cells = (
            (*(f"{v:.3f}" for v in (*point, distance, *wall)), station, f"{sigma:.3f}")
            for (point, distance, wall), station, sigma in zip(places, away.station, away.sigma.tolist(), strict=True)
        )
        header = ("x", "y", "z", "distance_m", "wall_x", "wall_y", "wall_z", "station", "sigma_m")
        files.append(_table(stem.with_name(f"{stem.name}_clearance.csv"), header, cells))
    return tuple(files)


def _table(path: Path, header: Sequence[str], rows: Iterable[Sequence[str]]) -> Path:
    # The byte-order mark lets spreadsheets read the text as UTF-8.
    with replacing(path) as part, part.open("w", encoding="utf-8-sig", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([spreadsheet_cell(cell) for cell in row] for row in rows)
    return path
