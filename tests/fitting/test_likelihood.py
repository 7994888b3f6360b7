from __future__ import annotations

import math

import numpy as np
import pytest
from likelihoods import N, judge, setting

from geofit.fitting.likelihood import CURVED, DOUBT, RISE, ROUND, Likelihood, Slope
from geofit.splines.matern import MaternPrecision, metric


def at_place(likelihood, place):
    log_kappa, log_rho, *stretch = place
    return likelihood(likelihood.parameters(math.exp(log_kappa), math.exp(log_rho), tuple(stretch)))


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
    ours = [at_place(likelihood, place) for place in places]
    theirs = [dense_value(*given, alpha, place[0], place[1], place[2:]) for place in places]
    np.testing.assert_allclose(np.diff(ours), np.diff(theirs), atol=1e-5)


@pytest.mark.parametrize("alpha", [1, 2, 3, 6])
@pytest.mark.parametrize("columns", [1, 3])
@pytest.mark.parametrize("extent", [0.0, 8.0])
def test_the_gradient_against_central_differences(alpha, columns, extent):
    space, plane, z, weight = setting(columns=columns)
    likelihood = judge(space, plane, z, weight, alpha, Slope(np.eye(3), np.array([0.0, -0.4, 0.7]), extent))
    places = [(1.1, 1e-2, (0.0, 0.0)), (0.8, 1e-4, (0.25, 0.15)), (1.5, 0.3, (-0.4, 0.6))]
    for at in (likelihood.parameters(*place) for place in places):
        # Applied twice, the form leaves the value seven digits.
        expected = [(likelihood(at + by) - likelihood(at - by)) / 2e-3 for by in 1e-3 * np.eye(4)]
        np.testing.assert_allclose(likelihood.derivatives(at)[0], expected, rtol=1e-3, atol=0.01)


def dense_information(space, plane, z, weight, alpha, at, slope, hold):
    """The same from dense covariance matrices and their central differences (Gilmour, Thompson, Cullis 1995)."""
    a, f = space.matrix(plane).toarray(), np.column_stack([np.ones(N), plane])

    def covariance(at):
        p, q = at[2:]
        band = MaternPrecision(space, alpha).band(math.exp(at[0] + (math.hypot(p, q, ROUND) - ROUND) / 2), (p, q))
        full = np.zeros((space.size, space.size))
        for k in range(len(band)):
            index = np.arange(space.size - k)
            full[index + k, index] = full[index, index + k] = band[k, : space.size - k]
        return np.diag(1 / weight) + a @ np.linalg.solve(full, a.T) / math.exp(at[1])

    turned = [(covariance(at + by) - covariance(at - by)) / 2e-4 for by in 1e-4 * np.eye(4)]
    inverse = np.linalg.inv(covariance(at))
    prior = np.diag([0.0, hold, hold])
    projected = inverse - inverse @ f @ np.linalg.solve(f.T @ inverse @ f + prior, f.T @ inverse)
    found, along, misfit = np.zeros((4, 4)), np.zeros(4), 0.0
    for column in z.reshape(N, -1).T:
        rest = projected @ (column - f @ slope.aim)
        moved = [one @ rest for one in turned]
        found += [[one @ projected @ other for other in moved] for one in moved]
        along += [rest @ one for one in moved]
        misfit += (column - f @ slope.aim) @ rest
    free = (N - (1 if hold else 3)) * (1 if z.ndim == 1 else z.shape[1])
    doubt = np.diag([0.0, 0.0, 2 / DOUBT**2, 2 / DOUBT**2])
    return (found - np.outer(along, along) / misfit) * free / misfit + doubt


@pytest.mark.parametrize("alpha", [2, 3, 6])
@pytest.mark.parametrize(("columns", "extent"), [(1, 0.0), (1, 8.0), (3, 0.0)])
def test_the_information_agrees_with_dense_algebra(alpha, columns, extent):
    given, slope = setting(columns=columns), Slope(np.eye(3), np.array([0.0, -0.4, 0.7]) * (extent > 0), extent)
    likelihood = judge(*given, alpha, slope)
    for place in [(1.1, 1e-2, (0.0, 0.0)), (0.8, 1e-3, (0.25, 0.15))]:
        at = likelihood.parameters(*place)
        expected = dense_information(*given, alpha, at, slope, likelihood.optimum(at).hold)
        found = likelihood.derivatives(at)[1]
        np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max())


def test_a_range_cut_at_its_bound_keeps_the_variance():
    likelihood = judge(*setting(), 3)
    found = likelihood.optimum(likelihood.parameters(0.01, 1e-3, (0.3, 0.1)))
    # The range in the direction of the longest is the one that is bounded.
    assert found.kappa > likelihood.optimum(likelihood.parameters(0.01, 1e-3, (0.0, 0.0))).kappa >= 0.99 * CURVED
    longest = math.sqrt(np.linalg.eigvalsh(np.array(metric(found.stretch))[[[0, 1], [1, 2]]])[1]) / found.kappa
    assert longest == pytest.approx(1 / CURVED, rel=ROUND / 2)
    wide = judge(*setting(), 3)
    whole = wide.optimum(wide.parameters(0.3, 1e-3, (0.3, 0.1)))
    assert whole.rho * whole.kappa**4 == pytest.approx(1e-3 * 0.3**4)


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
    ours = [at_place(likelihood, place) for place in places]
    np.testing.assert_allclose(np.diff(ours), np.diff(expected), atol=1e-5)
