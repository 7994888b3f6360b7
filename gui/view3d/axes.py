"""Coordinate lines under the scene, with true map coordinates whatever the exaggeration. Plain numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.lengths import LENGTH_UNITS, LengthUnit
from geofit.gui.lengths import coordinate_unit, length_mark, length_unit, shown_coordinate, shown_length
from geofit.gui.view3d.projector import Projector

__all__ = ["Mark", "floor_lines", "grouped", "marks", "nice", "ticks"]

Floats = NDArray[np.float64]

#: Most coordinate lines a direction.
MOST = 40
#: An edge drawn shorter than this has no numbers, and numbers stand so far apart at least, beside each other and one
#: above the other, logical pixels.
SHORT, APART, CLOSE = 90.0, 62.0, 22.0
#: So many coarser steps are tried.
COARSER = 5


@dataclass(frozen=True)
class Mark:
    """A number beside an axis: where the tick is, the way out of the box (unit pixels), and the text."""

    x: float
    y: float
    out: tuple[float, float]
    text: str


def nice(length: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a length."""
    power = 10.0 ** math.floor(math.log10(max(length, 1e-6)))
    return next(k * power for k in (5, 2, 1) if k * power <= length * (1 + 1e-9))


def grouped(value: float) -> str:
    """Return a number with narrow gaps between thousands: 3 100 500."""
    text = f"{value:,.6f}".rstrip("0").rstrip(".").replace(",", "\u2009")
    return text.replace("-", "−")


def ticks(low: float, high: float, step: float, unit: LengthUnit | None = None) -> Floats:
    """Return the multiples of a step inside a range, or of a greater one where there are too many; metres.

    They are round in a unit: that which is shown, where none is given.
    """
    per = LENGTH_UNITS[unit or length_unit()]
    low, high = low / per, high / per
    step = step if per == 1.0 else nice(step / per)
    while (high - low) / step > MOST:
        step *= 2 if f"{step:e}"[0] != "2" else 2.5
    return np.asarray(
        np.round(np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step, 6) * per
    )


def floor_lines(box: Floats, step: float) -> tuple[Floats, list[NDArray[np.int64]]]:
    """Return the lines of the coordinate grid at the bottom of a box (2, 3), and its rim: points and runs."""
    (x0, y0, z), (x1, y1, _) = box
    ends = [((x, y0, z), (x, y1, z)) for x in (x0, *ticks(x0, x1, step, coordinate_unit()), x1)]
    ends += [((x0, y, z), (x1, y, z)) for y in (y0, *ticks(y0, y1, step, coordinate_unit()), y1)]
    return np.array(ends).reshape(-1, 3), list(np.arange(2 * len(ends)).reshape(-1, 2))


def marks(box: Floats, step: float, view: Projector) -> list[Mark]:
    """Return the numbers along one edge of the box each way: those that are lowest, and leftmost, in the picture."""
    low, high = box
    floors = [_edge(0, np.array([0, y, low[2]]), box, view) for y in (low[1], high[1])]
    sides = [_edge(1, np.array([x, 0, low[2]]), box, view) for x in (low[0], high[0])]
    posts = [_edge(2, np.array([x, y, 0]), box, view) for x in (low[0], high[0]) for y in (low[1], high[1])]
    middle = view.screen(box.mean(axis=0)[None])[0, :2]
    found: list[Mark] = []
    for axis, edges, down, right, letter in (
        (0, floors, 1.0, 0.0, "E "),
        (1, sides, 1.0, -0.01, "N "),
        (2, posts, 0.0, -1.0, ""),
    ):
        whole = [
            (float(screen[:, :2].mean(axis=0) @ (right, down)), k)
            for k, (_, screen) in enumerate(edges)
            if np.isfinite(screen).all()
        ]
        if not whole:
            continue
        base, screen = edges[max(whole)[1]]
        if np.linalg.norm(screen[1, :2] - screen[0, :2]) >= SHORT:
            found += _along(axis, base, letter, box, step, view, middle)
    return found


def _edge(axis: int, base: Floats, box: Floats, view: Projector) -> tuple[Floats, Floats]:
    ends = np.stack([base, base])
    ends[:, axis] = box[:, axis]
    return base, view.screen(ends)


def _along(
    axis: int, base: Floats, letter: str, box: Floats, step: float, view: Projector, middle: Floats
) -> list[Mark]:
    if axis == 2:
        step = nice((box[1, 2] - box[0, 2]) / 3)
    gap, unit = (APART, coordinate_unit()) if axis < 2 else (CLOSE, length_unit())
    for _ in range(COARSER):
        values = ticks(box[0, axis], box[1, axis], step, unit)
        places = np.tile(base, (len(values), 1))
        places[:, axis] = values
        seen = view.screen(places)[:, :2] if len(values) else np.empty((0, 2))
        # All at even steps: of numbers too close to each other some alone would be left out.
        if len(values) < 3 or np.linalg.norm(np.diff(seen, axis=0), axis=1).min() >= gap:
            break
        step *= 2.5 if f"{step:e}"[0] == "2" else 2
    way = seen[-1] - seen[0] if len(values) > 1 else np.array([1.0, 0.0])
    out = np.array([-way[1], way[0]]) / max(float(np.linalg.norm(way)), 1e-9)
    if len(values) and out @ (seen.mean(axis=0) - middle) < 0:
        out = -out
    kept: list[Mark] = []
    for value, (x, y) in zip(values.tolist(), seen.tolist(), strict=True):
        inside = 0 <= x <= view.width and 0 <= y <= view.height
        if inside and (not kept or math.hypot(x - kept[-1].x, y - kept[-1].y) >= gap):
            number = grouped(round(shown_length(value) if axis == 2 else shown_coordinate(value), 6))
            behind = f" {length_mark()}" if axis == 2 else ""
            kept.append(Mark(x, y, (float(out[0]), float(out[1])), f"{letter}{number}{behind}"))
    return kept
