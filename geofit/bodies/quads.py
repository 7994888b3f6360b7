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

__all__ = ["PartOfBody", "Patchable", "PatchedSurface", "fit_part", "patched_surface"]

Floats = NDArray[np.float64]

#: Patches of a body at most; more where it has many parts, each its share; and of a part at least as a rule.
MOST = 500
EACH = 50
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
        If a part has no patches (see :func:`fit_part`), or the body is cut at its box, where it has edges.
    """
    cut = body.cut_sides
    if cut:
        raise FitError(
            message(
                "bodies.body-cut-at-box",
                "The body is cut at its box ({sides}): it has sharp edges, which smooth patches cannot follow. "
                "Enlarge the box; triangles keep the edges.",
                sides=", ".join(cut),
            )
        )
    mesh = body.overview
    lower, upper = body.extent
    if tolerance is None:
        tolerance = min(body.epsilon / 2, 1e-3 * float((upper - lower).max()))
    parts = mesh.split()
    left = max(MOST, EACH * len(parts))
    fits: dict[int, PatchFit] = {}
    # The largest first: where it has no patches, the others need not be tried.
    for done, k in enumerate(sorted(range(len(parts)), key=lambda k: -len(parts[k].triangles)), 1):
        others = mesh.only(mesh.component_of != k)
        given = PartOfBody(k + 1, len(parts), min(MOST, left - FEWEST * (len(parts) - done)))
        fits[k] = fit_part(body.field, parts[k], others, tolerance, given)
        left -= len(fits[k].control)
    components = []
    for k in range(len(parts)):
        prefix = f"{k + 1}." if len(parts) > 1 else ""
        components.append(
            tuple(
                Patch(f"{prefix}{i + 1}", (3, 3), PatchFit.knots(len(control)), PatchFit.knots(len(control)), control)
                for i, control in enumerate(fits[k].control)
            )
        )
    deviation = max((fit.deviation for fit in fits.values()), default=0.0)
    return PatchedSurface(tuple(components), deviation, max((fit.seam_angle for fit in fits.values()), default=0.0))


@dataclass(frozen=True)
class PartOfBody:
    """Number of a part of a body, from 1, of how many, and the patches that it may have at most."""

    number: int
    parts: int
    most: int


def fit_part(
    field: Field, component: TriangleMesh, others: TriangleMesh, tolerance: float, part: PartOfBody
) -> PatchFit:
    """Return the patches of one part of a body: of the layout of fewest quadrilaterals within the tolerance.

    Parameters
    ----------
    field : Field
        The field; its zero set is the surface.
    component, others : TriangleMesh
        The part's triangles, and those of the rest of the surface (maybe none).
    tolerance : float
        Largest distance in metres between patches and surface.
    part : PartOfBody
        Which part it is, and the patches that it may have.

    Raises
    ------
    FitError
        ``bodies.part-without-layout`` if no layout has the topology of the part, ``bodies.part-folds`` if the places of
        every layout fold over, ``bodies.patches-off-body`` if no patches stay within the tolerance.
    """
    best, folded, tried = (np.inf, np.inf), 0, 0
    for layout in quad_meshes(field, component, others, part.most):
        tried += 1
        grids = relaxed_grids(field, layout)
        if grids is None:
            folded += 1
            continue
        fit = fit_patches(field, layout, grids, tolerance)
        if fit.deviation <= tolerance and fit.seam_angle <= ANGLE:
            return fit
        best = min(best, (fit.deviation, fit.seam_angle))
    size, volume = float(np.ptp(component.vertices, axis=0).max()), abs(component.volume)
    which = message(
        "bodies.part-of-body",
        "part {number} of {parts} ({size:.0f} m long, {volume:.3g} m³)",
        number=part.number,
        parts=part.parts,
        size=size,
        volume=volume,
    )
    if not tried:
        raise FitError(
            message(
                "bodies.part-without-layout",
                "Layout of patches: no raster of at most {most} quadrilaterals follows all branches, necks and holes "
                "of {which}: it is thin or ragged compared with its triangles, and only triangles follow it.",
                most=part.most,
                which=which,
            )
        )
    if not np.isfinite(best[0]):
        raise FitError(
            message(
                "bodies.part-folds",
                "Places of patches: in {folded} of {tried} layouts of {which} the surface turns back within a patch: "
                "it has folds finer than that, which only triangles follow.",
                folded=folded,
                tried=tried,
                which=which,
            )
        )
    raise FitError(
        message(
            "bodies.patches-off-body",
            "Fit of patches: over {which} they do not stay within {tolerance:.3g} m and {angle:g} degrees at the seams "
            "(best: {deviation:.3g} m, {turn:.3g} degrees). Allow a larger epsilon if patches are needed.",
            which=which,
            tolerance=tolerance,
            angle=ANGLE,
            deviation=best[0],
            turn=best[1],
        )
    )
