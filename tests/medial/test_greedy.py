"""The lazy choice against the full search, the loops against numpy, the radius search against trying many radii."""

from __future__ import annotations

import heapq
import itertools

import numpy as np
import pytest
from counts import cases
from scipy.ndimage import gaussian_filter

from geofit.medial.axis import medial_points
from geofit.medial.greedy import UNIT, Cover, choose_fully, choose_next
from geofit.medial.kernel import kernel

PAD = 6


def cover(seed, n=18, edges=(1.0, 1.0, 1.0), cost=1.0):
    rng = np.random.default_rng(seed)
    noise = gaussian_filter(rng.standard_normal((n, n, n)), rng.uniform(1.2, 3))
    body = noise > np.quantile(noise, rng.uniform(0.5, 0.85))
    points = medial_points(body)
    return Cover(np.pad(body, PAD), np.array(edges), points.index + PAD, points.distance, cost)


def heap_of(found):
    heap = [(-bound, i, -1) for i, bound in enumerate(found.bounds().tolist())]
    heapq.heapify(heap)
    return heap


@pytest.mark.parametrize(
    ("seed", "n"), [*((seed, 18) for seed in range(50)), *((seed, 40) for seed in range(cases(50, 6)))]
)
def test_the_lazy_choice_is_the_full_search(seed, n):
    """PORES.md, test 16: 50 bodies of 40³ voxels."""
    lazy, full = cover(seed, n, cost=0.5 + seed % 3), cover(seed, n, cost=0.5 + seed % 3)
    heap, candidates = heap_of(lazy), list(range(len(full.index)))
    gains = []
    for _ in range(12):
        first, second = choose_next(lazy, heap), choose_fully(full, candidates)
        assert first == second
        if first is None:
            break
        gains.append(first.gain)
    assert np.array_equal(lazy.field, full.field)
    assert all(a >= b for a, b in itertools.pairwise(gains))
    assert lazy.evaluations < full.evaluations


def distances_from(found, i):
    grid = np.argwhere(np.ones(found.body.shape, bool))
    return np.linalg.norm((grid - found.index[i]) * found.edges, axis=1)


def field_of(found, i, radius):
    return kernel(distances_from(found, i), radius).reshape(found.body.shape)


@pytest.mark.parametrize("edges", [(1.0, 1.0, 1.0), (1.0, 1.5, 2.0)])
def test_gain_and_addition_equal_plain_numpy(edges):
    found = cover(3, edges=edges)
    rng = np.random.default_rng(1)
    total = np.zeros(found.body.shape)
    for i in rng.choice(len(found.index), 6, replace=False).tolist():
        own = field_of(found, i, found.radius[i])
        more = (np.minimum(total + own, 1) - np.minimum(total, 1))[found.body].sum()
        spilled = (np.maximum(total + own, 1) - np.maximum(total, 1))[~found.body].sum()
        assert found.gain(i) == pytest.approx(more - spilled, abs=1e-2)
        found.add(i, float(found.radius[i]))
        total += own
        np.testing.assert_allclose(found.field / UNIT, total, atol=1e-5)
    inside = found.field >= UNIT
    assert found.covered == (inside & found.body).sum()
    assert found.spilled == (inside & ~found.body).sum()


def test_the_bound_is_never_below_the_gain():
    found = cover(4)
    bounds = found.bounds()
    assert all(found.gain(i) <= bounds[i] for i in range(len(found.index)))


@pytest.mark.parametrize("edges", [(1.0, 1.0, 1.0), (1.0, 1.5, 2.0)])
def test_the_room_in_blocks_is_never_below_the_gain(edges):
    """At the start and after each ball: the bound that saves evaluations must not hide the best candidate."""
    found = cover(6, edges=edges)
    heap, everyone = heap_of(found), range(len(found.index))
    before = np.full(len(found.index), np.inf)
    for _ in range(5):
        rooms = np.array([found.room(i) for i in everyone])
        assert (np.array([found.gain(i) for i in everyone]) <= rooms).all()
        assert (rooms <= before).all()
        chosen = choose_next(found, heap)
        assert found.room(chosen.candidate) < rooms[chosen.candidate]
        before = rooms


@pytest.mark.parametrize("seed", range(10))
def test_the_radius_search_is_at_least_as_good_as_a_thousand_radii(seed):
    """PORES.md, test 17."""
    found = cover(seed, cost=1.3)
    heap = heap_of(found)
    for _ in range(4):
        choose_next(found, heap)
    total, body = found.field.ravel() / UNIT, found.body.ravel()
    for i in np.random.default_rng(seed).choice(len(found.index), 3, replace=False).tolist():
        radius, score = found.search_radius(i)
        assert found.smallest <= radius <= max(found.distance[i], found.smallest)
        r = distances_from(found, i)
        # No narrower ball reaches farther than the widest; voxels inside before count for none.
        near = np.flatnonzero((kernel(r, max(found.distance[i], found.smallest)) > 0) & (total < 1))
        scores = []
        for e in [radius, *np.linspace(found.smallest, found.distance[i], 1000)]:
            new = total[near] + kernel(r[near], e) >= 1
            scores.append((new & body[near]).sum() - found.cost * (new & ~body[near]).sum())
        assert scores[0] == pytest.approx(score)
        assert score >= max(scores) - 1e-9
