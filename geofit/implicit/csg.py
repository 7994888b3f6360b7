"""Bodies combined: union, intersection, difference, complement; sharp, blended over a radius, or by R-functions.

Sharp ones are the default, as contacts between rocks are. min and max of two distances are distances outside a union
and only bounds elsewhere: compute distances (:mod:`geofit.implicit.reinitialize`) before offsets.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, Field, range_in

__all__ = [
    "complement",
    "difference",
    "intersection",
    "r_intersection",
    "r_union",
    "sharp_union",
    "smooth_difference",
    "smooth_intersection",
    "smooth_union",
    "union",
]

Floats = NDArray[np.float64]


@arguments_checked
@dataclass(frozen=True, eq=False)
class _Complement:
    field: Field

    def value(self, xyz: Floats) -> Floats:
        return -self.field.value(xyz)

    def gradient(self, xyz: Floats) -> Floats:
        return -self.field.gradient(xyz)

    @property
    def bounds(self) -> Box:
        return np.full(3, -np.inf), np.full(3, np.inf)

    @property
    def lipschitz(self) -> float:
        return self.field.lipschitz

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        low, high = range_in(self.field, lower, upper)
        return -high, -low


@arguments_checked
@dataclass(frozen=True, eq=False)
class _Union:
    fields: tuple[Field, ...]

    def value(self, xyz: Floats) -> Floats:
        return np.asarray(np.min([f.value(xyz) for f in self.fields], axis=0))

    def gradient(self, xyz: Floats) -> Floats:
        nearest = np.argmin([f.value(xyz) for f in self.fields], axis=0)
        gradient = np.empty((len(xyz), 3))
        for i, f in enumerate(self.fields):
            gradient[nearest == i] = f.gradient(xyz[nearest == i])
        return gradient

    @property
    def bounds(self) -> Box:
        low, high = zip(*(f.bounds for f in self.fields), strict=True)
        return np.min(low, axis=0), np.max(high, axis=0)

    @property
    def lipschitz(self) -> float:
        return max(f.lipschitz for f in self.fields)

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        low, high = zip(*(range_in(f, lower, upper) for f in self.fields), strict=True)
        return np.min(low, axis=0), np.min(high, axis=0)


@arguments_checked
@dataclass(frozen=True, eq=False)
class _SmoothUnion:
    """min(f, g) - k h^3 / 6 with h = max(1 - |f - g| / k, 0): C2 across f = g and at |f - g| = k."""

    first: Field
    second: Field
    radius: float

    def value(self, xyz: Floats) -> Floats:
        f, g = self.first.value(xyz), self.second.value(xyz)
        h = np.maximum(1 - np.abs(f - g) / self.radius, 0)
        return np.asarray(np.minimum(f, g) - self.radius / 6 * h**3)

    def gradient(self, xyz: Floats) -> Floats:
        f, g = self.first.value(xyz), self.second.value(xyz)
        half = np.maximum(1 - np.abs(f - g) / self.radius, 0) ** 2 / 2
        share = np.where(f < g, 1 - half, half)[:, None]
        return share * self.first.gradient(xyz) + (1 - share) * self.second.gradient(xyz)

    @property
    def bounds(self) -> Box:
        # The blend fills in up to k/6 beyond both bodies.
        (a, b), (c, d) = self.first.bounds, self.second.bounds
        return np.minimum(a, c) - self.radius, np.maximum(b, d) + self.radius

    @property
    def lipschitz(self) -> float:
        return max(self.first.lipschitz, self.second.lipschitz)

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        (a, b), (c, d) = range_in(self.first, lower, upper), range_in(self.second, lower, upper)
        return np.minimum(a, c) - self.radius / 6, np.minimum(b, d)


@arguments_checked
@dataclass(frozen=True, eq=False)
class _RUnion:
    """f + g - sqrt(f^2 + g^2) (Rvachev): smooth but where both are zero."""

    first: Field
    second: Field

    def value(self, xyz: Floats) -> Floats:
        f, g = self.first.value(xyz), self.second.value(xyz)
        return np.asarray(f + g - np.hypot(f, g))

    def gradient(self, xyz: Floats) -> Floats:
        f, g = self.first.value(xyz), self.second.value(xyz)
        length = np.hypot(f, g)
        length = np.where(length > 0, length, 1.0)
        first, second = (1 - f / length)[:, None], (1 - g / length)[:, None]
        return np.asarray(first * self.first.gradient(xyz) + second * self.second.gradient(xyz))

    @property
    def bounds(self) -> Box:
        return _Union((self.first, self.second)).bounds

    @property
    def lipschitz(self) -> float:
        return (2 + math.sqrt(2)) * max(self.first.lipschitz, self.second.lipschitz)

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        # Rising in f and in g.
        (a, b), (c, d) = range_in(self.first, lower, upper), range_in(self.second, lower, upper)
        with np.errstate(invalid="ignore"):
            low, high = a + c - np.hypot(a, c), b + d - np.hypot(b, d)
        return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)


@arguments_checked
@dataclass(frozen=True, eq=False)
class _Within:
    """A field in a smaller box than its own: that of an intersection."""

    field: Field
    box: Box

    def value(self, xyz: Floats) -> Floats:
        return self.field.value(xyz)

    def gradient(self, xyz: Floats) -> Floats:
        return self.field.gradient(xyz)

    @property
    def bounds(self) -> Box:
        return self.box

    @property
    def lipschitz(self) -> float:
        return self.field.lipschitz

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        return range_in(self.field, lower, upper)


def _common_box(fields: tuple[Field, ...]) -> Box:
    low, high = zip(*(f.bounds for f in fields), strict=True)
    lower, upper = np.max(low, axis=0), np.min(high, axis=0)
    # Bodies that do not meet: a box without volume.
    return lower, np.maximum(lower, upper)


def _some(fields: tuple[Field, ...]) -> tuple[Field, ...]:
    if not fields:
        raise SettingsError(
            message("implicit.nothing-to-combine", "there is nothing to combine: give one field or more")
        )
    return fields


def _blend(radius: float) -> float:
    if not (np.isfinite(radius) and radius > 0):
        raise SettingsError(
            message(
                "implicit.blend-not-positive",
                "the radius {radius} of a blend must be a positive length",
                radius=radius,
            )
        )
    return float(radius)


@arguments_checked
def complement(field: Field) -> Field:
    """Return what is outside: -f."""
    return field.field if isinstance(field, _Complement) else _Complement(field)


@arguments_checked
def union(*fields: Field) -> Field:
    """Return what is in any of the bodies: min(f, g, ...)."""
    return _Union(_some(fields))


@arguments_checked
def intersection(*fields: Field) -> Field:
    """Return what is in all bodies: max(f, g, ...)."""
    return _Within(complement(_Union(tuple(map(complement, _some(fields))))), _common_box(fields))


@arguments_checked
def difference(field: Field, *others: Field) -> Field:
    """Return what is in the first body and in no other: max(f, -g, ...)."""
    return intersection(field, *map(complement, others))


def sharp_union(field: Field) -> tuple[tuple[Field, ...], bool] | None:
    """Return the bodies whose sharp union a field is, and whether it is what lies outside them; None of other fields.

    An intersection is what lies outside the union of complements.
    """
    base, outside = field, False
    while isinstance(base, _Within | _Complement):
        outside ^= isinstance(base, _Complement)
        base = base.field
    if isinstance(base, _Union):
        return base.fields, outside
    return ((base,), True) if isinstance(field, _Complement) else None


@arguments_checked
def smooth_union(first: Field, second: Field, radius: float) -> Field:
    """Return the union with its crease filled where |f - g| < radius (metres), C2."""
    return _SmoothUnion(first, second, _blend(radius))


@arguments_checked
def smooth_intersection(first: Field, second: Field, radius: float) -> Field:
    """Return the intersection with its edge rounded where |f - g| < radius (metres), C2."""
    rounded = complement(_SmoothUnion(complement(first), complement(second), _blend(radius)))
    return _Within(rounded, _common_box((first, second)))


@arguments_checked
def smooth_difference(first: Field, second: Field, radius: float) -> Field:
    """Return the first body without the second, its edge rounded, C2."""
    return smooth_intersection(first, complement(second), radius)


@arguments_checked
def r_union(first: Field, second: Field) -> Field:
    """Return the union by Rvachev's f + g - sqrt(f^2 + g^2): smooth off the common curve of both surfaces."""
    return _RUnion(first, second)


@arguments_checked
def r_intersection(first: Field, second: Field) -> Field:
    """Return the intersection by Rvachev's f + g + sqrt(f^2 + g^2)."""
    return _Within(complement(_RUnion(complement(first), complement(second))), _common_box((first, second)))
