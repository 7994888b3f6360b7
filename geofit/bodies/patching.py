"""Bicubic splines through places of a surface over given quadrilaterals, each as fine as its own piece asks for.

Neighbours share the spline of their edge. Each edge takes the fewest spans with which it stays on the surface, each
patch the fewest, not below its edges, with which it does, and with which its normals along the seams are the surface's:
so patches meet smoothly without conditions between them, and one fold of the surface costs one fine patch.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.layout import QuadMesh, Sides
from geofit.bodies.relax import CELLS
from geofit.implicit.field import Field
from geofit.implicit.foot import project_along_gradient
from geofit.splines import bspline

__all__ = ["ANGLE", "PatchFit", "fit_patches"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Spans along a side of a patch: each number divides the next, so a patch holds the splines of coarser edges.
SPANS = (4, 8, 16, 32)
#: Largest angle between patches along a seam, degrees; largest one between a patch and the surface inside it, beyond
#: which the patch may fold over.
ANGLE = 1.0
FOLD = 60.0
#: Samples in each span at which patches are compared with the surface, and along each side at which their normals are.
SAMPLES = 3
SEAM = 33


@dataclass(frozen=True, eq=False)
class PatchFit:
    """Control points (k, k, 3) of each patch, the largest distance from the surface, and angle at a seam in degrees."""

    control: tuple[Floats, ...]
    deviation: float
    seam_angle: float

    @staticmethod
    def knots(count: int) -> Floats:
        """Return the knots of ``count`` control points."""
        return _knots(count - 3)


def fit_patches(field: Field, layout: QuadMesh, grids: Floats, tolerance: float) -> PatchFit:
    """Return patches through places (q, 9, 9, 3) on the surface and further ones between them.

    Patches that miss the tolerance with the most spans are returned all the same; ``deviation`` tells.
    """
    from scipy.interpolate import make_interp_spline

    sides = Sides.of(layout.quads)
    t = np.linspace(0, 1, CELLS + 1)
    curves = np.empty((len(sides.edges), CELLS + 1, 3))
    for k, line in enumerate((grids[:, :, 0], grids[:, :, -1], grids[:, 0], grids[:, -1])):
        own = line.copy()
        own[sides.reverse[:, k]] = own[sides.reverse[:, k]][:, ::-1]
        curves[sides.edge[:, k]] = own
    edges, level = _fit_edges(field, curves, layout.spacing, tolerance)
    along = make_interp_spline(t, np.moveaxis(grids, 0, 2), axis=0)
    least = level[sides.edge].max(axis=1)
    control: list[Floats] = [np.zeros(0)] * len(layout.quads)
    deviation = np.zeros(len(layout.quads))
    for k, spans in enumerate(SPANS):
        todo = np.flatnonzero((least <= k) & np.array([not len(c) for c in control], bool))
        if not len(todo):
            continue
        u = _places(spans)
        rows = np.moveaxis(make_interp_spline(t, along(u), axis=1)(u), 2, 0)[todo]
        found = _fit(field, rows, _lines(edges, sides, todo, u), spans, layout.spacing)
        off, turned, folded = _judged(field, found, spans)
        good = (off <= tolerance) & (turned <= ANGLE / 2) & (folded <= FOLD)
        for q in np.flatnonzero(good | (k == len(SPANS) - 1)).tolist():
            control[todo[q]], deviation[todo[q]] = found[q], off[q] if folded[q] <= FOLD else np.inf
    return PatchFit(tuple(control), float(deviation.max()), _seam_angle(control, sides))


def _fit_edges(field: Field, curves: Floats, spacing: float, tolerance: float) -> tuple[list[Floats], Ints]:
    """Return the control points of each edge, and the number of its spans in ``SPANS``."""
    from scipy.interpolate import make_interp_spline

    control: list[Floats] = [np.zeros(0)] * len(curves)
    level = np.zeros(len(curves), np.int64)
    spline = make_interp_spline(np.linspace(0, 1, CELLS + 1), curves, axis=1)
    todo = np.arange(len(curves))
    for k, spans in enumerate(SPANS):
        places = np.asarray(spline(_places(spans)))[todo]
        places[:, 1:-1] = _onto(field, places[:, 1:-1], spacing)
        places[:, 0], places[:, -1] = curves[todo, 0], curves[todo, -1]
        found = np.einsum("ij,ejc->eic", _inverse(spans), places)
        found[:, 0], found[:, -1] = places[:, 0], places[:, -1]
        t = np.linspace(0, 1, SAMPLES * spans + 1)
        xyz, way = (np.einsum("ij,ejc->eic", bspline.collocation(_knots(spans), 3, t, d), found) for d in (0, 1))
        off, normal = _offset(field, xyz)
        lean = np.abs((way * normal).sum(axis=2)) / np.maximum(np.linalg.norm(way, axis=2), 1e-300)
        good = (off.max(axis=1) <= tolerance / 2) & (lean.max(axis=1) <= np.sin(np.radians(ANGLE / 3)))
        level[todo] = k
        for e in np.flatnonzero(good | (k == len(SPANS) - 1)).tolist():
            control[todo[e]] = found[e]
        todo = todo[~good]
        if not len(todo):
            break
    return control, level


def _lines(edges: list[Floats], sides: Sides, quads: Ints, u: Floats) -> list[Floats]:
    """Return the places (n, len(u), 3) of the four sides of some quadrilaterals."""
    found = []
    for k in range(4):
        line = np.empty((len(quads), len(u), 3))
        for row, q in enumerate(quads.tolist()):
            own = edges[sides.edge[q, k]]
            one = bspline.collocation(_knots(len(own) - 3), 3, u) @ own
            line[row] = one[::-1] if sides.reverse[q, k] else one
        found.append(line)
    return found


def _fit(field: Field, rows: Floats, lines: list[Floats], spans: int, spacing: float) -> Floats:
    """Return the control points (n, k, k, 3) of patches through places and the lines of their sides."""
    bottom, top, left, right = lines
    places = _onto(field, rows, spacing)
    # An edge that is coarser than the patch is a little off the surface: places near it follow it, or the patch would
    # turn there.
    t = _places(spans)
    u, v = t[None, :, None, None], t[None, None, :, None]
    off = (
        (1 - v) * (bottom - places[:, :, 0])[:, :, None]
        + v * (top - places[:, :, -1])[:, :, None]
        + (1 - u) * (left - places[:, 0])[:, None]
        + u * (right - places[:, -1])[:, None]
    )
    places += off
    places[:, :, 0], places[:, :, -1], places[:, 0], places[:, -1] = bottom, top, left, right
    inverse = _inverse(spans)
    return np.asarray(np.einsum("ai,bj,qijc->qabc", inverse, inverse, places, optimize=True))


def _judged(field: Field, control: Floats, spans: int) -> tuple[Floats, Floats, Floats]:
    """Return each patch's largest distance from the surface, and angles with its normal: at the sides, and anywhere."""
    t = np.linspace(0, 1, SAMPLES * spans + 1)
    place, du, dv = _derivatives(control, t, t)
    off, normal = _offset(field, place)
    angle = _angle(np.cross(du, dv), normal)
    rim = np.ones(angle.shape[1:], bool)
    rim[1:-1, 1:-1] = False
    return off.max(axis=(1, 2)), angle[:, rim].max(axis=1), angle.max(axis=(1, 2))


