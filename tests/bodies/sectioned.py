"""Bodies cut by parallel planes: how well the other planes' outlines tell a left-out one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bodies.planted import ORIGIN, SIZE, Truth, ellipsoid
from bodies.shapes import KINDS, horn
from geofit.bodies.fit import fit_body
from geofit.bodies.outlines import Outline, from_outlines

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
    nodes = np.stack(np.meshgrid(LINE[::2], LINE[::2], LINE[::2], indexing="ij"), axis=-1).reshape(-1, 3)
    along = nodes[truth(nodes) < 0, axis]
    at = along.min() + (np.arange(count) + 0.5) / count * np.ptp(along)
    scores = []
    for left in (count // 2 - 1, count // 2, count // 2 + 1):
        outlines = [o for k, x in enumerate(at.tolist()) if k != left for o in _outlines(truth, axis, x, str(k))]
        body = fit_body(from_outlines(outlines))
        places, inside = _plane(truth, axis, float(at[left]))
        got = (body.value(places * SIZE + ORIGIN) < 0).reshape(inside.shape)
        near = [_distance(_plane(truth, axis, float(at[left + side]))[1]) for side in (-1, 1)]
        scores.append((_overlap(inside, got), _overlap(inside, near[0] + near[1] < 0)))
    ours, linear = np.mean(scores, axis=0).tolist()
    return ours, linear


def _plane(truth: Truth, axis: int, at: float) -> tuple[Floats, Bools]:
    plane = np.stack(np.meshgrid(LINE, LINE, indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.insert(plane, axis, at, axis=1)
    return places, (truth(places) < 0).reshape(len(LINE), len(LINE))


def _outlines(truth: Truth, axis: int, at: float, name: str) -> list[Outline]:
    import contourpy

    places, _ = _plane(truth, axis, at)
    value = truth(places).reshape(len(LINE), len(LINE))
    lines = [line[:-1] for line in contourpy.contour_generator(LINE, LINE, value.T).lines(0.0) if len(line) > 8]
    return [Outline(name, np.insert(line, axis, at, axis=1) * SIZE + ORIGIN) for line in lines]


def _distance(inside: Bools) -> Floats:
    from scipy.ndimage import distance_transform_edt

    return np.asarray(distance_transform_edt(~inside) - distance_transform_edt(inside))


def _overlap(a: Bools, b: Bools) -> float:
    return float((a & b).sum() / (a | b).sum())
