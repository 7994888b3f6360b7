"""The greedy choice of metaballs: always the candidate that adds most, found without trying them all.

The gain of a ball i over the field F of the balls chosen so far is

    E_i = sum_body [min(F + f_i, 1) - min(F, 1)] - lambda sum_rock [max(F + f_i, 1) - max(F, 1)].

Both terms fall as F grows, so E is submodular: a gain from an earlier round bounds the present one from above. A heap
of old gains therefore finds the best candidate with a few new evaluations (Minoux 1978, "Accelerated greedy algorithms
for maximizing submodular set functions"), and finds the same one as the full search. Fields are integers in units of
2^-20, so that rounding cannot break this.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.medial.kernel import STIFFNESS, reach, visible_radius

__all__ = ["UNIT", "Choice", "Cover", "choose_fully", "choose_next"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: The iso value in fixed point.
UNIT = 1 << 20


@dataclass(frozen=True)
class Choice:
    """One chosen ball: candidate, gain (voxels) when it was chosen, radius after the search."""

    candidate: int
    gain: float
    radius: float


class Cover:
    """Candidates, the body they should cover, and the field of the balls chosen so far.

    Parameters
    ----------
    body : (nx, ny, nz) array of bool
        Voxels to cover, with a margin of rock as wide as a ball may swell.
    edges : (3,) array
        Edge lengths of a voxel.
    index : (n, 3) array of int
        Centres of the candidates.
    distance : (n,) array
        Distance of each candidate from the rock: no ball becomes larger.
    cost : float
        Cost of covering a rock voxel, against 1 gained by a body voxel.
    stiffness : float
        s of the kernel.
    """

    def __init__(
        self,
        body: NDArray[np.bool_],
        edges: Floats,
        index: Ints,
        distance: Floats,
        cost: float = 1.0,
        stiffness: float = STIFFNESS,
    ) -> None:
        self.body, self.edges, self.cost, self.stiffness = np.ascontiguousarray(body), edges, cost, stiffness
        self.index, self.distance = np.ascontiguousarray(index), distance
        self.smallest = 0.5 * float(edges.min())
        # Distances run between voxel centres; the surface lies half a voxel nearer.
        self.radius = np.maximum(distance - self.smallest, self.smallest)
        self.field = np.zeros(body.shape, dtype=np.int32)
        self.covered = self.spilled = self.evaluations = 0
        self.total = int(body.sum())
        self._centres: list[Ints] = []
        self._reaches: list[float] = []

    def gain(self, i: int) -> float:
        """Return the gain of candidate i, in voxels."""
        self.evaluations += 1
        more, spilled = _loops()[0](
            self.field, self.body, self.edges, self.index[i], self.radius[i], self.stiffness, UNIT
        )
        return float((more - self.cost * spilled) / UNIT)

    def bounds(self) -> Floats:
        """Return the gain (n,) of each candidate if all voxels in its reach were in the body and not covered."""
        values, inverse = np.unique(self.radius, return_inverse=True)
        whole = np.empty(len(values))
        for j, e in enumerate(values.tolist()):
            half = np.ceil(reach(e, self.stiffness) / self.edges).astype(np.int64)
            shape = tuple((2 * half + 1).tolist())
            box, full = np.zeros(shape, dtype=np.int32), np.ones(shape, dtype=bool)
            whole[j] = _loops()[0](box, full, self.edges, half, e, self.stiffness, UNIT)[0] / UNIT
        return np.asarray(whole[inverse])

    def touched(self, i: int, since: int) -> bool:
        """Whether a ball chosen since round ``since`` shares voxels with candidate i."""
        own = float(reach(self.radius[i], self.stiffness))
        for centre, other in zip(self._centres[since:], self._reaches[since:], strict=True):
            if float((((centre - self.index[i]) * self.edges) ** 2).sum()) < (own + other) ** 2:
                return True
        return False

    def search_radius(self, i: int) -> tuple[float, float]:
        """Return the radius of candidate i that covers most body voxels less the cost of rock voxels, and that score.

        A voxel is covered from a radius on that has a closed form (:func:`visible_radius`), so a sort of these
        radii replaces the bisection of the article and is exact. The radius lies midway to the next voxel.
        """
        centre, most = self.index[i], max(float(self.distance[i]), self.smallest)
        half = np.ceil(reach(most, self.stiffness) / self.edges).astype(np.int64)
        low, high = np.maximum(centre - half, 0), np.minimum(centre + half + 1, self.body.shape)
        box = tuple(slice(a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True))
        axes = [((np.arange(a, b) - c) * h) ** 2 for a, b, c, h in zip(low, high, centre, self.edges, strict=True)]
        r2 = axes[0][:, None, None] + axes[1][:, None] + axes[2]
        field = self.field[box]
        open_ = (field < UNIT) & (r2 < reach(most, self.stiffness) ** 2)
        threshold = np.maximum(visible_radius(np.sqrt(r2[open_]), field[open_] / UNIT, self.stiffness), self.smallest)
        order = np.argsort(threshold, kind="stable")
        threshold = threshold[order]
        order = order[: np.searchsorted(threshold, most, side="right")]
        if not len(order):
            return self.smallest, 0.0
        score = np.cumsum(np.where(self.body[box][open_][order], 1.0, -self.cost))
        # Voxels of one threshold enter together.
        last = np.r_[threshold[1 : len(order)] > threshold[: len(order) - 1], True]
        best = int(np.where(last, score, -np.inf).argmax())
        following = threshold[best + 1] if best + 1 < len(threshold) else most
        return 0.5 * (float(threshold[best]) + min(float(following), most)), float(score[best])

    def add(self, i: int, radius: float) -> None:
        """Add candidate i with a radius to the field."""
        gained, spilled = _loops()[1](self.field, self.body, self.edges, self.index[i], radius, self.stiffness, UNIT)
        self.covered += int(gained)
        self.spilled += int(spilled)
        self._centres.append(self.index[i])
        self._reaches.append(float(reach(radius, self.stiffness)))

    @property
    def dice(self) -> float:
        """Twice the covered body voxels over body voxels plus covered voxels."""
        return 2.0 * self.covered / max(self.total + self.covered + self.spilled, 1)


def choose_next(cover: Cover, heap: list[tuple[float, int, int]]) -> Choice | None:
    """Choose the next ball with a heap of (-bound, candidate, round of the bound), and add it.

    Start with ``[(-bound, i, -1) ...]`` of :meth:`Cover.bounds`, made a heap. Returns None where no candidate gains a
    voxel.
    """
    while heap:
        bound, i, since = heapq.heappop(heap)
        if -bound < 1.0:
            return None
        now = len(cover._centres)
        if since < 0 or cover.touched(i, since):
            heapq.heappush(heap, (-cover.gain(i), i, now))
            continue
        radius, score = cover.search_radius(i)
        if score > 0:
            cover.add(i, radius)
            return Choice(i, -bound, radius)
    return None


def choose_fully(cover: Cover, candidates: list[int]) -> Choice | None:
    """Choose the next ball by evaluating every candidate, and add it: the reference for :func:`choose_next`."""
    while candidates:
        gains = [cover.gain(i) for i in candidates]
        best = int(np.argmax(gains))
        if gains[best] < 1.0:
            return None
        i = candidates.pop(best)
        radius, score = cover.search_radius(i)
        if score > 0:
            cover.add(i, radius)
            return Choice(i, gains[best], radius)
    return None


@cache
def _loops() -> tuple[Any, Any]:
    """Return the compiled loops over the voxels of a ball: its gain, and its addition to the field."""
    from numba import njit

    @njit(cache=True, inline="always")
    def strength(r2, e, s, unit):  # type: ignore[no-untyped-def]  # pragma: no cover
        r = np.sqrt(r2)
        if r <= e:
            return np.int64((1.0 + s * (1.0 - r / e)) * unit + 0.5)
        t = (e * (1.0 + 2.0 / s) - r) * s / (2.0 * e)
        return np.int64(t * t * unit + 0.5)

    @njit(cache=True)
    def gain(field, body, edges, centre, e, s, unit):  # type: ignore[no-untyped-def]  # pragma: no cover
        far = e * (1.0 + 2.0 / s)
        more = spilled = np.int64(0)
        a, b, c = np.ceil(far / edges[0]), np.ceil(far / edges[1]), np.ceil(far / edges[2])
        for i in range(max(centre[0] - a, 0), min(centre[0] + a + 1, field.shape[0])):
            x2 = ((i - centre[0]) * edges[0]) ** 2
            for j in range(max(centre[1] - b, 0), min(centre[1] + b + 1, field.shape[1])):
                xy2 = x2 + ((j - centre[1]) * edges[1]) ** 2
                if xy2 >= far * far:
                    continue
                for k in range(max(centre[2] - c, 0), min(centre[2] + c + 1, field.shape[2])):
                    r2 = xy2 + ((k - centre[2]) * edges[2]) ** 2
                    if r2 < far * far:
                        old = np.int64(field[i, j, k])
                        if body[i, j, k]:
                            if old < unit:
                                more += min(old + strength(r2, e, s, unit), unit) - old
                        else:
                            spilled += max(old + strength(r2, e, s, unit), unit) - max(old, unit)
        return more, spilled

    @njit(cache=True)
    def add(field, body, edges, centre, e, s, unit):  # type: ignore[no-untyped-def]  # pragma: no cover
        far = e * (1.0 + 2.0 / s)
        gained = spilled = np.int64(0)
        a, b, c = np.ceil(far / edges[0]), np.ceil(far / edges[1]), np.ceil(far / edges[2])
        for i in range(max(centre[0] - a, 0), min(centre[0] + a + 1, field.shape[0])):
            for j in range(max(centre[1] - b, 0), min(centre[1] + b + 1, field.shape[1])):
                for k in range(max(centre[2] - c, 0), min(centre[2] + c + 1, field.shape[2])):
                    r2 = ((i - centre[0]) * edges[0]) ** 2
                    r2 = r2 + ((j - centre[1]) * edges[1]) ** 2
                    r2 = r2 + ((k - centre[2]) * edges[2]) ** 2
                    if r2 < far * far:
                        old = np.int64(field[i, j, k])
                        new = min(old + strength(r2, e, s, unit), np.int64(1) << 30)
                        field[i, j, k] = new
                        if old < unit <= new:
                            if body[i, j, k]:
                                gained += 1
                            else:
                                spilled += 1
        return gained, spilled

    return gain, add
