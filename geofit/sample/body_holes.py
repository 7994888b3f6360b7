"""Deviated holes that cross the rock bodies of the sample site, and their tables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.sample.bodies import BODIES, BodyTruth, body_truth
from geofit.sample.paths import borehole_path, zero_between
from geofit.sample.tables import table, write
from geofit.sample.truth import ground

__all__ = ["BodyHole", "drill_bodies", "write_bodies"]

Floats = NDArray[np.float64]

#: Prefix of the holes of each body, how many in each direction, and how far they lie beyond its box (share of it).
_CAMPAIGNS = {"ORE": ("OR", (7, 6), 0.97), "VOID": ("KV", (8, 4), 1.0), "GABBRO": ("GB", (8, 5), 1.05)}
#: What the log calls rock that is none of the bodies.
HOST = "HOST"
_NAMES = {"ORE": "massive sulphide ore", "VOID": "open void", "GABBRO": "gabbro", HOST: "country rock"}
#: Standard deviation of a logged depth, metres.
NOISE = 0.05
_STEP = 0.25


@dataclass(frozen=True)
class BodyHole:
    """A hole: its collar, (k, 3) stations of depth, azimuth and dip, and its intervals (top, base, code)."""

    name: str
    collar: Floats
    depth: float
    survey: Floats
    intervals: tuple[tuple[float, float, str], ...]


def drill_bodies() -> tuple[BodyHole, ...]:
    """Return the holes of all bodies; the same at every call."""
    rng = np.random.default_rng(47)
    holes: list[BodyHole] = []
    for body in BODIES:
        prefix, (across, along), wide = _CAMPAIGNS[body]
        truth = body_truth(body)
        for i in range(across * along):
            share = np.array([i % across + 0.5, i // across + 0.5]) / (across, along) * 2 - 1
            target = truth.half[:2] * wide * (share + rng.uniform(-0.35, 0.35, 2) / (across, along))
            holes.append(_drill(f"{prefix}{i + 1:02d}", truth, target, rng))
    return tuple(holes)


def _drill(name: str, truth: BodyTruth, target: Floats, rng: np.random.Generator) -> BodyHole:
    """Drill from the ground through a place on the body's middle level, 40 m beyond its box."""
    azimuth, dip = rng.uniform(0, 360), rng.uniform(72, 88)
    turn, fall = np.radians([azimuth, dip])
    way = np.array([np.sin(turn) * np.cos(fall), np.cos(turn) * np.cos(fall), -np.sin(fall)])
    middle = truth.to_map(np.array([[*target, 0.0]]))[0]
    up = 0.0
    for _ in range(20):
        collar = middle - up * way
        up += (float(ground(collar[0], collar[1])) - collar[2]) / np.sin(fall)
    collar = np.round(middle - up * way, 2)
    collar[2] = np.round(float(ground(collar[0], collar[1])), 2)
    depth = round(up + (float(truth.half[2]) + 40.0) / float(np.sin(fall)), 1)
    at = np.append(np.arange(0.0, depth - 5.0, 30.0), depth)
    bend = np.arange(len(at))
    survey = np.column_stack(
        [
            at,
            np.round((azimuth + rng.uniform(-0.6, 0.6) * bend + rng.normal(0, 0.3, len(at))) % 360, 1),
            np.round(np.minimum(dip + rng.uniform(-0.5, 0.3) * bend + rng.normal(0, 0.15, len(at)), 89.9), 1),
        ]
    )
    return BodyHole(name, collar, depth, survey, _logged(truth, collar, survey, depth, rng))


def _logged(
    truth: BodyTruth, collar: Floats, survey: Floats, depth: float, rng: np.random.Generator
) -> tuple[tuple[float, float, str], ...]:
    """Return what the log will show: the hole in and out of the body."""
    path = borehole_path(collar, survey)
    at = np.linspace(0.0, depth, int(depth / _STEP) + 1)
    inside = truth.value(path(at)) < 0
    ends = [
        round(zero_between(lambda d: truth.value(path(d)), at[i], at[i + 1]) + rng.normal(0, NOISE), 2)
        for i in np.flatnonzero(inside[1:] != inside[:-1])
    ]
    ends = [0.0, *ends, depth]
    codes = [truth.name if (k % 2 == 1) != inside[0] else HOST for k in range(len(ends) - 1)]
    return tuple(zip(ends[:-1], ends[1:], codes, strict=True))


def write_bodies(folder: Path) -> None:
    """Write ``bodies.toml`` and the tables that it names into ``bodies/``."""
    holes = drill_bodies()
    (folder / "bodies").mkdir(parents=True, exist_ok=True)
    collars = ((hole.name, *(f"{c:.2f}" for c in hole.collar), f"{hole.depth:.1f}") for hole in holes)
    write(folder / "bodies" / "collar.csv", table(("hole_id", "x", "y", "z", "depth"), collars))
    stations = ((hole.name, *(f"{value:.1f}" for value in station)) for hole in holes for station in hole.survey)
    write(folder / "bodies" / "survey.csv", table(("hole_id", "depth", "azimuth", "dip"), stations))
    write(
        folder / "bodies" / "lithology.csv",
        table(("hole_id", "from", "to", "code", "description"), _rows(holes)),
    )
    write(folder / "bodies.toml", _SITE)


def _rows(holes: Iterable[BodyHole]) -> Iterable[tuple[str, ...]]:
    for hole in holes:
        for top, base, code in hole.intervals:
            yield hole.name, f"{top:.2f}", f"{base:.2f}", code, _NAMES[code]


_SITE = """\
# Holes through three bodies below the fictional dam site: codes ORE, VOID and GABBRO.
# geofit body sample_data/bodies.toml --code ORE --out results
[site]
name = "Heishui bend, bodies (fictional)"
crs = "local grid, fictional"

[boreholes]
collar = "bodies/collar.csv"
survey = "bodies/survey.csv"
intervals = "bodies/lithology.csv"
dip = "down-positive"
"""
