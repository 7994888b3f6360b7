"""Which points contradict each other, and what of a field's noise is noise, as the nearest points show it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

__all__ = ["CLIFF", "SHARED", "contradict", "near_noise", "neighbours_within", "off_neighbours", "torn_points"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

#: One of so many points, but at least the second number, is looked at: those with the nearest neighbours.
NEAREST, FEWEST = 3, 20
#: Share of the noise by which the nearest points must differ at least: what they share more of is relief.
SHARED = 0.5
#: Slope that two neighbours may ask for beyond the field's own.
CLIFF = 0.5
#: Points whose plane shows how far another one lies from them, and that are a point's neighbours.
AROUND = 8
#: So many times the accuracy that the points state, a field's noise is relief between them.
BEYOND = 3.0


def near_noise(plane: Floats, misfit: Floats) -> float:
    """Return the noise of points as the nearest of them show it, in units of the misfits (1 sigma).

    A field counts relief that its spans cannot follow as noise. Of that, two points share the more the nearer to each
    other they are; of noise, they share none. Single wrong points count: they are noise, too.

    Parameters
    ----------
    plane : (n, 2) array
        Places of the points.
    misfit : (n,) or (n, k) array
        What a field leaves of them.
    """
    difference, _ = _nearest(plane, misfit)
    return _noise_of(difference)


def contradict(plane: Floats, misfit: Floats, noise: float, accuracy: Floats) -> bool:
    """Return whether points contradict each other where a field takes most of their relief for noise.

    Holes far apart that scatter about every smooth surface do not: the ground varies between them. The nearest ones do
    if they share little of what the field leaves of them, and a surface through them would be steep.

    Parameters
    ----------
    plane : (n, 2) array
        Places of the points, metres.
    misfit : (n,) or (n, k) array
        What the field leaves of them, metres.
    noise : float
        The field's noise, metres.
    accuracy : (n,) array
        Stated accuracies, metres, nan where there is none. Where most points state one, it decides.
    """
    stated = np.isfinite(accuracy)
    if 2 * stated.sum() > len(plane) and noise > BEYOND * float(np.median(accuracy[stated])):
        return False
    difference, apart = _nearest(plane, misfit)
    steep = float(np.median(np.linalg.norm(difference, axis=1) - CLIFF * apart)) > 0
    return steep and _noise_of(difference) > SHARED * noise


def torn_points(
    plane: Floats,
    misfit: Floats,
    pairs: Ints,
    loose: NDArray[np.bool_],
    steepest: float,
    doubt: Callable[[], Floats],
    excused: Floats | float = 0.0,
) -> NDArray[np.bool_]:
    """Return (n,) the points to let go: of two neighbours that ask for a cliff, the more doubtful one.

    Parameters
    ----------
    plane : (n, 2) array
        Places of the points, metres.
    misfit : (n,) or (n, k) array
        What the field leaves of them, metres.
    pairs : (m, 2) array of int
        Which of them are neighbours.
    loose : (n,) array of bool
        Points that may be let go.
    steepest : float
        Slope that two neighbours may ask for.
    doubt : callable
        Returns (n,) how far each point lies from where the others see it; called where two ask for a cliff.
    excused : (n,) array or float
        How far the surface may miss each point, metres.
    """
    first, second = pairs.T
    off, missed = misfit.reshape(len(plane), -1), np.broadcast_to(excused, len(plane))
    rise = np.linalg.norm(off[first] - off[second], axis=1) - missed[first] - missed[second]
    slope = rise / np.maximum(np.linalg.norm(plane[first] - plane[second], axis=1), 1e-9)
    torn = np.zeros(len(plane), bool)
    steep = np.argsort(-slope, kind="stable")[: int((slope > steepest).sum())]
    size = doubt() if len(steep) else torn
    for both in pairs[steep]:
        if loose[both].any() and not torn[both].any():
            torn[both[np.argmax(np.where(loose[both], size[both], -1.0))]] = True
    return torn


def neighbours_within(plane: Floats, reach: float) -> Ints:
    """Return (m, 2) pairs of n points nearer to each other than ``reach``: each with its nearest, of very many."""
    apart, index = (
        np.asarray(found) for found in KDTree(plane).query(plane, k=AROUND, distance_upper_bound=reach, workers=-1)
    )
    first, column = np.nonzero(np.isfinite(apart))
    both = np.column_stack([first, index[first, column]])
    return np.unique(np.sort(both[both[:, 0] != both[:, 1]], axis=1), axis=0)


def off_neighbours(plane: Floats, value: Floats) -> Floats:
    """Return how far each of n points lies from a plane through those around it, its nearest neighbour left out.

    A field passes between two neighbours that contradict each other: of which of them is wrong, it says nothing.

    Parameters
    ----------
    plane : (n, 2) array
        Places of the points.
    value : (n,) or (n, k) array
        Heights or coordinates, metres.
    """
    count = min(AROUND + 2, len(plane))
    apart, index = (np.asarray(found)[:, 2:] for found in KDTree(plane).query(plane, k=count, workers=-1))
    unit = apart.max(axis=1, initial=1e-300)
    to = (plane[index] - plane[:, None]) / unit[:, None, None]
    weight = unit[:, None] / np.maximum(apart, 1e-3 * unit[:, None])
    rows = weight[..., None] * np.concatenate([np.ones((*to.shape[:2], 1)), to], axis=2)
    heights = value.reshape(len(plane), -1)
    normal = rows.swapaxes(1, 2) @ rows
    # Points in one line say nothing across it.
    normal[:, range(3), range(3)] += 1e-6 * normal[:, :1, 0] + 1e-300
    found = np.linalg.solve(normal, rows.swapaxes(1, 2) @ (weight[..., None] * (heights[index] - heights[:, None])))
    return np.asarray(np.linalg.norm(found[:, 0], axis=1))


def _nearest(plane: Floats, misfit: Floats) -> tuple[Floats, Floats]:
    """Return how the points with the nearest neighbours differ from them, (m, k), and how far apart they are."""
    apart, index = (np.asarray(found) for found in KDTree(plane).query(plane, k=2))
    near = np.argsort(apart[:, 1], kind="stable")[: max(len(plane) // NEAREST, FEWEST)]
    return (misfit[near] - misfit[index[near, 1]]).reshape(len(near), -1), apart[near, 1]


def _noise_of(difference: Floats) -> float:
    """Return the noise of points that differ from each other by so much, (m, k)."""
    return float(np.sqrt(np.mean(difference**2) / 2))
