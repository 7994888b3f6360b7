"""OpenCASCADE's GeomPlate through scattered points, as its documentation builds it."""

from __future__ import annotations

from geofit import PointSet
from geofit.cad.faces import from_geom
from geofit.fitting.horizon_fit import HorizonFit
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["COARSE", "FINE", "Setting", "geom_plate"]

#: Degree, points and iterations of the plate; tolerance, segments and degree of its B-spline.
Setting = tuple[tuple[int, int, int], tuple[float, int, int, float, int]]
#: A B-spline within 1 mm of the plate, and one within 1 cm of at most 20 segments.
FINE: Setting = ((3, 10, 2), (1e-3, 100, 8, 1e-3, 0))
COARSE: Setting = ((3, 15, 2), (1e-2, 20, 3, 1e-3, 0))


def geom_plate(points: PointSet, setting: Setting = FINE) -> HorizonFit:
    """Fit a plate, approximate it by a B-spline surface, and return that as one patch about a local origin."""
    from OCP.GeomPlate import GeomPlate_BuildPlateSurface, GeomPlate_MakeApprox, GeomPlate_PointConstraint
    from OCP.gp import gp_Pnt

    origin = points.xyz.mean(axis=0)
    plate = GeomPlate_BuildPlateSurface(*setting[0])
    for place in (points.xyz - origin).tolist():
        plate.Add(GeomPlate_PointConstraint(gp_Pnt(*place), 0))
    plate.Perform()
    spline = GeomPlate_MakeApprox(plate.Surface(), *setting[1]).Surface()
    return HorizonFit(PatchSurface((from_geom("plate", spline),), origin), points)
