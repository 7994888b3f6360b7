"""Metaballs that cover a branching voxel body, the fewest first (Guo, Peng and Li 1999)."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.medial.agreement import Agreement, agreement
from geofit.medial.balls import MetaballBody
from geofit.medial.greedy import UNIT, Choice, Cover, choose_next
from geofit.medial.kernel import STIFFNESS, reach
from geofit.medial.polish import polish, surface_points
from geofit.medial.weights import INTEGER_WEIGHTS
from geofit.pores.volume import RockVolume

__all__ = ["BallStep", "FittedMetaballs", "metaballs"]

Floats = NDArray[np.float64]

#: The Hausdorff distance at 95 % within which a fit may stop, voxels.
CLOSE = 0.75
#: Voxels whose field is computed together.
SLAB = 1 << 20


@dataclass(frozen=True)
class BallStep:
    """One ball of the greedy choice: what the body was after it.

    Parameters
    ----------
    balls : int
        Balls so far.
    gain : float
        What the ball added to the energy when it was chosen, voxels.
    dice, share : float
        Overlap with the body, and the share of its voxels that are covered.
    volume : float
        Covered volume, cubic metres.
    hausdorff, hausdorff95 : float
        As in :class:`~geofit.medial.agreement.Agreement`, metres; nan but for steps 1, 2, 4, 8 ... and the last.
    """

    balls: int
    gain: float
    dice: float
    share: float
    volume: float
    hausdorff: float = np.nan
    hausdorff95: float = np.nan


@dataclass(frozen=True, eq=False, kw_only=True)
class FittedMetaballs(MetaballBody):
    """Metaballs with the volume that they cover. Editing a ball returns another one, with its own figures.

    Coordinates are metres along the axes of the array, from the corner of the volume.

    Parameters
    ----------
    volume : RockVolume
        The voxels.
    curve : tuple of Step
        The greedy choice, ball by ball, before the balls were polished and edited.
    candidates, evaluations : int
        Medial points, and gains that were computed; a full search computes ``candidates`` for every ball.
    """

    volume: RockVolume
    curve: tuple[BallStep, ...] = ()
    candidates: int = 0
    evaluations: int = 0

    def covered(self) -> NDArray[np.bool_]:
        """Return the voxels whose centre is in the body, shape of the volume."""
        voxel, shape = np.array(self.volume.voxel), np.array(self.volume.shape)
        low, high = self.bounds
        first = np.clip(np.floor(low / voxel).astype(int), 0, shape)
        last = np.clip(np.ceil(high / voxel).astype(int), 0, shape)
        inside = np.zeros(self.volume.shape, dtype=bool)
        axes = [(np.arange(i, j) + 0.5) * h for i, j, h in zip(first, last, voxel, strict=True)]
        thick = max(1, SLAB // max(len(axes[1]) * len(axes[2]), 1))
        for start in range(0, len(axes[0]), thick):
            part = np.stack(np.meshgrid(axes[0][start : start + thick], *axes[1:], indexing="ij"), axis=-1)
            values = self.value(part.reshape(-1, 3)).reshape(part.shape[:3])
            row = first[0] + start
            inside[row : row + len(part), first[1] : last[1], first[2] : last[2]] = values <= 0
        return inside

    @cached_property
    def figures(self) -> Agreement:
        """Dice, Hausdorff and volume of the body against the volume."""
        return agreement(self.covered(), self.volume.pore, self.volume.voxel)

    @property
    def dice(self) -> float:
        """Twice the common voxels over the sum of both, 0 to 1."""
        return self.figures.dice

    @property
    def hausdorff(self) -> float:
        """Largest distance between the boundary voxels of body and volume, metres."""
        return self.figures.hausdorff


@arguments_checked
def metaballs(
    volume: RockVolume,
    *,
    distance: Literal["euclid", "chamfer"] = "euclid",
    weights: ArrayLike = INTEGER_WEIGHTS,
    cost: float = 1.0,
    share: float = 0.995,
    max_balls: int | None = None,
    stiffness: float = STIFFNESS,
    progress: Progress | None = None,
) -> FittedMetaballs:
    """Return metaballs on the medial axis that cover the pore voxels of a volume.

    Parameters
    ----------
    volume : RockVolume
        The body; its pore voxels are covered.
    distance : {"euclid", "chamfer"}
        Exact maximal balls (default), or those of the chamfer distance with ``weights``, as in the article; chamfer
        needs voxels that are cubes.
    weights : three int
        Chamfer distances to a neighbour across a face, an edge and a corner of a voxel; the Euclidean distance does not
        use them.
    cost : float
        Weight of a rock voxel that is covered, relative to a pore voxel.
    share : float
        Stop once this share of the voxels is covered and 95 % of the boundary voxels lie within 0.75 voxel.
    max_balls : int, optional
        Stop at this number of balls.
    stiffness : float
        Weight s in the exponent of the kernel: a ball acts to 1 + 2 / s times its radius.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    FittedMetaballs
        The balls in the order of their choice, then moved and resized together so that their surface is nearest to
        that of the voxels, if this raises the Dice figure or joins parts of the body. Without ``max_balls`` the choice
        ends where no ball gains a voxel.

    Raises
    ------
    SettingsError
        If a setting is out of its range, or chamfer is used for voxels that are not cubes.

    Notes
    -----
    The article's energy is lost in our copy; see :mod:`geofit.medial.greedy` for the one used here.
    """
    if not (cost > 0 and 0 < share <= 1 and stiffness > 0 and (max_balls is None or max_balls > 0)):
        raise SettingsError(
            message(
                "medial.settings-unusable",
                "Give a cost and a stiffness above 0, a share above 0 and at most 1, and at least 1 ball; given: cost "
                "{cost:g}, stiffness {stiffness:g}, share {share:g}, balls {balls}.",
                cost=cost,
                stiffness=stiffness,
                share=share,
                balls=message("medial.any-number", "as many as it takes") if max_balls is None else max_balls,
            )
        )
    tell(progress, "medial axis", 0.0)
    index, far = _candidates(volume, distance, weights)
    edges = np.array(volume.edges)
    # A ball may swell beyond the faces of the volume, and rock there counts as any other.
    margin = np.ceil((reach(far.max(), stiffness) - far.max()) / edges).astype(int) + 1
    body = np.pad(volume.pore, [(m, m) for m in margin.tolist()])
    cover = Cover(body, edges, index + margin, far, cost, stiffness)
    chosen, curve = _choose_all(cover, volume, share, max_balls, progress)
    if not chosen:
        raise SettingsError(
            message(
                "medial.body-too-thin",
                "No ball covers a voxel more than it costs: the body is thinner than a voxel. Scan it with smaller "
                "voxels.",
            )
        )
    picked = np.array([choice.candidate for choice in chosen])
    centre, radius = (index[picked] + 0.5) * edges, np.array([choice.radius for choice in chosen])
    greedy = FittedMetaballs(
        centre=centre * volume.unit,
        radius=radius * volume.unit,
        stiffness=stiffness,
        volume=volume,
        curve=curve,
        candidates=len(index),
        evaluations=cover.evaluations,
    )
    tell(progress, "polish", 0.9)
    centre, radius = polish(centre, radius, stiffness, surface_points(volume.pore, edges))
    polished = replace(greedy, centre=centre * volume.unit, radius=radius * volume.unit)
    # Balls along a tube of one voxel may have gaps that the polished ones close, though they cover more rock.
    better = polished.dice >= greedy.dice or _parts_wrong(polished) < _parts_wrong(greedy)
    return polished if better else greedy


def _parts_wrong(body: FittedMetaballs) -> int:
    """Return by how many the connected parts of a body differ from those of the voxels."""
    from scipy.ndimage import label

    touching = np.ones((3, 3, 3))
    return abs(int(label(body.covered(), touching)[1]) - int(label(body.volume.pore, touching)[1]))


def _candidates(volume: RockVolume, distance: str, weights: ArrayLike) -> tuple[NDArray[np.int64], Floats]:
    """Return medial points (n, 3) and their distances from the rock (n,), in units of the shortest edge."""
    if distance == "euclid":
        from geofit.pores.balls import maximal_balls

        balls = maximal_balls(volume)
        return balls.centre.astype(np.int64), np.sqrt(balls.reach2.astype(np.float64))
    if distance != "chamfer":
        raise SettingsError(
            message(
                "medial.distance-unknown",
                "The distance '{name}' is unknown; give 'euclid' or 'chamfer'.",
                name=distance,
            )
        )
    if not volume.cubic:
        raise SettingsError(
            message(
                "medial.chamfer-needs-cubes",
                "The voxels measure {edges} m, and a chamfer distance needs cubes; use distance='euclid'.",
                edges=volume.voxel,
            )
        )
    from geofit.medial.axis import medial_points

    points = medial_points(volume.pore, weights)
    return points.index, points.distance


def _choose_all(
    cover: Cover, volume: RockVolume, share: float, max_balls: int | None, progress: Progress | None
) -> tuple[list[Choice], tuple[BallStep, ...]]:
    heap = [(-bound, i, -1) for i, bound in enumerate(cover.bounds().tolist())]
    heapq.heapify(heap)
    chosen: list[Choice] = []
    curve: list[BallStep] = []
    size = float(np.prod(volume.voxel))
    check = 1
    while max_balls is None or len(chosen) < max_balls:
        covered = cover.covered / cover.total
        tell(progress, "metaballs", covered)
        choice = choose_next(cover, heap)
        if choice is None:
            break
        chosen.append(choice)
        covered = cover.covered / cover.total
        step = BallStep(len(chosen), choice.gain, cover.dice, covered, (cover.covered + cover.spilled) * size)
        if len(chosen) >= check or (max_balls is not None and len(chosen) == max_balls):
            step = _measured(step, cover, volume)
            # Once the share is reached the surfaces are compared every tenth ball more, before that at 1, 2, 4, 8 ...
            check = len(chosen) + max(1, len(chosen) // 10) if covered >= share else 2 * len(chosen)
        elif covered >= share:
            check = min(check, len(chosen) + 1)
        curve.append(step)
        if covered >= share and step.hausdorff95 <= CLOSE * volume.unit:
            break
    if curve:
        curve[-1] = _measured(curve[-1], cover, volume)
    return chosen, tuple(curve)


def _measured(step: BallStep, cover: Cover, volume: RockVolume) -> BallStep:
    found = agreement(cover.field >= UNIT, cover.body, volume.voxel)
    return BallStep(step.balls, step.gain, step.dice, step.share, step.volume, found.hausdorff, found.hausdorff95)
