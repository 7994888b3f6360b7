"""Implicit surfaces: bodies as functions that are negative inside, and what can be done with them.

>>> import geofit.implicit as implicit
>>> ball = implicit.Sphere([0, 0, 0], 1.0)
>>> lattice = implicit.Lattice.around([-1.2, -1.2, -1.2], [1.2, 1.2, 1.2], cells=24)
>>> mesh = implicit.isosurface(ball, lattice)
>>> mesh.is_closed, mesh.euler
(True, 2)
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

# The function must hide the module of its name, so it cannot wait; it needs numpy only.
from geofit.implicit.isosurface import isosurface

# numba, scipy and VTK are imported when they are first needed.
_LAZY = {
    "BallFit": "muraki",
    "Contour": "contour",
    "Convolution": "convolution",
    "Crossing": "trace",
    "CurveTube": "distance",
    "Cylinder": "distance",
    "Extent": "volume",
    "Field": "field",
    "FootPoints": "foot",
    "FunctionField": "field",
    "Hits": "trace",
    "Lattice": "lattice",
    "Metaballs": "blobs",
    "POTENTIALS": "kernels",
    "Plane": "quadric",
    "Potential": "kernels",
    "Quadric": "quadric",
    "RangedField": "field",
    "RoundCones": "distance",
    "Sphere": "distance",
    "SplineGrid": "grid",
    "Torus": "distance",
    "TriangleMesh": "mesh",
    "collapse_slivers": "clean",
    "complement": "csg",
    "field_contours": "contour",
    "curved_extent": "volume",
    "difference": "csg",
    "distance_field": "reinitialize",
    "distance_samples": "reinitialize",
    "ellipsoid": "quadric",
    "even_samples": "particles",
    "extent_of_samples": "volume",
    "extrapolated_extent": "volume",
    "first_hits": "trace",
    "fit_metaballs": "muraki",
    "fit_quadric": "quadric",
    "foot_points": "foot",
    "hole_crossings": "trace",
    "intersection": "csg",
    "isosurface_of_blocks": "isosurface",
    "isosurface_of_samples": "isosurface",
    "spherical_metaballs": "blobs",
    "moved": "field",
    "normals": "field",
    "open_sides": "isosurface",
    "potential": "kernels",
    "project_along_gradient": "foot",
    "quadric_from_coefficients": "quadric",
    "r_intersection": "csg",
    "r_union": "csg",
    "range_in": "field",
    "sample": "lattice",
    "signed_distance": "foot",
    "smooth_difference": "csg",
    "smooth_intersection": "csg",
    "smooth_union": "csg",
    "spline_grid": "grid",
    "spline_of_field": "grid",
    "union": "csg",
}

__all__ = ["isosurface", *_LAZY]


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'geofit.implicit' has no attribute '{name}'")
    return getattr(import_module(f"geofit.implicit.{_LAZY[name]}"), name)
