"""Roots of a field on segments between points of different sign."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Field

__all__ = ["roots_between"]

Floats = NDArray[np.float64]

#: A root is found when the field has fallen to this part of the difference between the ends.
FALLEN = 1e-11
STEPS = 100
#: From this step on, every other one halves the interval: there the field is far from a line.
PATIENCE = 10


def roots_between(field: Field, start: Floats, step: Floats, low: Floats, high: Floats) -> Floats:
    """Return t in [0, 1] with f(start + t step) = 0, by the Illinois method, mixed with bisection where it is slow.

    Parameters
    ----------
    field : Field
        f.
    start, step : (n, 3) array
        Segments, metres.
    low, high : (n,) array
        f at t = 0 and t = 1, finite; one is negative, the other is not.

    Returns
    -------
    (n,) array
        One root for each segment.
    """
    a, b = np.zeros(len(start)), np.ones(len(start))
    fa, fb = low.copy(), high.copy()
    share = np.where(fa == 0, a, b)
    moved_left = np.zeros(len(start), bool)
    limit = FALLEN * np.abs(fb - fa)
    i = np.nonzero((fa != 0) & (fb != 0))[0]
    for turn in range(STEPS):
        if not len(i):
            break
        t = (a[i] * fb[i] - b[i] * fa[i]) / (fb[i] - fa[i])
        halve = turn >= PATIENCE and turn % 2 == 0
        t = np.where(halve | ~((t > a[i]) & (t < b[i])), (a[i] + b[i]) / 2, t)
        f = field.value(start[i] + t[:, None] * step[i])
        share[i] = t
        left = (f < 0) == (fa[i] < 0)
        # An end that stays a second time counts half, or it would hold the secant up.
        again = left == moved_left[i]
        fb[i] = np.where(left, np.where(again & (turn > 0), fb[i] / 2, fb[i]), f)
        fa[i] = np.where(left, f, np.where(again & (turn > 0), fa[i] / 2, fa[i]))
        moved_left[i] = left
        a[i], b[i] = np.where(left, t, a[i]), np.where(left, b[i], t)
        i = i[(np.abs(f) > limit[i]) & (b[i] - a[i] > 1e-15)]
    return share
