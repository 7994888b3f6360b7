"""What a fit is asked for, refused where no surface can come of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import refuse_far
from geofit.data.errors import PointsError
from geofit.data.given import POINTS, require_kind
from geofit.data.long_arrays import blocks
from geofit.data.messages import message, plural_message
from geofit.data.points import PointSet, look_like_degrees
from geofit.geometry.area import fault_of_area

__all__ = ["require", "study_area_of"]

Floats = NDArray[np.float64]


def require(points: PointSet, boundary: ArrayLike | None) -> Floats | None:
    """Return the corners of the study area as an array; refuse points and corners that no surface can be fitted to.

    Parameters
    ----------
    points : PointSet
        All points of the horizon.
    boundary : (k, 2) array_like, optional
        Corners of the study area, map coordinates in metres.

    Raises
    ------
    ArgumentError
        If ``points`` is of another type.
    PointsError
        If fewer than three places are given, if they look like degrees, or if the corners enclose no area or one
        that is far off the points.
    """
    require_kind("points", points, PointSet, POINTS)
    if len(points) < 3:
        given = plural_message("fitting.points-given", "{count} point given", "{count} points given", count=len(points))
        text = message(
            "fitting.too-few-points",
            "{given}; at least 3 are needed to fit a surface. Check the horizon's name and the filters of the import.",
            given=given,
        )
        raise PointsError(text)
    if all(np.ptp(axis) == 0 for axis in points.xyz.T):
        raise PointsError(
            message(
                "fitting.points-at-one-location",
                "All {count} points are at one location; at least 3 locations are needed.",
                count=len(points),
            )
        )
    refuse_far(points.xyz)
    if look_like_degrees(points.xyz):
        raise PointsError(
            message(
                "fitting.points-in-degrees",
                "The points look like longitude and latitude in degrees (the first: {x:.6g}, {y:.6g}); easting and "
                "northing in metres are needed. Project them to the grid of the site (geofit fit --crs EPSG:..., or "
                "crs in the site file).",
                x=points.xyz[0, 0],
                y=points.xyz[0, 1],
            )
        )
    corners = study_area_of(boundary)
    if corners is None:
        return None
    low, high = corners.min(axis=0), corners.max(axis=0)
    # Column by column: short rows take ten times as long.
    plan, off = points.xyz[:, :2].T, np.inf
    for (part,) in blocks(points.xyz):
        beyond = [np.maximum(a - x, x - b) for x, a, b in zip(part.T, low, high, strict=False)]
        off = min(off, np.maximum(*beyond).min())
        if off <= 0:
            break
    if off > 0 and off > max(np.hypot(*(high - low)), np.hypot(*(np.ptp(x) for x in plan))):
        text = message(
            "fitting.points-off-study-area",
            "All points lie outside the study area; the nearest is {off:.6g} m from it. Check the coordinates of "
            "both, and the order of easting and northing.",
            off=float(off),
        )
        raise PointsError(text)
    return corners


def study_area_of(boundary: ArrayLike | None) -> Floats | None:
    """Return the corners of a study area as (k, 2) array, None without one.

    Raises
    ------
    PointsError
        If there are fewer than three finite corners, or they enclose no area.
    """
    if boundary is None:
        return None
    try:
        corners = np.asarray(boundary, float)
    except (TypeError, ValueError, OverflowError):
        raise PointsError(
            message(
                "fitting.boundary-without-corners",
                "The boundary is not a list of corners; at least three pairs of easting and northing are needed.",
            )
        ) from None
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3 or not np.isfinite(corners).all():
        text = message(
            "fitting.boundary-wrong-shape",
            "The boundary has shape {shape}; at least three finite (easting, northing) corners are needed.",
            shape=corners.shape,
        )
        raise PointsError(text)
    refuse_far(corners)
    fault = fault_of_area(corners)
    if fault is not None:
        raise PointsError(
            message(
                "fitting.study-area-invalid",
                "{fault}. List the corners in order around the study area, each once.",
                fault=fault,
            )
        )
    return corners
