"""NURBS patches over the surface of a body: bicubic splines through its places, with shared edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.layout import quad_meshes
from geofit.bodies.patching import ANGLE, PatchFit, fit_patches
from geofit.bodies.relax import relaxed_grids
from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.implicit.field import Field
from geofit.implicit.mesh import TriangleMesh
from geofit.splines.patch import Patch

__all__ = ["Patchable", "PatchedSurface", "patched_surface"]

Floats = NDArray[np.float64]

#: Patches of a body at most, and of a part at least as a rule.
MOST = 500
FEWEST = 24


class Patchable(Protocol):
    """What patches need of a body: see :class:`geofit.bodies.implicit_body.ImplicitBody`."""

    @property
    def field(self) -> Field:
        """The field, negative inside."""

    @property
    def overview(self) -> TriangleMesh:
        """Closed triangles of moderate size."""

    @property
    def extent(self) -> tuple[Floats, Floats]:
        """Corners of a box around the body."""

    @property
    def epsilon(self) -> float:
        """Distance in metres that a file may have from the body."""

    @property
    def cut_sides(self) -> tuple[str, ...]:
        """Sides of its box at which the body is cut."""


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


def patched_surface(body: Patchable, tolerance: float | None = None) -> PatchedSurface:
    """Return NURBS patches that meet the surface of a body within a tolerance.

    Parameters
    ----------
    body : ImplicitBody
        The body, or a part of one.
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
                "bodies.body-cut-at-box",
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
        fit = _fitted(body.field, part, others, tolerance, left - FEWEST * (len(parts) - k - 1))
        prefix = f"{k + 1}." if len(parts) > 1 else ""
        components.append(
            tuple(
                Patch(f"{prefix}{i + 1}", (3, 3), fit.knots(len(control)), fit.knots(len(control)), control)
                for i, control in enumerate(fit.control)
            )
        )
        left -= len(fit.control)
        deviation, angle = max(deviation, fit.deviation), max(angle, fit.seam_angle)
    return PatchedSurface(tuple(components), deviation, angle)


def _fitted(field: Field, component: TriangleMesh, others: TriangleMesh, tolerance: float, most: int) -> PatchFit:
    """Return the patches of the layout of fewest quadrilaterals that stays within the tolerance."""
    best = (np.inf, np.inf)
    for layout in quad_meshes(field, component, others, most):
        grids = relaxed_grids(field, layout)
        if grids is None:
            continue
        fit = fit_patches(field, layout, grids, tolerance)
        if fit.deviation <= tolerance and fit.seam_angle <= ANGLE:
            return fit
        best = min(best, (fit.deviation, fit.seam_angle))
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
            "bodies.patches-off-body",
            "{most} patches do not follow the body within {tolerance:.3g} m and {angle:g} degrees at the seams (best: "
            "{deviation:.3g} m, {turn:.3g} degrees). Allow a larger epsilon, or write triangles.",
            most=most,
            tolerance=tolerance,
            angle=ANGLE,
            deviation=best[0],
            turn=best[1],
        )
    )
