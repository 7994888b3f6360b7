"""The body of metaballs as a field, and its edits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geofit.data.errors import SettingsError
from geofit.implicit.field import Field, RangedField
from geofit.medial.balls import MetaballBody
from geofit.medial.kernel import kernel


def random_body(seed, n=40):
    rng = np.random.default_rng(seed)
    return MetaballBody(rng.uniform(0, 20, (n, 3)), rng.uniform(0.3, 3, n)), rng


def test_it_is_a_field():
    body, _ = random_body(0)
    assert isinstance(body, Field)
    assert isinstance(body, RangedField)


@pytest.mark.parametrize("seed", range(4))
def test_values_equal_plain_numpy(seed):
    body, rng = random_body(seed)
    points = rng.uniform(-5, 25, (2000, 3))
    r = np.linalg.norm(points[:, None] - body.centre, axis=2)
    plain = (1 - kernel(r, body.radius).sum(axis=1)) * body.radius.mean() / body.stiffness
    np.testing.assert_allclose(body.value(points), plain, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_gradient_and_lipschitz_bound(seed):
    body, rng = random_body(seed)
    points = rng.uniform(0, 20, (2000, 3))
    gradient = body.gradient(points)
    step = 1e-6 * np.eye(3)
    numeric = np.stack([(body.value(points + s) - body.value(points - s)) / 2e-6 for s in step], axis=1)
    assert np.quantile(np.abs(gradient - numeric).max(axis=1), 0.99) < 1e-5
    assert np.linalg.norm(gradient, axis=1).max() <= body.lipschitz


@pytest.mark.parametrize("seed", range(3))
def test_ranges_contain_the_values(seed):
    body, rng = random_body(seed)
    low = rng.uniform(-4, 20, (50, 3))
    high = low + rng.uniform(0.1, 6, (50, 3))
    least, most = body.range_in(low, high)
    for k in range(50):
        values = body.value(rng.uniform(low[k], high[k], (200, 3)))
        assert least[k] - 1e-12 <= values.min()
        assert values.max() <= most[k] + 1e-12


@given(st.floats(0.01, 100), st.tuples(*[st.floats(-1e3, 1e3)] * 3), st.floats(1, 10))
@settings(max_examples=60, deadline=None)
def test_a_lone_ball_is_a_sphere(radius, centre, stiffness):
    body = MetaballBody(np.array([centre]), np.array([radius]), stiffness)
    directions = np.array([[1, 0, 0], [0, -1, 0], [0.6, 0, 0.8], [-1 / 3, 2 / 3, 2 / 3]])
    on = np.array(centre) + radius * directions
    assert np.abs(body.value(on)).max() <= 1e-9 * max(radius, 1)


def test_triangles_of_a_ball_have_its_volume():
    mesh = MetaballBody(np.full((1, 3), 5.0), np.array([3.0])).triangulate(0.25)
    assert mesh.is_closed
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 27, rel=0.01)


def test_edits_return_another_body_and_leave_the_first():
    body, _ = random_body(7, 5)
    moved = body.with_ball(2, centre=[1, 2, 3], radius=0.5)
    assert moved.balls[2].tolist() == [1, 2, 3, 0.5]
    assert body.balls[2].tolist() != [1, 2, 3, 0.5]
    assert len(body.without(0)) == 4
    assert np.array_equal(body.without(0).balls, body.balls[1:])
    assert body.plus([0, 0, 0], 2.0).balls[-1].tolist() == [0, 0, 0, 2]
    with pytest.raises(ValueError, match="read-only"):
        body.centre[0] = 0
    with pytest.raises(SettingsError, match="numbered from 0 to 4"):
        body.without(5)


@pytest.mark.parametrize(
    ("centre", "radius"), [(np.zeros((0, 3)), np.zeros(0)), (np.zeros((2, 2)), np.ones(2)), (np.zeros((1, 3)), [0.0])]
)
def test_bad_balls_are_refused(centre, radius):
    with pytest.raises(SettingsError):
        MetaballBody(centre, np.asarray(radius))
