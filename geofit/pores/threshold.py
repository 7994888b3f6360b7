"""The threshold between pores and rock in a grey volume (step 0 of Huang et al. 2007, which names no method)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.pores.volume import VolumeError

__all__ = ["grey_histogram", "otsu_threshold"]

_BINS = 256


def grey_histogram(values: NDArray[Any], bins: int = _BINS) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return counts (n,) and edges (n + 1,) of the values of voxels; whole numbers get a bin each where they fit."""
    values = values.view(np.uint8) if values.dtype == bool else values
    low, high = float(values.min()), float(values.max())
    if values.dtype.kind in "bui" and high - low < bins:
        edges = np.arange(low, high + 2) - 0.5
    else:
        edges = np.linspace(low, high, bins + 1) if high > low else np.array([low - 0.5, low + 0.5])
    counts = np.zeros(len(edges) - 1, np.int64)
    # Slice by slice: the histogram of a whole volume would make a copy of it in eight bytes a voxel.
    for slice_ in values:
        counts += np.histogram(slice_, edges)[0]
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
    counts, edges = grey_histogram(values)
    if np.count_nonzero(counts) < 2:
        raise VolumeError(
            message("pores.one-grey-value", "All voxels have the value {value}; there is no threshold.", value=edges[0])
        )
    middle = 0.5 * (edges[1:] + edges[:-1])
    below = np.cumsum(counts)[:-1].astype(np.float64)
    above = counts.sum() - below
    total = np.cumsum(counts * middle)
    apart = total[:-1] / np.maximum(below, 1) - (total[-1] - total[:-1]) / np.maximum(above, 1)
    between = below * above * apart**2
    best = np.flatnonzero(between >= between.max() * (1 - 1e-12))
    return float(0.5 * (edges[1:-1][best[0]] + edges[1:-1][best[-1]]))
