"""Where a plane meets a surface: traced through its triangles, then moved onto the surface itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.geometry.chains import chains_of
from geofit.geometry.mesh import Mesh
from geofit.splines.patch import Patch
from geofit.surfaces.protocol import Surface

__all__ = ["level_lines", "plane_lines"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Newton steps end when a place is nearer to the plane than this (metres).
EXACT = 1e-10
STEPS = 20


def plane_lines(surface: Surface, mesh: Mesh, normal: Floats, offset: float) -> list[Floats]:
    """Return the lines in which the plane ``normal . x = offset`` cuts a surface; see :func:`level_lines`."""
    return level_lines(surface, mesh, normal, [offset])[0]


def level_lines(surface: Surface, mesh: Mesh, normal: Floats, offsets: Sequence[float]) -> list[list[Floats]]:
    """Return for each of some parallel planes ``normal . x = offset`` the lines in which it cuts a surface.

    Parameters
    ----------
    surface : Surface
        The surface.
    mesh : Mesh
        Its triangles (:func:`geofit.geometry.mesh.triangulate`), which decide how many vertices a line gets.
    normal : (3,) array
        Unit normal of the planes.
    offsets : sequence of float
        Where they stand, in the coordinates of the mesh (local, metres).

    Returns
    -------
    list of list of (k, 3) array
        Lines in local coordinates; a closed one ends where it began. Their vertices lie on the surface, and
        on the plane to 1e-7 m, but for a place where the surface only touches the plane: there they stay
        on the triangles.
    """
    height = mesh.points @ normal
    traced = [_traced(mesh, height - offset) for offset in offsets]
    points = np.concatenate([one.points for one in traced])
    counts = [len(one.points) for one in traced]
    if surface.patches:  # the triangles of a file are the surface themselves
        patch, uv = (np.concatenate(parts) for parts in zip(*((one.patch, one.uv) for one in traced), strict=True))
        points = _refined(surface.patches, patch, uv, points, normal, np.repeat(np.asarray(offsets, float), counts))
    places = np.split(points, np.cumsum(counts)[:-1])
    return [[own[chain] for chain in one.chains] for own, one in zip(places, traced, strict=True)]


@dataclass(frozen=True, eq=False)
class _Traced:
    """Where the edges of triangles cross a plane: places (n, 3), their patches and ``uv`` (n, 2); chains of them."""

    points: Floats
    patch: Ints
    uv: Floats
    chains: list[Ints]


def _traced(mesh: Mesh, value: Floats) -> _Traced:
    """Trace a plane through triangles; ``value`` is the height of their vertices above it."""
    above = value >= 0
    side = above[mesh.triangles]
    crossed = np.flatnonzero(side.any(axis=1) & ~side.all(axis=1))
    if not len(crossed):
        return _Traced(np.empty((0, 3)), np.empty(0, np.int64), np.empty((0, 2)), [])
    triangles, side = mesh.triangles[crossed], side[crossed]
    # The corner that stands alone on its side: both of its edges are crossed.
    lone = np.where(side.sum(axis=1) == 1, side.argmax(axis=1), (~side).argmax(axis=1))
    rows = np.arange(len(crossed))
    ends, uvs, places = [], [], []
    for turn in (1, 2):
        other = (lone + turn) % 3
        a, b = triangles[rows, lone], triangles[rows, other]
        t = (value[a] / (value[a] - value[b]))[:, None]
        ends.append(np.sort(np.stack([a, b], axis=1), axis=1))
        places.append(mesh.points[a] + t * (mesh.points[b] - mesh.points[a]))
        first, second = mesh.uv[crossed, lone], mesh.uv[crossed, other]
        uvs.append(first + t * (second - first))
    edges, number = np.unique(np.concatenate(ends), axis=0, return_inverse=True)
    number = number.reshape(-1)
    # One place for an edge, whichever of its triangles it is taken from.
    first = np.unique(number, return_index=True)[1]
    patch = np.concatenate([mesh.patch[crossed]] * 2)[first]
    chains = chains_of(number.reshape(2, -1).T, len(edges))
    return _Traced(np.concatenate(places)[first], patch, np.concatenate(uvs)[first], chains)


def _refined(
    patches: tuple[Patch, ...], which: Ints, uv: Floats, points: Floats, normal: Floats, offsets: Floats
) -> Floats:
    """Move places along the surface, each onto its own plane, by the shortest way in space (Newton)."""
    result = points.copy()
    for k in np.unique(which):
        patch, rows = patches[k], np.flatnonzero(which == k)
        u0, u1, v0, v1 = patch.domain
        low, high = np.array([u0, v0]), np.array([u1, v1])
        place, level = uv[rows].clip(low, high), offsets[rows]
        for _ in range(STEPS):
            at = patch.evaluate(place[:, 0], place[:, 1])
            off = at @ normal - level
            if np.abs(off).max() <= EXACT:
                break
            su = patch.evaluate(place[:, 0], place[:, 1], 1, 0)
            sv = patch.evaluate(place[:, 0], place[:, 1], 0, 1)
            place = _step(place, off, su, sv, normal, (low, high))
        near = np.abs(off) <= 1e3 * EXACT
        moved = np.linalg.norm(at - points[rows], axis=1)
        size = np.linalg.norm(np.ptp(patch.control.reshape(-1, 3), axis=0))
        result[rows[near & (moved < 0.05 * size)]] = at[near & (moved < 0.05 * size)]
    return result


def _step(place: Floats, off: Floats, su: Floats, sv: Floats, normal: Floats, box: tuple[Floats, Floats]) -> Floats:
    """One Newton step; at an edge of the patch, along the edge."""
    gradient = np.stack([su @ normal, sv @ normal], axis=1)
    metric = np.maximum(np.stack([(su**2).sum(axis=1), (sv**2).sum(axis=1)], axis=1), 1e-300)
    for _ in range(2):
        way = gradient / metric
        slope = (gradient * way).sum(axis=1)
        step = -off[:, None] * way / np.where(slope > 0, slope, np.inf)[:, None]
        target = (place + step).clip(*box)
        # A direction that ends at the edge is given up, and the other one takes its share.
        gradient = np.where(target == place + step, gradient, 0.0)
        if np.array_equal(target, place + step):
            break
    return np.asarray(target)
