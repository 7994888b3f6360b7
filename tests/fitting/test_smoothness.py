from __future__ import annotations

import numpy as np
import pytest
from likelihoods import judge, setting

from geofit.fitting import smoothness
from geofit.fitting.smoothness import as_smooth, search


@pytest.mark.parametrize("shorter", [1.0, 2.5])
def test_a_field_of_another_smoothness_keeps_variance_and_length(shorter):
    kappa, rho = as_smooth(0.8, 1e-3, 3, 6, shorter)
    assert np.sqrt(5) / kappa == pytest.approx(np.sqrt(2) / 0.8 / shorter)
    assert rho * 5 * kappa**10 == pytest.approx(1e-3 * 2 * 0.8**4)


class Valleys:
    """A likelihood of two valleys in log kappa: the deeper one has the higher start."""

    alpha = 3

    def __init__(self, deeper=0.0):
        self.deeper, self.begun = deeper, []

    def parameters(self, kappa, rho, stretch):
        return np.array([np.log(kappa), np.log(rho), *stretch])

    def __call__(self, at):
        return {0.04: 10.0, 0.2: 50.0, 1.0: 12.0 + self.deeper}[round(float(np.exp(at[0])), 2)]


def test_the_search_begins_in_every_valley_that_is_not_far_behind():
    begun = smoothness.starts(Valleys(), 1e-3)
    assert [round(float(np.exp(at[0])), 2) for at in begun] == [0.04, 1.0]
    assert len(smoothness.starts(Valleys(deeper=1e3), 1e-3)) == 1


@pytest.mark.parametrize("seed", range(4))
def test_no_start_of_a_fine_raster_leads_to_a_likelier_field(seed, monkeypatch):
    given = setting(seed)
    found = search(lambda alpha: judge(*given, alpha), 3, 60, None)
    monkeypatch.setattr(smoothness, "KAPPAS", tuple(np.geomspace(0.02, 2, 9)))
    monkeypatch.setattr(smoothness, "WAVES", tuple(np.geomspace(0.3, 10, 9)))
    finer = search(lambda alpha: judge(*given, alpha), 3, 60, None)
    assert min(one.value for one in found) < min(one.value for one in finer) + 0.5
    assert [one.alpha for one in found][:2] == [3, 2]


def test_a_given_smoothing_is_kept():
    given = setting()
    found = search(lambda alpha: judge(*given, alpha), 3, 60, 1e-2)
    assert [one.alpha for one in found] == [3, 2]
    assert [one.rho for one in found] == pytest.approx([1e-2, 1e-2])
