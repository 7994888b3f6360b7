"""Rows of long arrays: what is left out of them, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data import long_arrays
from geofit.data.long_arrays import blocks, without


@pytest.mark.parametrize("few", [0, 1_000])
@pytest.mark.parametrize("gone", [[0], [99], [3, 4, 5, 40, 98, 99], list(range(0, 100, 2)), list(range(20, 60))])
def test_what_is_left_is_that_of_a_deletion_block_by_block(gone, few, monkeypatch):
    monkeypatch.setattr(long_arrays, "FEW", few)
    monkeypatch.setattr(long_arrays, "BLOCK", 7)
    rows = np.random.default_rng(0).normal(size=(100, 2))
    left = without(rows, np.array(gone))
    expected = np.delete(rows, gone, axis=0)
    assert len(left) == len(expected)
    np.testing.assert_array_equal(left[:], expected)
    np.testing.assert_array_equal(np.concatenate([part for (part,) in blocks(left)]), expected)
    np.testing.assert_array_equal(left[5:31:3], expected[5:31:3])
