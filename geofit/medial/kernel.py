"""The field of one metaball: linear inside its visible radius, quadratic to its reach, 0 beyond.

Guo, Peng and Li 1999, step 5, after Gascuel 1993 and Bittar, Tsingos and Gascuel 1995. With the iso value 1, the
visible radius e and the slope k = -s / e at it,

    f = 1 + k (r - e)                for r <= e,
    f = ((R - r) / (R - e))^2        for e < r <= R,

and f is C1 at e and R if and only if R = e - 2 / k = e (1 + 2 / s).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["STIFFNESS", "kernel", "kernel_slope", "reach", "visible_radius"]

Floats = NDArray[np.float64]

#: s = |k| e: with 4 a ball acts to 1.5 times its radius. Larger is stiffer, with a rippled seam between two balls.
STIFFNESS = 4.0


def reach(radius: ArrayLike, stiffness: float = STIFFNESS) -> Floats:
    """Return the radii beyond which balls of visible radii have no effect."""
    return np.asarray(radius, dtype=np.float64) * (1.0 + 2.0 / stiffness)


def kernel(distance: ArrayLike, radius: ArrayLike, stiffness: float = STIFFNESS) -> Floats:
    """Return the field at distances from the centre of balls of visible radii; arrays broadcast."""
    r, e = np.asarray(distance, dtype=np.float64), np.asarray(radius, dtype=np.float64)
    t = np.maximum(reach(e, stiffness) - r, 0.0) * stiffness / (2.0 * e)
    return np.asarray(np.where(r <= e, 1.0 + stiffness * (1.0 - r / e), t * t))


def kernel_slope(distance: ArrayLike, radius: ArrayLike, stiffness: float = STIFFNESS) -> Floats:
    """Return the derivative of :func:`kernel` with respect to the distance; arrays broadcast."""
    r, e = np.asarray(distance, dtype=np.float64), np.asarray(radius, dtype=np.float64)
    t = np.maximum(reach(e, stiffness) - r, 0.0) * stiffness / (2.0 * e)
    return np.asarray(np.where(r <= e, -stiffness / e, -t * stiffness / e))


def visible_radius(distance: ArrayLike, field: ArrayLike, stiffness: float = STIFFNESS) -> Floats:
    """Return the visible radii at which balls lift points at distances from a field in [0, 1] to the iso value 1.

    The inverse of :func:`kernel` in the radius: f >= 1 - F if and only if e >= r / (1 + (2 / s) (1 - sqrt(1 - F))).
    """
    q = 1.0 - np.asarray(field, dtype=np.float64)
    return np.asarray(np.asarray(distance, dtype=np.float64) / (1.0 + 2.0 / stiffness * (1.0 - np.sqrt(q))))
