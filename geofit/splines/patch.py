"""A NURBS patch: one tensor-product piece of a surface (eq. 1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.prepared import Preparing
from geofit.splines import bspline

__all__ = ["Patch", "Patches"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Patch(Preparing):
    """A NURBS patch (eq. 1) about the surface's local origin.

    Parameters
    ----------
    name : str
        "core", "west", "north-east", ... or the name of an imported face.
    degree : (int, int)
        Degrees in u and v.
    knots_u, knots_v : (m,) arrays
        Clamped knot vectors.
    control : (nu, nv, 3) array
        Control points in metres, relative to the surface's origin.
    weights : (nu, nv) array or None
        Weights of the control points; None: all 1.
    """

    name: str
    degree: tuple[int, int]
    knots_u: Floats
    knots_v: Floats
    control: Floats
    weights: Floats | None = None

    def __post_init__(self) -> None:
        # What is prepared from a patch (search trees, polynomial pieces) stays right only while its arrays do.
        for name in ("knots_u", "knots_v", "control", "weights"):
            array = getattr(self, name)
            if array is not None and array.flags.writeable:
                array = np.array(array, dtype=np.float64)
                array.setflags(write=False)
                object.__setattr__(self, name, array)

    def __repr__(self) -> str:
        (nu, nv), (p, q) = self.control.shape[:2], self.degree
        rational = "" if self.weights is None else ", rational"
        return f"<Patch {self.name}: {nu} x {nv} control points, degree {p} x {q}{rational}>"

    @property
    def domain(self) -> tuple[float, float, float, float]:
        """Parameter range (u0, u1, v0, v1)."""
        return (self.knots_u[0], self.knots_u[-1], self.knots_v[0], self.knots_v[-1])

    def evaluate(self, u: ArrayLike, v: ArrayLike, du: int = 0, dv: int = 0) -> Floats:
        """Return points, or partial derivatives, at parameters; arrays broadcast to shape (..., 3)."""
        u, v = np.asarray(u, float), np.asarray(v, float)
        if self.weights is None:
            return self._sum(self.control, u, v, du, dv)
        return self._rational(u, v, du, dv)

    def _sum(self, control: Floats, u: Floats, v: Floats, du: int, dv: int) -> Floats:
        if u.ndim == v.ndim == 2 and u.shape[1] == v.shape[0] == 1:
            # A grid, one axis after the other.
            along = bspline.collocation(self.knots_u, self.degree[0], u[:, 0], du)
            across = bspline.collocation(self.knots_v, self.degree[1], v[0], dv)
            return np.asarray(across @ np.tensordot(along, control, axes=1))
        u, v = np.broadcast_arrays(u, v)
        iu, nu = bspline.basis(self.knots_u, self.degree[0], u.ravel(), du)
        iv, nv = bspline.basis(self.knots_v, self.degree[1], v.ravel(), dv)
        rows = iu[:, None] + np.arange(self.degree[0] + 1)
        columns = iv[:, None] + np.arange(self.degree[1] + 1)
        local = control[rows[:, :, None], columns[:, None, :]]
        total: Floats = np.einsum("na,nb,nabk->nk", nu, nv, local)
        return total.reshape(*u.shape, control.shape[2])

    def _rational(self, u: Floats, v: Floats, du: int, dv: int) -> Floats:
        """Quotient rule on homogeneous coordinates (The NURBS Book, eq. 4.20), up to second order."""
        assert self.weights is not None
        homogeneous = np.concatenate([self.control * self.weights[..., None], self.weights[..., None]], axis=2)
        table: dict[tuple[int, int], Floats] = {}
        parts = {(a, b): self._sum(homogeneous, u, v, a, b) for a in range(du + 1) for b in range(dv + 1)}
        w = parts[0, 0][..., 3:]
        for a in range(du + 1):
            for b in range(dv + 1):
                total = parts[a, b][..., :3].copy()
                for i in range(a + 1):
                    for j in range(b + 1):
                        if (i, j) != (0, 0):
                            factor = _binomial(a, i) * _binomial(b, j)
                            total -= factor * parts[i, j][..., 3:] * table[a - i, b - j]
                table[a, b] = total / w
        return table[du, dv]

    def normal(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Return unit normals S_u x S_v; arrays broadcast to shape (..., 3)."""
        cross = np.cross(self.evaluate(u, v, 1, 0), self.evaluate(u, v, 0, 1))
        unit: Floats = cross / np.linalg.norm(cross, axis=-1, keepdims=True)
        return unit


def _binomial(n: int, k: int) -> int:
    return (1, 1, 1, 1, 2, 1)[n * (n + 1) // 2 + k]


class Patches(tuple[Patch, ...], Preparing):
    """The patches of one surface, with what has been prepared from them: it lives as long as they do."""

    @classmethod
    def of(cls, patches: Iterable[Patch]) -> Patches:
        """Return the patches themselves where they are already of this class."""
        return patches if isinstance(patches, cls) else cls(patches)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the patches without what was prepared from them."""
        return Patches, (tuple(self),)
