"""The kernel of a metaball: continuity, inverse, and the chain of equal balls."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from geofit.implicit import potential
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


#: Radius of the surface round a chain of balls of radius 1, at a ball and between two: the table of 1A step 4, where a
#: lone figure is that at a ball.
CHAIN = {
    "guo, R / e = 1.5": {0.25: (1.234, 1.234), 0.5: (1.146, 1.145), 1.0: (1.012, 1.032), 1.5: (1.000, 0.867)},
    "guo, R / e = 1.25": {0.25: (1.093, None), 0.5: (1.040, 1.044), 1.0: (1.000, 0.950), 1.5: (1.000, 0.768)},
    "guo, R / e = 2": {0.25: (1.559, None), 0.5: (1.411, None), 1.0: (1.208, 1.197), 1.5: (1.033, 1.053)},
    "exponential, kappa = 8": {0.25: (1.056, None), 0.5: (1.015, None), 1.0: (1.000, 0.915), 1.5: (1.000, 0.724)},
}


def field_of_a_ball(name):
    if name.startswith("guo"):
        stiffness = 2 / (float(name.rpartition(" ")[2]) - 1)
        return lambda r: kernel(r, 1.0, stiffness)
    if name == "wyvill":
        wyvill = potential("wyvill")
        return lambda r: wyvill.value((r / 1.5) ** 2) / float(wyvill.value(1 / 1.5**2))
    return lambda r: np.exp(-8 * (r**2 - 1))


def chain_radius(name, spacing, x):
    one, centres = field_of_a_ball(name), spacing * np.arange(-14, 15)
    return brentq(lambda y: one(np.hypot(x - centres, y)).sum() - 1, 0.1, 2.5, xtol=1e-12)


@pytest.mark.parametrize("spacing", [0.25, 0.5, 1.0, 1.5])
@pytest.mark.parametrize("name", CHAIN)
def test_the_radius_of_a_chain_of_equal_balls(name, spacing):
    """PORES.md, test 14."""
    at_ball, between = CHAIN[name][spacing]
    assert chain_radius(name, spacing, 0.0) == pytest.approx(at_ball, abs=1e-3)
    assert chain_radius(name, spacing, spacing / 2) == pytest.approx(at_ball if between is None else between, abs=2e-3)
    assert between is None or chain_radius(name, spacing, spacing / 2) == pytest.approx(between, abs=1e-3)


@pytest.mark.parametrize("spacing", [0.25, 0.5, 1.0, 1.5])
def test_wyvills_chain_is_nearly_that_of_guo(spacing):
    """Within 0.008; the table says 0.005."""
    for x, truth in zip((0.0, spacing / 2), CHAIN["guo, R / e = 1.5"][spacing], strict=True):
        assert chain_radius("wyvill", spacing, x) == pytest.approx(truth, abs=8.5e-3)
