"""How sure the regional field is of itself: the posterior of the smoothing spline.

The field is Gaussian, so its coefficients have the posterior covariance noise^2 P^-1 with P = A' W A + rho E, A the
collocation matrix of the points (below it the rows of measured slopes), W their weights. The plane under it, which no
prior holds, adds noise^2 D M^-1 D', where D = P^-1 rho E B is what the field leaves of the planes B, and
M = B' rho E (B - D) their normal matrix
(G. Wahba, J. R. Stat. Soc. B 45, 1983, 133-150). A variance b' P^-1 b asks for the band of P^-1 alone (Takahashi,
Fagan & Chin 1973).

The three coordinates of a folded surface are fields of one covariance and one noise. So each has the same variance, and
so has the surface along any direction, its normal too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from geofit.fitting.active_points import Data, gather_points
from geofit.fitting.core_relief import CoreRelief
from geofit.fitting.field import FieldChoice, held_planes, planes_of, relative_noise, slope_of, widened_space
from geofit.fitting.model import Model
from geofit.fitting.resolution import even_space
from geofit.splines.blocks import BlockFactor, InverseBlocks
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import TensorSpace, band_sum

__all__ = ["Posterior", "noise_of_unused", "posterior", "posterior_of_core"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: More control points than these are replaced by an even net of so many: the field is smooth.
LARGEST = 25_000
#: Longest span of that net, in units of the spacing.
_SPAN = 0.5


@dataclass(frozen=True, eq=False)
class Posterior:
    """The field that a fit starts from, and its covariance in units of noise^2; places are in units.

    Parameters
    ----------
    kept : (n,) array of int
        Numbers of the points that the fit honours, among all points.
    plane, value, weight : (n, 2), (n,) or (n, 3), and (n,) arrays
        Their places, heights (or coordinates) about the trend (m), and weights: 1 for a point of the field's own noise.
    space : TensorSpace
        Space of the field, wider than the area; ``turned`` states that its u runs along the net's v, for a narrower
        band.
    factor : BlockFactor
        Factor of P.
    drift, moment : (size, r) and (r, r) arrays
        D and M.
    field : (size,) or (size, 3) array
        Coefficients about the trend, metres.
    model : Field
        The field's covariance and noise.
    square : float
        The penalised sum of squares, z' W (z - f) and the slope's: what noise^2 is estimated from.
    trend : (3,) or (3, 3) array
        Plane 1, u, v under the field, metres.
    """

    kept: Ints
    plane: Floats
    value: Floats
    weight: Floats
    space: TensorSpace
    turned: bool
    factor: BlockFactor
    drift: Floats
    moment: Floats
    field: Floats
    model: FieldChoice
    square: float
    trend: Floats

    @property
    def noise(self) -> float:
        """Noise of a point of weight 1, metres (1 sigma)."""
        return self.model.noise

    @property
    def noise_variance(self) -> Floats:
        """Variance of each point about the field, (n,) m^2."""
        return np.asarray(self.noise**2 / self.weight)

    def rows(self, plane: Floats) -> tuple[Ints, Floats]:
        """Return the coefficients that act at (n, 2) places and their basis values."""
        return self.space.rows(plane[:, ::-1] if self.turned else plane)

    def matrix(self, plane: Floats) -> csr_array:
        """Return the sparse (n, size) collocation matrix of (n, 2) places."""
        return self.space.matrix(plane[:, ::-1] if self.turned else plane)

    def variance(self, plane: Floats) -> Floats:
        """Return the (n,) variances of the field at (n, 2) places, m^2."""
        return np.asarray(self.noise**2 * self._quadratic(plane))

    def height(self, plane: Floats) -> Floats:
        """Return the (n,) heights or (n, 3) coordinates of the field at (n, 2) places, trend included, metres."""
        base = np.column_stack([np.ones(len(plane)), plane]) @ self.trend
        return np.asarray(base + self.matrix(plane) @ self.field)

    def gram(self, plane: Floats) -> Floats:
        """Return the (n, n) covariance of the field among (n, 2) places, in units of noise^2."""
        matrix = self.matrix(plane)
        over = matrix @ self.drift
        return np.asarray(self.factor.gram(matrix) + over @ np.linalg.solve(self.moment, over.T))

    def covariance(self, plane: Floats) -> Floats:
        """Return the (n, n) covariance of the field among (n, 2) places, m^2."""
        return np.asarray(self.noise**2 * self.gram(plane))

    def covariance_with(self, plane: Floats, others: Floats) -> Floats:
        """Return the (n, k) covariance of the field at (n, 2) places with that at a few (k, 2) others, m^2."""
        mine, theirs = self.matrix(plane), self.matrix(others)
        solved = self.factor.solve(theirs.T.toarray())
        over = (mine @ self.drift) @ np.linalg.solve(self.moment, (theirs @ self.drift).T)
        return np.asarray(self.noise**2 * (mine @ solved + over))

    @cached_property
    def residual(self) -> Floats:
        """Heights minus field at the points, (n,) metres."""
        return np.asarray(self.value - self.matrix(self.plane) @ self.field)

    @cached_property
    def leverage(self) -> Floats:
        """Diagonal of the hat matrix, (n,)."""
        return np.asarray(self.weight * self._quadratic(self.plane))

    def _quadratic(self, plane: Floats) -> Floats:
        over = self.matrix(plane) @ self.drift
        own = np.maximum(self._inverse.quadratic(*self.rows(plane)), 0.0)
        return np.asarray(own + (over * np.linalg.solve(self.moment, over.T).T).sum(axis=1))

    @cached_property
    def _inverse(self) -> InverseBlocks:
        return self.factor.inverse()


def noise_of_unused(given: Posterior, model: Model, points: Ints) -> Floats:
    """Return the noise (k,) of points of the horizon that take no part in the fit, metres (1 sigma)."""
    problem = model.problem
    return given.noise * relative_noise(problem.accuracy, problem.settings.interior_tolerance)[points]


def posterior(model: Model) -> Posterior:
    """Return the posterior of the field of a fitted surface; the model keeps it.

    Raises
    ------
    FitError
        If its system has no solution.
    """
    return model.prepared(_posterior)


def posterior_of_core(relief: CoreRelief) -> Posterior:
    """Return the posterior of a core's own field, which keeps it; places are in that field's units.

    Raises
    ------
    FitError
        If its system has no solution.
    """
    return relief.prepared(_of_relief)


def _posterior(model: Model) -> Posterior:
    given, net = model.problem, model.net
    # The points between the sections of a folded surface have found their places by now.
    kept = given.kept if given.parametrization.parametric else given.kept & given.parametrization.parametrized
    data = gather_points(
        given.accuracy, given.parametrization, given.settings, kept, None, given.slopes, net.unit
    ).whole()
    space = net.base if net.base.size <= LARGEST else even_space(data.area, _SPAN, net.base.degree, LARGEST)
    return _of_field(np.flatnonzero(kept), data, space, net.field)


def _of_relief(relief: CoreRelief) -> Posterior:
    return _of_field(np.arange(len(relief.data.plane)), relief.data, relief.space, relief.field)


def _of_field(kept: Ints, data: Data, space: TensorSpace, field: FieldChoice) -> Posterior:
    """Return the posterior of a field that was chosen for data, on a space of the area."""
    space = widened_space(space)
    turned = space.shape[1] > space.shape[0]
    if turned:
        space, field = space.turned, field.turned
    plane, trend = (data.plane[:, ::-1], data.trend[[0, 2, 1]]) if turned else (data.plane, data.trend)
    weight = 1 / data.noise**2
    band, right = space.normal_equations(plane, data.value, weight)
    measured, weighed = data.slopes.turned if turned and data.slopes is not None else data.slopes, 0.0
    if measured is not None:
        of_slopes = measured.equations(space, field.noise)
        band, right, weighed = band + of_slopes[0], right + of_slopes[1], of_slopes[2]
    precision, slope = MaternPrecision(space, field.alpha), slope_of(plane, trend, measured)
    prior = field.rho * precision.band(field.kappa, field.stretch)
    factor = BlockFactor(band_sum(band, prior))
    held = held_planes(precision, field, slope, factor.ridge)
    solved = factor.solve(np.column_stack([right, held]))
    columns = solved.shape[1] - held.shape[1]
    free, drift = solved[:, :columns], solved[:, columns:]
    moment, cross = planes_of(space, slope, field.hold, held, free, drift)
    slopes = np.linalg.solve(moment, cross)
    value = np.asarray(data.value[:])
    coefficients = (free + drift @ slopes).reshape(-1, *value.shape[1:])
    off = slopes.sum(axis=1) - slope.aim
    square = float(
        (weight @ value**2).sum()
        + weighed
        - (right * coefficients).sum()
        - slope.aim @ slope.precision(field.hold) @ off
    )
    return Posterior(
        kept, np.asarray(data.plane[:]), value, weight, space, turned, factor, drift, moment,
        coefficients, field, square, data.trend,
    )  # fmt: skip
