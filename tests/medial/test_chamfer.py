"""The two scans against Dijkstra on the graph of 26 neighbours, a plain reference, and the closed form."""

from __future__ import annotations

import heapq

import numpy as np
import pytest

from geofit.data.errors import SettingsError
from geofit.medial.axis import chamfer_length
from geofit.medial.chamfer import FORWARD, chamfer_distance, step_weights


def two_scans(void, weights):
    """The article's scans, voxel by voxel."""
    v = np.zeros(np.array(void.shape) + 2)
    v[1:-1, 1:-1, 1:-1] = np.where(void, 1e9, 0)
    steps = step_weights(weights)
    order = np.argwhere(np.ones(void.shape, bool)) + 1
    for sign, visits in ((1, order), (-1, order[::-1])):
        for i, j, k in visits:
            known = [
                v[i + sign * a, j + sign * b, k + sign * c] + w for (a, b, c), w in zip(FORWARD, steps, strict=True)
            ]
            v[i, j, k] = min(v[i, j, k], *known)
    return v[1:-1, 1:-1, 1:-1]


def dijkstra(void, weights):
    padded = np.pad(void, 1)
    distance = {tuple(p): 0.0 for p in np.argwhere(~padded)}
    queue = [(0.0, p) for p in distance]
    steps = [(tuple(s * o), w) for o, w in zip(FORWARD, step_weights(weights), strict=True) for s in (-1, 1)]
    done = set()
    while queue:
        d, p = heapq.heappop(queue)
        if p in done:
            continue
        done.add(p)
        for offset, w in steps:
            q = tuple(np.add(p, offset))
            if all(0 <= c < n for c, n in zip(q, padded.shape, strict=True)) and d + w < distance.get(q, np.inf):
                distance[q] = d + w
                heapq.heappush(queue, (d + w, q))
    return np.array([distance[tuple(p)] for p in np.argwhere(np.ones(padded.shape, bool))]).reshape(padded.shape)[
        1:-1, 1:-1, 1:-1
    ]


@pytest.mark.parametrize("weights", [(3, 4, 5), (1.0, 1.31402, 1.62803), (0.92644, 1.34066, 1.65849)])
@pytest.mark.parametrize("seed", range(3))
def test_scans_equal_the_reference_and_dijkstra(seed, weights):
    rng = np.random.default_rng(seed)
    void = rng.random((9, 11, 7)) > rng.choice([0.01, 0.05, 0.3])
    found = chamfer_distance(void, weights)
    np.testing.assert_allclose(found, two_scans(void, weights), rtol=0, atol=1e-12)
    np.testing.assert_allclose(found, dijkstra(void, weights), rtol=0, atol=1e-12)


def test_a_point_source_has_the_closed_form():
    void = np.ones((41, 41, 41), bool)
    void[20, 20, 20] = False
    found = chamfer_distance(void, outside_is_rock=False)
    offset = np.argwhere(np.ones(void.shape, bool)) - 20
    assert np.array_equal(found.ravel(), chamfer_length(offset))
    assert found.dtype == np.int32


def test_the_extremes_of_a_point_source_are_those_of_the_table():
    # A wedge of offsets up to 100 voxels: m1 >= m2 >= m3 >= 0.
    m = np.array([(100, b, c) for b in range(101) for c in range(b + 1)])
    error = chamfer_length(m) / 3 - np.linalg.norm(m, axis=1)
    assert error.max() / 100 == pytest.approx(0.1181, abs=1e-3)
    assert error.min() / 100 == pytest.approx(-0.0809, abs=1e-3)


def test_the_faces_of_the_volume_are_rock_unless_said_otherwise():
    void = np.ones((5, 5, 5), bool)
    assert chamfer_distance(void)[2, 2, 2] == 9
    assert (chamfer_distance(void, outside_is_rock=False) == np.iinfo(np.int32).max).all()
    assert np.isinf(chamfer_distance(void, (1.0, 1.3, 1.6), outside_is_rock=False)).all()
    assert not chamfer_distance(~void).any()


def test_a_plane_is_refused():
    with pytest.raises(SettingsError, match="array of 3"):
        chamfer_distance(np.ones((4, 4), bool))
    with pytest.raises(SettingsError, match="3 numbers above 0"):
        chamfer_distance(np.ones((4, 4, 4), bool), (3, 4))
