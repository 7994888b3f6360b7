"""Contours of a field on any plane: closed and open lines on levels, vertical sections, inclined planes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.geometry.chains import chains_of
from geofit.implicit.field import Field
from geofit.implicit.roots import roots_between

__all__ = ["Contour", "field_contours"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Contour:
    """A line on which the field is zero.

    Parameters
    ----------
    xyz : (k, 3) array
        Its vertices, metres, in order; each on the surface and on the plane.
    closed : bool
        Whether the last vertex is joined to the first, which is not repeated.
    """

    xyz: Floats
    closed: bool


@arguments_checked
def field_contours(
    field: Field, origin: ArrayLike, along: ArrayLike, up: ArrayLike, *, size: tuple[float, float], spacing: float
) -> tuple[Contour, ...]:
    """Return the lines in which the surface of a field meets a rectangle of a plane.

    Parameters
    ----------
    field : Field
        phi.
    origin : (3,) array
        A corner of the rectangle, metres.
    along, up : (3,) array
        Directions of its sides, orthogonal, of any length.
    size : (2,) array_like
        Lengths of its sides along both, metres.
    spacing : float
        Largest distance of the nodes at which phi is sampled, metres.

    Raises
    ------
    SettingsError
        If the directions are not orthogonal, or a length is not positive.
    """
    u, v = (np.asarray(d, float) / max(float(np.linalg.norm(d)), 1e-300) for d in (along, up))
    if not np.isclose(np.linalg.norm(u), 1) or not np.isclose(np.linalg.norm(v), 1) or abs(u @ v) > 1e-9:
        raise SettingsError(
            message(
                "implicit.directions-not-orthogonal",
                "the directions {along} and {up} must be orthogonal and not zero",
                along=u.tolist(),
                up=v.tolist(),
            )
        )
    if not (min(size) > 0 and spacing > 0):
        raise SettingsError(
            message(
                "implicit.rectangle-not-positive",
                "the rectangle {size} and the spacing {spacing} must be positive lengths",
                size=size,
                spacing=spacing,
            )
        )
    counts = [int(np.ceil(s / spacing - 1e-9)) + 1 for s in size]
    s, t = (np.linspace(0, side, n) for side, n in zip(size, counts, strict=True))
    nodes = np.asarray(origin, float) + s[:, None, None] * u + t[None, :, None] * v
    values = field.value(nodes.reshape(-1, 3)).reshape(len(s), len(t))
    inside = values < 0

    # Edges along u have the numbers of their first nodes; those along v follow.
    number = np.arange(inside.size).reshape(inside.shape)
    across_u, across_v = inside[1:] != inside[:-1], inside[:, 1:] != inside[:, :-1]
    first = np.concatenate([number[:-1][across_u], number[:, :-1][across_v]])
    second = np.concatenate([number[1:][across_u], number[:, 1:][across_v]])
    edge = np.concatenate([number[:-1][across_u], inside.size + number[:, :-1][across_v]])
    flat, f = nodes.reshape(-1, 3), values.ravel()
    step = flat[second] - flat[first]
    share = roots_between(field, flat[first], step, f[first], f[second])
    xyz = flat[first] + share[:, None] * step
    pairs = _segments(field, nodes, inside, number)
    order = np.argsort(edge)
    pairs = order[np.searchsorted(edge[order], pairs)]
    return tuple(_line(xyz, chain) for chain in chains_of(pairs, len(xyz)))


def _segments(field: Field, nodes: Floats, inside: NDArray[np.bool_], number: Ints) -> Ints:
    """Pairs of edges that are joined in a cell, (k, 2), by marching squares."""
    a, b, c, d = inside[:-1, :-1], inside[1:, :-1], inside[1:, 1:], inside[:-1, 1:]
    bottom, top = number[:-1, :-1], number[:-1, 1:]
    left, right = number.size + number[:-1, :-1], number.size + number[1:, :-1]
    sides = np.stack([bottom, right, top, left], axis=-1)
    cut = np.stack([a != b, b != c, c != d, d != a], axis=-1)
    simple = cut.sum(axis=-1) == 2
    pairs = [sides[simple][cut[simple]].reshape(-1, 2)]
    saddle = cut.all(axis=-1)
    if saddle.any():
        middle = (nodes[:-1, :-1][saddle] + nodes[1:, 1:][saddle]) / 2
        # The diagonal whose sign the middle has stays whole: the other two corners are cut off.
        whole = (field.value(middle) < 0) == a[saddle]
        around = sides[saddle]
        cut_off = np.where(whole[:, None], around, np.roll(around, 1, axis=1))
        pairs += [cut_off[:, :2], cut_off[:, 2:]]
    return np.concatenate(pairs)


def _line(xyz: Floats, chain: Ints) -> Contour:
    closed = bool(chain[0] == chain[-1])
    return Contour(xyz[chain[:-1] if closed else chain], closed)
