"""The distance map against scipy and against the article's 26 rays."""

import numpy as np
import pytest
from brute import blobs
from scipy import ndimage

from geofit.pores.distance import squared_distance, sums_of_squares


@pytest.mark.parametrize("seed", range(40))
def test_equal_to_scipy(seed):
    rng = np.random.default_rng(seed)
    pore = blobs(seed, tuple(rng.integers(1, 28, 3)))
    pore.flat[0] = False
    wide = np.pad(pore, 1)
    for edges in ((1.0, 1.0, 1.0), (1.0, 1.37, 2.0)):
        closed = ndimage.distance_transform_edt(wide, sampling=edges)[1:-1, 1:-1, 1:-1] ** 2
        open_ = ndimage.distance_transform_edt(pore, sampling=edges) ** 2
        for border, truth in (("closed", closed), ("open", open_)):
            found = squared_distance(pore, border, edges)
            if found.dtype == np.int32:
                np.testing.assert_array_equal(found, np.rint(truth))
            else:
                np.testing.assert_allclose(found, truth, rtol=1e-12)


def rays(pore):
    """The article's step 1, literally: 26 runs bound the cube, then all voxels of the cube are looked at."""
    wide = np.pad(pore, 1)
    steps = [s for s in np.ndindex(3, 3, 3) if s != (1, 1, 1)]
    radius2 = np.full(pore.shape, -1)
    for p in np.argwhere(pore):
        bound = 10**9
        for step in steps:
            move = np.array(step) - 1
            q, count = p + 1, 0
            while wide[tuple(q)]:
                q, count = q + move, count + 1
            bound = min(bound, count * count * int((move**2).sum()))
        half = int(np.sqrt(bound)) + 1
        low, high = np.maximum(p + 1 - half, 0), np.minimum(p + 2 + half, wide.shape)
        part = wide[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
        gap = sum((g - c) ** 2 for g, c in zip(np.ogrid[tuple(map(slice, part.shape))], p + 1 - low, strict=True))
        nearest = gap[~part].min()
        radius2[tuple(p)] = max(s for s in range(nearest) if is_sum(s))
    return radius2


def is_sum(n):
    """Legendre: every whole number but 4^a (8 b + 7) is a sum of three squares."""
    while n and n % 4 == 0:
        n //= 4
    return n % 8 != 7


@pytest.mark.parametrize("seed", range(200))
def test_one_pass_is_the_articles_search(seed):
    pore = blobs(seed, (10, 9, 8))
    reach2 = squared_distance(pore)
    found = np.where(pore, sums_of_squares(int(reach2.max()))[reach2], -1)
    np.testing.assert_array_equal(found, rays(pore))


def test_sums_of_three_squares_follow_legendre():
    below = sums_of_squares(400)
    assert [max(s for s in range(n) if is_sum(s)) for n in range(1, 401)] == below[1:].tolist()
