"""Metaballs: F = sum of densities times potentials, the body is where F exceeds a threshold.

Blinn 1982, Nishimura 1985, Murakami 1987, Wyvill 1986. A negative density makes a hollow; a ball with a matrix is an
ellipsoid (Liu, Jin, Wang & Hui, Computers & Graphics 31(2), 2007). The balls are sorted into the cells of a grid, so a
point looks only at those that reach it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, box_corners, points_of
from geofit.implicit.kernels import Potential, potential

__all__ = ["Metaballs", "spherical_metaballs"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Cells of the grid along the longest side of all balls, at most.
MOST_CELLS = 64


@arguments_checked
@dataclass(frozen=True, eq=False)
class Metaballs:
    """phi = (T - F) / g0 with F = sum b_i f(|A_i (x - c_i)|^2), in metres near the surface of a lone ball.

    Parameters
    ----------
    centres : (n, 3) array
        c_i, metres.
    shapes : (n, 3, 3) array
        A_i, 1/m: the identity over R for a ball of effective radius R.
    densities : (n,) array
        b_i; negative for hollows.
    kernel : Potential
        f.
    threshold : float
        T, positive.
    """

    centres: Floats
    shapes: Floats
    densities: Floats
    kernel: Potential = field(default_factory=lambda: potential("smooth"))
    threshold: float = 0.5

    def __post_init__(self) -> None:
        centres = points_of(self.centres).copy()
        shapes = np.ascontiguousarray(self.shapes, float).copy()
        densities = np.array(self.densities, float)
        n = len(centres)
        if shapes.shape != (n, 3, 3) or densities.shape != (n,):
            raise SettingsError(
                message(
                    "implicit.balls-arrays-differ",
                    "{centres} centres need as many matrices and densities, not {shapes} and {densities}",
                    centres=n,
                    shapes=len(shapes),
                    densities=len(densities),
                )
            )
        if not (np.isfinite(centres).all() and np.isfinite(shapes).all() and np.isfinite(densities).all()):
            raise SettingsError(
                message(
                    "implicit.balls-not-finite",
                    "centres, matrices and densities of balls must be finite numbers",
                )
            )
        if not self.threshold > 0:
            raise SettingsError(
                message(
                    "implicit.threshold-not-positive",
                    "the threshold {threshold} must be positive",
                    threshold=self.threshold,
                )
            )
        if not (densities > self.threshold).any() and not densities[densities > 0].sum() > self.threshold:
            raise SettingsError(
                message(
                    "implicit.density-below-threshold",
                    "no density reaches the threshold {threshold}: the body is empty",
                    threshold=self.threshold,
                )
            )
        for array in (centres, shapes, densities):
            array.flags.writeable = False
        object.__setattr__(self, "centres", centres)
        object.__setattr__(self, "shapes", shapes)
        object.__setattr__(self, "densities", densities)

    @cached_property
    def slope_scale(self) -> float:
        """g0: median over the balls with a surface of |grad F| there; else that of the steepest ball."""
        size = np.linalg.norm(self.shapes, axis=(1, 2)) / np.sqrt(3)
        alone = np.nonzero(self.densities > self.threshold)[0]
        if not len(alone):
            return float((np.abs(self.densities) * size).max()) * self.kernel.steepest
        ratio = self.threshold / self.densities[alone]
        s = np.array([self.kernel.iso_radius(float(r)) for r in ratio])
        return float(np.median(self.densities[alone] * 2 * s * np.abs(self.kernel.slope(s**2)) * size[alone]))

    @cached_property
    def _reach(self) -> Floats:
        """Half sides of the boxes about the balls, (n, 3), and r/R where each ends."""
        inverse = np.linalg.inv(self.shapes)
        return np.asarray(np.linalg.norm(inverse, axis=2) * np.sqrt(self._ends)[:, None])

    @cached_property
    def _ends(self) -> Floats:
        """(r/R)^2 at which each ball ends."""
        return np.array([self.kernel.support(self.threshold / abs(b)) ** 2 if b else 0.0 for b in self.densities])

    @cached_property
    def _cells(self) -> tuple[Floats, float, Ints, Ints, Ints]:
        """Grid of cells: corner, side, counts, and the balls of each cell as offsets into a list."""
        low, high = self.centres - self._reach, self.centres + self._reach
        corner, size = low.min(axis=0), np.ptp(np.concatenate([low, high]), axis=0)
        side = max(float(size.max()) / MOST_CELLS, float(np.median(self._reach)) / 2, 1e-12)
        counts = np.floor(size / side).astype(np.int64) + 1
        first = np.floor((low - corner) / side).astype(np.int64)
        last = np.minimum(np.floor((high - corner) / side).astype(np.int64), counts - 1)
        cells, balls = [], []
        for i in range(len(first)):
            ranges = [np.arange(first[i, a], last[i, a] + 1) for a in range(3)]
            inside = np.ravel_multi_index(np.meshgrid(*ranges, indexing="ij"), tuple(counts)).ravel()
            cells.append(inside)
            balls.append(np.full(len(inside), i))
        cell, ball = np.concatenate(cells), np.concatenate(balls)
        order = np.argsort(cell, kind="stable")
        start = np.searchsorted(cell[order], np.arange(int(np.prod(counts)) + 1))
        return corner, side, counts, start.astype(np.int64), ball[order].astype(np.int64)

    def value(self, xyz: Floats) -> Floats:
        """Return phi at (n, 3) points."""
        from geofit.implicit.blob_loops import density

        total = density(points_of(xyz), *self._cells, *self._balls)
        return np.asarray((self.threshold - total) / self.slope_scale)

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradient of phi at (n, 3) points."""
        from geofit.implicit.blob_loops import density_gradient

        total = density_gradient(points_of(xyz), *self._cells, *self._balls)
        return np.asarray(-total / self.slope_scale)

    @property
    def _balls(self) -> tuple[Floats, Floats, Floats, Floats, int]:
        return self.centres, self.shapes, self.densities, self._ends, self.kernel.code

    @property
    def bounds(self) -> Box:
        """Box of the balls with a positive density."""
        solid = self.densities > 0
        reach = self._reach[solid]
        return (self.centres[solid] - reach).min(axis=0), (self.centres[solid] + reach).max(axis=0)

    @cached_property
    def lipschitz(self) -> float:
        """Largest sum, over the cells of the grid, of the steepest slopes of the balls that reach the cell."""
        _, _, _, start, ball = self._cells
        steep = np.abs(self.densities) * self.kernel.steepest * np.linalg.norm(self.shapes, ord=2, axis=(1, 2))
        total = np.append(0.0, np.cumsum(steep[ball]))
        return float((total[start[1:]] - total[start[:-1]]).max()) / self.slope_scale

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds of phi in boxes: each potential is monotone in q, and q is bounded in a box."""
        from geofit.implicit.blob_loops import density_range

        lower, upper = box_corners(lower, upper)
        lowest, highest = density_range(lower, upper, *self._balls)
        return (self.threshold - highest) / self.slope_scale, (self.threshold - lowest) / self.slope_scale


@arguments_checked
def spherical_metaballs(
    centres: ArrayLike,
    radii: ArrayLike,
    densities: ArrayLike = 1.0,
    *,
    kernel: str = "smooth",
    threshold: float = 0.5,
) -> Metaballs:
    """Return spherical metaballs.

    Parameters
    ----------
    centres : (n, 3) array
        Centres, metres.
    radii : (n,) array or float
        Effective radii R, metres; Blinn's e^(-a r^2) has R = 1/sqrt(a).
    densities : (n,) array or float
        Value at the centre; negative for hollows.
    kernel : str
        Name of a potential of :data:`geofit.implicit.kernels.POTENTIALS`.
    threshold : float
        Value of F on the surface.

    Raises
    ------
    SettingsError
        If a radius is not positive, or the body is empty.

    Examples
    --------
    >>> body = metaballs([[0, 0, 0], [1, 0, 0]], radii=1.0)
    >>> body.value(np.array([[0.5, 0, 0], [3.0, 0, 0]])) < 0
    array([ True, False])
    """
    points = points_of(centres)
    reach = np.broadcast_to(np.asarray(radii, float), len(points))
    if not (np.isfinite(reach) & (reach > 0)).all():
        raise SettingsError(
            message(
                "implicit.radius-not-positive-ball",
                "the smallest radius, {radius}, must be positive",
                radius=float(np.min(reach)),
            )
        )
    shapes = np.eye(3) / reach[:, None, None]
    weight = np.broadcast_to(np.asarray(densities, float), len(points))
    return Metaballs(points, shapes, weight, potential(kernel), threshold)
