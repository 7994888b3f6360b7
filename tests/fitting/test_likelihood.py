from __future__ import annotations

import math

import numpy as np
import pytest

from geofit.fitting.likelihood import CURVED, DOUBT, RISE, Likelihood, Slope
from geofit.splines import bspline
from geofit.splines.matern import MaternPrecision
from geofit.splines.tensor import TensorSpace

N = 60


def setting(seed=0, columns=1):
    rng = np.random.default_rng(seed)
    space = TensorSpace(bspline.clamped_knots(np.arange(-2, 11.0), 3), bspline.clamped_knots(np.arange(-2, 9.0), 3))
    plane = rng.uniform(0, 7, (N, 2))
    z = np.sin(plane[:, 0]) + 0.3 * plane[:, 1] + rng.normal(0, 0.1, N)
    z = z if columns == 1 else np.column_stack([z, plane[:, 0], np.cos(plane[:, 1])])
    weight = rng.uniform(0.5, 2, N)
    return space, plane, z, weight


def judge(space, plane, z, weight, alpha):
    band, right = space.normal_equations(plane, z, weight)
    square = float((weight @ z.reshape(N, -1) ** 2).sum())
    return Likelihood(space, alpha, band, right, square, Slope(np.eye(3), np.zeros(3), 0.0), N)


def dense_value(space, plane, z, weight, alpha, log_kappa, log_rho, stretch):
    """The same from dense covariance matrices of the points (Harville 1977)."""
    band = MaternPrecision(space, alpha).band(math.exp(log_kappa), stretch)
    full = np.zeros((space.size, space.size))
    for k in range(len(band)):
        index = np.arange(space.size - k)
        full[index + k, index] = full[index, index + k] = band[k, : space.size - k]
    a = space.matrix(plane).toarray()
    v = np.diag(1 / weight) + a @ np.linalg.solve(full, a.T) / math.exp(log_rho)
    f = np.column_stack([np.ones(N), plane])
    inverse = np.linalg.inv(v)
    moment = f.T @ inverse @ f
    value, free = 0.0, (N - 3) * (1 if z.ndim == 1 else z.shape[1])
    misfit = 0.0
    for column in z.reshape(N, -1).T:
        rest = column - f @ np.linalg.solve(moment, f.T @ inverse @ column)
        misfit += rest @ inverse @ rest
        value += np.linalg.slogdet(v)[1] + np.linalg.slogdet(moment)[1]
    return value + free * math.log(misfit / free) + (np.hypot(*stretch) / DOUBT) ** 2


@pytest.mark.parametrize("alpha", [2, 3])
@pytest.mark.parametrize("columns", [1, 3])
def test_differences_agree_with_dense_algebra(alpha, columns):
    given = setting(columns=columns)
    likelihood = judge(*given, alpha)
    places = [(0.0, -3.0, 0.0, 0.0), (-0.5, -5.0, 0.3, 0.2), (0.7, 0.5, -0.4, 0.6)]
    ours = [likelihood(np.array(place)) for place in places]
    theirs = [dense_value(*given, alpha, place[0], place[1], place[2:]) for place in places]
    np.testing.assert_allclose(np.diff(ours), np.diff(theirs), atol=1e-5)


def test_the_search_ends_at_a_maximum():
    likelihood = judge(*setting(), 3)
    start = [(0.0, log, 0.0, 0.0) for log in (-10.0, -6.0, -2.0)]
    found = likelihood.best(start, 4, 30)
    best = np.array([math.log(found.kappa), math.log(found.rho), *found.stretch])
    low, high = np.array(likelihood.bounds()).T
    for k in range(4):
        for step in (-0.05, 0.05):
            moved = best.copy()
            moved[k] = np.clip(moved[k] + step, low[k], high[k])
            assert likelihood(moved) >= found.value - 0.05
    assert found.value <= min(likelihood(np.array(one)) for one in start)


def test_the_noise_s_variance_is_found():
    found = judge(*setting(), 3).best([(0.0, log, 0.0, 0.0) for log in (-10.0, -6.0, -2.0)], 2, 20)
    # Weights of mean 1.25 about noise of 0.1 m.
    assert found.variance == pytest.approx(0.0125, rel=0.5)
    assert found.kappa >= CURVED - 1e-9


def test_an_exact_plane_has_a_finite_likelihood():
    space, plane, _, weight = setting()
    likelihood = judge(space, plane, 3 + plane @ (0.5, -0.2), weight, 2)
    assert np.isfinite(likelihood(np.array([0.0, -3.0, 0.0, 0.0])))


def test_the_slope_s_prior_agrees_with_dense_algebra():
    space, plane, z, weight = setting()
    aim, places = np.array([0.0, -0.4, 0.7]), [(0.0, -3.0, 0.0, 0.0), (-1.5, -5.0, 0.2, 0.1)]
    extent = float(((plane - plane.mean(axis=0)) ** 2).sum(axis=1).mean())
    band, right = space.normal_equations(plane, z, weight)
    likelihood = Likelihood(space, 2, band, right, float(weight @ z**2), Slope(np.eye(3), aim, extent), N)
    full = np.zeros((space.size, space.size))
    a, f = space.matrix(plane).toarray(), np.column_stack([np.ones(N), plane])
    expected = []
    for log_kappa, log_rho, *stretch in places:
        band = MaternPrecision(space, 2).band(math.exp(log_kappa), stretch)
        for k in range(len(band)):
            index = np.arange(space.size - k)
            full[index + k, index] = full[index, index + k] = band[k, : space.size - k]
        values = []
        for wider in np.exp(np.arange(15.0)):
            hold = math.exp(log_rho + 2 * log_kappa) * 4 * math.pi * extent / RISE / wider
            v = np.diag(1 / weight) + a @ np.linalg.solve(full, a.T) / math.exp(log_rho) + f[:, 1:] @ f[:, 1:].T / hold
            inverse, rest, one = np.linalg.inv(v), z - f @ aim, f[:, :1]
            moment = (one.T @ inverse @ one).item()
            misfit = rest @ inverse @ rest - (one.T @ inverse @ rest).item() ** 2 / moment
            value = (N - 1) * math.log(misfit / (N - 1)) + np.linalg.slogdet(v)[1] + math.log(moment)
            values.append(value + 3 * math.log(wider) + 1 / wider)
        expected.append(min(values) + (np.hypot(*stretch) / DOUBT) ** 2)
    ours = [likelihood(np.array(place)) for place in places]
    np.testing.assert_allclose(np.diff(ours), np.diff(expected), atol=1e-5)
