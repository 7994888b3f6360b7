"""Seams: where the edges of patches meet, how wide the gaps are and at what angle. No OpenCASCADE."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Seam
from geofit.splines.patch import Patch

__all__ = ["seams"]

Floats = NDArray[np.float64]

#: Places at which every seam is measured.
SAMPLES = 200
#: Two edges are one seam if they run together within this share of their length, and of their patches' width.
TOGETHER = 0.01
#: Below this (metres) a seam is closed: equal parameters are equal places.
CLOSED = 1e-9
EDGES = ("u0", "u1", "v0", "v1")


def seams(patches: Sequence[Patch], samples: int = SAMPLES) -> tuple[Seam, ...]:
    """Measure the gap and the angle between neighbouring patches along every common edge.

    Two edges belong together if their ends and middles are nearer to each other than 1 % of their length: a
    gap that a fit has left is found, not overlooked.

    Parameters
    ----------
    surface : HorizonFit or sequence of Patch
        Patches whose neighbours run along whole edges (no T-junctions).
    samples : int
        Places along each seam, evenly in the first patch's parameter.

    Returns
    -------
    tuple of Seam
        In the order of the patches; gap in metres (distance to the nearest place of the other edge), angle
        between the normals in degrees (0 to 180; an edge whose normal vanishes is left out of it).
    """
    edges = [(index, edge) for index in range(len(patches)) for edge in EDGES]
    marks = np.array([_rims(patch, np.linspace(0, 1, 5)) for patch in patches]).reshape(-1, 5, 3)
    # How far a patch reaches away from its edge: from one middle to the other.
    middle = marks[:, 2].reshape(-1, 2, 2, 3)
    width = np.repeat(np.linalg.norm(middle[:, :, 0] - middle[:, :, 1], axis=-1).ravel(), 2)
    reach = TOGETHER * np.minimum(width[:, None], width)
    apart = np.linalg.norm(marks[:, None, [0, -1]] - marks[:, [0, -1]], axis=-1).max(axis=-1)
    turned = np.linalg.norm(marks[:, None, [0, -1]] - marks[:, [-1, 0]], axis=-1).max(axis=-1)
    found = []
    for a, b in np.argwhere(np.triu(np.minimum(apart, turned) <= reach, 1)):
        (first, edge_a), (second, edge_b) = edges[a], edges[b]
        if second != first and (way := _together(marks[a], marks[b], reach[a, b])) is not None:
            found.append(_measure(patches[first], edge_a, patches[second], edge_b, way, samples))
    return tuple(found)


def _together(a: Floats, b: Floats, reach: float) -> bool | None:
    """Whether two edges (5 places each) run together: False as they stand, True if one is turned round."""
    length = np.linalg.norm(np.diff(a, axis=0), axis=1).sum()
    for turned in (False, True):
        other = b[::-1] if turned else b
        # The middle may stand elsewhere in the other edge's parameter: compare the ends, and the bulge
        # roughly.
        ends = np.linalg.norm((a - other)[[0, -1]], axis=1).max()
        middle = np.linalg.norm(a[2] - other, axis=1).min()
        if ends <= min(TOGETHER * length, reach) and middle <= 0.3 * length:
            return turned
    return None


def _rims(patch: Patch, share: Floats) -> Floats:
    """Return places on the four edges (4, n, 3) of a patch."""
    u0, u1, v0, v1 = patch.domain
    along = patch.evaluate([[u0], [u1]], (v0 + share * (v1 - v0))[None])
    across = patch.evaluate((u0 + share * (u1 - u0))[:, None], [[v0, v1]])
    return np.concatenate([along, across.swapaxes(0, 1)])


def _edge(patch: Patch, edge: str, share: Floats, du: int = 0, dv: int = 0) -> Floats:
    u0, u1, v0, v1 = patch.domain
    if edge[0] == "u":
        grid = patch.evaluate([[u0 if edge == "u0" else u1]], (v0 + share * (v1 - v0))[None], du, dv)
    else:
        grid = patch.evaluate((u0 + share * (u1 - u0))[:, None], [[v0 if edge == "v0" else v1]], du, dv)
    return grid.reshape(-1, 3)


def _measure(first: Patch, edge_a: str, second: Patch, edge_b: str, turned: bool, samples: int) -> Seam:
    share = np.linspace(0, 1, samples)
    a = _edge(first, edge_a, share)
    other, apart = _nearest(second, edge_b, 1 - share if turned else share, a)
    normal_a, normal_b = _normal(first, edge_a, share), _normal(second, edge_b, other)
    angle = np.arctan2(np.linalg.norm(np.cross(normal_a, normal_b), axis=1), np.einsum("nk,nk->n", normal_a, normal_b))
    known = (np.linalg.norm(normal_a, axis=1) > 0) & (np.linalg.norm(normal_b, axis=1) > 0)
    return Seam(first.name, second.name, float(apart.max()), float(np.degrees(angle[known].max(initial=0.0))))


def _nearest(patch: Patch, edge: str, share: Floats, target: Floats) -> tuple[Floats, Floats]:
    """Gauss-Newton along an edge to the nearest place, as shares of its parameter range; return also how far it is."""
    u0, u1, v0, v1 = patch.domain
    width, order = (v1 - v0, (0, 1)) if edge[0] == "u" else (u1 - u0, (1, 0))
    best, least = share, np.linalg.norm(_edge(patch, edge, share) - target, axis=1)
    for _ in range(0 if least.max() <= CLOSED else 20):
        tangent = _edge(patch, edge, share, *order) * width
        short = target - _edge(patch, edge, share)
        speed = np.maximum(np.einsum("nk,nk->n", tangent, tangent), 1e-300)
        share = np.clip(share + np.einsum("nk,nk->n", short, tangent) / speed, 0, 1)
        distance = np.linalg.norm(_edge(patch, edge, share) - target, axis=1)
        nearer = distance < least
        if not nearer.any():
            break
        best, least = np.where(nearer, share, best), np.minimum(distance, least)
    return best, least


def _normal(patch: Patch, edge: str, share: Floats) -> Floats:
    cross = np.cross(_edge(patch, edge, share, 1, 0), _edge(patch, edge, share, 0, 1))
    return np.asarray(cross)
