"""Sphere tracing: where rays meet the surface of a field, and where a straight hole enters and leaves a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Field, normals, points_of
from geofit.implicit.roots import roots_between

__all__ = ["Crossing", "Hits", "first_hits", "hole_crossings"]

Floats = NDArray[np.float64]

#: Least step in metres: two crossings of a ray that are nearer to each other may both be missed.
RESOLUTION = 1e-3


@dataclass(frozen=True, eq=False)
class Hits:
    """First meetings of n rays with a surface.

    Parameters
    ----------
    depth : (n,) array
        Distance along each ray, metres; NaN where it misses.
    xyz, normal : (n, 3) array
        Points and outward unit normals; NaN where a ray misses.
    entering : (n,) array of bool
        Whether the ray goes into the body there.
    """

    depth: Floats
    xyz: Floats
    normal: Floats
    entering: NDArray[np.bool_]


@dataclass(frozen=True)
class Crossing:
    """Where a hole crosses the surface of a body: depth along the hole in metres, and whether it enters."""

    depth: float
    entering: bool


@arguments_checked
def first_hits(
    field: Field, origins: ArrayLike, directions: ArrayLike, *, length: float, resolution: float = RESOLUTION
) -> Hits:
    """Return where rays first cross the surface of a field.

    Parameters
    ----------
    field : Field
        A field with a finite Lipschitz bound: a step of |phi| / bound cannot pass through the surface.
    origins, directions : (n, 3) array
        Rays; the directions may have any length.
    length : float
        How far to look, metres.
    resolution : float
        Least step, metres: a chord shorter than this may be missed.

    Raises
    ------
    SettingsError
        If the field has no finite Lipschitz bound, or a direction is zero.

    Notes
    -----
    J. Hart, Sphere tracing, The Visual Computer 12, 1996.
    """
    start = points_of(origins)
    along = _unit(directions)
    march = _March(field, start, along, length, resolution)
    depth, entering = march.next()
    xyz = start + depth[:, None] * along
    normal = np.full_like(xyz, np.nan)
    hit = np.isfinite(depth)
    normal[hit] = normals(field, xyz[hit])
    return Hits(depth, xyz, normal, entering)


@arguments_checked
def hole_crossings(
    field: Field, collars: ArrayLike, directions: ArrayLike, *, length: float, resolution: float = RESOLUTION
) -> tuple[tuple[Crossing, ...], ...]:
    """Return all depths at which straight holes enter and leave a body.

    Parameters
    ----------
    field : Field
        A field with a finite Lipschitz bound.
    collars, directions : (n, 3) array
        Where the holes begin, metres, and where they point.
    length : float
        Their length, metres.
    resolution : float
        Least step, metres: a piece of the body thinner than this along the hole may be missed.

    Returns
    -------
    tuple of n tuples of Crossing
        For each hole, from its collar down.

    Raises
    ------
    SettingsError
        If the field has no finite Lipschitz bound, or a direction is zero.
    """
    start = points_of(collars)
    march = _March(field, start, _unit(directions), length, resolution)
    found: list[list[Crossing]] = [[] for _ in start]
    while True:
        depth, entering = march.next()
        hit = np.nonzero(np.isfinite(depth))[0]
        if not len(hit):
            return tuple(map(tuple, found))
        for i in hit:
            found[i].append(Crossing(float(depth[i]), bool(entering[i])))


def _unit(directions: ArrayLike) -> Floats:
    vectors = points_of(directions)
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    if not (size > 0).all():
        raise SettingsError(
            message("implicit.direction-zero", "direction {number} is zero", number=int(np.argmin(size)))
        )
    return np.asarray(vectors / size)


class _March:
    """Rays that go from crossing to crossing."""

    def __init__(self, field: Field, start: Floats, along: Floats, length: float, resolution: float) -> None:
        if not np.isfinite(field.lipschitz):
            raise SettingsError(
                message(
                    "implicit.lipschitz-bound-missing",
                    "the field has no finite Lipschitz bound: give its region, or reinitialize it on a lattice",
                )
            )
        if not resolution > 0:
            raise SettingsError(
                message(
                    "implicit.resolution-not-positive",
                    "the resolution {resolution} must be a positive length",
                    resolution=resolution,
                )
            )
        self.field, self.start, self.along, self.resolution = field, start, along, resolution
        self.slowness = 1 / max(field.lipschitz, 1e-300)
        low, high = field.bounds
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (low - start) / along, (high - start) / along
        # 0/0: the ray runs along a side of the box.
        near = np.nan_to_num(np.minimum(a, b), nan=-np.inf, posinf=np.inf, neginf=-np.inf).max(axis=1)
        far = np.nan_to_num(np.maximum(a, b), nan=np.inf, posinf=np.inf, neginf=-np.inf).min(axis=1)
        # A step of slack on both sides: a body may touch its box.
        self.t = np.clip(near - resolution, 0, length)
        self.end = np.minimum(far + resolution, length)
        self.end[near > far + resolution] = -1.0
        self.f = field.value(self._at(np.arange(len(start))))

    def _at(self, i: NDArray[np.intp]) -> Floats:
        return np.asarray(self.start[i] + self.t[i, None] * self.along[i])

    def next(self) -> tuple[Floats, NDArray[np.bool_]]:
        """Return depth (NaN: none) and direction of the next crossing of every ray, and go past it."""
        depth = np.full(len(self.start), np.nan)
        entering = np.zeros(len(self.start), bool)
        active = np.nonzero(self.t < self.end)[0]
        while len(active):
            before, f = self.t[active], self.f[active]
            step = np.maximum(np.abs(f) * self.slowness, self.resolution)
            self.t[active] = np.minimum(before + step, self.end[active])
            self.f[active] = self.field.value(self._at(active))
            crossed = (self.f[active] < 0) != (f < 0)
            i = active[crossed]
            span = self.t[i] - before[crossed]
            begin = self.start[i] + before[crossed, None] * self.along[i]
            share = roots_between(self.field, begin, span[:, None] * self.along[i], f[crossed], self.f[i])
            depth[i] = before[crossed] + share * span
            entering[i] = self.f[i] < 0
            active = active[~crossed & (self.t[active] < self.end[active])]
        return depth, entering
