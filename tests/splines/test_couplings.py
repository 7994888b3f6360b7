from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import cholesky_banded

from geofit.splines.blocks import inverse_band
from geofit.splines.couplings import banded, dyads, from_band

SHAPES = [(7, 5), (5, 7), (9, 2), (2, 3)]


def steps(shape):
    """Return the (size, size) distances of control points in either direction."""
    i, j = (index.ravel() for index in np.indices(shape))
    return np.maximum(np.abs(i[:, None] - i), np.abs(j[:, None] - j))


def near(shape, reach, seed=0):
    """Return a random positive definite matrix that couples control points at most ``reach`` steps apart."""
    size = shape[0] * shape[1]
    full = np.random.default_rng(seed).normal(size=(size, size))
    full = np.where(steps(shape) <= reach, full + full.T, 0.0)
    return full + np.diag(np.abs(full).sum(axis=1) + 1)


def couplings_of(full, shape, reach):
    """Return the couplings of a dense matrix, entry by entry as they are defined."""
    result = np.zeros((2 * reach + 1, shape[0], 2 * reach + 1, shape[1]))
    for row, (i, j) in enumerate(np.ndindex(shape)):
        for column, (k, m) in enumerate(np.ndindex(shape)):
            if max(abs(i - k), abs(j - m)) <= reach:
                result[i - k + reach, k, j - m + reach, m] = full[row, column]
    return result


def lower_band(full, width):
    size = len(full)
    return np.array([np.pad(np.diagonal(full, -k), (0, size - len(np.diagonal(full, -k)))) for k in range(width + 1)])


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("reach", [1, 2])
def test_a_band_and_its_couplings_are_the_same_matrix(shape, reach):
    full = near(shape, reach)
    couplings = couplings_of(full, shape, reach)
    band = banded(couplings[reach:])
    np.testing.assert_array_equal(band, lower_band(full, len(band) - 1))
    np.testing.assert_array_equal(from_band(band, shape, reach), couplings)


@pytest.mark.parametrize("shape", SHAPES)
def test_dyads_are_those_of_dense_columns(shape):
    net = np.random.default_rng(1).normal(size=(*shape, 3))
    columns = net.reshape(-1, 3)
    np.testing.assert_allclose(dyads(net, 1), couplings_of(columns @ columns.T, shape, 1), atol=1e-12)


@pytest.mark.parametrize(("size", "width"), [(40, 7), (35, 7), (6, 5), (9, 8), (1, 0), (5, 1), (330, 131)])
def test_the_inverse_near_the_diagonal_is_that_of_the_whole_matrix(size, width):
    full = np.random.default_rng(3).normal(size=(size, size))
    full = np.where(np.abs(np.subtract.outer(np.arange(size), np.arange(size))) <= width, full + full.T, 0.0)
    full += np.diag(np.abs(full).sum(axis=1) + 1)
    lower = cholesky_banded(lower_band(full, width), lower=True)
    found, inverse = inverse_band(lower), np.linalg.inv(full)
    for k in range(width + 1):
        np.testing.assert_allclose(found[k, : size - k], np.diagonal(inverse, -k), atol=1e-13)
