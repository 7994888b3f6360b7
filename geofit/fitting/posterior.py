"""How sure the regional field is of itself: the posterior of the smoothing spline.

The energy is a Gaussian prior of the surface, so the field's coefficients have the posterior covariance
noise^2 K^-1 with K = A' W A + lambda E, A the collocation matrix of the points, W their weights
(Wahba 1983, J. R. Stat. Soc. B 45, 133-150; its coverage on the average over the area: Nychka 1988, J. Am. Stat.
Assoc. 83, 1134-1143). A variance b' K^-1 b asks for the band of K^-1 alone (Takahashi, Fagan & Chin 1973).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.fitting.field import cell_weights, energy_band
from geofit.fitting.model import Model
from geofit.fitting.net import even_space, gather
from geofit.splines.blocks import BlockFactor, InverseBlocks
from geofit.splines.tensor import TensorSpace

__all__ = ["Posterior", "posterior"]

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
    plane, value, weight, noise_ratio : (n, 2) and (n,) arrays
        Their places, heights about the trend (m), weights, and the noise of each beside that of the median point.
    space : TensorSpace
        Space of the field; ``turned`` says that its u runs along the net's v, for a narrower band.
    factor : BlockFactor
        Factor of K.
    field : (size,) array
        Coefficients about the trend, metres.
    noise : float
        Noise of the median point, metres (1 sigma).
    square : float
        The penalised sum of squares, z' W (z - f): what noise^2 is estimated from.
    exact_net : bool
        Whether the space is the fit's own.
    trend : (3,) array
        Plane 1, u, v under the field, metres.
    """

    kept: Ints
    plane: Floats
    value: Floats
    weight: Floats
    noise_ratio: Floats
    space: TensorSpace
    turned: bool
    factor: BlockFactor
    field: Floats
    noise: float
    square: float
    exact_net: bool
    trend: Floats

    def rows(self, plane: Floats) -> tuple[Ints, Floats]:
        """Return the coefficients that act at (n, 2) places and their basis values."""
        return self.space.rows(plane[:, ::-1] if self.turned else plane)

    def matrix(self, plane: Floats) -> csr_array:
        """Return the sparse (n, size) collocation matrix of (n, 2) places."""
        return self.space.matrix(plane[:, ::-1] if self.turned else plane)

    def variance(self, plane: Floats) -> Floats:
        """Return the (n,) variances of the field at (n, 2) places, m^2."""
        return np.asarray(self.noise**2 * np.maximum(self._inverse.quadratic(*self.rows(plane)), 0.0))

    def height(self, plane: Floats) -> Floats:
        """Return the (n,) heights of the field at (n, 2) places, trend included, metres."""
        base = np.column_stack([np.ones(len(plane)), plane]) @ self.trend
        return np.asarray(base + self.matrix(plane) @ self.field)

    def covariance(self, plane: Floats) -> Floats:
        """Return the (n, n) covariance of the field among (n, 2) places, m^2."""
        return np.asarray(self.noise**2 * self.factor.gram(self.matrix(plane)))

    def covariance_with(self, plane: Floats, others: Floats) -> Floats:
        """Return the (n, k) covariance of the field at (n, 2) places with that at a few (k, 2) others, m^2."""
        solved = self.factor.solve(self.matrix(others).T.toarray())
        return np.asarray(self.noise**2 * (self.matrix(plane) @ solved))

    @cached_property
    def residual(self) -> Floats:
        """Heights minus field at the points, (n,) metres."""
        return np.asarray(self.value - self.matrix(self.plane) @ self.field)

    @cached_property
    def leverage(self) -> Floats:
        """Diagonal of the hat matrix A K^-1 A' W, (n,)."""
        return np.asarray(self.weight * self._inverse.quadratic(*self.rows(self.plane)))

    @cached_property
    def _inverse(self) -> InverseBlocks:
        return self.factor.inverse()


def posterior(model: Model) -> Posterior:
    """Return the posterior of the field of a fitted height field.

    Raises
    ------
    FitError
        If the surface is parametric, or its system has no solution.
    """
    given, net = model.problem, model.net
    if given.chart.parametric:
        raise FitError(
            message(
                "prediction.parametric-surface-no-height",
                "A parametric surface is no height field, and has no posterior. Leave out its sections instead.",
            )
        )
    kept = given.kept & given.chart.placed
    split = given.split if given.split.core is not None else None
    data = gather(given.points, given.chart, kept, split)
    own = net.space.size <= LARGEST
    space = net.space if own else even_space(data.area, _SPAN, net.space.degree, LARGEST)
    turned = space.shape[1] > space.shape[0]
    if turned:
        space = TensorSpace(space.knots_v, space.knots_u, space.degree)
    plane = data.plane[:, ::-1] if turned else data.plane
    weight = cell_weights(space, plane, data.accuracy)
    band, right = space.normal_equations(plane, data.value, weight)
    factor = BlockFactor(band + net.field.smoothing * energy_band(space, net.field.energy))
    field = factor.solve(right[:, None])[:, 0]
    square = float(weight @ data.value**2 - right @ field)
    ratio = _noise_ratio(data.accuracy)
    return Posterior(
        np.flatnonzero(kept), data.plane, data.value, weight, ratio, space, turned, factor, field,
        net.field.noise, square, own, data.trend,
    )  # fmt: skip


def _noise_ratio(accuracy: Floats) -> Floats:
    """Return each point's stated accuracy beside the median one, for :func:`geofit.fitting.field.cell_weights`."""
    stated = np.isfinite(accuracy)
    ratio = np.ones(len(accuracy))
    if stated.any():
        ratio[stated] = np.clip(accuracy[stated] / float(np.median(accuracy[stated])), 0.1, 10.0)
    return ratio
