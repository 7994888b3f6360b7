"""Seams: where the edges of patches meet, how wide the gaps are and at what angle. No OpenCASCADE."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

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
#: A common stretch of two edges is longer than so many times what they may be apart.
LEAST = 3.0
EDGES = ("u0", "u1", "v0", "v1")
#: Shares of an edge at which it is looked at before it is measured.
RAIL = np.linspace(0, 1, 33)


def seams(patches: Sequence[Patch], samples: int = SAMPLES) -> tuple[Seam, ...]:
    """Measure the gap and the angle between neighbouring patches along every common edge.

    Two edges belong together if their ends and middles are nearer to each other than 1 % of their length: a
    gap that a fit has left is found, not overlooked. Edges of which no other one runs along the whole (of a file
    whose faces end at the trimming, say) are measured along the stretch that they share with another.

    Parameters
    ----------
    surface : HorizonFit or sequence of Patch
        Patches; neighbours run along whole edges or parts of them.
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
    found: dict[tuple[int, int], Seam] = {}
    for a, b in np.argwhere(np.triu(np.minimum(apart, turned) <= reach, 1)):
        (first, edge_a), (second, edge_b) = edges[a], edges[b]
        if second != first and (way := _together(marks[a], marks[b], reach[a, b])) is not None:
            places = np.linspace(0, 1, samples), np.linspace(1, 0, samples) if way else np.linspace(0, 1, samples)
            found[int(a), int(b)] = _measure(patches[first], edge_a, patches[second], edge_b, *places)
    matched = {k for pair in found for k in pair}
    for a, b in combinations([k for k in range(len(edges)) if k not in matched], 2):
        (first, edge_a), (second, edge_b) = edges[a], edges[b]
        if first != second and _may_share(marks[a], marks[b], reach[a, b]):
            shared = _shared(patches[first], edge_a, patches[second], edge_b, reach[a, b], samples)
            if shared is not None:
                found[a, b] = _measure(patches[first], edge_a, patches[second], edge_b, *shared)
    return tuple(found[pair] for pair in sorted(found))


def _may_share(a: Floats, b: Floats, reach: float) -> bool:
    """Whether two edges (as many places along each) might have more than an end in common."""
    ends = np.array([a[0], a[-1], b[0], b[-1]])
    rails = np.array([b, b, a, a])
    apart = np.linalg.norm(ends[:, None] - rails, axis=2).min(axis=1)
    step = np.linalg.norm(np.diff(rails, axis=1), axis=2).max(axis=1)
    met = ends[apart <= reach + step]
    return len(met) > 1 and bool(np.linalg.norm(np.ptp(met, axis=0)) > LEAST * reach)


def _shared(
    first: Patch, edge_a: str, second: Patch, edge_b: str, reach: float, samples: int
) -> tuple[Floats, Floats] | None:
    """Return shares of two edges along the stretch that they have in common; None if they only touch or cross."""
    rail_a, rail_b = _edge(first, edge_a, RAIL), _edge(second, edge_b, RAIL)
    if not _may_share(rail_a, rail_b, reach):
        return None
    ends = np.array([0.0, 1.0])
    _, apart_b = _nearest(second, edge_b, _start(rail_b, rail_a[[0, -1]]), rail_a[[0, -1]])
    on_a, apart_a = _nearest(first, edge_a, _start(rail_a, rail_b[[0, -1]]), rail_b[[0, -1]])
    met = np.concatenate([ends[apart_b <= reach], on_a[apart_a <= reach]])
    if len(met) < 2:
        return None
    share = np.linspace(met.min(), met.max(), samples)
    places = _edge(first, edge_a, share)
    length = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    other, apart = _nearest(second, edge_b, _start(rail_b, places), places)
    return (share, other) if length > LEAST * reach and apart.max() <= reach else None


def _start(rail: Floats, target: Floats) -> Floats:
    """Return the share of the nearest place on an edge's rail for each target."""
    return np.asarray(RAIL[np.linalg.norm(rail[None] - target[:, None], axis=2).argmin(axis=1)])


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


def _measure(first: Patch, edge_a: str, second: Patch, edge_b: str, share: Floats, start: Floats) -> Seam:
    """Measure a seam at shares of the first edge; ``start`` are about the same places on the second one."""
    other, apart = _nearest(second, edge_b, start, _edge(first, edge_a, share))
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
