"""Points where the surface ends before it reaches them: outside its outline, or beyond its edge.

They count in sigma like all others (paper, eq. 3): outside the outline with their distance to the surface as it
continues there, beyond the edge with their distance to the edge. Sigma of the other points is stated, too: it is the
same for a fit and for its files of any format.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Check
from geofit.data.long_arrays import blocks
from geofit.data.messages import Message, message
from geofit.geometry.mesh_projection import ASIDE
from geofit.surfaces.protocol import FittedSurface

__all__ = ["BEYOND", "beyond_by", "beyond_check", "continued", "outside"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Name of the check.
BEYOND = "beyond the surface"


def outside(outline: Floats, xyz: Floats) -> Bools:
    """Return which of (n, 2 or more) map coordinates lie outside a plan polygon (k, 2), metres.

    Examples
    --------
    >>> outside(np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]), np.array([[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]])).tolist()
    [False, False, True]
    """
    import shapely

    # About a corner: far from 0 a point on the rim is lost in rounding.
    ring = outline - outline[0]
    area = shapely.Polygon(ring)
    shapely.prepare(area)
    low, high = ring.min(axis=0), ring.max(axis=0)
    box_only = area.area >= (1 - 1e-12) * float(np.prod(high - low))
    found = np.empty(len(xyz), bool)
    start = 0
    for (part,) in blocks(xyz):
        x, y = part[:, 0] - outline[0, 0], part[:, 1] - outline[0, 1]
        gone = (x < low[0] - ASIDE) | (x > high[0] + ASIDE) | (y < low[1] - ASIDE) | (y > high[1] + ASIDE)
        if not box_only:
            gone |= ~shapely.intersects_xy(area, x, y)
            near = np.flatnonzero(gone)
            gone[near] = ~shapely.dwithin(area, shapely.points(x[near], y[near]), ASIDE)
        found[start : start + len(part)] = gone
        start += len(part)
    return found


def continued(surface: FittedSurface) -> Bools:
    """Return (n,) which points lie outside the outline, where no trim loops end the patches too."""
    if surface.outline is None or any(surface.loops):
        return np.zeros(len(surface.points), bool)
    return outside(surface.outline, surface.points.xyz)


def beyond_check(out: int, at_edge: int, total: int, sigma: float, within: float, epsilon: float) -> Check:
    """Return the check of how many points the surface does not reach.

    Parameters
    ----------
    out, at_edge, total : int
        Points outside the outline, points beyond the edge, and all points.
    sigma, within, epsilon : float
        Sigma of all points and of those that the surface reaches, and the control error, metres. The check fails where
        sigma is below epsilon only because of the points that the surface does not reach.
    """
    text = _text(out, at_edge, total, within)
    failed = "within" in text.params and sigma < epsilon <= within
    return Check(BEYOND, False if failed else None, float(out + at_edge), 0.0, "points", text)


def beyond_by(former: Check, sigma: float, epsilon: float) -> Check:
    """Return the check judged by another control error, metres."""
    within = former.text.params.get("within")
    passed = False if within is not None and sigma < epsilon <= within else None
    return former if passed is former.passed else replace(former, passed=passed)


def _text(out: int, at_edge: int, total: int, within: float) -> Message:
    texts = []
    if at_edge or not out:
        texts.append(
            message(
                "checks.points-beyond-edge",
                "points beyond the surface's edge, measured to the edge: {count} of {total}",
                count=at_edge,
                total=total,
            )
        )
    if out:
        texts.append(
            message(
                "checks.points-outside-outline",
                "points outside the surface's outline, measured to the surface as it continues there: {count} of "
                "{total}",
                count=out,
                total=total,
            )
        )
    others = total - out - at_edge
    if not 0 < others < total:
        return texts[0]
    return message(
        "checks.sigma-of-others",
        "{text}; sigma of the other points ({others}): {within:length} m",
        text=tuple(texts),
        others=others,
        within=within,
    )
