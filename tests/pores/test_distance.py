"""The distance map against scipy and against the article's 26 rays."""

import numpy as np
import pytest
from brute import article_search, blobs
from conftest import ROCKS
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


def is_sum(n):
    """Legendre: every whole number but 4^a (8 b + 7) is a sum of three squares."""
    while n and n % 4 == 0:
        n //= 4
    return n % 8 != 7


@pytest.mark.parametrize("seed", range(200))
def test_one_pass_is_the_articles_search(seed):
    """PORES.md, test 2: R² and L² of 26 runs and a search of the cube, on 24³ voxels."""
    pore = blobs(seed)
    reach2 = squared_distance(pore)
    radius2, limit2 = article_search(pore)
    np.testing.assert_array_equal(np.where(pore, sums_of_squares(int(reach2.max()))[reach2], -1), radius2)
    np.testing.assert_array_equal(np.where(pore, reach2 + 1, -1), limit2)


@pytest.mark.parametrize("name", [name for name in ROCKS if name != "berea_400"])
def test_equal_to_scipy_on_rocks(rock, name):
    """PORES.md, test 1."""
    pore = rock(name).pore
    np.testing.assert_array_equal(
        squared_distance(pore, "open"), np.rint(ndimage.distance_transform_edt(pore) ** 2).astype(np.int32)
    )


def test_sums_of_three_squares_follow_legendre():
    below = sums_of_squares(400)
    assert [max(s for s in range(n) if is_sum(s)) for n in range(1, 401)] == below[1:].tolist()
