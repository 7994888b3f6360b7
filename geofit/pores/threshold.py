"""The threshold between pores and rock in a grey volume (step 0 of Huang et al. 2007, which names no method)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.pores.volume import VolumeError

__all__ = ["grey_histogram", "histogram_of_counts", "otsu_of_histogram", "otsu_threshold", "value_counts"]

_BINS = 256
#: Whole numbers that are counted one by one.
_MOST_VALUES = 1 << 16


def value_counts(values: NDArray[Any]) -> tuple[int, NDArray[np.int64]] | None:
    """Return the smallest value and how many voxels have it, and each whole number above it up to the largest.

    Returns
    -------
    tuple of int and (n,) array, or None
        None for values that are not whole numbers, or are spread over more than 65,536 of them.
    """
    values = values.view(np.uint8) if values.dtype == bool else values
    if values.dtype.kind not in "ui":
        return None
    low, high = int(values.min()), int(values.max())
    if high - low >= _MOST_VALUES:
        return None
    counts = np.zeros(high - low + 1, np.int64)
    # Slice by slice: a whole volume would be copied into eight bytes a voxel.
    for slice_ in values:
        # In eight bytes without a sign, differences are right for numbers of any type.
        above = slice_.ravel().astype(np.uint64) - np.uint64(low % (1 << 64))
        counts += np.bincount(above.astype(np.int64), minlength=len(counts))
    return low, counts


def histogram_of_counts(
    first: int, counts: NDArray[np.int64], bins: int = _BINS
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the histogram of :func:`grey_histogram` from what :func:`value_counts` returns."""
    if len(counts) <= bins:
        return counts, np.arange(first, first + len(counts) + 1, dtype=np.float64) - 0.5
    edges = np.linspace(first, first + len(counts) - 1, bins + 1, dtype=np.float64)
    each = np.arange(first, first + len(counts))
    folded = np.add.reduceat(counts, np.searchsorted(each, edges[:-1]))
    return np.asarray(folded, np.int64), edges


def grey_histogram(values: NDArray[Any], bins: int = _BINS) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return counts (n,) and edges (n + 1,) of the values of voxels; whole numbers get a bin each where they fit."""
    values = values.view(np.uint8) if values.dtype == bool else values
    each = value_counts(values)
    if each is not None:
        return histogram_of_counts(*each, bins)
    low, high = float(values.min()), float(values.max())
    edges = np.linspace(low, high, bins + 1) if high > low else np.array([low - 0.5, low + 0.5])
    counts = np.zeros(len(edges) - 1, np.int64)
    for slice_ in values:
        counts += np.histogram(slice_, len(counts), (edges[0], edges[-1]))[0]
    return counts, edges


def otsu_threshold(values: NDArray[Any]) -> float:
    """Return the grey value that parts the voxels into two classes with the largest variance between their means.

    It is proposed, never used unasked: pores are the values up to it where they are dark, as in most scans.

    Parameters
    ----------
    values : ndarray, shape (n0, n1, n2)
        Grey values.

    Raises
    ------
    VolumeError
        If all voxels have the same value.

    Notes
    -----
    Otsu (1979), on 256 classes of equal width; whole numbers of a smaller range have a class each. Where several
    thresholds part the same voxels, it is the middle one.

    Examples
    --------
    >>> otsu_threshold(np.array([[[10, 12, 11, 200, 201, 202]]], np.uint8))
    105.5
    """
    return otsu_of_histogram(*grey_histogram(values))


def otsu_of_histogram(counts: NDArray[np.int64], edges: NDArray[np.float64]) -> float:
    """Return Otsu's threshold for a histogram: counts (n,) and edges (n + 1,), as :func:`grey_histogram` has them.

    Raises
    ------
    VolumeError
        As for :func:`otsu_threshold`.
    """
    if np.count_nonzero(counts) < 2:
        value = f"{0.5 * (edges[0] + edges[-1]):g}"
        raise VolumeError(
            message("pores.one-grey-value", "All voxels have the value {value}; there is no threshold.", value=value)
        )
    middle = 0.5 * (edges[1:] + edges[:-1])
    below = np.cumsum(counts)[:-1].astype(np.float64)
    above = counts.sum() - below
    total = np.cumsum(counts * middle)
    apart = total[:-1] / np.maximum(below, 1) - (total[-1] - total[:-1]) / np.maximum(above, 1)
    between = below * above * apart**2
    best = np.flatnonzero(between >= between.max() * (1 - 1e-12))
    return float(0.5 * (edges[1:-1][best[0]] + edges[1:-1][best[-1]]))
