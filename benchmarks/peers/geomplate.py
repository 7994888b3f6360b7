"""OpenCASCADE's GeomPlate through scattered points, as its documentation builds it."""

from __future__ import annotations

from geofit import PointSet
from geofit.cad.faces import from_geom
from geofit.fitting.horizon_fit import HorizonFit
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["geom_plate"]

#: Degree, points and iterations of the plate; tolerance, segments and degree of its B-spline.
PLATE = (3, 10, 2)
SPLINE = (1e-3, 100, 8, 1e-3, 0)


def geom_plate(points: PointSet) -> HorizonFit:
    """Fit a plate, approximate it by a B-spline surface, and return that as one patch about a local origin."""
    from OCP.GeomPlate import GeomPlate_BuildPlateSurface, GeomPlate_MakeApprox, GeomPlate_PointConstraint
    from OCP.gp import gp_Pnt

    origin = points.xyz.mean(axis=0)
    plate = GeomPlate_BuildPlateSurface(*PLATE)
    for place in (points.xyz - origin).tolist():
        plate.Add(GeomPlate_PointConstraint(gp_Pnt(*place), 0))
    plate.Perform()
    spline = GeomPlate_MakeApprox(plate.Surface(), *SPLINE).Surface()
    return HorizonFit(PatchSurface((from_geom("plate", spline),), origin), points)
