"""What a fit says at a point that it has not seen: groups of points taken out by linear algebra.

With the smoothing, the knots and the set of pulled points as they were chosen, a fit is linear in its heights:

1. the regional field and the plane under it, of least (z - f)' W (z - f) + rho (f - plane)' E (f - plane);
2. the core's correction, the least change of the control points with B (f + g) = z on the core's points;
3. the pull on peripheral points outside the tolerance, a damped least change of the control points outside the core;
   points that were released because they contradict their neighbours exert no pull.

Taking a group g out of step 1 is a rank update (Cook & Weisberg 1982, sec. 3.6): with the hat matrix H = C W, C the
posterior covariance over noise^2, its left-out error is e = (I - H_gg)^-1 r_g, and every other residual grows by
C_:g W_g e. Steps 2 and 3 are interpolations with the kernel M = B B' (plus a nugget in step 3), and a group leaves an
interpolation by blocks of the inverse P = M^-1 (Dubrule 1983, Math. Geology 15, 687-699): its multipliers become
P r - P_:g P_gg^-1 (P r)_g.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_array

from geofit.data.allowance import allowance
from geofit.fitting.approximate import RIM
from geofit.fitting.model import Model
from geofit.fitting.posterior import Posterior
from geofit.fitting.skin import DAMPING
from geofit.splines.refined import finest

__all__ = ["Correction", "LinearFit", "Prediction", "linear_fit"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Ridge of the core's interpolation, relative to its diagonal: its points are met to 1e-10 of their misfit.
_RIDGE = 1e-12
#: Least eigenvalue of I - H_gg: below it, nothing but the group itself holds the field at the group.
_HELD = 1e-9
#: A point that keeps more than this share of its misfit was let go: a damped change leaves about a hundredth.
LET_GO = 0.1


@dataclass(frozen=True, eq=False)
class Prediction:
    """Errors at points left out, each by the fit without its group; nan where it was never left out.

    ``error`` (n,) is the point's height minus the surface's, ``field_error`` (n,) minus the field's alone, metres;
    ``variance`` (n,) is the posterior variance of the field there without the group, m^2.
    """

    error: Floats
    field_error: Floats
    variance: Floats


@dataclass(frozen=True, eq=False)
class Correction:
    """One interpolation of what the steps before it leave: core or pull.

    ``points`` (h,) are the numbers of the points that it meets, ``kernel`` (n, h) the products of the rows of all
    points with those, ``inverse`` (h, h) that of the kernel among them. ``slack`` is how far from the surface a
    point may stay, metres.
    """

    points: Ints
    kernel: Floats
    inverse: Floats
    slack: float

    def after(self, residual: Floats, groups: Sequence[Ints]) -> Floats:
        """Return the residuals (n, k) once corrected; in column j without the points of group j."""
        wanted = residual[self.points]
        if self.slack:
            wanted = np.sign(wanted) * np.maximum(np.abs(wanted) - self.slack, 0.0)
        multipliers = self.inverse @ wanted
        place = np.full(len(self.kernel), -1)
        place[self.points] = np.arange(len(self.points))
        for column, group in enumerate(groups):
            own = place[group]
            own = own[own >= 0]
            if len(own):
                share = np.linalg.solve(self.inverse[np.ix_(own, own)], multipliers[own, column])
                multipliers[:, column] -= self.inverse[:, own] @ share
                multipliers[own, column] = 0.0
        return np.asarray(residual - self.kernel @ multipliers)


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A fit as a linear estimator of the heights of its n points.

    Parameters
    ----------
    posterior : Posterior
        The field.
    covariance : (n, n) array
        The covariance of the field at the points, in units of noise^2.
    corrections : tuple of Correction
        What follows the field: the core, and the pull.
    """

    posterior: Posterior
    covariance: Floats
    corrections: tuple[Correction, ...]

    @property
    def leverage(self) -> Floats:
        """Diagonal of the hat matrix, (n,)."""
        return np.asarray(np.diag(self.covariance) * self.posterior.weight)

    def without(self, groups: Sequence[Ints]) -> Prediction:
        """Predict each group of points from all others.

        Parameters
        ----------
        groups : sequence of arrays of int
            Numbers of points; no point in two groups. A group that nothing but itself holds is not predicted.
        """
        given = self.posterior
        n = len(given.value)
        error, field_error, variance = (np.full(n, np.nan) for _ in range(3))
        left = np.empty((n, len(groups)))
        predicted = []
        for k, group in enumerate(groups):
            residual = given.residual
            among = self.covariance[np.ix_(group, group)]
            gap = np.eye(len(group)) - among * given.weight[group]
            if len(group) == n or np.linalg.cond(gap) > 1 / _HELD:
                continue
            own = np.linalg.solve(gap, np.column_stack([residual[group], among]))
            field_error[group], variance[group] = own[:, 0], np.maximum(np.diag(own[:, 1:]), 0.0)
            left[:, k] = residual + self.covariance[:, group] @ (given.weight[group] * own[:, 0])
            predicted.append(k)
        left, groups = left[:, predicted], [groups[k] for k in predicted]
        for correction in self.corrections:
            left = correction.after(left, groups)
        for k, group in enumerate(groups):
            error[group] = left[group, k]
        return Prediction(error, field_error, given.noise**2 * variance)


