"""The regional field: the smooth surface that the data support, and how noisy they are.

A penalised least-squares spline, the sum of w_i d_i^2 + lambda * energy. Lengths are counted in units of the
spacing of the sparse points, so that one range of lambda serves every site. Two energies are offered:

========= ============================================ ====================================================
name      energy                                       where it wins
========= ============================================ ====================================================
"smooth"  third derivatives + 4 x second derivatives   gentle horizons: half the error of a thin plate
"plate"   second derivatives: the thin plate           rugged horizons, where third derivatives overshoot
"level"   second derivatives + 1/4 first derivatives   points in a line, which say nothing of the slope across it
========= ============================================ ====================================================

At short distances third derivatives rule the first, beyond the spacing the second, which calm the surface where no
data are. Energy and lambda are those of the greatest restricted likelihood, in which the energy is a Gaussian prior
of the surface (S. N. Wood, J. R. Stat. Soc. B 73, 2011, 3-36): one that is too stiff for the relief, or too loose,
makes the data unlikely. Restricted likelihoods compare only energies that leave the same surfaces free, here planes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.splines.tensor import Factor, TensorSpace

__all__ = ["ENOUGH", "Field", "cell_weights", "choose", "energy_band", "plane_trend", "smooth"]

Floats = NDArray[np.float64]

#: Weights of the derivative orders in each energy, and the dimension of what it leaves free.
ENERGIES: dict[str, tuple[dict[int, float], int]] = {
    "smooth": ({3: 1.0, 2: 4.0}, 3),
    "plate": ({2: 1.0}, 3),
    "level": ({2: 1.0, 1: 0.25}, 1),
    "flat": ({1: 1.0}, 1),
}
#: Range of log10(lambda) in units of the spacing.
_LOG_RANGE = (-9.0, 3.0)
#: Noise above this share of the values' own spread contradicts any tolerance below it.
CONTRADICTION = 0.5
#: Standard deviation across a strip, in units of the spacing, below which it counts as a line.
_NARROW = 0.05
#: Fewer points than these cannot tell noise from relief.
ENOUGH = 16
#: Part of an energy's diagonal that stands in for what the energy leaves free, in its determinant.
_RIDGE = 1e-10
#: No elevation is known better than this, metres: keeps the likelihood finite on exact planes.
_FINEST = 1e-4
#: Stands for the likelihood of a lambda whose system has no solution; finite, for Brent's method.
_UNSOLVABLE = 1e12


@dataclass(frozen=True)
class Field:
    """What was chosen: energy, lambda, and the noise (1 sigma, metres) that the likelihood finds.

    ``contradictory`` says that the data are little else than noise; ``spread`` is the standard deviation of the data
    about their trend, metres.
    """

    energy: str
    smoothing: float
    noise: float
    contradictory: bool = False
    spread: float = math.inf


def energy_band(space: TensorSpace, name: str) -> Floats:
    """Return the band of a named energy on a space, (bandwidth + 1, size)."""
    orders, _ = ENERGIES[name]
    return sum((factor * space.energy(order) for order, factor in orders.items()), start=np.zeros(1))


def plane_trend(plane: Floats, z: Floats, weight: Floats) -> Floats:
    """Return (3,) or (3, k) coefficients of the plane 1, u, v of weighted least squares, least slope first.

    Collinear points leave the slope across them at zero.
    """
    root = np.sqrt(weight)
    centre = weight @ plane / weight.sum()
    matrix = np.stack([root, *(root * (plane - centre).T)]).T
    solution: Floats = np.linalg.lstsq(matrix, z.reshape(len(z), -1) * root[:, None], rcond=1e-9)[0]
    solution[0] -= centre @ solution[1:]
    return solution.reshape(3, *z.shape[1:])


def cell_weights(space: TensorSpace, plane: Floats, accuracy: Floats) -> Floats:
    """Return the weight of each point: relative accuracy, shared where a knot cell holds more points than most.

    Points nearer to each other than the knots say one thing together; sharing keeps one dense section from
    deciding how noisy and how rough the whole area is. Points without a stated accuracy take the median.
    """
    stated = np.isfinite(accuracy)
    relative = np.ones(len(plane))
    if stated.any():
        middle = float(np.median(accuracy[stated]))
        relative[stated] = np.clip(middle / accuracy[stated], 0.1, 10.0) ** 2
    index, _ = space.rows(plane)
    _, cell, count = np.unique(index[:, 0], return_inverse=True, return_counts=True)
    return np.asarray(relative * np.minimum(1.0, np.median(count) / count[cell]))


def choose(
    space: TensorSpace,
    plane: Floats,
    z: Floats,
    weight: Floats,
    smoothing: float | None = None,
) -> Field:
    """Choose the energy and lambda for data about their trend.

    Parameters
    ----------
    space : TensorSpace
        A space with a few knots a spacing; the choice holds for finer ones.
    plane : (n, 2) array
        Places, in units of the spacing.
    z : (n,) or (n, k) array
        Heights (or coordinates) in metres, trend removed.
    weight : (n,) array
        Weights.
    smoothing : float, optional
        Take this lambda; only the energy is chosen.

    Raises
    ------
    FitError
        If no lambda gives a solvable system.
    """
    if space.shape[1] > space.shape[0]:
        space, plane = space.turned, plane[:, ::-1]
    band, right = space.normal_equations(plane, z, weight)
    square = float((weight @ (z.reshape(len(z), -1) ** 2)).sum())
    names = {3: ("smooth", "plate"), 2: ("plate",)}.get(space.degree, ("flat",))
    if space.degree > 1 and _in_line(plane):
        names = ("level",)
    found = []
    for name in names:
        likelihood = _Likelihood(space, name, band, right, square, len(plane), float(weight.sum()))
        log = likelihood.best() if smoothing is None else math.log10(smoothing)
        found.append((likelihood(log), log, likelihood))
    value, log, likelihood = min(found, key=lambda one: one[0])
    if value >= _UNSOLVABLE:
        text = message(
            "fit.no-smoothing-system-points",
            "No smoothing makes the system of {points} points and {size} control points solvable: the points lie on "
            "too few places. Give more points, or a larger conflict_distance.",
            points=len(plane),
            size=space.size,
        )
        raise FitError(text)
    noise = likelihood.noise(log)
    spread = float(np.std(z, axis=0).max())
    contradictory = len(plane) >= ENOUGH and noise > CONTRADICTION * max(spread, _FINEST)
    return Field(likelihood.name, 10.0**log, noise, contradictory, spread)


def _in_line(plane: Floats) -> bool:
    """Tell whether the points lie in a strip so narrow, beside their spacing, that no slope across it is known."""
    across = np.linalg.svd(plane - plane.mean(axis=0), compute_uv=False)[-1]
    return float(across) < _NARROW * math.sqrt(len(plane))


class _Likelihood:
    """Restricted likelihood of lambda for one energy; each new value costs one factorisation."""

    def __init__(
        self, space: TensorSpace, name: str, band: Floats, right: Floats, square: float, n: int, weight: float
    ) -> None:
        self.name, self.space, self.band, self.right, self.square = name, space, band, right, square
        self.energy = energy_band(space, name)
        self.determinant = _log_pseudo_determinant(self.energy, ENERGIES[name][1])
        self.columns = 1 if right.ndim == 1 else right.shape[1]
        self.n, self.free = n, ENERGIES[name][1]
        self.weight = weight
        self.floor = n * self.columns * _FINEST**2
        self.known: dict[float, tuple[float, float]] = {}

    def _solve(self, log: float) -> tuple[float, float]:
        """Return the value, and the penalised sum of squares."""
        try:
            factor = Factor(self.band + 10.0**log * self.energy)
        except FitError:
            return _UNSOLVABLE, math.nan
        penalised = max(self.square - float((factor.solve(self.right) * self.right).sum()), self.floor)
        degrees = max(self.n - self.free, 1)
        misfit = self.columns * degrees * math.log(penalised / (degrees * self.columns))
        prior = self.determinant + (self.space.size - self.free) * log * math.log(10)
        return misfit + self.columns * (factor.logdet - prior), penalised

    def __call__(self, log: float) -> float:
        """Return -2 log of the restricted likelihood, but for a constant of the data."""
        if log not in self.known:
            self.known[log] = self._solve(log)
        return self.known[log][0]

    def best(self) -> float:
        """Search log10 lambda: a coarse scan, then Brent's method between the neighbours of its best."""
        grid = np.linspace(*_LOG_RANGE, 7)
        values = [self(log) for log in grid]
        k = int(np.argmin(values))
        if values[k] >= _UNSOLVABLE:
            return float(grid[-1])
        low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
        found = minimize_scalar(self, bounds=(low, high), method="bounded", options={"xatol": 0.15})
        return float(found.x) if found.fun <= values[k] else float(grid[k])

    def noise(self, log: float) -> float:
        """Return the likeliest noise of a point, metres."""
        penalised = self.known[log][1]
        share = self.n / (max(self.n - self.free, 1) * self.columns * self.weight)
        return math.sqrt(penalised * share)


def _log_pseudo_determinant(energy: Floats, free: int) -> float:
    """Return log of the product of the eigenvalues of an energy that are not zero."""
    ridge = _RIDGE * float(np.median(energy[0]))
    held = energy.copy()
    held[0] += ridge
    return Factor(held).logdet - free * math.log(ridge)


def smooth(space: TensorSpace, field: Field, plane: Floats, z: Floats, weight: Floats) -> Floats:
    """Return the coefficients of a chosen field on any space, (size,) or (size, k): heights, metres."""
    turned = space.turned if space.shape[1] > space.shape[0] else space
    band, right = turned.normal_equations(plane if turned is space else plane[:, ::-1], z, weight)
    solution = Factor(band + field.smoothing * energy_band(turned, field.energy)).solve(right)
    net = solution.reshape(*turned.shape, *solution.shape[1:])
    return (net if turned is space else np.swapaxes(net, 0, 1)).reshape(solution.shape)
