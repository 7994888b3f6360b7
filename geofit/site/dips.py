"""Dips measured in the field beside the surface's own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Check
from geofit.data.messages import message
from geofit.data.site import Orientations
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.attitudes import attitudes, plane_normals
from geofit.geometry.projection import project

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["DipDeviation", "check_dips", "dips_within"]

Floats = NDArray[np.float64]

#: Angle (degrees) between a measured plane and the surface that is a contradiction: bedding measured at one outcrop
#: strays by 5 to 10, and a surface that is right within a metre dips otherwise by as much between sparse points.
LIMIT = 30.0
NAMED = 20


@dataclass(frozen=True)
class DipDeviation:
    """One measurement beside the surface at its nearest place.

    ``index`` counts in the site's orientations; azimuths (of steepest descent, clockwise from north), dips and
    ``angle`` between the two planes in degrees; ``distance`` from the surface in metres.
    """

    index: int
    azimuth: float
    dip: float
    surface_azimuth: float
    surface_dip: float
    angle: float
    distance: float


def check_dips(surface: HorizonFit, orientations: Orientations | None) -> tuple[tuple[DipDeviation, ...], Check | None]:
    """Compare the dips that were measured on a horizon with the surface's own dip there.

    Parameters
    ----------
    surface : HorizonFit
        The fit; measurements that name its horizon are compared.
    orientations : Orientations or None
        All measurements of the site.

    Returns
    -------
    deviations : tuple of DipDeviation
        In the order of the measurements.
    check : Check or None
        The largest angle against 30 degrees; None where nothing was measured on this horizon.

    Notes
    -----
    The angle is the one between the planes, 0 to 90 degrees: the azimuth of a nearly level plane says little, and
    the angle lets it. Overturned beds compare by their plane, not by their younging.
    """
    if orientations is None or not surface.patches:
        return (), None
    mine = np.flatnonzero(orientations.horizon == surface.name)
    if not len(mine):
        return (), None
    normal, distance = _at_the_surface(surface, orientations.xyz[mine])
    measured = plane_normals(orientations.azimuth[mine], orientations.dip[mine])
    sine = np.linalg.norm(np.cross(measured, normal), axis=1)
    angle = np.degrees(np.arctan2(sine, np.abs((measured * normal).sum(axis=1))))
    azimuth, dip = attitudes(normal)
    rows = zip(mine, orientations.azimuth[mine], orientations.dip[mine], azimuth, dip, angle, distance, strict=True)
    deviations = tuple(DipDeviation(int(index), *(float(x) for x in values)) for index, *values in rows)
    return deviations, _check(deviations, orientations)


def dips_within(orientations: Orientations | None, horizon: str, area: Polygon, name: str) -> Orientations | None:
    """Return the measurements with those of a horizon inside an area (shapely.Polygon, map) under another name."""
    import shapely

    if orientations is None:
        return None
    mine = (orientations.horizon == horizon) & shapely.contains_xy(area, *orientations.xyz[:, :2].T)
    return replace(orientations, horizon=np.where(mine, name, ""))


def _at_the_surface(surface: HorizonFit, xyz: Floats) -> tuple[Floats, Floats]:
    """Return upward unit normals (n, 3) at the nearest places, and the distances, metres."""
    projection = project(surface.patches, xyz - surface.origin)
    normal = np.zeros((len(xyz), 3))
    for index, patch in enumerate(surface.patches):
        here = projection.patch == index
        if here.any():
            u, v = projection.u[here], projection.v[here]
            normal[here] = np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1))
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return np.where(normal[:, 2:] < 0, -normal, normal), projection.distance


def _check(deviations: tuple[DipDeviation, ...], orientations: Orientations) -> Check:
    worst = sorted(deviations, key=lambda one: -one.angle)
    first = worst[0]
    beyond = [one for one in worst if one.angle > LIMIT]
    if not beyond:
        text = message(
            "site.dips-agree-surface",
            "the measured dips ({n}) agree with the surface, the worst by {angle:.0f}°",
            n=len(worst),
            angle=first.angle,
        )
        return Check("dips", True, first.angle, LIMIT, "deg", text)
    text = message(
        "site.dips-contradict-surface",
        "measured dips that contradict the surface: {count} of {n}, the worst is {azimuth:.0f}/{dip:.0f} where "
        "the surface dips {surface_azimuth:.0f}/{surface_dip:.0f} ({angle:.0f}° between the planes); the "
        "measurement belongs to another structure, or the surface is wrong there",
        count=len(beyond),
        n=len(worst),
        azimuth=first.azimuth,
        dip=first.dip,
        surface_azimuth=first.surface_azimuth,
        surface_dip=first.surface_dip,
        angle=first.angle,
    )
    xyz = orientations.xyz[[one.index for one in beyond[:NAMED]]]
    return Check(
        "dips", False, first.angle, LIMIT, "deg", text, tuple((float(a), float(b), float(c)) for a, b, c in xyz)
    )
