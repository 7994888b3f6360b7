"""Samples on a lattice as a C2 field: the tricubic B-spline that interpolates them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, Field, box_corners, points_of
from geofit.implicit.lattice import Lattice, sample

__all__ = ["SplineGrid", "spline_grid", "spline_of_field"]

Floats = NDArray[np.float64]

#: Samples that continue each line beyond its ends: the filter forgets by 0.268 a sample, so rounding remains.
TAIL = 28


@arguments_checked
@dataclass(frozen=True, eq=False)
class SplineGrid:
    """phi(x) = sum c_ijk b(x/h - i) b(y/h - j) b(z/h - k) with cubic B-splines b; made by :func:`spline_grid`.

    Outside the box of the lattice the field is that of the nearest point of the box plus the distance to it.

    Parameters
    ----------
    lattice : Lattice
        Nodes of the samples.
    coefficients : (nx + 2, ny + 2, nz + 2) array
        c, with one more at each end.
    """

    lattice: Lattice
    coefficients: Floats

    def value(self, xyz: Floats) -> Floats:
        """Return phi at (n, 3) points."""
        from geofit.implicit.grid_loops import spline_value

        places, beyond = self._places(xyz)
        return np.asarray(spline_value(places, self.coefficients) + np.linalg.norm(beyond, axis=1))

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradient of phi at (n, 3) points."""
        return self.jet(xyz)[1]

    def jet(self, xyz: Floats) -> tuple[Floats, Floats, Floats]:
        """Return values (n,), gradients (n, 3) and Hessians (n, 3, 3); Hessians are those of the box, also outside."""
        from geofit.implicit.grid_loops import spline_jet

        places, beyond = self._places(xyz)
        value, gradient, second = spline_jet(places, self.coefficients)
        h = self.lattice.spacing
        distance = np.linalg.norm(beyond, axis=1)
        away = beyond / np.where(distance > 0, distance, 1.0)[:, None]
        xx, yy, zz, xy, xz, yz = second.T / h**2
        hessian = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3)
        return value + distance, np.where(beyond != 0, 0.0, gradient / h) + away, hessian

    def mean_curvature(self, xyz: Floats) -> Floats:
        """Return div(grad phi / |grad phi|) at (n, 3) points, 1/m: k1 + k2, positive for a ball."""
        _, g, hessian = self.jet(xyz)
        length2 = (g**2).sum(axis=1)
        along = np.einsum("ni,nij,nj->n", g, hessian, g)
        return np.asarray((length2 * np.trace(hessian, axis1=1, axis2=2) - along) / length2**1.5)

    def _places(self, xyz: Floats) -> tuple[Floats, Floats]:
        """Points in units of the spacing, moved into the box, and how far they were beyond it, metres."""
        raw = (points_of(xyz) - self.lattice.origin) / self.lattice.spacing
        places = np.clip(raw, 0, np.array(self.lattice.shape) - 1.0)
        return places, (raw - places) * self.lattice.spacing

    @property
    def bounds(self) -> Box:
        """Box of the lattice."""
        return self.lattice.bounds

    @cached_property
    def lipschitz(self) -> float:
        """Bound by the Bezier ordinates of the derivatives; outside the box the distance adds to it."""
        steps = []
        for axis in range(3):
            arrays = [np.diff(self.coefficients, axis=axis)]
            for other in {0, 1, 2} - {axis}:
                arrays = [bezier for array in arrays for bezier in _bezier(array, other)]
            steps.append(max(float(np.abs(array).max()) for array in arrays) / self.lattice.spacing)
        return max(float(np.linalg.norm(steps)), float(np.linalg.norm([*sorted(steps)[1:], 1.0])))

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds of phi in boxes: a B-spline stays between its coefficients."""
        from geofit.implicit.grid_loops import coefficient_range

        (low, near), (high, far) = map(self._places, box_corners(lower, upper))
        cells = np.array(self.lattice.shape) - 2
        first = np.clip(np.floor(low).astype(np.int64), 0, cells)
        last = np.minimum(np.maximum(np.ceil(high).astype(np.int64) - 1, first), cells) + 3
        lowest, highest = coefficient_range(first, last, self.coefficients)
        beyond = np.linalg.norm(np.maximum(np.abs(near), np.abs(far)), axis=1)
        return lowest, highest + beyond


def _bezier(c: Floats, axis: int) -> tuple[Floats, Floats, Floats]:
    """Ordinates of the Bezier pieces of a cubic B-spline along an axis: at nodes, and at the thirds between them."""
    c = np.moveaxis(c, axis, 0)
    before, at, after = c[:-2], c[1:-1], c[2:]
    ordinates = (before + 4 * at + after) / 6, (2 * at[:-1] + at[1:]) / 3, (at[:-1] + 2 * at[1:]) / 3
    a, b, d = (np.moveaxis(o, 0, axis) for o in ordinates)
    return a, b, d


@arguments_checked
def spline_grid(values: ArrayLike, lattice: Lattice) -> SplineGrid:
    """Return the tricubic B-spline through samples.

    Parameters
    ----------
    values : (nx, ny, nz) array
        Samples at the nodes, negative inside.
    lattice : Lattice
        The nodes.

    Raises
    ------
    SettingsError
        If there are more or fewer samples than nodes, or one is not finite.

    Notes
    -----
    M. Unser, Splines: a perfect fit for signal and image processing, IEEE SPM 16(6), 1999: one causal and one
    anticausal filter with the pole sqrt(3) - 2 along every axis.
    """
    from scipy.ndimage import spline_filter1d

    samples = np.asarray(values, float)
    if samples.shape != lattice.shape:
        raise SettingsError(
            message(
                "implicit.samples-wrong-shape",
                "the samples have shape {given}, the lattice {needed}: give one value a node",
                given=samples.shape,
                needed=lattice.shape,
            )
        )
    if not np.isfinite(samples).all():
        raise SettingsError(
            message(
                "implicit.samples-not-finite",
                "{count} samples are not finite: fill them first",
                count=int((~np.isfinite(samples)).sum()),
            )
        )
    coefficients = samples
    for axis in range(3):
        # Reflected about its end, a sample continues the slope: the second derivative vanishes there (natural ends).
        ends = [(TAIL, TAIL) if a == axis else (0, 0) for a in range(3)]
        filtered = spline_filter1d(
            np.pad(coefficients, ends, mode="reflect", reflect_type="odd"), 3, axis, mode="mirror"
        )
        inner = slice(TAIL - 1, TAIL + samples.shape[axis] + 1)
        coefficients = filtered[tuple(inner if a == axis else slice(None) for a in range(3))]
    coefficients = np.ascontiguousarray(coefficients)
    coefficients.flags.writeable = False
    return SplineGrid(lattice, coefficients)


@arguments_checked
def spline_of_field(field: Field, lattice: Lattice) -> SplineGrid:
    """Return the tricubic B-spline through the values of a field at the nodes of a lattice."""
    return spline_grid(sample(field, lattice), lattice)
