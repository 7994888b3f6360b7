"""Any field to the signed distance from its own surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Field
from geofit.implicit.foot import foot_points
from geofit.implicit.grid import SplineGrid, spline_grid
from geofit.implicit.lattice import Lattice, sample

__all__ = ["distance_field", "distance_samples"]

Floats = NDArray[np.float64]


@arguments_checked
def distance_field(field: Field, lattice: Lattice, *, band: float = 10.0) -> SplineGrid:
    """Return the signed distance from the surface of a field as tricubic spline on a lattice.

    Parameters
    ----------
    field : Field
        A field with that surface.
    lattice : Lattice
        Nodes of the new field.
    band : float
        Nodes nearer to the surface than this, in spacings, get their own foot point; the others the distance from the
        foot point of the nearest node of the surface, which is right to about a tenth of a spacing.

    Raises
    ------
    FitError
        If the field has one sign at all nodes.
    """
    return spline_grid(distance_samples(field, lattice, band=band), lattice)


@arguments_checked
def distance_samples(field: Field, lattice: Lattice, *, band: float = 10.0) -> Floats:
    """Return the samples of :func:`distance_field`, shape ``lattice.shape``, metres."""
    from scipy.ndimage import distance_transform_edt

    values, h = sample(field, lattice), lattice.spacing
    inside = values < 0
    crossed = np.zeros(lattice.shape, bool)
    for axis in range(3):
        change = np.diff(inside, axis=axis)
        ends = [(0, 0)] * 3
        for ends[axis] in ((0, 1), (1, 0)):
            crossed |= np.pad(change, ends)
    if not crossed.any():
        raise FitError(
            message(
                "implicit.field-of-one-sign",
                "the field has one sign at all nodes: choose a box that its surface passes through",
            )
        )
    nearest = distance_transform_edt(~crossed, return_distances=False, return_indices=True)
    xyz = lattice.nodes()
    at_surface = np.nonzero(crossed.ravel())[0]
    seeds = foot_points(field, xyz[at_surface], reach=h).xyz
    slot = np.zeros(crossed.size, np.int64)
    slot[at_surface] = np.arange(len(at_surface))
    start = seeds[slot[np.ravel_multi_index(nearest.reshape(3, -1), lattice.shape)]]
    distance = np.linalg.norm(xyz - start, axis=1)
    # The start of a node overestimates its distance by less than a spacing.
    close = distance <= (band + 1) * h
    refined = foot_points(field, xyz[close], start=start[close], reach=h)
    shorter = np.abs(refined.distance) <= distance[close] + 1e-9 * h
    distance[close] = np.where(shorter & refined.converged, np.abs(refined.distance), distance[close])
    return np.asarray(np.where(inside.ravel(), -distance, distance).reshape(lattice.shape))
