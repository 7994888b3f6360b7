"""Kinds of bodies whose truth is known, ten to calibrate with and five to judge by, and campaigns of holes.

The holes have any spacing, pattern, deviation and noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from bodies.planted import ORIGIN, SIZE, Truth, ellipsoid
from geofit.bodies.data import BodyData

Floats = NDArray[np.float64]
Random = np.random.Generator


@dataclass(frozen=True, eq=False)
class Case:
    """A body in the box [-1, 1]^3 and what holes show of it, in map metres."""

    kind: str
    truth: Truth
    data: BodyData

    def volume(self, cells: int = 64) -> float:
        """Return the volume in m3 by counting the cells of a raster."""
        line = (np.arange(cells) + 0.5) / cells * 2 - 1
        plane = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
        count = sum(int((self.truth(np.column_stack([plane, np.full(len(plane), z)])) < 0).sum()) for z in line)
        return count * (2 * SIZE / cells) ** 3


def _length(x: Floats) -> Floats:
    """Return the lengths (n,) of vectors (n, 3); a norm along an axis of three takes several times as long."""
    return np.sqrt(np.einsum("ij,ij->i", x, x))


def _turn(rng: Random) -> Floats:
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def _upright(rng: Random) -> Truth:
    a, b, c = rng.uniform(0.25, 0.65, 3).tolist()
    return ellipsoid((a, b, c))[0]


def _tilted(rng: Random) -> Truth:
    axes, turn = rng.uniform(0.22, 0.65, 3), _turn(rng)
    return lambda x: _length((x @ turn.T) / axes) - 1.0


def _lens(rng: Random) -> Truth:
    axes = np.array([rng.uniform(0.5, 0.75), rng.uniform(0.4, 0.6), rng.uniform(0.1, 0.2)])
    dip = rng.uniform(-0.5, 0.5)
    turn = np.array([[np.cos(dip), 0, np.sin(dip)], [0, 1, 0], [-np.sin(dip), 0, np.cos(dip)]])
    return lambda x: _length((x @ turn.T) / axes) - 1.0


def _bumpy(rng: Random) -> Truth:
    waves = rng.normal(size=(6, 3))
    waves *= (rng.uniform(1, 3, 6) / np.linalg.norm(waves, axis=1))[:, None]
    phase, height = rng.uniform(0, 2 * np.pi, 6), rng.uniform(0.06, 0.18, 6)
    size, stretch = rng.uniform(0.38, 0.5), rng.uniform(0.8, 1.25, 3)

    def truth(x: Floats) -> Floats:
        y = x / stretch
        far = _length(y)
        unit = y / np.maximum(far, 1e-9)[:, None]
        return np.asarray(far - size * (1 + (height * np.sin(unit @ waves.T + phase)).sum(axis=1)))

    return truth


def _tube(rng: Random) -> Truth:
    t = np.linspace(-1, 1, 40)
    line = np.column_stack([0.62 * t, 0.25 * np.sin(2.2 * t + rng.uniform(0, 6)), 0.2 * np.cos(1.7 * t)])
    line = (line - line.mean(axis=0)) @ (_turn(rng) if rng.random() < 0.5 else np.eye(3))
    radius = rng.uniform(0.18, 0.28) * (1 + 0.25 * np.sin(3 * t + rng.uniform(0, 6)))
    return lambda x: (cdist(x, line) - radius).min(axis=1)


def _cuboid(rng: Random) -> Truth:
    half, turn = rng.uniform(0.3, 0.6, 3), _turn(rng)
    return lambda x: (np.abs(x @ turn.T) - half).max(axis=1)


def _ring(rng: Random) -> Truth:
    radius, tube = rng.uniform(0.45, 0.6), rng.uniform(0.2, 0.28)
    turn = _turn(rng) if rng.random() < 0.4 else np.eye(3)

    def truth(x: Floats) -> Floats:
        y = x @ turn
        return np.hypot(np.hypot(y[:, 0], y[:, 1]) - radius, y[:, 2]) - tube

    return truth


def _two(rng: Random) -> Truth:
    first, second = rng.uniform(0.25, 0.38, (2, 3))
    away = np.array([rng.uniform(0.42, 0.55), *rng.uniform(-0.2, 0.2, 2)])
    return lambda x: np.minimum(_length((x - away) / first), _length((x + away) / second)) - 1.0


def _fork(rng: Random) -> Truth:
    turn, radius = _turn(rng) if rng.random() < 0.4 else np.eye(3), rng.uniform(0.17, 0.25)
    ends = np.array([[-0.6, 0, 0], [0.5, 0.4, 0.1], [0.5, -0.4, -0.1]])

    def truth(x: Floats) -> Floats:
        y = x @ turn
        gaps = []
        for end in ends:
            share = np.clip(y @ end / (end @ end), 0.0, 1.0)
            gaps.append(_length(y - share[:, None] * end))
        return np.asarray(np.min(gaps, axis=0) - radius)

    return truth


def horn() -> Truth:
    """Return a body that tapers along an arc, as a horn does."""
    t = np.linspace(0, 1, 60)
    turn = 0.75 * np.pi * t
    line = np.column_stack([0.6 * np.cos(turn) - 0.1, 0.6 * np.sin(turn) - 0.35, 0.3 * t - 0.15])
    return lambda x: (cdist(x, line) - (0.30 - 0.22 * t)).min(axis=1)


KINDS: dict[str, Callable[[Random], Truth]] = {
    "upright ellipsoid": _upright,
    "ellipsoid .6 .4 .3": lambda rng: ellipsoid((0.6, 0.4, 0.3))[0],
    "tilted ellipsoid": _tilted,
    "thin lens": _lens,
    "bumpy": _bumpy,
    "tube": _tube,
    "cuboid": _cuboid,
    "ring": _ring,
    "two bodies": _two,
    "fork": _fork,
}


def _superquadric(rng: Random) -> Truth:
    axes, power, turn = rng.uniform(0.25, 0.65, 3), rng.uniform(1.3, 5), _maybe_turn(rng)
    return lambda x: (np.abs((x @ turn) / axes) ** power).sum(axis=1) ** (1 / power) - 1.0


def _bent_lens(rng: Random) -> Truth:
    axes = np.array([rng.uniform(0.5, 0.75), rng.uniform(0.35, 0.6), rng.uniform(0.1, 0.22)])
    bend, turn = rng.uniform(-0.8, 0.8), _maybe_turn(rng)

    def truth(x: Floats) -> Floats:
        y = x @ turn
        y[:, 2] += bend * (0.15 - y[:, 0] ** 2)
        return np.asarray(_length(y / axes) - 1.0)

    return truth


def _two_parts(rng: Random) -> Truth:
    first, second = rng.uniform(0.2, 0.4, (2, 3))
    away = rng.normal(size=3)
    away *= rng.uniform(0.35, 0.55) / np.linalg.norm(away)
    return lambda x: np.minimum(_length((x - away) / first), _length((x + away) / second)) - 1.0


def _blobs(rng: Random) -> Truth:
    count = int(rng.integers(3, 7))
    centres, radius = rng.uniform(-0.4, 0.4, (count, 3)), rng.uniform(0.2, 0.45, count)

    def truth(x: Floats) -> Floats:
        q = np.clip(cdist(x, centres, "sqeuclidean") / (2 * radius) ** 2, 0, 1)
        return np.asarray(0.42 - ((1 - q) ** 3).sum(axis=1))

    return truth


def _pinched_ring(rng: Random) -> Truth:
    radius, tube, phase, turn = rng.uniform(0.4, 0.55), rng.uniform(0.16, 0.24), rng.uniform(0, 6), _maybe_turn(rng)

    def truth(x: Floats) -> Floats:
        y = x @ turn
        width = tube * (1 + 0.35 * np.sin(2 * np.arctan2(y[:, 1], y[:, 0]) + phase))
        return np.asarray(np.hypot(np.hypot(y[:, 0], y[:, 1]) - radius, y[:, 2]) - width)

    return truth


def _maybe_turn(rng: Random) -> Floats:
    return _turn(rng) if rng.random() < 0.6 else np.eye(3)


#: Kinds that no factor of the chance of lying inside was chosen on.
OTHERS: dict[str, Callable[[Random], Truth]] = {
    "superquadric": _superquadric,
    "bent lens": _bent_lens,
    "two parts": _two_parts,
    "blobs": _blobs,
    "pinched ring": _pinched_ring,
}


def case(seed: int) -> Case:
    """Return a case: 7 to 11 squared holes on a grid, at random or as fans, with and without noise of the contacts."""
    return _case(np.random.default_rng(5000 + seed), seed, KINDS, 7, [0.0, 0.0, 0.01])


def other_case(seed: int) -> Case:
    """Return a case of the other kinds: 5 to 11 squared holes, and twice the noise."""
    return _case(np.random.default_rng(90_000 + seed), seed, OTHERS, 5, [0.0, 0.0, 0.01, 0.02])


def mixed_case(seed: int) -> Case:
    """Return a case of all kinds in turn that nothing was chosen on: 6 to 11 squared holes, noise of its own."""
    return _case(np.random.default_rng(777_000 + seed), seed, {**KINDS, **OTHERS}, 6, [0.0, 0.005, 0.015])


def _case(
    rng: Random, seed: int, kinds: dict[str, Callable[[Random], Truth]], fewest: int, noises: list[float]
) -> Case:
    kind = list(kinds)[seed % len(kinds)]
    truth = kinds[kind](rng)
    rows, pattern = int(rng.integers(fewest, 12)), str(rng.choice(["grid", "random", "fan"]))
    noise, step = float(rng.choice(noises)), float(rng.choice([0.02, 0.04, 0.06]))
    return Case(kind, truth, drilled(truth, rng, rows, pattern, rng.uniform(0.02, 0.25), noise, step))


def drilled(
    truth: Truth, rng: Random, rows: int, pattern: str, deviation: float, noise: float, step: float
) -> BodyData:
    """Return contacts and samples of rows x rows holes; the log follows its contacts, which are off by the noise."""
    grid = (np.arange(rows) + 0.5) / rows * 2 - 1
    collars = np.array([(x, y) for x in grid for y in grid]) + rng.uniform(-0.3, 0.3, (rows**2, 2)) / rows
    if pattern == "random":
        collars = rng.uniform(-1, 1, (rows**2, 2))
    parts: list[list[Floats]] = [[], [], []]
    names: list[list[str]] = [[], [], []]
    for k, collar in enumerate(collars):
        turn = rng.uniform(0, 2 * np.pi)
        fan = 0.6 * np.array([np.cos(turn), np.sin(turn)])
        way = np.append(fan if pattern == "fan" and k % 2 else rng.normal(0, deviation, 2), -1.0)
        way /= np.linalg.norm(way)
        depth = np.linspace(0, -2 / way[2], 4001)
        value = truth(np.append(collar, 1.0) + depth[:, None] * way)
        at = np.flatnonzero((value[1:] < 0) != (value[:-1] < 0))
        met = depth[at] + value[at] / (value[at] - value[at + 1]) * depth[1] + rng.normal(0, noise, len(at))
        met = np.clip(np.sort(met), 1e-3, depth[-1] - 1e-3)
        along = np.arange(step / 2, depth[-1], step)
        inside = (np.searchsorted(met, along) + int(value[0] < 0)) % 2 == 1
        for own, mine, these in zip(parts, names, (met, along[inside], along[~inside]), strict=True):
            own += list(np.append(collar, 1.0) + these[:, None] * way)
            mine += [f"B{k}"] * len(these)
    places = [np.array(part).reshape(-1, 3) * SIZE + ORIGIN for part in parts]
    return BodyData(*places, None, *names, step * SIZE, step * SIZE)
