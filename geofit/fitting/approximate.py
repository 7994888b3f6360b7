"""The periphery: approximated within the tolerance, its boundary taken from the core (paper, sec. 3.2, step 2).

The smoothest surface for the data's own noise comes first. Points that it leaves outside the tolerance are then
met by the smallest change of the control points around them, as the core's points are: what lies between them
stays the regional field's, where a surface bent as a whole would swing between points that disagree.

The control points that act on the core stay as the core has them; they are eliminated from the unknowns, not
penalised. Neighbouring patches therefore share their edge curve, and their tangent planes, to the last digit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from geofit.fitting.skin import regularized_correction
from geofit.splines.refined import Space
from geofit.splines.tensor import Factor, TensorSpace, band_times

__all__ = ["Approximation", "approximate", "fixed_by_core", "solved_beside", "swinging_points"]

Floats = NDArray[np.float64]

#: Where a corrected point comes to lie, as a share of the tolerance.
RIM = 0.9
#: How many times the largest misfit around a point the control points there may move to meet it.
SWING = 3.0


@dataclass(frozen=True, eq=False)
class Approximation:
    """Coefficients, the misfit (m,) at the peripheral points in metres, and the rounds it took.

    ``released`` (m,) marks the points that were let go, because they contradict their neighbours.
    """

    coefficients: Floats
    misfit: Floats
    rounds: int
    released: NDArray[np.bool_]


def fixed_by_core(space: TensorSpace, core: tuple[float, float, float, float]) -> NDArray[np.bool_]:
    """Return (nu, nv) bool: the control points that act inside the core's rectangle."""
    p = space.degree
    masks = []
    for knots, low, high in ((space.knots_u, core[0], core[1]), (space.knots_v, core[2], core[3])):
        count = len(knots) - p - 1
        edge = 1e-12 * max(abs(low), abs(high), 1.0)
        masks.append((knots[:count] < high - edge) & (knots[p + 1 : p + 1 + count] > low + edge))
    return masks[0][:, None] & masks[1][None, :]


def approximate(
    space: Space,
    start: Floats,
    frozen: NDArray[np.bool_],
    plane: Floats,
    height: Floats,
    tolerance: float | Floats,
    limit: float | Floats,
    rounds: int,
    strict: bool = False,
) -> Approximation:
    """Bring every point that lies beyond a limit within the tolerance; no frozen control point moves.

    Neighbours that contradict each other are let go: control points that both share would have to move by several
    times their misfits, and the surface with them where no point sees it.

    Parameters
    ----------
    space : TensorSpace or RefinedSpace
        The space of the whole surface.
    start : (size,) or (size, k) array
        Coefficients of the field; those that are frozen stay.
    frozen : (size,) array of bool
        Control points borrowed from the core.
    plane : (m, 2) array
        Places of the peripheral points.
    height : (m,) or (m, k) array
        Their heights (or coordinates), metres.
    tolerance : float or (m,) array
        How far from the surface a point that is corrected may lie, metres.
    limit : float or (m,) array
        How far away it must lie to be corrected at all: the tolerance, or more where its noise explains it.
    rounds : int
        Cap of the number of rounds; with none, points outside the tolerance stay there.
    strict : bool
        Whether no point is let go.
    """
    matrix = space.matrix(plane)
    tolerance, limit = (np.broadcast_to(one, len(plane)) for one in (tolerance, limit))
    best = start
    misfit = height - matrix @ best
    first = _size(misfit)
    held, released = (np.zeros(len(plane), bool) for _ in range(2))
    done = 0
    while done < rounds and (_size(misfit) > limit)[~released].any():
        done += 1
        held |= (_size(misfit) > limit) & ~released
        # Points that are corrected once stay at the rim of their tolerance while their neighbours are corrected.
        length = _size(misfit[held])
        rim = RIM * tolerance[held]
        share = (1 - rim / np.maximum(length, rim)).reshape(-1, *[1] * (misfit.ndim - 1))
        corrected = best + regularized_correction(csr_array(matrix[held]), share * misfit[held], ~frozen)
        swinging = np.zeros(len(plane), bool) if strict else swinging_points(matrix, corrected - start, first, held)
        if swinging.any():
            released |= swinging
            best, misfit, held = start, height - matrix @ start, np.zeros(len(plane), bool)
            continue
        after = height - matrix @ corrected
        before, left = (np.maximum(_size(one) - limit, 0)[~released].sum() for one in (misfit, after))
        if left >= 0.98 * before:
            break
        best, misfit = corrected, after
    return Approximation(best, _size(misfit), done, released)


def swinging_points(
    matrix: csr_array, change: Floats, misfit: Floats, held: NDArray[np.bool_], times: float = SWING
) -> NDArray[np.bool_]:
    """Return (m,) which of the points that are held make the surface swing around them.

    There a control point moves by more than so many ``times`` the largest misfit around.
    """
    acting = csr_array(matrix[held])
    moved = _size(change)[acting.indices] * (acting.data > 0)
    moved = np.maximum.reduceat(moved, acting.indptr[:-1]) if acting.nnz else np.zeros(0)
    # The largest misfit of those that share a control point.
    rows = np.repeat(np.arange(acting.shape[0]), np.diff(acting.indptr))
    around = np.zeros(matrix.shape[1])
    np.maximum.at(around, acting.indices, misfit[held][rows])
    largest = np.maximum.reduceat(around[acting.indices], acting.indptr[:-1]) if acting.nnz else np.zeros(0)
    result = np.zeros(len(held), bool)
    result[np.flatnonzero(held)[moved > times * largest]] = True
    return result


def solved_beside(
    space: TensorSpace,
    energy: Floats,
    start: Floats,
    frozen: NDArray[np.bool_],
    plane: Floats,
    height: Floats,
    weight: Floats,
) -> Floats:
    """Return the penalised least squares of (m, 2) places with heights (m,) beside control points that are frozen.

    ``energy`` is the band of the penalty, ``start`` holds the frozen coefficients; the others of it do not matter.
    """
    band, right = space.normal_equations(plane, height, weight)
    band = band + energy
    if frozen.any():
        known = start.copy()
        known[~frozen] = 0.0
        right -= band_times(band, known)
        right[frozen] = start[frozen]
        band[:, frozen] = 0.0
        for k in range(1, len(band)):
            band[k, : space.size - k][frozen[k:]] = 0.0
        band[0, frozen] = 1.0
    solution = Factor(band).solve(right)
    solution[frozen] = start[frozen]
    return solution


def _size(misfit: Floats) -> Floats:
    return np.abs(misfit) if misfit.ndim == 1 else np.linalg.norm(misfit, axis=1)
