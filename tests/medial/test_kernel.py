"""The kernel of a metaball: continuity, inverse, and the chain of equal balls."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from geofit.medial.kernel import kernel, kernel_slope, reach, visible_radius


@pytest.mark.parametrize("stiffness", [2.0, 4.0, 8.0])
def test_value_and_slope_are_continuous_at_both_joints(stiffness):
    e, far = 1.7, float(reach(1.7, stiffness))
    assert kernel(e, e, stiffness) == pytest.approx(1, abs=1e-15)
    assert kernel(far, e, stiffness) == 0
    assert kernel(far + 1, e, stiffness) == 0
    for joint in (e, far):
        below, above = kernel_slope(joint - 1e-9, e, stiffness), kernel_slope(joint + 1e-9, e, stiffness)
        assert below == pytest.approx(float(above), abs=1e-7)


def test_the_slope_is_the_derivative():
    r = np.linspace(0.01, 3, 500)
    numeric = (kernel(r + 1e-6, 1.7) - kernel(r - 1e-6, 1.7)) / 2e-6
    np.testing.assert_allclose(kernel_slope(r, 1.7), numeric, atol=1e-5)


def test_the_visible_radius_inverts_the_kernel():
    rng = np.random.default_rng(0)
    r, field = rng.uniform(0.1, 9, 1000), rng.uniform(0, 0.999, 1000)
    e = visible_radius(r, field)
    np.testing.assert_allclose(field + kernel(r, e), 1, atol=1e-12)


@pytest.mark.parametrize(
    ("spacing", "at_ball", "between"),
    [(0.25, 1.234, 1.234), (0.5, 1.146, 1.145), (1.0, 1.012, 1.032), (1.5, 1.000, 0.867)],
)
def test_the_radius_of_a_chain_of_equal_balls(spacing, at_ball, between):
    """The table of 1A step 4 for this kernel, R / e = 1.5."""
    centres = spacing * np.arange(-12, 13)

    def surface(x):
        return brentq(lambda y: kernel(np.hypot(x - centres, y), 1.0).sum() - 1, 0.1, 2.5, xtol=1e-12)

    assert surface(0.0) == pytest.approx(at_ball, abs=1e-3)
    assert surface(spacing / 2) == pytest.approx(between, abs=1e-3)
