"""How far a fault displaces a horizon: throw and heave along the line where its blocks face each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.fitting.horizon_fit import HorizonFit
from geofit.site.fault import BEYOND_TRACE, HALVINGS, Fault, longer, longer_side
from geofit.site.height_field import HeightField

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["FaultCut", "Sides", "throws"]

Floats = NDArray[np.float64]
#: On which side of each fault a block lies.
Sides = tuple[int, ...]

#: Places along a fault at which the throw is measured.
PLACES = 50
#: How far across the trace a block's end is looked for, as a share of the area's longer side.
ACROSS = 0.05


@dataclass(frozen=True, eq=False)
class FaultCut:
    """The displacement of one horizon along one fault, between two blocks.

    ``trace`` (k, 3) runs midway between the ends of both blocks in map coordinates, ``distance`` (k,) along it in
    metres, and ``throw`` (k,) is the elevation of the block ``up`` minus that of the block ``down`` there: positive
    on average, negative where the fault's sense is turned round. ``heave`` (k,) is the horizontal distance between
    the two blocks' ends, negative where they overlap in plan (a reverse fault), nan at the area's edge.
    """

    fault: str
    horizon: str
    up: str
    down: str
    trace: Floats
    distance: Floats
    throw: Floats
    heave: Floats

    @property
    def text(self) -> Message:
        """The throw in words."""
        return message(
            "site.fault-throw",
            "{fault} throws {horizon} down by {low:.2f} to {high:.2f} m, {mean:.2f} m on average over {length:.0f} m: "
            "{up} lies above {down}",
            fault=self.fault,
            horizon=self.horizon,
            low=float(self.throw.min()),
            high=float(self.throw.max()),
            mean=float(self.throw.mean()),
            length=float(self.distance[-1]),
            up=self.up,
            down=self.down,
        )


def throws(
    blocks: Sequence[tuple[Sides, HorizonFit]], faults: Sequence[Fault], horizon: str, area: Polygon
) -> tuple[FaultCut, ...]:
    """Return what each fault displaces between every two blocks that it alone parts.

    Parameters
    ----------
    blocks : sequence of tuple of int and HorizonFit
        Surfaces of one horizon with their side of each of ``faults``; they reach somewhat beyond their outlines.
    faults : sequence of Fault
        All that cut the horizon.
    horizon : str
        Its name.
    area : shapely.Polygon
        The study area, map coordinates.
    """
    known = [_Block(sides, surface.name, HeightField(surface)) for sides, surface in blocks]
    found = []
    for one, two in combinations(known, 2):
        differing = [k for k in range(len(faults)) if one.sides[k] != two.sides[k]]
        if len(differing) == 1:
            found.append(_displacement(differing[0], faults, horizon, one, two, area))
    return tuple(cut for cut in found if cut is not None)


@dataclass(frozen=True, eq=False)
class _Block:
    """One block: the side of each fault it lies on, and its height."""

    sides: Sides
    name: str
    height_field: HeightField


def _displacement(
    number: int, faults: Sequence[Fault], horizon: str, one: _Block, two: _Block, area: Polygon
) -> FaultCut | None:
    """Measure throw and heave between two blocks along one fault; None where they do not meet."""
    import shapely

    fault = faults[number]

    def middle(x: Floats, y: Floats) -> Floats:
        return np.asarray((one.height_field(x, y) + two.height_field(x, y)) / 2)

    lines = [
        part
        for line in fault.traces(area, middle)
        for part in shapely.get_parts(
            shapely.intersection(shapely.LineString(longer(line, BEYOND_TRACE * longer_side(area))), area)
        )
        if part.geom_type == "LineString"
    ]
    met: tuple[Floats, Floats] | None = None
    for line in lines:
        distance = np.linspace(0, line.length, PLACES)
        plan = shapely.get_coordinates(shapely.line_interpolate_point(line, distance))
        trace = np.column_stack([plan, middle(*plan.T)])
        # Where a further fault parts the two blocks from this place, they do not meet here.
        meets = np.isfinite(trace[:, 2])
        for k, other in enumerate(faults):
            if k != number:
                meets[meets] &= other.side(trace[meets]) == one.sides[k]
        if meets.sum() > 1 and (met is None or np.ptp(distance[meets]) > met[1][-1]):
            met = trace[meets], distance[meets] - distance[meets][0]
    if met is None:
        return None
    trace, distance = met
    throw = one.height_field(*trace[:, :2].T) - two.height_field(*trace[:, :2].T)
    heave = _heave(fault, number, one, two, trace[:, :2], ACROSS * longer_side(area))
    upper, lower = (one, two) if throw.mean() >= 0 else (two, one)
    throw = throw if upper is one else -throw
    return FaultCut(fault.name, horizon, upper.name, lower.name, trace, distance, throw, heave)


def _heave(fault: Fault, number: int, one: _Block, two: _Block, plan: Floats, reach: float) -> Floats:
    """Return (k,) the distance in plan, across the trace, from the end of one block to that of the other."""
    way = np.gradient(plan, axis=0)
    across = np.column_stack([-way[:, 1], way[:, 0]]) / np.linalg.norm(way, axis=1)[:, None]
    ends = []
    for block in (one, two):

        def side(off: Floats, block: _Block = block) -> NDArray[np.int64]:
            place = plan + off[:, None] * across
            return fault.side(np.column_stack([place, np.nan_to_num(block.height_field(*place.T))]))

        low, high = np.full(len(plan), -reach), np.full(len(plan), reach)
        first = side(low)
        for _ in range(HALVINGS):
            half = (low + high) / 2
            same = side(half) == first
            low, high = np.where(same, half, low), np.where(same, high, half)
        end = (low + high) / 2
        known = np.isfinite(block.height_field(*(plan + end[:, None] * across).T)) & (np.abs(end) < 0.99 * reach)
        ends.append(np.where(known, end, np.nan))
    # The block whose side lies across the trace begins where the other ends.
    ahead = side(np.full(len(plan), reach)) == one.sides[number]
    return np.where(ahead, ends[0] - ends[1], ends[1] - ends[0])
