"""Another control error gives another verdict on the same surface."""

from __future__ import annotations

from dataclasses import replace

import pytest
from panel_samples import fitted


@pytest.mark.parametrize("epsilon", [0.001, 0.2, 0.5, 3.0])
def test_only_what_depends_on_epsilon_changes(epsilon):
    surface = fitted()
    judged = surface.judged_by(epsilon)
    assert judged.surface is surface.surface
    assert judged.settings == replace(surface.settings, epsilon=epsilon)
    assert judged.accuracy.passed == (surface.accuracy.sigma < epsilon)
    assert judged.accuracy.over["epsilon"].limit == epsilon
    assert judged.accuracy.over["epsilon"].count == (abs(surface.accuracy.residuals) > epsilon).sum()
    by_name = {check.name: check for check in surface.accuracy.checks}
    for check in judged.accuracy.checks:
        if check.name != "trend":
            assert check is by_name[check.name]


@pytest.mark.parametrize("epsilon", [0.01, 50.0, 200.0])
def test_the_trend_is_that_of_a_check_from_the_start(epsilon):
    surface = fitted()
    start = surface.with_(settings=replace(surface.settings, epsilon=epsilon)).checked((), ())
    judged = surface.with_(settings=replace(surface.settings, epsilon=40.0)).checked((), ()).judged_by(epsilon)
    ours, theirs = (next(c for c in one.accuracy.checks if c.name == "trend") for one in (judged, start))
    assert (ours.passed, ours.limit) == (theirs.passed, pytest.approx(theirs.limit))
