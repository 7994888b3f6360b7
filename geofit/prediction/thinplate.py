"""The exact thin-plate spline at points left out, to be compared with."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, LinAlgWarning, inv
from scipy.spatial.distance import pdist, squareform

__all__ = ["thin_plate_inverse", "thin_plate_left_out"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def thin_plate_left_out(plane: Floats, z: Floats, groups: Sequence[Ints], inverse: Floats | None = None) -> Floats:
    """Return (n,) values of the thin-plate spline of all other points at the points of each group; else nan.

    One inverse Q of the spline's system serves all groups: the left-out error is Q_gg^-1 (Q z)_g (Dubrule 1983,
    Math. Geology 15, 687-699), the same to rounding as a new spline (``scipy.interpolate.RBFInterpolator``).

    Parameters
    ----------
    plane : (n, 2) array
        Places, no two alike.
    z : (n,) array
        Values.
    groups : sequence of arrays of int
        Points that are left out together.
    inverse : (n, n) array, optional
        What :func:`thin_plate_inverse` gives, where several schemes share it.
    """
    n = len(z)
    estimate = np.full(n, np.nan)
    if inverse is None:
        inverse = thin_plate_inverse(plane)
    multipliers = inverse @ z
    for group in groups:
        if n - len(group) >= 3:
            own = inverse[np.ix_(group, group)]
            if np.isfinite(own).all() and np.linalg.cond(own) < 1e12:
                estimate[group] = z[group] - np.linalg.solve(own, multipliers[group])
    return estimate


def thin_plate_inverse(plane: Floats) -> Floats:
    """Return the (n, n) part of the inverse of the spline's system that acts on values; nan where it is singular."""
    n = len(plane)
    scaled = (plane - plane.mean(axis=0)) / max(float(np.ptp(plane, axis=0).max()), 1e-300)
    r = squareform(pdist(scaled))
    with np.errstate(divide="ignore", invalid="ignore"):
        kernel = np.where(r > 0, r**2 * np.log(r), 0.0)
    system = np.zeros((n + 3, n + 3))
    system[:n, :n] = kernel
    system[:n, n:] = np.column_stack([np.ones(n), scaled])
    system[n:, :n] = system[:n, n:].T
    try:
        with warnings.catch_warnings():
            # An inverse without a correct digit is none: points in one line, or all but.
            warnings.simplefilter("error", LinAlgWarning)
            return np.asarray(inv(system, check_finite=False)[:n, :n])
    except (LinAlgError, LinAlgWarning):
        return np.full((n, n), np.nan)
