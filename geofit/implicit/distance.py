"""Distance surfaces d(x, A) = r: spheres, cylinders, tori, smooth curves, and round cones along a centre line."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, points_of

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline
    from scipy.spatial import KDTree

__all__ = ["CurveTube", "Cylinder", "RoundCones", "Sphere", "Torus"]

Floats = NDArray[np.float64]

#: Seeds a span of a curve, and Newton steps from the nearest one.
SEEDS, STEPS = 16, 12


class _Distance:
    """What all distance fields share."""

    @property
    def lipschitz(self) -> float:
        """1: the field is a distance less a radius."""
        return 1.0


def _positive(radius: float) -> float:
    if not (np.isfinite(radius) and radius > 0):
        raise SettingsError(
            message("implicit.radius-not-positive", "the radius {radius} must be a positive length", radius=radius)
        )
    return float(radius)


def _unit(direction: Floats) -> Floats:
    vector = np.array(direction, float)
    length = float(np.linalg.norm(vector))
    if vector.shape != (3,) or not length > 0:
        raise SettingsError(
            message(
                "implicit.direction-is-zero", "the direction {direction} must not be zero", direction=vector.tolist()
            )
        )
    return np.asarray(vector / length)


def _directions(offset: Floats) -> Floats:
    """Return unit vectors; zero where the offset is."""
    length = np.linalg.norm(offset, axis=1, keepdims=True)
    return np.asarray(offset / np.where(length > 0, length, 1.0))


@arguments_checked
@dataclass(frozen=True, eq=False)
class Sphere(_Distance):
    """d(x, centre) - radius, in metres.

    Parameters
    ----------
    centre : (3,) array
        Centre, metres.
    radius : float
        Radius, metres.
    """

    centre: Floats
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", np.array(self.centre, float))
        object.__setattr__(self, "radius", _positive(self.radius))

    def value(self, xyz: Floats) -> Floats:
        """Return signed distances of (n, 3) points."""
        return np.asarray(np.linalg.norm(points_of(xyz) - self.centre, axis=1) - self.radius)

    def gradient(self, xyz: Floats) -> Floats:
        """Return unit vectors from the centre."""
        return _directions(points_of(xyz) - self.centre)

    @property
    def bounds(self) -> Box:
        """Box of the sphere."""
        return self.centre - self.radius, self.centre + self.radius


@arguments_checked
@dataclass(frozen=True, eq=False)
class Cylinder(_Distance):
    """d(x, line) - radius, in metres: a circular cylinder without ends.

    Parameters
    ----------
    point : (3,) array
        A point of the axis.
    direction : (3,) array
        Direction of the axis, of any length.
    radius : float
        Radius, metres.
    """

    point: Floats
    direction: Floats
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", np.array(self.point, float))
        object.__setattr__(self, "direction", _unit(self.direction))
        object.__setattr__(self, "radius", _positive(self.radius))

    def value(self, xyz: Floats) -> Floats:
        """Return signed distances of (n, 3) points."""
        return np.asarray(np.linalg.norm(self._across(xyz), axis=1) - self.radius)

    def gradient(self, xyz: Floats) -> Floats:
        """Return unit vectors from the axis."""
        return _directions(self._across(xyz))

    def _across(self, xyz: Floats) -> Floats:
        offset = points_of(xyz) - self.point
        return np.asarray(offset - (offset @ self.direction)[:, None] * self.direction)

    @property
    def bounds(self) -> Box:
        """Finite only across a cylinder along x, y or z."""
        half = np.where(np.abs(self.direction) > 0, np.inf, self.radius)
        return self.point - half, self.point + half


@arguments_checked
@dataclass(frozen=True, eq=False)
class Torus(_Distance):
    """d(x, circle) - radius, in metres.

    Parameters
    ----------
    centre : (3,) array
        Centre of the circle.
    axis : (3,) array
        Normal of its plane, of any length.
    ring : float
        Radius of the circle, metres.
    radius : float
        Radius of the tube, metres.
    """

    centre: Floats
    axis: Floats
    ring: float
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", np.array(self.centre, float))
        object.__setattr__(self, "axis", _unit(self.axis))
        object.__setattr__(self, "ring", _positive(self.ring))
        object.__setattr__(self, "radius", _positive(self.radius))

    def value(self, xyz: Floats) -> Floats:
        """Return signed distances of (n, 3) points."""
        flat, height = self._parts(xyz)
        return np.asarray(np.hypot(np.linalg.norm(flat, axis=1) - self.ring, height) - self.radius)

    def gradient(self, xyz: Floats) -> Floats:
        """Return unit vectors from the circle; along the axis on the axis itself."""
        flat, height = self._parts(xyz)
        outward = (np.linalg.norm(flat, axis=1) - self.ring)[:, None] * _directions(flat)
        return _directions(outward + height[:, None] * self.axis)

    def _parts(self, xyz: Floats) -> tuple[Floats, Floats]:
        """Offsets from the centre in the plane of the circle, and heights above it."""
        offset = points_of(xyz) - self.centre
        height = offset @ self.axis
        return offset - height[:, None] * self.axis, height

    @property
    def bounds(self) -> Box:
        """Box of the torus."""
        half = self.ring * np.sqrt(np.maximum(1 - self.axis**2, 0)) + self.radius
        return self.centre - half, self.centre + half


@arguments_checked
@dataclass(frozen=True, eq=False)
class CurveTube(_Distance):
    """d(x, curve) - radius about the C2 cubic spline through points: a generalised cylinder with round ends.

    Parameters
    ----------
    points : (n, 3) array
        Points of the curve in order, at least 2, no two neighbours the same.
    radius : float
        Radius, metres.
    """

    points: Floats
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", _centre_line(self.points))
        object.__setattr__(self, "radius", _positive(self.radius))

    @cached_property
    def curve(self) -> CubicSpline:
        """The centre line, by the length of the chords from its first point."""
        from scipy.interpolate import CubicSpline

        chord = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return CubicSpline(np.append(0.0, np.cumsum(chord)), self.points, bc_type="natural")

    @cached_property
    def _derivatives(self) -> tuple[CubicSpline, CubicSpline]:
        return self.curve.derivative(), self.curve.derivative(2)

    @cached_property
    def _seeds(self) -> tuple[Floats, KDTree]:
        from scipy.spatial import KDTree

        curve = self.curve
        inner = curve.x[:-1, None] + np.diff(curve.x)[:, None] * np.arange(SEEDS) / SEEDS
        s = np.append(inner.ravel(), curve.x[-1])
        return s, KDTree(curve(s))

    def value(self, xyz: Floats) -> Floats:
        """Return signed distances of (n, 3) points."""
        return np.asarray(np.linalg.norm(points_of(xyz) - self._foot(xyz), axis=1) - self.radius)

    def gradient(self, xyz: Floats) -> Floats:
        """Return unit vectors from the curve."""
        return _directions(points_of(xyz) - self._foot(xyz))

    def _foot(self, xyz: Floats) -> Floats:
        curve, (first, second) = self.curve, self._derivatives
        seeds, tree = self._seeds
        s = seeds[tree.query(xyz)[1]]
        step = np.diff(seeds).max()
        low, high = np.maximum(s - step, seeds[0]), np.minimum(s + step, seeds[-1])
        for _ in range(STEPS):
            offset, tangent = curve(s) - xyz, first(s)
            slope = (offset * tangent).sum(axis=1)
            bend = (tangent**2).sum(axis=1) + (offset * second(s)).sum(axis=1)
            # Where the distance is not convex, the step of a straight line goes downhill.
            s = np.clip(s - slope / np.where(bend > 0, bend, (tangent**2).sum(axis=1)), low, high)
        return np.asarray(curve(s))

    @property
    def bounds(self) -> Box:
        """Box of the tube."""
        seeds, tree = self._seeds
        slack = self.radius + float(np.diff(seeds).max())
        return tree.data.min(axis=0) - slack, tree.data.max(axis=0) + slack


@arguments_checked
@dataclass(frozen=True, eq=False)
class RoundCones(_Distance):
    """Union of the round cones along a centre line: drifts, shafts, cave passages with a radius at each point.

    A round cone is the hull of two balls; the distance outside the union is exact.

    Parameters
    ----------
    points : (n, 3) array
        Centre line in order, at least 2 points.
    radii : (n,) array or float
        Radius at each point, metres.
    """

    points: Floats
    radii: Floats

    def __post_init__(self) -> None:
        points = _centre_line(self.points)
        radii = np.broadcast_to(np.asarray(self.radii, float), len(points)).copy()
        if not (np.isfinite(radii) & (radii > 0)).all():
            raise SettingsError(
                message(
                    "implicit.radius-not-positive-ball",
                    "the smallest radius, {radius}, must be positive",
                    radius=float(np.min(radii)),
                )
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "radii", radii)

    def value(self, xyz: Floats) -> Floats:
        """Return signed distances of (n, 3) points; inside the union a bound of them."""
        from geofit.implicit.cone_loops import nearest_cone

        return np.asarray(nearest_cone(points_of(xyz), self.points, self.radii)[0])

    def gradient(self, xyz: Floats) -> Floats:
        """Return unit vectors away from the nearest cone."""
        from geofit.implicit.cone_loops import nearest_cone

        return np.asarray(nearest_cone(points_of(xyz), self.points, self.radii)[1])

    @property
    def bounds(self) -> Box:
        """Box of the balls."""
        reach = self.radii[:, None]
        return (self.points - reach).min(axis=0), (self.points + reach).max(axis=0)


def _centre_line(points: Floats) -> Floats:
    line = np.array(points, float)
    if line.ndim != 2 or line.shape[1] != 3 or len(line) < 2 or not np.isfinite(line).all():
        raise SettingsError(
            message(
                "implicit.centre-line-too-short",
                "a centre line needs two or more points x, y, z, not an array of shape {shape}",
                shape=line.shape,
            )
        )
    same = np.nonzero((np.diff(line, axis=0) == 0).all(axis=1))[0]
    if len(same):
        raise SettingsError(
            message(
                "implicit.centre-line-points-coincide",
                "points {first} and {second} of the centre line coincide: leave one out",
                first=int(same[0]),
                second=int(same[0]) + 1,
            )
        )
    line.flags.writeable = False
    return line
