"""Section drawings: lines in plan, and what the geologist draws of each horizon along them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from geofit.sample.observations import LEAST_DISTANCE, Observations, errors_of
from geofit.sample.truth import (
    CORE,
    FAULT_BOTTOM,
    FoldTruth,
    MapTruth,
    PlaneTruth,
    ground,
    horizon_truth,
    to_map,
    to_site,
)

__all__ = ["CROSS_SECTIONS", "SampleDrawing", "draw_points", "empty_drawings"]

Floats = NDArray[np.float64]

#: s of the cross sections C1 to C8, metres: 60 m apart.
CROSS_SECTIONS: Floats = np.linspace(CORE[0], CORE[1], 8)
_HALF = 680.0
#: Longitudinal sections as (s, t) nodes: valley axis, left bank, right bank.
_LONGITUDINAL = {
    "L1": ((762.0, 2.0), (1005.0, -22.0), (1238.0, -30.0)),
    "L2": ((762.0, 236.0), (1238.0, 250.0)),
    "L3": ((762.0, -236.0), (1238.0, -262.0)),
}
#: Neighbours along a section keep this distance, metres.
_STEP = 6.0


#: Trace of a horizon on a section: (k,) places, (k,) density of points wanted there (0: none), and the
#: (distance, elevation) of a place when the drawing is off by an error.
_Trace = tuple[Floats, Floats, Callable[[float, float], Floats]]


@dataclass(frozen=True)
class SampleDrawing:
    """A section: its (k, 2) line in plan, and per horizon lines of (m, 2) (distance, elevation), in order."""

    name: str
    line: Floats
    lines: dict[str, list[Floats]] = field(default_factory=dict)

    def plan(self, distance: Floats) -> tuple[Floats, Floats]:
        """Return easting and northing at distances along the line."""
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.line, axis=0), axis=1))])
        return np.interp(distance, length, self.line[:, 0]), np.interp(distance, length, self.line[:, 1])

    @property
    def length(self) -> float:
        """Length of the line, metres."""
        return float(np.linalg.norm(np.diff(self.line, axis=0), axis=1).sum())


def empty_drawings() -> list[SampleDrawing]:
    """Return the empty drawings: cross sections from right to left bank, and longitudinal ones."""
    nodes = {f"C{i + 1}": ((s, -_HALF), (s, _HALF)) for i, s in enumerate(CROSS_SECTIONS)} | _LONGITUDINAL
    drawings = []
    for name, corners in nodes.items():
        s, t = np.array(corners, float).T
        drawings.append(SampleDrawing(name, np.column_stack(to_map(s, t)).round(3)))
    return drawings


def draw_points(
    drawing: SampleDrawing, horizon: str, n: int, observations: Observations, rng: np.random.Generator
) -> None:
    """Draw n points of a horizon on a section, none where it is eroded, and enter them in the observations."""
    truth = horizon_truth(horizon)
    if isinstance(truth, MapTruth):
        trace = _map_trace(drawing, truth)
    elif isinstance(truth, PlaneTruth):
        trace = _plane_trace(drawing, truth)
    else:
        trace = _fold_trace(drawing, truth)
    if not trace[1].any():
        return
    error = errors_of(rng, "section", n)
    for _ in range(100):
        points = _spread(drawing, horizon, trace, error, observations, rng)
        if points is not None:
            break
    else:
        raise AssertionError(f"No room for {n} points of {horizon} on section {drawing.name}.")
    for distance, elevation in points:
        x, y = drawing.plan(np.array([distance]))
        observations.add(horizon, "section", np.array([x[0], y[0], elevation]))
    drawing.lines[horizon] = _parts(points, horizon, drawing)


def _spread(
    drawing: SampleDrawing,
    horizon: str,
    trace: _Trace,
    error: Floats,
    observations: Observations,
    rng: np.random.Generator,
) -> Floats | None:
    """Return (n, 2) points of a trace, about one in each n-th part of it; None if one found no room."""
    places, weight, locate = trace
    share = np.cumsum(weight) / weight.sum()
    picked: list[Floats] = []
    last = -np.inf
    for i in range(len(error)):
        for _ in range(50):
            # The share is flat at its ends where nothing is drawn.
            part = np.clip((i + rng.uniform(-0.1, 1.1)) / len(error), 0.003, 0.997)
            place = np.interp(part, share, places)
            distance, elevation = locate(float(place), float(error[i]))
            point = np.array([round(float(distance), 2), round(float(elevation), 3)])
            x, y = drawing.plan(point[:1])
            near = bool(picked) and (
                np.linalg.norm(point - picked[-1]) < _STEP
                or np.abs(np.array(picked)[:, 0] - distance).min() < LEAST_DISTANCE
            )
            if place > last and not near and observations.is_clear(horizon, np.array([x[0], y[0], point[1]])):
                picked.append(point)
                last = place
                break
        else:
            return None
    return np.array(picked)


def _map_trace(drawing: SampleDrawing, truth: MapTruth) -> _Trace:
    margin = 16.0 if drawing.name.startswith("C") else 32.0
    distance = np.arange(margin, drawing.length - margin, 1.0)
    x, y = drawing.plan(distance)
    _, t = to_site(x, y)
    buried = truth.height(x, y) < ground(x, y) - 3.0
    # Closer together under the dam than high on the banks.
    weight = buried * (0.55 + 0.45 * np.exp(-((t / 330.0) ** 4)))

    def locate(d: float, error: float) -> Floats:
        here = np.round(np.array([d]), 2)
        return np.array([here[0], truth.height(*drawing.plan(here))[0] + error])

    return distance, weight, locate


def _plane_trace(drawing: SampleDrawing, truth: PlaneTruth) -> _Trace:
    start, end = drawing.line[0], drawing.line[-1]
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0], 0.0])

    def on_section(v: Floats, error: float) -> Floats:
        u = np.zeros_like(v)
        for _ in range(40):
            u = u - ((truth.point(u, v, error)[:, :2] - start) @ across[:2]) / float(truth.axes[0] @ across)
        return truth.point(u, v, error)

    v = np.arange(-320.0, 160.0, 1.0)
    xyz = on_section(v, 0.0)
    drawn = (xyz[:, 2] > FAULT_BOTTOM) & (xyz[:, 2] < ground(xyz[:, 0], xyz[:, 1]) - 3.0)

    def locate(v: float, error: float) -> Floats:
        point = on_section(np.array([v]), error)[0]
        return np.array([(point[:2] - start) @ along, point[2]])

    # Drawn downwards from the ground.
    return -v[::-1], drawn[::-1].astype(float), lambda place, error: locate(-place, error)


def _fold_trace(drawing: SampleDrawing, truth: FoldTruth) -> _Trace:
    start, end = drawing.line[0], drawing.line[-1]
    along = (end - start) / np.linalg.norm(end - start)
    s = float(to_site(*start)[0])

    def profile(p: Floats) -> Floats:
        xyz = truth.point(np.array(s), p)
        return np.column_stack([(xyz[:, :2] - start) @ along, xyz[:, 2]])

    p = np.linspace(-1.0, 1.0, 801)
    length = np.linalg.norm(np.gradient(profile(p), p, axis=0), axis=1)

    def locate(place: float, error: float) -> Floats:
        before, here, after = profile(place + np.array([-1e-4, 0.0, 1e-4]))
        tangent = (after - before) / np.linalg.norm(after - before)
        return np.asarray(here + error * np.array([-tangent[1], tangent[0]]))

    return p, length, locate


def _parts(points: Floats, horizon: str, drawing: SampleDrawing) -> list[Floats]:
    """Split a drawn line where the horizon is eroded between two of its points."""
    truth = horizon_truth(horizon)
    if not isinstance(truth, MapTruth):
        return [points]
    cuts = []
    for i, (a, b) in enumerate(zip(points[:-1, 0], points[1:, 0], strict=True)):
        x, y = drawing.plan(np.linspace(a, b, 20))
        if (truth.height(x, y) > ground(x, y)).any():
            cuts.append(i + 1)
    return np.split(points, cuts)
