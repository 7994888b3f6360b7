from __future__ import annotations

import numpy as np
import pytest
from likelihoods import judge, setting

from geofit.fitting.likelihood import CURVED
from geofit.fitting.optimum import BEHIND, EVERY, maximize, maximize_over_noise


def starts(likelihood):
    return [likelihood.parameters(1.0, rho, (0.0, 0.0)) for rho in (5e-5, 2e-3, 0.1)]


@pytest.mark.parametrize("alpha", [2, 3, 6])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_search_ends_at_a_maximum(alpha, seed):
    likelihood = judge(*setting(seed), alpha)
    found = maximize(likelihood, starts(likelihood), EVERY)
    best = likelihood.parameters(found.kappa, found.rho, found.stretch)
    low, high = np.array(likelihood.bounds()).T
    for k in range(4):
        for step in (-0.05, 0.05):
            moved = best.copy()
            moved[k] = np.clip(moved[k] + step, low[k], high[k])
            assert likelihood(moved) >= found.value - 0.1
    assert found.value <= min(likelihood(one) for one in starts(likelihood))


def test_parameters_that_are_not_free_keep_their_start():
    likelihood = judge(*setting(), 2)
    found = maximize(likelihood, starts(likelihood)[1:2], (0,))
    assert found.rho == pytest.approx(2e-3)
    assert found.stretch == (0.0, 0.0)
    assert found.value < likelihood(starts(likelihood)[1])


def test_the_noise_s_variance_is_found():
    likelihood = judge(*setting(), 3)
    found = maximize(likelihood, starts(likelihood), (0, 1))
    # Weights of mean 1.25 about noise of 0.1 m.
    assert found.variance == pytest.approx(0.0125, rel=0.5)
    assert found.kappa >= CURVED - 1e-9


@pytest.mark.parametrize("rho", [1e-6, 1e-3, 10.0])
def test_the_noise_alone_is_found_from_afar(rho):
    likelihood = judge(*setting(), 2)
    found = maximize_over_noise(likelihood, likelihood.parameters(0.8, rho, (0.1, 0.0)))
    places = [likelihood.parameters(0.8, one, (0.1, 0.0)) for one in np.geomspace(1e-7, 100, 400)]
    assert found.value <= min(likelihood(place) for place in places) + 0.1
    assert (found.kappa, found.stretch) == (pytest.approx(0.8), (0.1, 0.0))


def test_a_search_far_behind_its_rival_is_given_up():
    likelihood = judge(*setting(), 2)
    best = maximize(likelihood, starts(likelihood), EVERY)
    start = [likelihood.parameters(1.0, 100.0, (0.0, 0.0))]
    given_up = maximize(likelihood, start, EVERY, rival=best.value - 10 * BEHIND)
    assert given_up.value > best.value
