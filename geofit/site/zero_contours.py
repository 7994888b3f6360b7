"""Where a function of the plan changes its sign: lines through the cells of a lattice, exact on its edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.geometry.chains import chains_of

__all__ = ["lattice_triangles", "zero_contours"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Halvings of an edge: 34 leave 1e-9 m of 20 m.
HALVINGS = 34


def lattice_triangles(shape: tuple[int, int]) -> Ints:
    """Return (m, 3) numbers ``i * nv + j`` of the nodes of a lattice's triangles, two a cell, anticlockwise."""
    node = np.arange(shape[0] * shape[1]).reshape(shape)
    a, b, c, d = node[:-1, :-1].ravel(), node[1:, :-1].ravel(), node[1:, 1:].ravel(), node[:-1, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def zero_contours(
    plan: Floats, value: Floats, function: Callable[[Floats, Floats], Floats], halvings: int = HALVINGS
) -> list[Floats]:
    """Return the lines along which a function changes its sign.

    Parameters
    ----------
    plan : (nu, nv, 2) array
        Nodes of a lattice in plan.
    value : (nu, nv) array
        The function at them; nan where it is not to be looked at.
    function : callable
        ``function(x, y)`` with (n,) arrays; a value of nan counts as not negative.
    halvings : int
        How often an edge is halved to find where the sign changes.

    Returns
    -------
    list of (k, 2) array
        Lines, the longest first; a closed one ends where it began. Each vertex lies on an edge of the lattice's
        triangles, where the function changes its sign.
    """
    triangles = lattice_triangles((plan.shape[0], plan.shape[1]))
    flat, places = value.ravel(), plan.reshape(-1, 2)
    triangles = triangles[np.isfinite(flat[triangles]).all(axis=1)]
    low = flat < 0
    side = low[triangles]
    triangles = triangles[side.any(axis=1) & ~side.all(axis=1)]
    if not len(triangles):
        return []
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2)
    crossed = low[edges[..., 0]] != low[edges[..., 1]]
    # Two of the three edges of each triangle are crossed; neighbours know an edge by its sorted ends.
    ends, number = np.unique(np.sort(edges[crossed], axis=1), axis=0, return_inverse=True)
    inner = np.where(low[ends[:, :1]], ends, ends[:, ::-1])
    vertex = _halved(places[inner[:, 0]], places[inner[:, 1]], function, halvings)
    lines = [vertex[chain] for chain in chains_of(number.reshape(-1, 2), len(ends))]
    return sorted(lines, key=lambda line: -float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()))


def _halved(low: Floats, high: Floats, function: Callable[[Floats, Floats], Floats], halvings: int) -> Floats:
    """Return where the function stops being negative on the way from one place to the other."""
    for _ in range(halvings):
        middle = (low + high) / 2
        negative = (function(middle[:, 0], middle[:, 1]) < 0)[:, None]
        low, high = np.where(negative, middle, low), np.where(negative, high, middle)
    return (low + high) / 2
