"""How many control points there may be, and whether they can follow the points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.long_arrays import Rows
from geofit.data.settings import FitSettings
from geofit.fitting.density import CLOUD
from geofit.splines.refined import RefinedSpace, Space
from geofit.splines.tensor import TensorSpace

__all__ = ["UTMOST", "cap_for", "crowded", "in_patches"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]

#: Spans across nine tenths of the points, below which no control points can follow them.
CROWDED = 4
#: Control points a data point, and their bounds.
A_POINT, FEWEST, MOST = 40, 1_600, 20_000
#: Control points that a surface without a core takes to meet its points, at most.
UTMOST = 120_000


def cap_for(settings: FitSettings, n: int, a_point: int = A_POINT) -> int:
    """Return the cap of the number of control points."""
    return settings.max_control_points or int(np.clip(a_point * n, FEWEST, MOST))


def in_patches(shape: tuple[int, int], core: Rectangle | None, space: Space) -> int:
    """Return the control points of all patches: each seam adds knots, and a row that both sides count.

    ``shape`` is that of the net, outside of what is finer.
    """
    if core is None:
        return shape[0] * shape[1]
    rows, within = [], []
    for count, knots, edges in ((shape[0], space.knots_u, core[:2]), (shape[1], space.knots_v, core[2:])):
        inner = [x for x in edges if knots[0] < x < knots[-1]]
        rows.append(count + sum(space.degree + 1 - int((knots == x).sum()) for x in inner))
        within.append(int(((knots > edges[0]) & (knots < edges[1])).sum()) + space.degree + 1)
    finer = space.fine.size - within[0] * within[1] if isinstance(space, RefinedSpace) else 0
    return rows[0] * rows[1] + finer


def crowded(space: TensorSpace, plane: Rows) -> tuple[float, float] | None:
    """Return the extent of nine tenths of the points and the longest span there, if they lie within a few spans.

    Of an area far wider than its points no control points can follow them.
    """
    if len(plane) > CLOUD:
        return None
    low, high = np.quantile(plane[:], (0.05, 0.95), axis=0)
    spans = []
    for axis, knots in enumerate((space.knots_u, space.knots_v)):
        breaks = np.unique(knots)
        first, last = np.searchsorted(breaks, (low[axis], high[axis]), side="right")
        spans.append(float(np.diff(breaks[max(first - 1, 0) : last + 1]).max()))
    extent = float((high - low).max())
    return (extent, max(spans)) if extent < CROWDED * max(spans) else None