def linear_fit(model: Model, given: Posterior) -> LinearFit:
    """Return a fitted height field, whose field is ``given``, as the linear estimator that it is."""
    return LinearFit(given, given.gram(given.plane), _corrections(given, model))


def _corrections(given: Posterior, model: Model) -> tuple[Correction, ...]:
    net, problem = model.net, model.problem
    matrix, free = net.space.matrix(given.plane), ~net.frozen
    steps: list[Correction] = []
    residual = given.residual[:, None]
    inside = problem.split.inside[given.kept] & (problem.split.core is not None)
    if inside.any():
        steps.append(_correction(matrix, np.flatnonzero(inside), finest(net.space).astype(float), _RIDGE, 0.0))
        residual = steps[-1].after(residual, [])
    pulled = _pulled(given, model, residual[:, 0]) & ~inside
    if net.rounds and pulled.any():
        # Rounds of damped changes leave about as much as one round with so many times less damping.
        damping, slack = DAMPING / net.rounds, RIM * problem.settings.interior_tolerance
        steps.append(_correction(matrix, np.flatnonzero(pulled), free.astype(float), damping, slack))
    return tuple(steps)


def _pulled(given: Posterior, model: Model, before: Floats) -> NDArray[np.bool_]:
    """Return (n,) the points that were brought to the surface: beyond the limit before, no longer far off now.

    Those that contradict their neighbours were let go, and pull at nothing.
    """
    net = model.net
    over = np.column_stack([np.ones(len(given.plane)), given.plane]) @ given.trend
    left = np.abs(given.value + over - net.space.matrix(given.plane) @ net.coefficients)
    problem, settings = model.problem, model.problem.settings
    limit = np.full(len(left), net.limit)
    if not settings.strict:
        limit = allowance(problem.accuracy[given.kept], settings.interior_tolerance, net.limit)
    return np.asarray((np.abs(before) > limit) & ((left <= limit) | (left < LET_GO * np.abs(before))))


def _correction(matrix: csr_array, points: Ints, free: Floats, damping: float, slack: float) -> Correction:
    acting = csr_array(matrix[points] * free)
    kernel = np.asarray((matrix @ acting.T).todense())
    among = kernel[points].copy()
    among.flat[:: len(among) + 1] += damping * float(matrix.power(2).sum(axis=1).max())
    inverse = cho_solve(cho_factor(among, lower=True), np.eye(len(among)))
    return Correction(points, kernel, (inverse + inverse.T) / 2, slack)
