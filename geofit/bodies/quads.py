"""NURBS patches over the surface of a body: bicubic splines through its places, with shared edges."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.layout import QuadMesh, quad_mesh
from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.implicit.field import Field
from geofit.implicit.foot import project_along_gradient
from geofit.implicit.mesh import TriangleMesh
from geofit.splines import bspline
from geofit.splines.patch import Patch

if TYPE_CHECKING:
    from geofit.bodies.implicit_body import ImplicitBody

__all__ = ["PatchedSurface", "patched_surface"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Patches of a body at most, cells of the rasters that are tried, control points along a side of a patch.
MOST = 500
CELLS = (4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 18, 20)
CONTROL = (6, 8, 11, 15)
#: Largest angle between patches along a seam, degrees.
ANGLE = 1.0
#: Samples along each side of a patch where it is compared with the surface.
SAMPLES = 13


@dataclass(frozen=True, eq=False)
class PatchedSurface:
    """Patches of each component, about the body's local origin, and how well they meet the surface and each other.

    ``components`` holds the patches of each component, normals outwards; ``deviation`` is the largest distance in
    metres of a patch from the surface, ``seam_angle`` the largest angle in degrees between patches along a seam.
    """

    components: tuple[tuple[Patch, ...], ...]
    deviation: float
    seam_angle: float

    @property
    def patches(self) -> tuple[Patch, ...]:
        """All patches."""
        return tuple(patch for part in self.components for patch in part)


@dataclass(frozen=True, eq=False)
class _Fit:
    """The control points (q, k, k, 3) over a layout."""

    layout: QuadMesh
    control: Floats

    @cached_property
    def knots(self) -> Floats:
        return bspline.clamped_knots(np.linspace(0.0, 1.0, self.control.shape[1] - 2), 3)

    def evaluate(self, u: Floats, v: Floats, du: int = 0, dv: int = 0) -> Floats:
        """Return (q, nu, nv, 3) values of all patches on a grid."""
        along = bspline.collocation(self.knots, 3, u, du)
        across = bspline.collocation(self.knots, 3, v, dv)
        return np.asarray(np.einsum("ai,bj,qijc->qabc", along, across, self.control, optimize=True))

    def normals(self, u: Floats, v: Floats) -> Floats:
        """Return (q, nu, nv, 3) unit normals."""
        cross = np.cross(self.evaluate(u, v, 1, 0), self.evaluate(u, v, 0, 1))
        return np.asarray(cross / np.maximum(np.linalg.norm(cross, axis=-1, keepdims=True), 1e-300))


def patched_surface(body: ImplicitBody, tolerance: float | None = None) -> PatchedSurface:
    """Return NURBS patches that meet the surface of a body within a tolerance.

    Parameters
    ----------
    body : ImplicitBody
        The body.
    tolerance : float, optional
        Largest distance in metres between patches and surface; by default half of epsilon, and at most a thousandth
        of the body's size.

    Raises
    ------
    FitError
        If 500 patches do not suffice, or the body is cut at its box, where it has edges.
    """
    cut = body.cut_sides
    if cut:
        raise FitError(
            message(
                "bodies.body-cut-box",
                "The body is cut at its box ({sides}): it has sharp edges, which smooth patches cannot follow. "
                "Enlarge the box, or write triangles.",
                sides=", ".join(cut),
            )
        )
    mesh = body.overview
    lower, upper = body.extent
    if tolerance is None:
        tolerance = min(body.epsilon / 2, 1e-3 * float((upper - lower).max()))
    parts = mesh.split()
    components, left = [], MOST
    deviation = angle = 0.0
    for k, part in enumerate(parts):
        others = mesh.only(mesh.component_of != k)
        fit, off, turn = _fitted(body.field, part, others, tolerance, left - 24 * (len(parts) - k - 1))
        prefix = f"{k + 1}." if len(parts) > 1 else ""
        components.append(
            tuple(
                Patch(f"{prefix}{i + 1}", (3, 3), fit.knots, fit.knots, control)
                for i, control in enumerate(fit.control)
            )
        )
        left -= len(fit.control)
        deviation, angle = max(deviation, off), max(angle, turn)
    return PatchedSurface(tuple(components), deviation, angle)


def _fitted(
    field: Field, component: TriangleMesh, others: TriangleMesh, tolerance: float, most: int
) -> tuple[_Fit, float, float]:
    """Return the coarsest layout whose patches are within the tolerance, their deviation and seam angle."""
    best = (np.inf, np.inf)
    for cells in CELLS:
        layout = quad_mesh(field, component, others, cells)
        if layout is None:
            continue
        if len(layout.quads) > most:
            break
        for count in CONTROL:
            fit = _interpolated(field, layout, count)
            deviation, angle = _deviation(field, fit), _seam_angle(fit)
            if deviation <= tolerance and angle <= ANGLE:
                return fit, deviation, angle
            best = min(best, (deviation, angle))
    if not np.isfinite(best[0]):
        raise FitError(
            message(
                "bodies.too-many-patches",
                "The body needs more than {most} patches: it has many parts, or a shape of many branches. Write "
                "triangles.",
                most=MOST,
            )
        )
    raise FitError(
        message(
            "bodies.patches-not-follow",
            "{most} patches do not follow the body within {tolerance:.3g} m and {angle:g} degrees at the seams (best: "
            "{deviation:.3g} m, {turn:.3g} degrees). Allow a larger epsilon, or write triangles.",
            most=most,
            tolerance=tolerance,
            angle=ANGLE,
            deviation=best[0],
            turn=best[1],
        )
    )


def _sides(quads: Ints) -> tuple[Ints, Ints, NDArray[np.bool_]]:
    """Return the edges (e, 2), the edge (q, 4) of each side, and whether the side runs against it (q, 4).

    Sides in the order bottom (v = 0), top (v = 1), left (u = 0), right (u = 1), each with growing parameter.
    """
    corners = quads[:, [[0, 1], [3, 2], [0, 3], [1, 2]]]
    edges, index = np.unique(np.sort(corners.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    return edges, index.reshape(-1, 4), corners[:, :, 0] > corners[:, :, 1]


def _interpolated(field: Field, layout: QuadMesh, count: int) -> _Fit:
    """Return patches through ``count`` squared places of the surface each; neighbours share the control points."""
    knots = bspline.clamped_knots(np.linspace(0.0, 1.0, count - 2), 3)
    t = bspline.greville(knots, 3)
    inverse = np.linalg.inv(bspline.collocation(knots, 3, t))
    edges, side, reverse = _sides(layout.quads)
    ends = layout.corners[edges]
    reach = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).max())
    lines = (1 - t)[:, None] * ends[:, None, 0] + t[:, None] * ends[:, None, 1]
    lines[:, 1:-1] = _onto(field, lines[:, 1:-1], reach)
    edge_control = np.einsum("ij,ejc->eic", inverse, lines)
    edge_control[:, 0], edge_control[:, -1] = ends[:, 0], ends[:, 1]

    def sides(curves: Floats) -> list[Floats]:
        own = curves[side]
        own[reverse] = own[reverse][:, ::-1]
        return [own[:, k] for k in range(4)]

    bottom, top, left, right = sides(lines)
    u, v = t[None, :, None, None], t[None, None, :, None]
    corner = layout.corners[layout.quads]
    bilinear = (1 - u) * ((1 - v) * corner[:, 0, None, None] + v * corner[:, 3, None, None]) + u * (
        (1 - v) * corner[:, 1, None, None] + v * corner[:, 2, None, None]
    )
    places = (
        (1 - v) * bottom[:, :, None] + v * top[:, :, None] + (1 - u) * left[:, None] + u * right[:, None] - bilinear
    )
    places[:, 1:-1, 1:-1] = _onto(field, places[:, 1:-1, 1:-1], reach)
    control = np.einsum("ai,bj,qijc->qabc", inverse, inverse, places, optimize=True)
    # Rounding apart these are equal already; equal bits make one edge of two.
    control[:, :, 0], control[:, :, -1], control[:, 0], control[:, -1] = sides(edge_control)
    return _Fit(layout, control)


def _onto(field: Field, places: Floats, reach: float) -> Floats:
    flat = np.ascontiguousarray(places).reshape(-1, 3)
    return project_along_gradient(field, flat, reach=reach, steps=10).reshape(places.shape)


def _deviation(field: Field, fit: _Fit) -> float:
    """Return the largest distance of the patches from the surface, by first order."""
    t = np.linspace(0.0, 1.0, SAMPLES + 2)
    places = fit.evaluate(t, t).reshape(-1, 3)
    slope = np.linalg.norm(field.gradient(places), axis=1)
    return float((np.abs(field.value(places)) / np.maximum(slope, 1e-300)).max())


def _seam_angle(fit: _Fit) -> float:
    """Return the largest angle between neighbours along their common edges, degrees; 180 where a patch folds over."""
    t = np.linspace(0.0, 1.0, 2 * SAMPLES)
    ends = np.array([0.0, 1.0])
    along, across = fit.normals(t, ends), fit.normals(ends, t)
    own = np.stack([along[:, :, 0], along[:, :, 1], across[:, 0], across[:, 1]], axis=1)
    _, side, reverse = _sides(fit.layout.quads)
    own[reverse] = own[reverse][:, ::-1]
    order = np.argsort(side.ravel(), kind="stable")
    pairs = own.reshape(-1, len(t), 3)[order].reshape(-1, 2, len(t), 3)
    sine = np.linalg.norm(np.cross(pairs[:, 0], pairs[:, 1]), axis=-1)
    cosine = (pairs[:, 0] * pairs[:, 1]).sum(axis=-1)
    return float(np.degrees(np.arctan2(sine, cosine)).max())
