"""What a surface costs as control points, beside a TIN and a grid that hold the same surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.threads import one_thread
from geofit.splines.patch import Patch
from geofit.surfaces.protocol import FittedSurface

__all__ = ["Storage", "equal_accuracy"]

Floats = NDArray[np.float64]

#: Places of the surface that are compared.
PLACES = 12_000
#: Cosines of the steepest slope of a height field, and of the steepest mean dip of one over the map.
UPRIGHT, GENTLE = 0.05, 0.64


@dataclass(frozen=True)
class Storage:
    """Points that a TIN and a square grid need to stay within ``tolerance`` metres of the surface.

    None: more than the places that were compared, or the surface is not a height over any plane.
    """

    tolerance: float
    tin_points: int | None
    grid_points: int | None


def equal_accuracy(surface: FittedSurface, tolerance: float) -> Storage:
    """Count the points of a TIN and a grid that hold a surface within a tolerance.

    The surface is sampled at about 12,000 places; one that is steep, or no height over the map, is turned so
    that its mean normal is vertical. The TIN grows by the worst place of every triangle until none is further
    off than the tolerance (greedy insertion). The grid is read bilinearly and refined by a fifth at a time
    until 999 of 1,000 places are within it.

    Parameters
    ----------
    surface : FittedSurface
        Any patches.
    tolerance : float
        Largest distance along the mean normal, metres.
    """
    samples, normals = _sample(surface.patches)
    mean = normals.mean(axis=0)
    mean /= np.linalg.norm(mean)
    up = np.array([0.0, 0.0, np.sign(mean[2]) or 1.0])
    normal = up if abs(mean[2]) > GENTLE and (normals @ up).min() > UPRIGHT else mean
    if (normals @ normal).min() < UPRIGHT:
        return Storage(tolerance, None, None)
    axes = _axes(normal)
    turned = (samples - samples.mean(axis=0)) @ axes.T
    plan, unique = np.unique(np.round(turned[:, :2], 6), axis=0, return_index=True)
    height = turned[unique, 2]
    facing = normals[unique] @ axes.T
    slope = -facing[:, :2] / facing[:, 2:]

    # Qhull hands LAPACK one 2 x 2 matrix a triangle: starting threads for each costs a hundred times the work.
    with one_thread():
        return Storage(tolerance, _tin(plan, height, tolerance), _grid(plan, height, slope, tolerance))


def _sample(patches: tuple[Patch, ...]) -> tuple[Floats, Floats]:
    share = _uneven(max(int(np.sqrt(PLACES / len(patches))), 8))
    samples, normals = [], []
    for patch in patches:
        u0, u1, v0, v1 = patch.domain
        u, v = np.meshgrid(u0 + share * (u1 - u0), v0 + share * (v1 - v0), indexing="ij")
        cross = np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1)).reshape(-1, 3)
        length = np.linalg.norm(cross, axis=1)
        regular = length > 0
        samples.append(patch.evaluate(u, v).reshape(-1, 3)[regular])
        normals.append(cross[regular] / length[regular, None])
    return np.concatenate(samples), np.concatenate(normals)


def _uneven(count: int) -> Floats:
    """Return shares from 0 to 1, near to even ones but in no step with them.

    Nodes of a grid that fall on the places would be exact at every place that is compared, however coarse.
    """
    share = np.linspace(0, 1, count)
    golden = (np.arange(count) * (np.sqrt(5) - 1) / 2) % 1 - 0.5
    share[1:-1] += 0.9 * golden[1:-1] / (count - 1)
    return share


def _axes(normal: Floats) -> Floats:
    """Rows: two axes in the plane, and its normal."""
    across = np.eye(3)[np.argmin(np.abs(normal))]
    first = np.cross(normal, across)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first), normal])


def _tin(plan: Floats, height: Floats, tolerance: float) -> int | None:
    from scipy.spatial import ConvexHull, Delaunay

    chosen = np.zeros(len(plan), bool)
    chosen[_corners(plan, ConvexHull(plan).vertices)] = True
    while True:
        kept = np.flatnonzero(chosen)
        mesh = Delaunay(plan[kept])
        triangle = mesh.find_simplex(plan, tol=1e-9)
        inside = triangle >= 0
        map_ = mesh.transform[triangle]
        first = np.einsum("nij,nj->ni", map_[:, :2], plan - map_[:, 2])
        shares = np.column_stack([first, 1 - first.sum(axis=1)])
        flat = (shares * height[kept][mesh.simplices[triangle]]).sum(axis=1)
        off = np.where(inside & ~chosen, np.abs(flat - height), 0.0)
        bad = np.flatnonzero(off > tolerance)
        if not bad.size:
            return len(kept)
        if len(kept) > 0.9 * len(plan):
            return None
        # The worst place of every triangle that is too far off.
        bad = bad[np.argsort(-off[bad], kind="stable")]
        chosen[bad[np.unique(triangle[bad], return_index=True)[1]]] = True


def _corners(plan: Floats, ring: NDArray[np.integer]) -> NDArray[np.integer]:
    """Hull vertices without those along an edge that is straight to a hundredth of the size."""
    import shapely

    hull = shapely.Polygon(plan[ring])
    kept = shapely.get_coordinates(hull.simplify(0.01 * float(np.ptp(plan, axis=0).max())))
    turns: NDArray[np.bool_] = (plan[ring][:, None] == kept).all(axis=2).any(axis=1)
    return ring[turns]


def _grid(plan: Floats, height: Floats, slope: Floats, tolerance: float) -> int | None:
    from scipy.interpolate import LinearNDInterpolator, RegularGridInterpolator
    from scipy.spatial import cKDTree

    inside, tree = LinearNDInterpolator(plan, height), cKDTree(plan)
    low, high = plan.min(axis=0), plan.max(axis=0)
    spacing = float((high - low).max()) / 4
    while True:
        axes = [np.linspace(a, b, int(np.ceil((b - a) / spacing)) + 1) for a, b in zip(low, high, strict=True)]
        count = len(axes[0]) * len(axes[1])
        if count > len(plan):
            return None
        x, y = np.meshgrid(*axes, indexing="ij")
        nodes = inside(x, y)
        hull = np.isfinite(nodes)
        # Beyond the rim the nearest place's tangent plane: the cells there are read too.
        beyond = np.column_stack([x[~hull], y[~hull]])
        nearest = tree.query(beyond)[1]
        nodes[~hull] = height[nearest] + (slope[nearest] * (beyond - plan[nearest])).sum(axis=1)
        off = np.abs(RegularGridInterpolator(axes, nodes)(plan) - height)
        if np.quantile(off, 0.999) <= tolerance:
            return count
        spacing /= 1.2
