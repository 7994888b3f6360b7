"""Places where a horizon stands above the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from geofit.data.accuracy import Check
from geofit.data.messages import message
from geofit.data.site import Ground
from geofit.data.threads import one_thread
from geofit.fitting.horizon_fit import HorizonFit

__all__ = ["check_ground"]

Floats = NDArray[np.float64]

#: Nodes of the ground that are compared.
PLACES = 40_000
#: Three points no farther apart than so many times their usual distance show that the horizon is between them.
REACH = 2.0
NAMED = 20


def check_ground(surface: HorizonFit, ground: Ground | None, tolerance: float) -> Check | None:
    """Look for places where a horizon stands above the ground.

    A horizon that crops out goes on above the ground as it was before erosion: that is reported, not a failure. Above
    the ground at one of its own points it is wrong, and so it is between three points close to each other that lie
    deeper below the ground than it stands above, and whose plane does so there: elsewhere a valley cuts the horizon.

    Parameters
    ----------
    surface : HorizonFit
        The fit; of a fold the highest sheet counts.
    ground : Ground or None
        The ground surface.
    tolerance : float
        How far it may stand above the ground, metres: the accuracy of both.

    Returns
    -------
    Check or None
        The greatest height above the ground where it is wrong, metres; ``passed`` is None where it stands above
        the ground away from its points only. None without common area.
    """
    if ground is None or not surface.patches:
        return None
    x, y, cell = _nodes(ground, surface)
    own = surface.points.xyz[:, :2]
    plan = np.concatenate([np.column_stack([x, y]), own])
    z = surface.elevation(plan[:, 0], plan[:, 1])
    height = z - ground.elevation(plan[:, 0], plan[:, 1])
    known = np.isfinite(height)
    if not known.any():
        return None
    above = known & (height > tolerance)
    at_point = np.arange(len(plan)) >= len(x)
    depth = np.where(known, -height, 0.0)[len(x) :]
    least, level = _around(plan, surface.points.xyz, depth)
    deep = np.minimum(least, z - height - np.where(np.isfinite(level), level, np.inf))
    wrong = above & (at_point | (deep > np.maximum(height, tolerance)))
    area = {"area": float((above & ~at_point).sum()) * cell, "tolerance": tolerance}
    if wrong.any():
        worst = np.flatnonzero(wrong)[np.argsort(-height[wrong], kind="stable")]
        value = float(height[worst[0]])
        text = message(
            "site.horizon-above-ground",
            "the horizon lies above the ground: by {value:.1f} m at {x:.0f}, {y:.0f}, where its "
            "own points constrain it; {points} points and {area:whole} square metres in all are more "
            "than {tolerance:g} m above it",
            value=value,
            x=plan[worst[0], 0],
            y=plan[worst[0], 1],
            points=int((wrong & at_point).sum()),
            **area,
        )
        named = tuple((float(plan[k, 0]), float(plan[k, 1]), float(z[k])) for k in worst[:NAMED])
        return Check("above ground", False, value, tolerance, "m", text, named)
    if above.any():
        highest = float(height[above].max())
        text = message(
            "site.horizon-above-ground-away",
            "away from its points the horizon continues above the ground, up to {value:.1f} m over "
            "{area:whole} square metres: it is eroded there, or no point constrains it",
            value=highest,
            **area,
        )
        return Check("above ground", None, highest, tolerance, "m", text)
    text = message(
        "site.horizon-below-ground",
        "the horizon stays below the ground (within {tolerance:g} m)",
        tolerance=tolerance,
    )
    return Check("above ground", True, max(float(height[known].max()), 0.0), tolerance, "m", text)


def _around(plan: Floats, own: Floats, depth: Floats) -> tuple[Floats, Floats]:
    """Return how deep (m) under the ground all three points around each place lie, 0 if one of them is far off.

    Also return the elevation of their plane there, nan where there are none.
    """
    points, first = np.unique(own[:, :2], axis=0, return_index=True)
    # LAPACK starts threads even for matrices of two columns, which costs a hundred times the work.
    with one_thread():
        if len(points) < 3 or np.linalg.matrix_rank(points - points[0], tol=1e-6) < 2:
            return np.zeros(len(plan)), np.full(len(plan), np.nan)
        mesh = Delaunay(points - points[0])
        triangle = mesh.find_simplex(plan - points[0])
        slope = mesh.transform[triangle, :2]
        share = np.einsum("nij,nj->ni", slope, plan - points[0] - mesh.transform[triangle, 2])
    share = np.column_stack([share, 1.0 - share.sum(axis=1)])
    level = (share * own[first, 2][mesh.simplices[triangle]]).sum(axis=1)
    corners = mesh.points[mesh.simplices]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    least = np.where(longest <= REACH * np.median(longest), depth[first][mesh.simplices].min(axis=1), 0.0)
    return np.where(triangle >= 0, least[triangle], 0.0), np.where(triangle >= 0, level, np.nan)


def _nodes(ground: Ground, surface: HorizonFit) -> tuple[Floats, Floats, float]:
    """Flat x, y of the ground's nodes over the surface, thinned if there are many, and the area of each."""
    box = np.concatenate([patch.control[..., :2].reshape(-1, 2) for patch in surface.patches]) + surface.origin[:2]
    low, high = box.min(axis=0), box.max(axis=0)
    if surface.outline is not None:
        low, high = np.maximum(low, surface.outline.min(axis=0)), np.minimum(high, surface.outline.max(axis=0))
    x = ground.x[(ground.x >= low[0]) & (ground.x <= high[0])]
    y = ground.y[(ground.y >= low[1]) & (ground.y <= high[1])]
    step = max(1, int(np.ceil(np.sqrt(len(x) * len(y) / PLACES))))
    cell = float(np.ptp(ground.x) * np.ptp(ground.y)) / ((len(ground.x) - 1) * (len(ground.y) - 1)) * step**2
    grid = np.meshgrid(x[::step], y[::step])
    return grid[0].ravel(), grid[1].ravel(), cell
