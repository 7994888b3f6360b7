"""Places of a hole between two samples of one side: the log states their side, and no sample lies there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import BodyData

__all__ = ["between_samples"]

Floats = NDArray[np.float64]

#: Places between two neighbouring samples.
INNER = 3
#: Lengths are alike within this share of them.
ALIKE = 1e-4


def between_samples(data: BodyData, *, inside: bool) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Return places evenly spaced between the neighbouring samples of each stretch of a hole.

    Returns
    -------
    tuple
        The places (k, 3), map coordinates, metres; the length (k,) of the hole that each represents, metres; and the
        number (k,) of the sample before it.
    """
    if inside:
        xyz, hole, length = data.inside, data.inside_hole, data.inside_length
    else:
        xyz, hole, length = data.outside, data.outside_hole, data.outside_length
    if len(xyz) < 2:
        return np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.intp)
    gap = np.linalg.norm(np.diff(xyz, axis=0), axis=1)
    # Samples of one stretch have one length and lie as far apart, less on a curve; to the next stretch it is farther,
    # or its samples have another length.
    alike = np.isclose(length[1:], length[:-1], rtol=ALIKE) & (gap <= (1 + ALIKE) * length[1:])
    pair = np.flatnonzero((hole[1:] == hole[:-1]) & (hole[1:] != "") & alike)
    pair = pair[~_split(data, (xyz[pair] + xyz[pair + 1]) / 2, gap[pair] / 2, hole[pair])]
    share = np.arange(1, INNER + 1)[:, None] / (INNER + 1)
    places = xyz[pair, None] + share * (xyz[pair + 1] - xyz[pair])[:, None]
    return places.reshape(-1, 3), np.repeat(gap[pair] / (INNER + 1), INNER), np.repeat(pair, INNER)


def _split(data: BodyData, middle: Floats, half: Floats, hole: NDArray[np.str_]) -> NDArray[np.bool_]:
    """Return whether a contact of the hole lies between two samples (k,): a stretch too short for a sample is there."""
    from scipy.spatial import cKDTree

    named = np.flatnonzero(data.hole != "")
    if not len(named) or not len(middle):
        return np.zeros(len(middle), bool)
    origin = middle[0]
    near = cKDTree(data.contacts[named] - origin).query_ball_point(middle - origin, half)
    return np.array([any(data.hole[named[i]] == own for i in found) for found, own in zip(near, hole, strict=True)])
