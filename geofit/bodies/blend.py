"""Many thousand conditions: one coarse field, corrected in overlapping parts that are blended.

A field through a few hundred well-spread contacts takes the shape; in each part a correction of compact kernels makes
it exact there. Corrections are blended by weights that are C2 and add up to one (partition of unity; Wendland,
*Scattered Data Approximation*, ch. 15). Every correction of a part satisfies all conditions inside the part. The blend
is their convex combination, so it satisfies them too: equalities and inequalities alike.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.active import ActiveFit, SidedSamples, farthest_apart, fit_active
from geofit.bodies.kernels import CUBIC, blend
from geofit.bodies.rbf import Rbf

__all__ = ["Blend", "BlendFit", "BlendPart", "fit_blend", "refit_blend"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Conditions and samples of the coarse field.
COARSE = 500
COARSE_SAMPLES = 4000
#: Rounds of the coarse field: what it leaves violated, the parts correct.
COARSE_ROUNDS = 6
#: Conditions in the core of a part, and how much each side of it is grown (share of the side).
CORE = 60
#: What a sample on the wrong side of the coarse field counts there.
LACKING = 0.3
OVERLAP = 0.12


@dataclass(frozen=True, eq=False)
class BlendPart:
    """A box with its correction: ``centre`` and ``half`` (3,) of the grown box; active samples and rounds it took."""

    centre: Floats
    half: Floats
    correction: Rbf | None = None
    active: int = 0
    rounds: int = 0

    def holds(self, x: Floats) -> NDArray[np.bool_]:
        """Return whether each of (n, 3) places lies in the grown box."""
        return np.asarray((np.abs(x - self.centre) < self.half).all(axis=1))


@dataclass(frozen=True, eq=False)
class Blend:
    """The coarse field plus the blended corrections; its parts cover the box of the body."""

    coarse: Rbf
    parts: tuple[BlendPart, ...]

    def value(self, x: Floats) -> Floats:
        """Return the values (n,) at (n, 3) places."""
        out = self.coarse.value(x)
        given: Any = (np.ascontiguousarray(x), *self._packed, False, out, np.zeros((0, 3)))
        blend(*given)
        return out

    def gradient(self, x: Floats) -> Floats:
        """Return the gradients (n, 3) at (n, 3) places."""
        out = np.ascontiguousarray(self.coarse.gradient(x))
        given: Any = (np.ascontiguousarray(x), *self._packed, True, np.zeros(len(x)), out)
        blend(*given)
        return out

    @cached_property
    def _packed(self) -> tuple[NDArray[Any], ...]:
        """The parts as the arrays of :func:`geofit.bodies.kernels.blend`."""
        none = Rbf(np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(10), 1.0)
        own = [part.correction or none for part in self.parts]
        return (
            np.array([part.centre for part in self.parts]),
            np.array([part.half for part in self.parts]),
            np.array([rbf.reach for rbf in own]),
            np.cumsum([0, *(len(rbf.centres) for rbf in own)]).astype(np.int64),
            np.ascontiguousarray(np.concatenate([rbf.centres for rbf in own]).T),
            np.concatenate([rbf.weights for rbf in own]),
            np.cumsum([0, *(len(rbf.dipoles) for rbf in own)]).astype(np.int64),
            np.ascontiguousarray(np.concatenate([rbf.dipoles for rbf in own]).T),
            np.ascontiguousarray(np.concatenate([rbf.moments for rbf in own]).T),
        )


@dataclass(frozen=True, eq=False)
class BlendFit:
    """The field, and the number of active samples and the rounds of its coarse field."""

    field: Blend
    coarse_active: int
    coarse_rounds: int

    @property
    def active(self) -> int:
        """Samples active in the coarse field and in the parts."""
        return self.coarse_active + sum(part.active for part in self.field.parts)

    @property
    def rounds(self) -> int:
        """Rounds of the coarse field or of the part that took most."""
        return max([self.coarse_rounds, *(part.rounds for part in self.field.parts)])


def fit_blend(
    points: Floats,
    oriented: NDArray[np.bool_],
    normals: Floats,
    samples: SidedSamples,
    corners: Floats,
    kernel: float = CUBIC,
) -> BlendFit:
    """Fit a field that is zero at the contacts and keeps every sample on its side, in parts.

    Parameters
    ----------
    points : (n, 3) array
        Contacts.
    oriented : (n,) array of bool
        Contacts with a normal.
    normals : (k, 3) array
        Gradients at those.
    samples : Samples
        Inequalities.
    corners : (c, 3) array
        Places whose box the parts must cover.
    kernel : float
        Of the coarse field, see :mod:`geofit.bodies.kernels`.
    """
    first = _coarse(points, oriented, normals, samples, kernel)
    left = _Left.by(first.rbf, points, oriented, normals, samples)
    lower = np.minimum(corners.min(axis=0), points.min(axis=0)) - 1e-9
    upper = np.maximum(corners.max(axis=0), points.max(axis=0)) + 1e-9
    lacking = left.samples.xyz[left.samples.bound > left.samples.slack]
    load = np.concatenate([np.where(oriented, 4, 1), np.full(len(lacking), LACKING)])
    boxes = _boxes(np.concatenate([points, lacking]), load, lower, upper)
    parts = tuple(left.fitted(BlendPart((low + high) / 2, (high - low) * (0.5 + OVERLAP))) for low, high in boxes)
    return BlendFit(Blend(first.rbf, parts), len(first.active), first.rounds)


def refit_blend(
    former: BlendFit,
    points: Floats,
    oriented: NDArray[np.bool_],
    normals: Floats,
    samples: SidedSamples,
    fresh: int,
) -> BlendFit:
    """Fit a field again with more samples, the last ``fresh`` of all: only parts that hold one of those change.

    The other parameters are those of :func:`fit_blend`.
    """
    left = _Left.by(former.field.coarse, points, oriented, normals, samples)
    new = samples.xyz[len(samples) - fresh :]
    parts = tuple(left.fitted(part) if part.holds(new).any() else part for part in former.field.parts)
    return replace(former, field=Blend(former.field.coarse, parts))


@dataclass(frozen=True, eq=False)
class _Left:
    """What a coarse field leaves to the parts: values at the contacts, gradients (NaN where none is given), bounds."""

    points: Floats
    values: Floats
    gradients: Floats
    samples: SidedSamples

    @classmethod
    def by(
        cls, coarse: Rbf, points: Floats, oriented: NDArray[np.bool_], normals: Floats, samples: SidedSamples
    ) -> _Left:
        gradients = np.full_like(points, np.nan)
        gradients[oriented] = normals - coarse.gradient(points[oriented])
        bound = samples.bound - samples.side * coarse.value(samples.xyz)
        return cls(points, -coarse.value(points), gradients, replace(samples, bound=bound))

    def fitted(self, part: BlendPart) -> BlendPart:
        """Return a part with its correction; without one where it has nothing to correct."""
        at, near = np.flatnonzero(part.holds(self.points)), self.samples[part.holds(self.samples.xyz)]
        if not len(at) and not (near.bound > near.slack).any():
            return part
        turned = at[np.isfinite(self.gradients[at]).all(axis=1)]
        reach = 2.0 * float(np.linalg.norm(part.half))
        fit = fit_active(self.points[at], self.values[at], self.points[turned], self.gradients[turned], near, reach)
        return replace(part, correction=fit.rbf, active=len(fit.active), rounds=fit.rounds)


def _coarse(
    points: Floats, oriented: NDArray[np.bool_], normals: Floats, samples: SidedSamples, kernel: float
) -> ActiveFit:
    """Fit the coarse field through some contacts far from each other; what it leaves violated, the parts correct."""
    rows = np.where(oriented, 4, 1)
    chosen = np.sort(farthest_apart(points, max(50, int(COARSE / rows.mean()))))
    gradients = np.full_like(points, np.nan)
    gradients[oriented] = normals
    own = chosen[oriented[chosen]]
    some = np.arange(0, len(samples), -(-len(samples) // COARSE_SAMPLES)) if len(samples) else np.zeros(0, np.int64)
    return fit_active(
        points[chosen],
        np.zeros(len(chosen)),
        points[own],
        gradients[own],
        samples[some],
        kernel,
        most=COARSE_ROUNDS,
        partial=True,
    )


def _boxes(points: Floats, load: Floats, lower: Floats, upper: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Split a box at medians of its points until each part carries a small load; the parts tile the box."""
    size = upper - lower
    if load.sum() <= CORE:
        yield lower, upper
        return
    # The longest side, and no cut that would leave a sliver: parts grow by a share of their sides.
    axis = int(size.argmax())
    cut = float(np.median(points[:, axis]))
    cut = min(max(cut, lower[axis] + 0.2 * size[axis]), upper[axis] - 0.2 * size[axis])
    below = points[:, axis] < cut
    for side, low, high in ((below, lower[axis], cut), (~below, cut, upper[axis])):
        first, last = lower.copy(), upper.copy()
        first[axis], last[axis] = low, high
        yield from _boxes(points[side], load[side], first, last)
