"""Where a layer is, as the holes that pass its place show: those that met it, and those without it.

Two surfaces that were fitted each by itself do not lie on each other where the layer between them is absent: they
differ there by as much as either is uncertain, and half of that looks like a layer. Holes know better.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError, cKDTree

from geofit.data.points import PointSet

__all__ = ["Presence", "presence_of"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Contacts nearer than this are one: the layer is absent. Places nearer than this in plan are one. Metres.
SAME = 1e-3
#: Of more places than these, as of grids, the surfaces themselves follow the edge of the layer.
MOST = 20_000


@dataclass(frozen=True, eq=False)
class Presence:
    """Places in plan (k, 2), map coordinates, at which both horizons were met, and at which of them there is a layer.

    ``layer`` (k,) is false where both have one contact: the layer has no thickness there.
    """

    plan: Floats
    layer: Bools

    @property
    def without(self) -> int:
        """Number of places without the layer."""
        return int((~self.layer).sum())

    def nearest(self, places: Floats) -> Bools:
        """Return whether the place nearest to each (n, 2) has the layer."""
        return np.asarray(self.layer[cKDTree(self.plan).query(places)[1]])

    def around(self, places: Floats) -> tuple[Bools, Bools]:
        """Return where all three places around each (n, 2) have the layer, and where all three have not.

        Beyond the hull of the places neither.
        """
        try:
            mesh = Delaunay(self.plan - self.plan[0])
        except (QhullError, ValueError):
            return np.zeros(len(places), bool), np.zeros(len(places), bool)
        triangle = mesh.find_simplex(places - self.plan[0])
        having = np.where(triangle >= 0, self.layer[mesh.simplices].sum(axis=1)[triangle], -1)
        return having == 3, having == 0


def presence_of(upper: PointSet, lower: PointSet) -> Presence | None:
    """Return where the layer between two horizons is, by their contacts; None if no hole is without it.

    Contacts belong together if their hole has no other of either horizon, or if they lie in one place in plan. Others,
    as those of geophysics or of one horizon alone, show nothing.
    """
    first, second = _alone(upper), _alone(lower)
    pairs = np.array([(first[hole], second[hole]) for hole in sorted(first.keys() & second.keys())], int).reshape(-1, 2)
    _, i, k = np.intersect1d(_places(upper), _places(lower), return_indices=True)
    free = ~np.isin(i, pairs[:, 0])
    i, k = np.concatenate([pairs, np.column_stack([i[free], k[free]])]).T
    apart = upper.xyz[i] - lower.xyz[k]
    # Where the upper contact lies below the lower one, one of the two is wrong.
    sound = apart[:, 2] >= -SAME
    layer = np.linalg.norm(apart, axis=1)[sound] > SAME
    if layer.all() or len(layer) > MOST:
        return None
    plan, index = np.unique(upper.xyz[i][sound][:, :2], axis=0, return_index=True)
    return Presence(plan, layer[index])


def _alone(points: PointSet) -> dict[str, int]:
    """Return the contact of each hole that has one alone, by its name."""
    labels = points.labels["hole"]
    count = np.bincount(labels.codes, minlength=len(labels.table))
    alone = np.flatnonzero(count[labels.codes] == 1).tolist() if len(points) else []
    return {name: k for k in alone if (name := labels.word(k))}


def _places(points: PointSet) -> NDArray[np.void]:
    """Return the places (n,) in plan, rounded, as numbers that can be compared."""
    rounded = np.ascontiguousarray(np.round(points.xyz[:, :2] / SAME).astype(np.int64))
    return rounded.view([("x", np.int64), ("y", np.int64)])[:, 0]
