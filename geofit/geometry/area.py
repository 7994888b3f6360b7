"""Whether corners make a study area: one rule for those of a file and those that a program gives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message

__all__ = ["fault_of_area"]


def fault_of_area(corners: NDArray[np.float64]) -> Message | None:
    """Return what is wrong with the (k, 2) corners of a polygon; None where they bound one area.

    Examples
    --------
    >>> fault_of_area(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])) is None
    True
    >>> print(fault_of_area(np.array([[0.0, 0.0], [4.0, 0.0], [9.0, 0.0]])))
    The boundary has no area: its corners lie on one line
    """
    distinct = len(np.unique(corners, axis=0))
    if distinct < 3:
        return message(
            "geometry.boundary-too-few-corners",
            "Different corners of the boundary: {count}; at least three are needed",
            count=distinct,
        )
    from shapely import Polygon
    from shapely.validation import explain_validity

    # About the first corner: far from 0 the area of a line is lost in rounding.
    polygon = Polygon(corners - corners[0])
    centred = corners - corners.mean(axis=0)
    length, width = np.linalg.svd(centred, compute_uv=False)
    if width < 1e-9 * length:
        return message("geometry.boundary-without-area", "The boundary has no area: its corners lie on one line")
    if not polygon.is_valid or polygon.area == 0:
        what, _, place = explain_validity(Polygon(corners)).rstrip("]").partition("[")
        return message(
            "geometry.boundary-crosses-itself",
            "The boundary crosses or touches itself: {reason}, {place}",
            reason=what,
            place=place,
        )
    return None
