"""Local adjustment where sigma is not yet below epsilon (paper, sec. 3.3): nothing outside a support moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.fitting.net import Net
from geofit.fitting.parametrize import Parametrization
from geofit.fitting.skin import regularized_correction

__all__ = ["adjust"]

Floats = NDArray[np.float64]

#: Share of the squared residuals that one step takes away.
SHARE = 0.7


def adjust(net: Net, parametrization: Parametrization, movable: NDArray[np.bool_], residuals: Floats) -> Net | None:
    """Pull the surface to the points that contribute most to sigma.

    Parameters
    ----------
    net : Net
        The surface.
    parametrization : Parametrization
        Places and values of all points.
    movable : (n,) array of bool
        Points that the surface may be moved to: active, and not in the core.
    residuals : (n,) array
        Distances of all points, metres.

    Returns
    -------
    Net or None
        The adjusted surface; the core's control points stay. None if no point can be met.
    """
    candidates = np.flatnonzero(movable)
    squares = residuals[candidates] ** 2
    order = np.argsort(-squares, kind="stable")
    enough = int(np.searchsorted(np.cumsum(squares[order]), SHARE * squares.sum())) + 1
    worst = candidates[order[:enough]]
    if not squares.any():
        return None
    matrix = net.space.matrix(parametrization.plane[worst] / net.unit)
    misfit = parametrization.values[worst] - matrix @ net.coefficients
    change = regularized_correction(matrix, misfit, ~net.frozen)
    return replace(net, coefficients=net.coefficients + change)
