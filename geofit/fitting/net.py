"""The control net: from points on a parametrization to the coefficients of one tensor-product surface.

This module holds the net, and the approximation of all points; that of a surface with a core is in
:mod:`geofit.fitting.core`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message
from geofit.data.settings import FitSettings
from geofit.fitting.active_points import Data
from geofit.fitting.caps import cap_for
from geofit.fitting.core_relief import CoreRelief
from geofit.fitting.field import FieldChoice
from geofit.fitting.periphery import Periphery
from geofit.fitting.resolution import Choice, choose_field
from geofit.splines.refined import Space
from geofit.splines.tensor import TensorSpace

__all__ = ["Net", "approximate_all"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]
Stage = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Net:
    """A fitted surface before it is cut into patches; lengths in u and v are counted in ``unit`` metres.

    ``coefficients`` (size,) heights or (size, 3) coordinates, metres; ``frozen`` (size,) marks the control
    points that act on the core; ``lines`` are the section lines of a core that is linear across them. ``base`` is
    the space of the field, before knots were added; ``limit`` (m) is how far from the surface noise explains points.
    ``torn`` (n,) marks the points that are let go, because they contradict those around them. ``relief`` is the field
    that replaces that of all points in the core, if there is one.
    """

    space: Space
    base: TensorSpace
    coefficients: Floats
    frozen: NDArray[np.bool_]
    core: Rectangle | None
    lines: Floats | None
    unit: float
    field: FieldChoice
    rounds: int
    limit: float
    notes: tuple[Message, ...]
    torn: NDArray[np.bool_]
    relief: CoreRelief | None = None


def approximate_all(
    data: Data,
    settings: FitSettings,
    stage: Stage,
    chosen: Choice | None = None,
    sketched: Sequence[FieldChoice] = (),
) -> Net:
    """Fit a surface without a core: the field, brought within the interior tolerance of sparse points.

    ``chosen`` is the field to take; None: it is chosen by these points, from ``sketched`` fields on if there are any.
    """
    n = len(data.plane)
    most = cap_for(settings, n)
    stage("field", 0.25)
    field, base = choose_field(data, settings, most, sketched) if chosen is None else chosen
    start = data.smoothed(base, field)
    stage("periphery", 0.5)
    periphery = Periphery(data, np.ones(n, bool), None, field, settings, most, False, np.zeros(0, bool))
    found = periphery.fit(base, start)
    total = found.coefficients + data.over_trend(found.space)
    return Net(
        found.space, base, total, found.frozen, None, None, data.unit, field, found.rounds, found.limit, found.notes,
        found.torn,
    )  # fmt: skip
