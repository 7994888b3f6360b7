"""The chamfer distance of a voxel body in two scans."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.medial.weights import INTEGER_WEIGHTS

__all__ = ["FORWARD", "chamfer_distance", "step_weights"]

#: Offsets (13, 3) of the neighbours that a scan in the order of memory has visited before a voxel.
FORWARD = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) < (0, 0, 0)])
FORWARD.setflags(write=False)


def step_weights(weights: ArrayLike) -> NDArray[Any]:
    """Return the weight (13,) of each step of :data:`FORWARD`: face, edge or corner neighbour."""
    w = np.asarray(weights)
    if w.shape != (3,) or not (w > 0).all() or not np.isfinite(w).all():
        raise SettingsError(
            message(
                "medial.chamfer-weights-not-positive",
                "The chamfer weights are {weights}; give 3 numbers above 0.",
                weights=weights,
            )
        )
    return np.asarray(w[np.abs(FORWARD).sum(axis=1) - 1])


@arguments_checked
def chamfer_distance(
    void: ArrayLike, weights: ArrayLike = INTEGER_WEIGHTS, *, outside_is_rock: bool = True
) -> NDArray[Any]:
    """Return the chamfer distance of each void voxel from the nearest rock voxel, by a forward and a backward scan.

    Parameters
    ----------
    void : (nx, ny, nz) array of bool
        The body.
    weights : (3,) array
        Weights of steps to face, edge and corner neighbours. Integers give an int32 distance, exactly.
    outside_is_rock : bool
        Whether the voxels beyond the faces of the volume are rock.

    Returns
    -------
    (nx, ny, nz) array
        Distances in units of the weights, 0 on rock. Where there is no rock at all: the largest int32, or infinity.

    Notes
    -----
    Guo, Peng and Li 1999, step 3; the two half masks are complete for any order of face, edge and corner weights
    that satisfies d_1 <= d_2 <= d_3, d_2 <= 2 d_1 and d_3 <= d_1 + d_2 (Borgefors 1984).
    """
    body = np.ascontiguousarray(void, dtype=bool)
    if body.ndim != 3:
        raise SettingsError(
            message("medial.volume-not-three-axes", "The volume has {count} axes; give an array of 3.", count=body.ndim)
        )
    integer = np.issubdtype(step_weights(weights).dtype, np.integer)
    kind = np.dtype(np.int32 if integer else np.float64)
    far = np.iinfo(np.int32).max if integer else np.inf
    # One layer around spares the scans every test of the faces; what is far is small enough to add a weight to it.
    reach = kind.type(far // 2 if integer else np.inf)
    padded = np.full([n + 2 for n in body.shape], 0 if outside_is_rock else reach, dtype=kind)
    padded[1:-1, 1:-1, 1:-1] = np.where(body, reach, kind.type(0))
    _scans()(padded, *np.asarray(weights).astype(kind))
    distance: NDArray[Any] = padded[1:-1, 1:-1, 1:-1].copy()
    distance[distance >= reach] = far
    return distance


@cache
def _scans() -> Any:
    """Return the compiled pair of scans over a padded volume, in place."""
    from numba import njit

    # Written out: a loop over the 13 offsets costs three times as much.
    @njit(cache=True)
    def scans(v: NDArray[Any], face: Any, edge: Any, corner: Any) -> None:  # pragma: no cover
        nx, ny, nz = v.shape
        for side in (-1, 1):
            for i in range(1, nx - 1) if side < 0 else range(nx - 2, 0, -1):
                for j in range(1, ny - 1) if side < 0 else range(ny - 2, 0, -1):
                    a, b, c = v[i + side, j - 1], v[i + side, j], v[i + side, j + 1]
                    d, row = v[i, j + side], v[i, j]
                    for k in range(1, nz - 1) if side < 0 else range(nz - 2, 0, -1):
                        here = row[k]
                        if here > 0:
                            by_face = min(b[k], d[k], row[k + side]) + face
                            by_edge = min(b[k - 1], b[k + 1], a[k], c[k], d[k - 1], d[k + 1]) + edge
                            by_corner = min(a[k - 1], a[k + 1], c[k - 1], c[k + 1]) + corner
                            row[k] = min(here, by_face, by_edge, by_corner)

    return scans
