"""Elevations that end at the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.site import Ground
from geofit.surfaces.protocol import HasElevation

__all__ = ["below_ground"]

Floats = NDArray[np.float64]


def below_ground(z: Floats, x: ArrayLike, y: ArrayLike, ground: Ground | HasElevation | None) -> Floats:
    """Return elevations, those above the ground lowered to it; as they are where the ground is not known.

    Parameters
    ----------
    z : array
        Elevations, metres; nan stays nan.
    x, y : array_like
        Map coordinates, metres; they broadcast to the shape of ``z``.
    ground : Ground, surface or None
        The ground; None lowers nothing.

    Examples
    --------
    >>> from geofit.data.site import Ground
    >>> flat = Ground(np.array([0.0, 9.0]), np.array([0.0, 9.0]), np.full((2, 2), 5.0))
    >>> below_ground(np.array([3.0, 7.0, 7.0]), [1.0, 1.0, 20.0], 1.0, flat).tolist()
    [3.0, 5.0, 7.0]
    """
    if ground is None:
        return z
    over = ground.elevation(np.asarray(x, float), np.asarray(y, float))
    return np.minimum(z, np.where(np.isnan(over), np.inf, over))
