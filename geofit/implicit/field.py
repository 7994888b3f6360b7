"""What an implicit body is to every algorithm of this room: a function that is negative inside.

All lengths are metres about the local origin of the site. A field returns its value and gradient at any points, a box
that contains the body, and a bound of its gradient. A field that can bound its own values in a box more sharply
(:class:`RangedField`) saves work: whole blocks of a grid are known to contain no surface.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message

__all__ = [
    "Field",
    "FunctionField",
    "RangedField",
    "box_corners",
    "box_of",
    "moved",
    "normals",
    "points_of",
    "range_in",
]

Floats = NDArray[np.float64]
Box = tuple[Floats, Floats]


@runtime_checkable
class Field(Protocol):
    """A scalar field in space; the body is where it is negative."""

    def value(self, xyz: Floats) -> Floats:
        """Return the values at (n, 3) points as (n,) array: negative inside, positive outside."""
        ...

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradients at (n, 3) points as (n, 3) array; they point out of the body."""
        ...

    @property
    def bounds(self) -> Box:
        """Lower and upper corner, (3,) each, of a box that contains the body; infinite where it has no end."""
        ...

    @property
    def lipschitz(self) -> float:
        """Upper bound of the length of the gradient; infinite if there is none."""
        ...


@runtime_checkable
class RangedField(Field, Protocol):
    """A field that bounds its own values in boxes."""

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return lower and upper bounds, (k,) each, of the values in k boxes given by their (k, 3) corners."""
        ...


@arguments_checked
def range_in(field: Field, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Return bounds of the values of a field in boxes.

    Parameters
    ----------
    field : Field
        The field. Its own ``range_in`` is used if it has one, else the value at the centre of each box and the
        Lipschitz bound.
    lower, upper : (k, 3) array
        Corners of the boxes, metres.

    Returns
    -------
    (k,) array, (k,) array
        No value in box i is below the first or above the second.
    """
    lower, upper = box_corners(lower, upper)
    # isinstance would read the Lipschitz bound too (Python 3.11), which may cost more than all boxes.
    own = getattr(field, "range_in", None)
    if callable(own):
        low, high = own(lower, upper)
        return low, high
    if not np.isfinite(field.lipschitz):
        return np.full(len(lower), -np.inf), np.full(len(lower), np.inf)
    reach = field.lipschitz * np.linalg.norm((upper - lower) / 2, axis=1)
    centre = field.value((lower + upper) / 2)
    return centre - reach, centre + reach


@arguments_checked
def normals(field: Field, xyz: ArrayLike) -> Floats:
    """Return unit normals at (n, 3) points, outwards; zero where the gradient vanishes."""
    gradient = field.gradient(points_of(xyz))
    length = np.linalg.norm(gradient, axis=1, keepdims=True)
    return np.asarray(gradient / np.where(length > 0, length, 1.0))


def points_of(xyz: ArrayLike) -> Floats:
    """Return points as (n, 3) array of floats, row by row in memory.

    Raises
    ------
    SettingsError
        If the array has another shape.
    """
    points = np.ascontiguousarray(xyz, float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise SettingsError(
            message(
                "implicit.points-wrong-shape",
                "points have shape {shape}, but need (n, 3): give x, y, z in columns",
                shape=points.shape,
            )
        )
    return points


def box_corners(lower: ArrayLike, upper: ArrayLike) -> Box:
    """Return the corners of boxes as two (k, 3) arrays of floats.

    Raises
    ------
    SettingsError
        If an array has another shape, or there are more corners of one kind.
    """
    low, high = points_of(lower), points_of(upper)
    if len(low) != len(high):
        raise SettingsError(
            message(
                "implicit.corners-differ",
                "{lower} lower and {upper} upper corners do not make boxes: give one of each for every box",
                lower=len(low),
                upper=len(high),
            )
        )
    return low, high


def box_of(lower: ArrayLike, upper: ArrayLike) -> Box:
    """Return the two corners of a box as read-only arrays, checked.

    Raises
    ------
    SettingsError
        If a corner has not three coordinates, or a lower one is above its upper one.
    """
    low, high = (np.array(corner, float) for corner in (lower, upper))
    if low.shape != (3,) or high.shape != (3,) or not (low <= high).all():
        raise SettingsError(
            message(
                "implicit.box-empty",
                "no box lies between the corners {lower} and {upper}: give lower <= upper, three coordinates each",
                lower=low.tolist(),
                upper=high.tolist(),
            )
        )
    low.flags.writeable = high.flags.writeable = False
    return low, high


@arguments_checked
@dataclass(frozen=True, eq=False)
class FunctionField:
    """A field given by two functions of (n, 3) points.

    Parameters
    ----------
    function : callable
        Values, (n, 3) -> (n,); negative inside.
    slope : callable
        Gradients, (n, 3) -> (n, 3).
    bounds : pair of (3,) arrays
        Box that contains the body.
    lipschitz : float
        Upper bound of the length of the gradient; infinite if it is unknown.
    """

    function: Callable[[Floats], Floats]
    slope: Callable[[Floats], Floats]
    bounds: Box = (np.full(3, -np.inf), np.full(3, np.inf))
    lipschitz: float = np.inf

    def value(self, xyz: Floats) -> Floats:
        """Return the values at (n, 3) points."""
        return self.function(points_of(xyz))

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradients at (n, 3) points."""
        return self.slope(points_of(xyz))


@arguments_checked
@dataclass(frozen=True, eq=False)
class _Moved:
    field: Field
    rotation: Floats
    shift: Floats

    def value(self, xyz: Floats) -> Floats:
        return self.field.value((points_of(xyz) - self.shift) @ self.rotation)

    def gradient(self, xyz: Floats) -> Floats:
        return self.field.gradient((points_of(xyz) - self.shift) @ self.rotation) @ self.rotation.T

    @property
    def bounds(self) -> Box:
        low, high = self.field.bounds
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            return np.full(3, -np.inf), np.full(3, np.inf)
        centre = self.rotation @ ((low + high) / 2) + self.shift
        half = np.abs(self.rotation) @ ((high - low) / 2)
        return centre - half, centre + half

    @property
    def lipschitz(self) -> float:
        return self.field.lipschitz


@arguments_checked
def moved(field: Field, rotation: ArrayLike = ((1, 0, 0), (0, 1, 0), (0, 0, 1)), shift: ArrayLike = (0, 0, 0)) -> Field:
    """Return a field turned about the origin, then shifted.

    Parameters
    ----------
    field : Field
        The field.
    rotation : (3, 3) array
        Rotation matrix R; a point x of the body moves to R x + shift.
    shift : (3,) array
        Shift in metres.

    Raises
    ------
    SettingsError
        If the matrix is not a rotation.
    """
    matrix, offset = np.array(rotation, float), np.array(shift, float)
    if matrix.shape != (3, 3) or not np.allclose(matrix.T @ matrix, np.eye(3), atol=1e-9):
        raise SettingsError(
            message(
                "implicit.matrix-not-rotation",
                "the matrix {matrix} is not a rotation: its columns must be orthogonal unit vectors",
                matrix=matrix.tolist(),
            )
        )
    return _Moved(field, matrix, offset)
