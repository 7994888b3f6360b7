"""Medial points of chamfer balls: union, inclusion by brute force, axis of a body of revolution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from geofit.medial.axis import chamfer_length, including_values, medial_points
from geofit.medial.chamfer import chamfer_distance


def random_body(seed, n=12):
    rng = np.random.default_rng(seed)
    noise = gaussian_filter(rng.standard_normal((n, n, n)), rng.uniform(0.5, 2.5))
    return noise > np.quantile(noise, rng.uniform(0.2, 0.8))


def ball(centre, value):
    reach = int(value) // 3 + 1
    offset = np.argwhere(np.ones((2 * reach + 1,) * 3, bool)) - reach
    return {tuple(p) for p in (offset[chamfer_length(offset) < value] + centre).tolist()}


@pytest.mark.parametrize("corrected", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_the_union_of_the_balls_is_the_body(seed, corrected):
    body = random_body(seed)
    points = medial_points(body, corrected=corrected)
    assert np.array_equal(chamfer_distance(body)[tuple(points.index.T)], points.value)
    union = set().union(*(ball(p, v) for p, v in zip(points.index, points.value, strict=True)))
    assert union == {tuple(p) for p in np.argwhere(body).tolist()}


@pytest.mark.parametrize("seed", range(8))
def test_the_corrected_axis_has_exactly_the_balls_that_no_other_includes(seed):
    body = random_body(seed, 9)
    distance = chamfer_distance(body)
    every = [(p, ball(p, distance[tuple(p)])) for p in np.argwhere(body)]
    # Equal balls have equal centres, so inclusion is strict.
    maximal = {tuple(p) for p, own in every if not any(own < other for _, other in every)}
    assert {tuple(p) for p in medial_points(body).index.tolist()} == maximal


def test_without_the_correction_included_balls_remain():
    found = [
        (len(medial_points(b).index), len(medial_points(b, corrected=False).index)) for b in map(random_body, range(6))
    ]
    assert all(few <= many for few, many in found)
    assert sum(few for few, _ in found) < 0.7 * sum(many for _, many in found)


def test_the_table_by_enumeration():
    table = including_values(20)
    q = np.argwhere(np.ones((17, 17, 17), bool)) - 8
    for kind, g in enumerate(([1, 0, 0], [1, 1, 0], [1, 1, 1])):
        for r in range(1, 20):
            assert table[kind, r] == 1 + chamfer_length(q[chamfer_length(q) < r] - g).max()


@pytest.mark.parametrize("direction", [(1, 0, 0), (1, 1, 0), (3, 2, 1)])
def test_the_largest_balls_of_a_body_of_revolution_lie_on_its_axis(direction):
    d = np.array(direction) / np.linalg.norm(direction)
    grid = np.argwhere(np.ones((48, 48, 48), bool)) + 0.5 - 24
    along = grid @ d
    radius = 9 + 2 * np.sin(along / 9)
    off = np.linalg.norm(grid - along[:, None] * d, axis=1)
    body = ((off < radius) & (np.abs(along) < 18)).reshape(48, 48, 48)
    points = medial_points(body)
    where = points.index + 0.5 - 24
    position = where @ d
    away = np.linalg.norm(where - position[:, None] * d, axis=1)
    for low in range(-10, 10, 4):
        here = np.flatnonzero((position >= low) & (position < low + 4))
        largest = here[points.value[here] == points.value[here].max()]
        assert away[largest].min() <= np.sqrt(3) / 2


def test_real_weights_have_no_table_but_the_same_union():
    body = random_body(3)
    points = medial_points(body, (0.92644, 1.34066, 1.65849))
    distance = chamfer_distance(body, (0.92644, 1.34066, 1.65849))
    assert np.allclose(distance[tuple(points.index.T)], points.value)
    assert 0 < len(points.index) < body.sum()
