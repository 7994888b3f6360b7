"""The periphery: approximated within the tolerance, its boundary borrowed from the core (paper, sec. 3.2, step 2).

The control points that act on the core stay as the core has them; they are eliminated from the unknowns, not
penalised. Neighbouring patches therefore share their edge curve, and their tangent planes, to the last digit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.tensor import Factor, TensorSpace, band_times

__all__ = ["Approximation", "approximate", "borrowed"]

Floats = NDArray[np.float64]

#: Pull towards the regional field where a break leaves control points free, relative to the system's diagonal.
_HOLD = 1e-7


@dataclass(frozen=True, eq=False)
class Approximation:
    """Coefficients, the misfit (m,) at the peripheral points in metres, and the rounds it took."""

    coefficients: Floats
    misfit: Floats
    rounds: int


def borrowed(space: TensorSpace, core: tuple[float, float, float, float]) -> NDArray[np.bool_]:
    """Return (nu, nv) bool: the control points that act inside the core's rectangle."""
    p = space.degree
    masks = []
    for knots, low, high in ((space.knots_u, core[0], core[1]), (space.knots_v, core[2], core[3])):
        count = len(knots) - p - 1
        edge = 1e-12 * max(abs(low), abs(high), 1.0)
        masks.append((knots[:count] < high - edge) & (knots[p + 1 : p + 1 + count] > low + edge))
    return masks[0][:, None] & masks[1][None, :]


def approximate(
    space: TensorSpace,
    energy: Floats,
    start: Floats,
    frozen: NDArray[np.bool_],
    plane: Floats,
    height: Floats,
    weight: Floats,
    tolerance: Floats,
    rounds: int,
) -> Approximation:
    """Fit the control points that are not frozen until every point lies within its tolerance.

    Points outside their tolerance gain weight, round by round; the fit stays the smoothest one for its weights.

    Parameters
    ----------
    space : TensorSpace
        The space of the whole surface.
    energy : (bandwidth + 1, size) array
        Band of lambda times the energy.
    start : (size,) or (size, k) array
        Coefficients to start from; those that are frozen stay.
    frozen : (size,) array of bool
        Control points borrowed from the core.
    plane : (m, 2) array
        Places of the peripheral points.
    height : (m,) or (m, k) array
        Their heights (or coordinates), metres.
    weight : (m,) array
        Their weights.
    tolerance : (m,) array
        How far from the surface each may lie, metres.
    rounds : int
        Cap of the number of rounds.
    """
    matrix = space.matrix(*plane.T)
    coefficients, best = start, start
    misfit = _size(height - matrix @ start)
    least = np.inf
    done = 0
    for done in range(1, rounds + 2):
        coefficients = _solve(space, energy, coefficients, frozen, plane, height, weight)
        misfit = _size(height - matrix @ coefficients)
        ratio = misfit / tolerance
        over = float(np.maximum(ratio - 1, 0).sum())
        if over < least:
            best, least = coefficients, over
        if over == 0 or done > rounds:
            break
        weight = weight * np.where(ratio > 1, np.clip(ratio**2, 2.0, 100.0), 1.0)
    return Approximation(best, _size(height - matrix @ best), done)


def _solve(
    space: TensorSpace,
    energy: Floats,
    start: Floats,
    frozen: NDArray[np.bool_],
    plane: Floats,
    height: Floats,
    weight: Floats,
) -> Floats:
    band, right = space.normal_equations(*plane.T, height, weight)
    band = band + energy
    hold = _HOLD * float(np.median(band[0]))
    band[0] += hold
    right = right + hold * start
    if frozen.any():
        known = start.copy()
        known[~frozen] = 0.0
        right -= band_times(band, known)
        right[frozen] = start[frozen]
        band[:, frozen] = 0.0
        for k in range(1, len(band)):
            band[k, : space.size - k][frozen[k:]] = 0.0
        band[0, frozen] = 1.0
    return Factor(band).solve(right)


def _size(misfit: Floats) -> Floats:
    return np.abs(misfit) if misfit.ndim == 1 else np.linalg.norm(misfit, axis=1)
