"""A tensor-product spline space that is finer in one rectangle: hierarchical B-splines of two levels.

Knots of a tensor product run through the whole surface. Those that only one rectangle needs belong to a second space
over it, of which the functions count that vanish at its edges inside the surface, as do their first ``degree - 1``
derivatives: beyond the edges the surface stays in the first space, and across them it is as smooth as any spline
(D. R. Forsey, R. H. Bartels, "Hierarchical B-spline refinement", Computer Graphics 22(4), 1988, 205-212).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.sparse import csr_array, hstack

from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

__all__ = ["RefinedSpace", "Space", "abscissae", "finest", "from_abscissae", "neighbours", "outer_of", "padded"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RefinedSpace:
    """A tensor space, and a finer one over a rectangle of it.

    The coefficients of ``outer`` come first; those of the ``inner`` functions of ``fine`` follow and add to them.

    Parameters
    ----------
    outer : TensorSpace
        Space of the whole surface. The rectangle's edges are knots of it.
    fine : TensorSpace
        Space over the rectangle. Its knots contain those of ``outer`` there.
    """

    outer: TensorSpace
    fine: TensorSpace

    @property
    def degree(self) -> int:
        """Degree in both directions."""
        return self.outer.degree

    @property
    def knots_u(self) -> Floats:
        """Knots of the whole surface in u."""
        return self.outer.knots_u

    @property
    def knots_v(self) -> Floats:
        """Knots of the whole surface in v."""
        return self.outer.knots_v

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return self.outer.size + len(self.inner)

    @property
    def rectangle(self) -> tuple[float, float, float, float]:
        """The rectangle (u0, u1, v0, v1) that is finer."""
        u, v = self.fine.knots_u, self.fine.knots_v
        return float(u[0]), float(u[-1]), float(v[0]), float(v[-1])

    @cached_property
    def inner(self) -> Ints:
        """Numbers of the functions of ``fine`` that vanish at the edges of the rectangle inside the surface."""
        masks = []
        for own, whole in ((self.fine.knots_u, self.knots_u), (self.fine.knots_v, self.knots_v)):
            mask = np.ones(len(own) - self.degree - 1, bool)
            if own[0] > whole[0]:
                mask[: self.degree] = False
            if own[-1] < whole[-1]:
                mask[-self.degree :] = False
            masks.append(mask)
        return np.flatnonzero((masks[0][:, None] & masks[1]).ravel())

    def support(self, index: int) -> tuple[float, float, float, float]:
        """Return the rectangle (u0, u1, v0, v1) outside of which a function is zero."""
        beyond = index - self.outer.size
        return self.outer.support(index) if beyond < 0 else self.fine.support(int(self.inner[beyond]))

    def matrix(self, plane: Floats) -> csr_array:
        """Return the sparse (n, size) collocation matrix of (n, 2) places."""
        return csr_array(hstack([self.outer.matrix(plane), self.fine_matrix(plane)], format="csr"))

    def fine_matrix(self, plane: Floats) -> csr_array:
        """Return the columns of the matrix that belong to the finer functions."""
        u0, u1, v0, v1 = self.rectangle
        at = np.clip(plane, (u0, v0), (u1, v1))
        index, values = self.fine.rows(at)
        column = np.full(self.fine.size, -1)
        column[self.inner] = np.arange(len(self.inner))
        index = column[index]
        acting = (index >= 0) & (values != 0) & (at == plane).all(axis=1)[:, None]
        pointer = np.append(0, np.cumsum(acting.sum(axis=1)))
        return csr_array((values[acting], index[acting], pointer), shape=(len(plane), len(self.inner)))

    def with_outer(self, outer: TensorSpace) -> RefinedSpace:
        """Return the space with other knots outside the rectangle."""
        return RefinedSpace(outer, self.fine)

    def split(self, coefficients: Floats) -> tuple[Floats, Floats]:
        """Return the coefficients of ``outer`` and of ``fine``, zeros included, (size,) or (size, k) each."""
        fine = np.zeros((self.fine.size, *coefficients.shape[1:]))
        fine[self.inner] = coefficients[self.outer.size :]
        return coefficients[: self.outer.size], fine


#: What the control net of a fitted surface may lie in.
Space = TensorSpace | RefinedSpace


def abscissae(space: TensorSpace) -> Floats:
    """Return the (size, 2) Greville abscissae of a space."""
    u, v = (bspline.greville(knots, space.degree) for knots in (space.knots_u, space.knots_v))
    return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)


def from_abscissae(space: Space, value: Callable[[Floats], Floats]) -> Floats:
    """Return the coefficients (size, ...) that are the values of a function of (n, 2) places at the abscissae.

    Schoenberg's approximation: a linear function is met.
    """
    if isinstance(space, TensorSpace):
        return value(abscissae(space))
    outer, at = value(abscissae(space.outer)), abscissae(space.fine)[space.inner]
    return np.concatenate([outer, value(at) - space.outer.matrix(at) @ outer])


def outer_of(space: Space) -> TensorSpace:
    """Return the space that the surface lies in where nothing is finer."""
    return space if isinstance(space, TensorSpace) else space.outer


def finest(space: Space) -> Bools:
    """Return (size,) the functions that pass through a core's points: the finer ones; all where none are finer."""
    return np.arange(space.size) >= (0 if isinstance(space, TensorSpace) else space.outer.size)


def padded(space: Space, coefficients: Floats) -> Floats:
    """Return coefficients of ``outer_of(space)`` as those of the space."""
    finer = np.zeros((space.size - len(coefficients), *coefficients.shape[1:]))
    return np.concatenate([coefficients, finer])


def neighbours(space: Space, some: Bools) -> Bools:
    """Return (size,) which functions of a space are among some, or next to them on their level."""
    if isinstance(space, TensorSpace):
        around = sliding_window_view(np.pad(some.reshape(space.shape), 1), (3, 3))
        return np.asarray(around.any(axis=(2, 3)).ravel())
    outer, fine = space.split(some.astype(float))
    finer = neighbours(space.fine, fine > 0)[space.inner]
    return np.concatenate([neighbours(space.outer, outer > 0), finer])
