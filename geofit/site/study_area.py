"""How much of a surface lies outside a study area that does not end it: of a fold, or over its best plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Check
from geofit.data.messages import message
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.mesh import Mesh, trim_to_outline

__all__ = ["check_area"]

#: Part of the surface, in percent, that may lie outside.
OUTSIDE = 0.1
#: Triangles that measure it leave the surface by this share of its extent at most.
SHARE = 1e-4


def check_area(surface: HorizonFit, boundary: NDArray[np.float64] | None, fault: bool = False) -> Check | None:
    """Check whether a surface that the study area does not end reaches beyond it.

    Parameters
    ----------
    surface : HorizonFit
        The fit; one over the map ends at the area, and is not examined.
    boundary : (k, 2) array or None
        Corners of the study area, map coordinates.
    fault : bool
        Whether the surface is a fault that cuts horizons: it may reach beyond the area, and that is only stated.

    Returns
    -------
    Check or None
        The part of the surface outside, percent of its own area; None without a study area, or where it ends the
        surface.
    """
    if boundary is None or surface.outline is not None or surface.frame == "map" or not surface.patches:
        return None
    low, high = surface.bounds
    mesh = surface.triangulate(SHARE * float(np.linalg.norm(high - low)))
    whole, within = _size(mesh), _size(trim_to_outline(mesh, surface.patches, boundary))
    off = 100.0 * max(1.0 - within / whole, 0.0) if whole > 0 else 0.0
    if off <= OUTSIDE:
        text = message("site.surface-within-area", "the surface lies within the study area")
    else:
        text = message(
            "site.study-area-not-applied",
            "the study area is not applied: only height fields over the map end at it, and {off:.1f} % of this surface "
            "lie outside",
            off=off,
        )
    return Check("area", None if fault and off > OUTSIDE else off <= OUTSIDE, off, OUTSIDE, "%", text)


def _size(mesh: Mesh) -> float:
    a, b, c = np.moveaxis(mesh.points[mesh.triangles], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2
