"""Maximal balls of a pore space: every digital ball that no other ball of the pore space includes.

Step 1 of Huang et al. (2007) finds the largest ball round each pore voxel; in one pass, it is the squared distance F²
to the nearest rock voxel, and R² is the largest sum of three squares below F². Step 2 deletes included balls. The
article compares radii (``rule="paper"``), which errs both ways on a grid; the default is the exact decision of Remy &
Thiel (2005). The union of the maximal balls is the pore space, voxel for voxel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.pores import slabs
from geofit.pores.distance import Border, border_walls, squared_distance, sums_of_squares
from geofit.pores.slabs import Slices
from geofit.pores.volume import RockVolume, VolumeError

__all__ = ["BallRule", "MaximalBalls", "balls_of_distance", "maximal_balls"]

BallRule = Literal["exact", "paper", "cover"]


@dataclass(frozen=True, eq=False)
class MaximalBalls:
    """Maximal balls, from the largest to the smallest.

    Attributes
    ----------
    centre : ndarray of int32, shape (n, 3)
        Index of the centre voxel along each axis of the volume.
    radius2 : ndarray of int32, shape (n,)
        R²: the squared distance of the farthest voxel of the ball. Float64 for voxels that are not cubic.
    reach2 : ndarray, shape (n,)
        F²: the squared distance of the nearest rock voxel. The ball is the set of voxels nearer than that.
    edges : tuple of float
        Edge lengths of a voxel, in units of the shortest edge, which is also the unit of R² and F².
    shape : tuple of int
        Shape of the volume.
    rule : {"exact", "paper", "cover"}
        How included balls were found.
    """

    centre: NDArray[np.int32]
    radius2: NDArray[Any]
    reach2: NDArray[Any]
    edges: tuple[float, float, float]
    shape: tuple[int, int, int]
    rule: BallRule

    def __len__(self) -> int:
        return len(self.centre)

    @property
    def radius(self) -> NDArray[np.float64]:
        """Geometric radii in voxels: from the centre to the rock's surface, half a voxel before the rock's centre."""
        return np.sqrt(self.reach2.astype(np.float64)) - 0.5

    def union(self) -> NDArray[np.bool_]:
        """Return the voxels of the volume that lie in at least one ball.

        Returns
        -------
        ndarray of bool, shape ``self.shape``
        """
        from geofit.pores.ball_painting import paint_union

        out = np.zeros(self.shape, dtype=bool)
        paint_union(self.centre, self.reach2.astype(np.float64), np.square(self.edges), out)
        return out


@arguments_checked
def maximal_balls(
    volume: Slices,
    *,
    rule: BallRule | None = None,
    border: Border = "closed",
    progress: Progress | None = None,
) -> MaximalBalls:
    """Return the maximal balls of a pore space.

    Parameters
    ----------
    volume : RockVolume or SlicedVolume
        The pore space. With the exact rule a large one is worked through in slabs.
    rule : {"exact", "paper", "cover"}, optional
        ``"exact"``: every ball that no other ball includes (default for cubic voxels). ``"paper"``: the article's
        comparison R2 + distance <= L1, which deletes some balls that are not included and keeps some that are; it
        loses no voxel, since it deletes a ball only if its centre lies in a larger one. ``"cover"``: from large to
        small, every ball that covers a voxel which no earlier ball covers: a subset of the maximal balls with the same
        union (default, and only rule, for voxels that are not cubic).
    border : "closed", "open" or three of them
        Closed (the article's rule): the sample's faces stop a ball like rock. Open: only rock does.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    MaximalBalls
        Centres and squared radii, from large to small.

    Raises
    ------
    VolumeError
        If the rule needs cubic voxels and these are not, or the whole volume in memory.

    Notes
    -----
    Maximal balls of a pore space: Huang et al. (2007); the rules "exact" and "cover" are this library's.

    Examples
    --------
    >>> balls = maximal_balls(RockVolume(np.ones((3, 3, 3)), pore=1, voxel=1e-6))
    >>> len(balls), bool(balls.union().all())
    (21, True)
    """
    rule = rule or ("exact" if volume.cubic else "cover")
    if rule not in ("exact", "paper", "cover"):
        raise VolumeError(
            message("pores.rule-unknown", "rule={rule} is unknown. Give 'exact', 'paper' or 'cover'.", rule=repr(rule))
        )
    if rule != "cover" and not volume.cubic:
        raise VolumeError(
            message(
                "pores.rule-needs-cubic-voxels",
                "rule='{rule}' compares sums of three squares and needs cubic voxels; these measure {voxel} m. Use "
                "rule='cover'.",
                rule=rule,
                voxel=volume.voxel,
            )
        )
    border_walls(border)
    if volume.porosity == 1:
        border = "closed"
    if rule == "exact" and (not isinstance(volume, RockVolume) or volume.pore.size > slabs.VOXELS):
        return _assembled(*_in_slabs(volume, border, progress), rule, volume.edges, volume.shape)
    if not isinstance(volume, RockVolume):
        raise VolumeError(
            message(
                "pores.rule-needs-whole-volume",
                "rule='{rule}' needs the whole volume in memory, and this one is read slab by slab. Read a part of it "
                "with read_volume; for cubic voxels rule='exact' works in slabs.",
                rule=rule,
            )
        )
    tell(progress, "distance", 0.0)
    reach2 = squared_distance(volume.pore, border, volume.edges)
    tell(progress, "balls", 0.4)
    return balls_of_distance(reach2, rule, volume.edges)


def _in_slabs(volume: Slices, border: Border, progress: Progress | None) -> tuple[NDArray[np.int64], NDArray[Any]]:
    """Return the flat indices and F² of the maximal balls, from two passes over the slabs."""
    from geofit.pores.ball_selection import BLOCK, BallSearch, block_maxima

    # Blocks at the seam of two slabs get a row from each.
    rows: dict[int, NDArray[np.int64]] = {}
    for first, _, _, found in slabs.distance_slabs(volume, border, 0, progress):
        for row, maxima in enumerate(block_maxima(found, first), first // BLOCK):
            rows[row] = np.maximum(rows.get(row, 0), maxima)
    search = BallSearch(np.array([rows[row] for row in sorted(rows)]))
    kept, values = [], []
    for first, end, before, found in slabs.distance_slabs(volume, border, search.REACH, progress):
        tell(progress, "balls", first / volume.shape[0])
        low = first - before
        balls = search.balls(found, low, first, end)
        kept.append(balls)
        values.append(found.ravel()[balls - low * found.shape[1] * found.shape[2]])
    return np.concatenate(kept), np.concatenate(values)


def balls_of_distance(reach2: NDArray[Any], rule: BallRule, edges: tuple[float, float, float]) -> MaximalBalls:
    """Return the maximal balls of a squared distance map; see :func:`maximal_balls`."""
    from geofit.pores import ball_painting, ball_selection

    shape = reach2.shape
    if rule == "exact":
        kept = ball_selection.exact(reach2)
    elif rule == "paper":
        kept = ball_selection.paper(reach2)
    else:
        kept = ball_painting.covering(reach2, np.square(edges))
    return _assembled(kept, reach2.ravel()[kept], rule, edges, (shape[0], shape[1], shape[2]))


def _assembled(
    kept: NDArray[np.int64],
    values: NDArray[Any],
    rule: BallRule,
    edges: tuple[float, float, float],
    shape: tuple[int, int, int],
) -> MaximalBalls:
    """Sort balls, given by flat index and F², from large to small."""
    from geofit.pores.ball_painting import farthest_squares

    cubic = edges == (1.0, 1.0, 1.0)
    # Small whole numbers are sorted by their digits, at once.
    least = values.max(initial=0) - values
    order = np.argsort(least.astype(np.uint16) if least.max(initial=0) < 1 << 16 and cubic else least, kind="stable")
    kept, values = kept[order], values[order]
    centre = np.stack(np.unravel_index(kept, shape), axis=1).astype(np.int32)
    if cubic:
        radius2: NDArray[Any] = sums_of_squares(int(values[0]) if len(values) else 0)[values]
    else:
        radius2 = farthest_squares(values, np.square(edges))
    for array in (centre, radius2, values):
        array.flags.writeable = False
    return MaximalBalls(centre, radius2, values, edges, shape, rule)
