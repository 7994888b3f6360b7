"""Inequalities by an active set: the smoothest field that passes through the contacts and keeps every sample's side.

Minimise the energy of the field subject to values and gradients given, and ``side_i f(x_i) >= bound_i`` at samples.
The optimum has the form of an interpolant through the given values and a few samples held at their bounds, each pulled
to its own side only (Nocedal & Wright, *Numerical Optimization*, sec. 16.4). Violated samples become candidates, batch
after batch; among the candidates the dual problem is solved exactly, so the energy grows with every batch and the loop
ends. In practice 1-5 % of the samples of drill-hole intervals end up active.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.kernels import CUBIC, gram, sweep
from geofit.bodies.rbf import DRIFTS, NONE, Rbf, Saddle
from geofit.data.errors import FitError
from geofit.data.messages import message

__all__ = ["ActiveFit", "SidedSamples", "complementarity", "farthest_apart", "fit_active", "fixes_trend"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Samples that enter in one round, at least.
BATCH = 30
#: Where contacts leave the trend free: rounds in which samples may be released; later ones only add, so the loop ends.
RELEASING = 40
ROUNDS = 200
#: Pivots without progress, restarts, and sweeps between them, of the dual problem.
CHANCES = 3
RESTARTS = 2
SWEEPS = 60
#: Samples looked at in the first rounds; all of them are looked at before the loop ends.
SURVEY = 20_000
#: Share of the largest variance that another may be below zero by rounding. Contacts 1e-5 m apart give 4e-4, planted
#: bodies none.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class SidedSamples:
    """Places with a known side: ``side`` (n,) is -1 inside and +1 outside, ``side * value >= bound`` is wanted.

    ``slack`` (n,) is how much of the bound may be missed.
    """

    xyz: Floats
    side: Floats
    bound: Floats
    slack: Floats

    @classmethod
    def of(cls, xyz: Floats, side: Floats, bound: Floats) -> SidedSamples:
        """Return samples with positive bounds (n,), of which a millionth may be missed."""
        return cls(xyz, side, bound, 1e-6 * bound)

    def __len__(self) -> int:
        return len(self.xyz)

    def __getitem__(self, index: NDArray[np.bool_] | Ints) -> SidedSamples:
        return SidedSamples(self.xyz[index], self.side[index], self.bound[index], self.slack[index])


@dataclass(frozen=True, eq=False)
class ActiveFit:
    """The field, its factorised system, the indices of the active samples and the rounds that were needed."""

    rbf: Rbf
    system: Saddle
    active: Ints
    rounds: int


def fit_active(
    points: Floats,
    values: Floats,
    oriented: Floats,
    normals: Floats,
    samples: SidedSamples,
    reach: float = CUBIC,
    most: int = ROUNDS,
    partial: bool = False,
) -> ActiveFit:
    """Fit a field with given values at the contacts that keeps every sample on its side.

    Parameters
    ----------
    points, values : (n, 3), (n,) arrays
        Contacts and their values; no two may coincide.
    oriented, normals : (k, 3), (k, 3) arrays
        Places with a given gradient, and the gradients.
    samples : Samples
        Inequalities; none may coincide with a contact.
    reach : float
        Radius of the compact kernel; 0 for r^3 or -1 for -r, with a drift.
    most : int
        Rounds at most.
    partial : bool
        Whether to return what is reached after that many rounds, in place of an error.

    Raises
    ------
    FitError
        If the conditions leave the field free, or no field satisfies them.
    """
    if reach == CUBIC and not fixes_trend(points, oriented):
        return _exchange(points, values, oriented, normals, samples)
    base = Saddle(points, oriented, reach)
    field = base.interpolate(values, normals)
    lack = samples.bound - samples.side * field.value(samples.xyz)
    candidates, pull = np.zeros(0, np.int64), np.zeros(0)
    columns = np.zeros((len(points) + 3 * len(oriented) + DRIFTS.get(reach, (0, 0))[0], 0))
    matrix, forced = np.zeros((0, 0)), np.zeros(0, bool)
    rbf, system, active = field, base, candidates
    for rounds in range(1, most + 1):
        # A candidate that is violated all the same is forced from now on, so that the loop ends.
        enter = _worst(rbf.value, samples, candidates[forced], len(points), rounds)
        known = np.isin(candidates, enter)
        forced |= known
        fresh = enter[~np.isin(enter, candidates)]
        if not len(enter) or (partial and rounds == most):
            return ActiveFit(rbf, system, active, rounds)
        candidates = np.concatenate([candidates, fresh])
        forced = np.append(forced, np.zeros(len(fresh), bool))
        if len(fresh):
            columns, matrix = _grown(base, columns, matrix, samples, candidates, len(fresh))
        variance = np.diag(matrix)
        if variance.min(initial=0.0) < -ROUNDING * variance.max(initial=0.0):
            raise FitError(
                message(
                    "bodies.contacts-almost-coincide",
                    "Some of the {count} contacts lie so close to each other that rounding hides the field between "
                    "them. Leave one of each such pair out, or give them a larger coincidence_distance.",
                    count=len(points),
                )
            )
        side = samples.side[candidates]
        start = np.append(pull, np.zeros(len(fresh)))
        pull = complementarity(matrix * side[:, None] * side, lack[candidates], start, forced)
        active = candidates[pull > 0]
        system = Saddle(np.vstack([points, samples.xyz[active]]), oriented, reach)
        rbf = system.interpolate(np.concatenate([values, (samples.side * samples.bound)[active]]), normals)
    raise _unsatisfied(len(enter), most)


def _grown(
    base: Saddle, columns: Floats, matrix: Floats, samples: SidedSamples, candidates: Ints, count: int
) -> tuple[Floats, Floats]:
    """Return the solved columns and the covariance of all candidates, the last ``count`` of which are new."""
    xyz = samples.xyz[candidates]
    rows = base.rows(xyz)
    columns = np.hstack([columns, base.solve_rows(rows[-count:])])
    new = gram(xyz[-count:], NONE, xyz, NONE, base.reach) - rows[-count:] @ columns
    old = len(candidates) - count
    grown = np.empty((len(candidates), len(candidates)))
    grown[:old, :old] = matrix
    grown[old:], grown[:, old:] = new, new.T
    return columns, grown


def complementarity(matrix: Floats, wanted: Floats, start: Floats, forced: NDArray[np.bool_]) -> Floats:
    """Return x >= 0 with matrix @ x >= wanted, and x = 0 wherever that is not an equality.

    Block principal pivoting (Portugal, Judice & Vicente, Math. Comp. 63, 1994); where it cycles, projected
    Gauss-Seidel sweeps give it another start.

    Parameters
    ----------
    matrix : (n, n) array
        Symmetric and positive definite.
    wanted : (n,) array
        Right-hand side.
    start : (n,) array
        A first guess; its positive entries start free.
    forced : (n,) array of bool
        Entries that are equalities whatever the sign of x.
    """
    from scipy.linalg import LinAlgError, cho_factor, cho_solve

    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    whole = matrix / scale / scale[:, None] + 1e-10 * np.eye(len(matrix))
    right = wanted / scale
    free, fewest, chances = (start > 0) | forced, len(right) + 1, CHANCES
    tiny = 1e-9 * max(float(np.abs(right).max(initial=0.0)), 1e-300)
    x = np.maximum(start, 0.0) * scale
    for _ in range(RESTARTS):
        while chances:
            x = np.zeros(len(right))
            block = whole[np.ix_(free, free)]
            try:
                x[free] = cho_solve(cho_factor(block, lower=True, check_finite=False), right[free])
            except LinAlgError:
                break
            wrong = np.where(free, x < 0, whole @ x - right < -tiny) & ~forced
            count = int(wrong.sum())
            if not count:
                return np.asarray(np.where(forced, np.abs(x) + 1e-300, x) / scale)
            chances = CHANCES if count < fewest else chances - 1
            fewest = min(fewest, count)
            free = free ^ wrong
        sweep(whole, right, forced, x, SWEEPS)
        free, fewest, chances = (x > 0) | forced, len(right) + 1, CHANCES
    # Not settled: what the sweeps left above zero is held, what is then still violated will be forced.
    return np.asarray(np.where(forced, np.abs(x) + 1e-300, np.maximum(x, 0.0)) / scale)


def fixes_trend(points: Floats, oriented: Floats) -> bool:
    """Return whether values at points and gradients leave no linear function free."""
    return len(oriented) > 0 or (
        len(points) >= 4 and bool(np.linalg.matrix_rank(points - points.mean(axis=0), tol=1e-6) == 3)
    )


def _unsatisfied(count: int, rounds: int) -> FitError:
    return FitError(
        message(
            "bodies.active-set-not-converged",
            "{count} samples are still on the wrong side after {rounds} rounds. Look for intervals that contradict "
            "the contacts, or give the contacts a larger coincidence_distance.",
            count=count,
            rounds=rounds,
        )
    )


def _exchange(points: Floats, values: Floats, oriented: Floats, normals: Floats, samples: SidedSamples) -> ActiveFit:
    """Fit where contacts alone leave the trend free: samples hold it from the start, and are released one by one."""
    active = _start(samples)
    for rounds in range(1, ROUNDS + 1):
        system = Saddle(np.vstack([points, samples.xyz[active]]), oriented)
        rbf = system.interpolate(np.concatenate([values, (samples.side * samples.bound)[active]]), normals)
        pull = rbf.weights[len(points) :] * samples.side[active]
        wrong = pull < -1e-12 * np.abs(rbf.weights).max(initial=0.0)
        if rounds > RELEASING:
            wrong[:] = False
        if len(points) + (~wrong).sum() < 12:
            # Too few conditions would be left to fix the trend: only the worst one goes.
            wrong &= (pull == pull.min(initial=0.0)) & (len(points) + len(active) > 6)
        enter = _worst(rbf.value, samples, active, len(points), rounds)
        kept = np.union1d(active[~wrong], enter)
        if wrong.any() and not fixes_trend(np.vstack([points, samples.xyz[kept]]), oriented):
            # Those of a fence of holes are all on one plane: without the others the trend across it would be free.
            wrong[:] = False
            kept = np.union1d(active, enter)
        if not len(enter) and not wrong.any():
            return ActiveFit(rbf, system, active, rounds)
        active = kept
    raise _unsatisfied(len(enter), ROUNDS)


def _start(samples: SidedSamples) -> Ints:
    """Return samples, far from each other and of both sides, that fix the trend with the contacts."""
    start: list[Ints] = []
    for side in (-1.0, 1.0):
        own = np.flatnonzero(samples.side == side)
        if len(own):
            start.append(own[farthest_apart(samples.xyz[own], min(8, len(own)))])
    return np.unique(np.concatenate(start)) if start else np.zeros(0, np.int64)


def farthest_apart(xyz: Floats, count: int) -> Ints:
    """Return the indices of ``count`` places far from each other: each the farthest from those before it."""
    chosen = [int(np.argmin(xyz @ np.array([1.0, 1e-3, 1e-6])))]
    gap = ((xyz - xyz[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < count:
        k = int(gap.argmax())
        if gap[k] <= 0:
            break
        chosen.append(k)
        np.minimum(gap, ((xyz - xyz[k]) ** 2).sum(axis=1), out=gap)
    return np.array(chosen, dtype=np.int64)


def _worst(value: Callable[[Floats], Floats], samples: SidedSamples, active: Ints, count: int, rounds: int) -> Ints:
    """Return the most violated samples that are not active, for a fit of ``count`` points.

    No two of them are close to each other in the first rounds: neighbours along a hole would be satisfied together.
    """
    stride = -(-len(samples) // SURVEY)
    for step in dict.fromkeys((stride, 1)) if len(samples) else ():
        index = np.arange(0, len(samples), step)
        missed = samples.bound[index] - samples.side[index] * value(samples.xyz[index])
        missed[missed <= samples.slack[index]] = 0.0
        missed[np.isin(index, active)] = 0.0
        if missed.any():
            break
    else:
        return np.zeros(0, np.int64)
    bad = np.flatnonzero(missed)
    bad = bad[np.argsort(-missed[bad], kind="stable")]
    # One a cell of a raster that becomes finer.
    cell = (np.ptp(samples.xyz, axis=0).max() or 1.0) / (64 * 1.5 ** min(rounds, 40))
    _, first = np.unique(np.floor(samples.xyz[index[bad]] / cell).astype(np.int64), axis=0, return_index=True)
    chosen = bad[np.sort(first)]
    return np.asarray(index[chosen[: max(BATCH, (len(active) + count) // 4)]])
