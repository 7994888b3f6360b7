"""Otsu's threshold and the histogram of grey volumes."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.pores.threshold import grey_histogram, otsu_threshold, value_counts
from geofit.pores.volume import VolumeError


def literal(values):
    """The threshold by trying every value: the largest variance between the two classes."""
    best, found = -1.0, []
    for limit in np.unique(values)[:-1]:
        below, above = values[values <= limit].astype(float), values[values > limit].astype(float)
        variance = len(below) * len(above) * (below.mean() - above.mean()) ** 2
        if variance > best * (1 + 1e-12):
            best, found = variance, [limit]
    return found[0]


@pytest.mark.parametrize("seed", range(20))
def test_it_parts_the_voxels_as_the_literal_search_does(seed):
    rng = np.random.default_rng(seed)
    share = rng.uniform(0.05, 0.6)
    dark = rng.random((12, 11, 10)) < share
    values = np.where(dark, rng.normal(60, rng.uniform(5, 20), dark.shape), rng.normal(160, 15, dark.shape))
    values = np.clip(values, 0, 255).astype(np.uint8)
    np.testing.assert_array_equal(values <= otsu_threshold(values), values <= literal(values))


@pytest.mark.parametrize("seed", range(5))
def test_a_rock_with_noise_is_parted_to_within_a_percent(seed):
    rng = np.random.default_rng(seed)
    dark = rng.random((30, 30, 30)) < 0.2
    values = np.where(dark, 4000.0, 9000.0) + rng.normal(0, 700, dark.shape)
    threshold = otsu_threshold(values)
    assert ((values <= threshold) != dark).mean() < 0.01


def test_a_volume_of_one_value_has_no_threshold():
    with pytest.raises(VolumeError, match="the value 7; there is no threshold"):
        otsu_threshold(np.full((3, 3, 3), 7, np.uint8))


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.int16, np.float32, bool])
def test_the_histogram_counts_every_voxel_once(kind):
    values = (
        np.random.default_rng(1).random((6, 7, 8)) * (1.9 if kind is bool else 5000 if kind != np.uint8 else 255)
    ).astype(kind)
    counts, edges = grey_histogram(values)
    assert counts.sum() == values.size
    assert len(edges) == len(counts) + 1
    assert edges[0] <= values.min()
    assert edges[-1] >= values.max()


@pytest.mark.parametrize(("kind", "low", "high"), [(np.uint8, 3, 250), (np.int16, -900, 4000), (np.uint16, 7, 263)])
def test_whole_numbers_are_counted_into_the_classes_of_numpy(kind, low, high):
    values = np.random.default_rng(5).integers(low, high + 1, (9, 10, 11)).astype(kind)
    counts, edges = grey_histogram(values)
    np.testing.assert_array_equal(counts, np.histogram(values, edges)[0])
    first, each = value_counts(values)
    np.testing.assert_array_equal(each, [(values == first + k).sum() for k in range(len(each))])


def test_values_that_are_not_whole_or_too_many_are_not_counted_one_by_one():
    assert value_counts(np.full((2, 2, 2), 0.5)) is None
    assert value_counts(np.array([[[0, 1 << 20]]])) is None


@pytest.mark.parametrize("kind", [np.int8, np.uint64, np.int64])
def test_the_largest_numbers_of_a_type_are_counted(kind):
    most = np.iinfo(kind).max
    values = np.array([[[most, most - 100, most]]], kind)
    first, each = value_counts(values)
    assert first == most - 100
    assert np.flatnonzero(each).tolist() == [0, 100]
    assert each[[0, 100]].tolist() == [1, 2]
