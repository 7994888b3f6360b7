"""Bodies cut by parallel planes: how well the other planes' outlines tell a left-out one."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from bodies.planted import ORIGIN, SIZE, Truth, ellipsoid
from bodies.shapes import KINDS, OTHERS, horn
from geofit.bodies.fit import fit_body
from geofit.bodies.outlines import Outline, from_outlines
from geofit.bodies.posterior import BodyPosterior
from geofit.implicit.lattice import Lattice
from geofit.implicit.volume import extent_of_samples

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Bodies and the axis across the planes: along the ellipsoid, across the horn's arc, along both arms of the fork.
BODIES: dict[str, tuple[Truth, int]] = {
    "ellipsoid": (ellipsoid((0.6, 0.4, 0.3))[0], 0),
    "horn": (horn(), 2),
    "fork": (KINDS["fork"](np.random.default_rng(3)), 1),
}
LINE = np.linspace(-1, 1, 161)


def left_out(name: str, count: int) -> tuple[float, float]:
    """Return the mean intersection over union with the middle planes left out in turn: of the body, of distances."""
    truth, axis = BODIES[name]
    at = planes_across(truth, axis, count)
    scores = []
    for left in (count // 2 - 1, count // 2, count // 2 + 1):
        outlines = [o for k, x in enumerate(at.tolist()) if k != left for o in _outlines(truth, axis, x, str(k))]
        body = fit_body(from_outlines(outlines))
        places, inside = plane_of(truth, axis, float(at[left]))
        got = (body.value(places * SIZE + ORIGIN) < 0).reshape(inside.shape)
        near = [_distance(plane_of(truth, axis, float(at[left + side]))[1]) for side in (-1, 1)]
        scores.append((overlap(inside, got), overlap(inside, near[0] + near[1] < 0)))
    ours, linear = np.mean(scores, axis=0).tolist()
    return ours, linear


def planes_across(truth: Truth, axis: int, count: int) -> Floats:
    """Return the places (count,) of planes across a body, as far apart from each other."""
    low, high = extent_along(truth, axis)
    return np.asarray(low + (np.arange(count) + 0.5) / count * (high - low))


@cache
def extent_along(truth: Truth, axis: int) -> tuple[float, float]:
    """Return where a body begins and ends along an axis, to a node of a raster."""
    nodes = np.stack(np.meshgrid(LINE[::2], LINE[::2], LINE[::2], indexing="ij"), axis=-1).reshape(-1, 3)
    along = nodes[truth(nodes) < 0, axis]
    return float(along.min()), float(along.max())


def sectioned_case(seed: int) -> tuple[str, Truth, list[Outline]]:
    """Return a body of one of fifteen kinds, its kind first, and its outlines on 4 to 10 planes across any axis."""
    rng, kinds = np.random.default_rng(31_000 + seed), {**KINDS, **OTHERS}
    kind = list(kinds)[seed % len(kinds)]
    truth = kinds[kind](rng)
    axis, count = int(rng.integers(3)), int(rng.integers(4, 11))
    line = np.linspace(-1, 1, 81)
    nodes = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    along = nodes[truth(nodes) < 0, axis]
    at = along.min() + (np.arange(count) + rng.uniform(0.2, 0.8)) / count * np.ptp(along)
    return kind, truth, [o for k, x in enumerate(at.tolist()) for o in _outlines(truth, axis, x, str(k))]


def surface_places(truth: Truth, seed: int, count: int) -> Floats:
    """Return places (count, 3) on the surface of a body in the box [-1, 1]^3, where lines at random cross it."""
    rng, line, found = np.random.default_rng(seed), np.linspace(-1, 1, 161), np.zeros((0, 3))
    while len(found) < count:
        axis = int(rng.integers(3))
        way = np.insert(np.tile(rng.uniform(-0.95, 0.95, 2), (len(line), 1)), axis, line, axis=1)
        value = truth(way)
        at = np.flatnonzero((value[1:] < 0) != (value[:-1] < 0))
        share = (value[at] / (value[at] - value[at + 1]))[:, None]
        found = np.concatenate([found, way[at] + share * (way[at + 1] - way[at])])
    return found[:count]


def volume_of(truth: Truth, cells: int = 96) -> float:
    """Return the volume in m3 of a body in the box [-1, 1]^3, extrapolated from two rasters."""
    found = []
    for count in (cells, cells // 2):
        line = np.linspace(-1, 1, count + 1)
        plane = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
        values = [truth(np.column_stack([np.full(len(plane), x), plane])) for x in line.tolist()]
        lattice = Lattice(np.full(3, -1.0), 2 / count, (count + 1,) * 3)
        found.append(extent_of_samples(np.reshape(values, lattice.shape), lattice).volume * SIZE**3)
    return (4 * found[0] - found[1]) / 3


def band_share(seed: int, count: int = 200) -> tuple[str, float]:
    """Return the kind of a body, and the share of its true surface in the 80 % band of the body of its outlines."""
    kind, truth, outlines = sectioned_case(seed)
    chance = BodyPosterior(fit_body(from_outlines(outlines))).probability(
        surface_places(truth, seed, count) * SIZE + ORIGIN
    )
    return kind, float(((chance > 0.1) & (chance < 0.9)).mean())


def plane_of(truth: Truth, axis: int, at: float) -> tuple[Floats, Bools]:
    """Return the places (n, 3) of a raster on a plane, and which of them lie inside, (161, 161)."""
    plane = np.stack(np.meshgrid(LINE, LINE, indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.insert(plane, axis, at, axis=1)
    return places, (truth(places) < 0).reshape(len(LINE), len(LINE))


@cache
def _outlines(truth: Truth, axis: int, at: float, name: str) -> list[Outline]:
    import contourpy

    places, _ = plane_of(truth, axis, at)
    value = truth(places).reshape(len(LINE), len(LINE))
    lines = [line[:-1] for line in contourpy.contour_generator(LINE, LINE, value.T).lines(0.0) if len(line) > 8]
    return [Outline(name, np.insert(line, axis, at, axis=1) * SIZE + ORIGIN) for line in lines]


def _distance(inside: Bools) -> Floats:
    from scipy.ndimage import distance_transform_edt

    return np.asarray(distance_transform_edt(~inside) - distance_transform_edt(inside))


def overlap(a: Bools, b: Bools) -> float:
    """Return the intersection over the union of two shapes on one raster."""
    return float((a & b).sum() / (a | b).sum())
