"""The arrival field: one static front equation for the whole way from A to B."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["FLOOR", "arrival", "source_field"]

Floats = NDArray[np.float64]

#: The speed |d_B| counts as this many spacings at least: at B the front would stop.
FLOOR = 0.05
#: Surfaces that are nearer to each other than this share of a spacing are one.
TOGETHER = 1e-6
#: Layers of nodes beyond the way of the front to which its lengths are continued.
LAYERS = 8


def arrival(d_a: Floats, d_b: Floats, spacing: float) -> Floats:
    """Return u = exp(-T) of the time T at which the front from A reaches each node.

    Parameters
    ----------
    d_a, d_b : (nx, ny, nz) array
        Signed distances from both surfaces, metres.
    spacing : float
        Of the nodes, metres.

    Returns
    -------
    (nx, ny, nz) array
        1 on the surface of A, 0 on that of B; nan away from the way between them, and where no front comes.

    Notes
    -----
    |grad T| = 1 / |d_B| with T = 0 on A: the motion of Breen & Whitaker (IEEE TVCG 7, 2001), whose speed depends on the
    place only. Fast marching of second order (J. Sethian, SIAM Review 41, 1999) for u, which is smooth at B where T has
    no end; buckets in place of a heap (L. Yatziv et al., J. Comput. Phys. 212, 2006).
    """
    from geofit.morphing.arrival_loops import START, march, start_values
    from geofit.morphing.wedge_loops import wedge_angles, wedges

    floor = FLOOR * spacing
    d_a, d_b = np.ascontiguousarray(d_a), np.ascontiguousarray(d_b)
    region = (d_a < 0) != (d_b < 0)
    near = np.minimum(np.abs(d_a), np.abs(d_b)) < (START + 2) * spacing
    cosine = wedge_angles(d_a, d_b, region | near, spacing)
    factor = wedges(d_a, d_b, cosine, region | (np.abs(d_a) <= START * spacing), spacing, floor)
    u = start_values(d_a, d_b, *factor[:2], spacing, floor)
    march(u, d_b, region, *factor, spacing, floor)
    return u


def source_field(u: Floats, d_a: Floats, d_b: Floats, spacing: float) -> Floats:
    """Return a field F that is zero on A and makes every frame linear: (1 - s) F + s d_B is zero where 1 - u = s.

    F = d_B + L with L = -d_B / u, the length that the whole way of the front has at a node; beyond the way L is
    continued. Inside both bodies F is negative, outside both positive: no frame leaves the corridor between them. In a
    part of the way that no front reaches, such as a hollow of B within A, F = d_A: the frames are those of a blend.
    """
    from geofit.morphing.arrival_loops import widen

    length = np.maximum(np.abs(d_b), FLOOR * spacing) / u
    length = np.where(d_b < 0, length, -length)
    # Where both surfaces run through a node, as in a common base, its share of the way is noise.
    length[np.abs(d_a) + np.abs(d_b) < TOGETHER * spacing] = np.nan
    alone = np.isnan(u) & ((d_a < 0) != (d_b < 0))
    widen(length, LAYERS)
    field = np.where(np.isnan(length) | alone, d_a, d_b + length)
    lower, upper = np.minimum(d_a, d_b), np.maximum(d_a, d_b)
    field = np.where(upper < 0, np.minimum(field, upper), field)
    return np.where(lower >= 0, np.maximum(field, lower), field)