def _seam_angle(control: list[Floats], sides: Sides) -> float:
    """Return the largest angle between neighbours along their common edges, degrees."""
    t, ends = np.linspace(0, 1, SEAM), np.array([0.0, 1.0])
    normals = np.empty((len(control), 4, SEAM, 3))
    count = np.array([len(c) for c in control])
    for size in np.unique(count).tolist():
        own = np.flatnonzero(count == size)
        stacked = np.stack([control[q] for q in own.tolist()])
        _, du, dv = _derivatives(stacked, t, ends)
        along = np.cross(du, dv)
        _, du, dv = _derivatives(stacked, ends, t)
        across = np.cross(du, dv)
        normals[own] = np.stack([along[:, :, 0], along[:, :, 1], across[:, 0], across[:, 1]], axis=1)
    normals[sides.reverse] = normals[sides.reverse][:, ::-1]
    order = np.argsort(sides.edge.ravel(), kind="stable")
    pairs = normals.reshape(-1, SEAM, 3)[order].reshape(-1, 2, SEAM, 3)
    return float(_angle(pairs[:, 0], pairs[:, 1]).max())


def _derivatives(control: Floats, u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Return places and first derivatives (n, nu, nv, 3) of patches with equally many control points."""
    knots = _knots(control.shape[1] - 3)
    a, b = ([bspline.collocation(knots, 3, t, d) for d in (0, 1)] for t in (u, v))
    place, du, dv = (
        np.einsum("ai,bj,qijc->qabc", a[d], b[e], control, optimize=True) for d, e in ((0, 0), (1, 0), (0, 1))
    )
    return place, du, dv


def _offset(field: Field, places: Floats) -> tuple[Floats, Floats]:
    """Return the distances from the surface by first order, and its unit normals."""
    flat = np.ascontiguousarray(places).reshape(-1, 3)
    gradient = field.gradient(flat)
    slope = np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
    off = np.abs(field.value(flat)) / slope
    return off.reshape(places.shape[:-1]), (gradient / slope[:, None]).reshape(places.shape)


def _angle(first: Floats, second: Floats) -> Floats:
    """Return the angles between vectors, degrees."""
    sine = np.linalg.norm(np.cross(first, second), axis=-1)
    return np.asarray(np.degrees(np.arctan2(sine, (first * second).sum(axis=-1))))


def _onto(field: Field, places: Floats, reach: float) -> Floats:
    flat = np.ascontiguousarray(places).reshape(-1, 3)
    return project_along_gradient(field, flat, reach=reach / 8, steps=10).reshape(places.shape)


@cache
def _knots(spans: int) -> Floats:
    return bspline.clamped_knots(np.linspace(0.0, 1.0, spans + 1), 3)


@cache
def _places(spans: int) -> Floats:
    return bspline.greville(_knots(spans), 3)


@cache
def _inverse(spans: int) -> Floats:
    return np.asarray(np.linalg.inv(bspline.collocation(_knots(spans), 3, _places(spans))))
