"""What a fit is: patches of one surface about a local origin, with their points and their check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.accuracy import Accuracy
from geofit.points import PointSet
from geofit.settings import FitSettings
from geofit.splines import bspline

if TYPE_CHECKING:
    from geofit.accuracy import ReadBack
    from geofit.model import Model

__all__ = ["HorizonSurface", "Partition", "Patch"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Patch:
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


@dataclass(frozen=True)
class Partition:
    """How the points were split into core and periphery, and why (paper, sec. 3.2; fig. 3a).

    ``corners`` are the core's four corners in map coordinates (None without a core), ``core`` and
    ``periphery`` count points, ``reason`` says in words what was chosen.
    """

    corners: tuple[tuple[float, float], ...] | None
    core: int
    periphery: int
    reason: str


@dataclass(frozen=True, eq=False)
class HorizonSurface:
    """A fitted (or imported) surface: patches, the points they were fitted to, and the check.

    Parameters
    ----------
    patches : tuple of Patch
        The core first, if there is one.
    origin : (3,) array
        Offset that turns the patches' coordinates into map coordinates, metres.
    points : PointSet
        All original points.
    settings : FitSettings
        Settings of the fit.
    name : str
        Name of the horizon.
    outline : (k, 2) array or None
        Plan polygon (map coordinates, not closed) that trims the surface; None: not trimmed.
    partition : Partition or None
        The split into core and periphery.
    core : (n,) array of bool
        Which points the surface interpolates exactly.
    accuracy : Accuracy or None
        The check; None only while the fit is under way.
    fit : mapping
        Figures of the fit for the report: control points, energy, smoothing, iterations, seconds a stage.
    model : Model or None
        What stands behind the patches of a fit; None for an imported surface.
    """

    patches: tuple[Patch, ...]
    origin: Floats
    points: PointSet
    settings: FitSettings = field(default_factory=FitSettings)
    name: str = "horizon"
    outline: Floats | None = None
    partition: Partition | None = None
    core: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    accuracy: Accuracy | None = None
    fit: Mapping[str, Any] = field(default_factory=dict)
    model: Model | None = None

    def with_(self, **changes: Any) -> HorizonSurface:
        """Return a copy with some fields replaced."""
        return replace(self, **changes)

    @property
    def control_points(self) -> int:
        """Number of control points; rows that two patches share count once for each."""
        return sum(patch.control.shape[0] * patch.control.shape[1] for patch in self.patches)

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the height at map coordinates in metres, nan outside; arrays broadcast.

        Where the surface stands over a place more than once (an overturned fold), the highest.
        """
        from geofit.geometry.distance import elevation

        return elevation(self, x, y)

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance of (n, 3) map coordinates, metres, positive above."""
        from geofit.geometry.distance import project

        return project(self.patches, np.atleast_2d(np.asarray(xyz, float)) - self.origin).distance

    def adjust(self, patch: str, i: int, j: int, dz: float) -> HorizonSurface:
        """Return the surface with one control point moved by hand; see :func:`geofit.handwork.adjust`."""
        from geofit.handwork import adjust

        return adjust(self, patch, i, j, dz)

    def pull_to(self, point: int | ArrayLike, share: float = 1.0) -> HorizonSurface:
        """Return the surface pulled to one of its points, or to a place; see :func:`geofit.handwork.pull_to`."""
        from geofit.handwork import pull_to

        return pull_to(self, point, share)

    def weigh(self, patch: str, i: int, j: int, weight: float) -> HorizonSurface:
        """Return the surface with another weight of one control point; see :func:`geofit.handwork.weigh`."""
        from geofit.handwork import weigh

        return weigh(self, patch, i, j, weight)

    def to_shape(self) -> Any:
        """Return a cadquery shell of the sewn patches in map coordinates."""
        from geofit.steps.stitch import to_shape

        return to_shape(self)

    def write_step(self, path: str | PathLike[str]) -> ReadBack:
        """Write the shell as STEP AP242, read it back, and return what the reader found."""
        from geofit.io.step import write_step

        return write_step({self.name: self}, path)[self.name]


def _binomial(n: int, k: int) -> int:
    return (1, 1, 1, 1, 2, 1)[n * (n + 1) // 2 + k]
