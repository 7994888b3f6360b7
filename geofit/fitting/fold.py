"""Overturned folds: section curves that turn back, one parametrisation for all of them (METHOD, sec. 8).

Each section is an ordered line of points. Along it v is the chord length; the hinges, where the line turns
back, are given the same v on every section, so that limb is joined to limb. Across the sections u is the
distance of their lines in plan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.geometry.frame import Frame

__all__ = ["Loft", "backtracking", "loft", "turning_points"]

Floats = NDArray[np.float64]

#: A line is drawn in order if this much shorter than its points joined from side to side.
ORDERED = 0.95
#: How far a line must run back, as a share of its extent, for a turning point to be a hinge.
PROMINENT = 0.05
#: A curve that runs back by more than this share of its length shows the fold.
FOLDED = 0.02
#: Sines of the angles, 10 and 45 degrees, beyond which a section crosses another one, and runs along the fold.
CROSSING, ALONG = 0.17, 0.71


@dataclass(frozen=True, eq=False)
class Loft:
    """Parameters: ``plane`` (n, 2) metres, ``on_line`` (n,) bool: points of a curve, ``u`` (k,) of the curves."""

    plane: Floats
    on_line: NDArray[np.bool_]
    u: Floats
    notes: tuple[Message, ...]


def _curves(points: PointSet) -> dict[str, NDArray[np.int64]]:
    names = dict.fromkeys(points.section[points.section != ""].tolist())
    curves = {name: np.flatnonzero(points.section == name) for name in names}
    return {name: index for name, index in curves.items() if len(index) >= 3}


def backtracking(points: PointSet, frame: Frame) -> float:
    """Return the share of the sections' length in the frame's plane that runs backwards.

    Each section's points are taken in their order and projected on their principal direction in the plane. Zero
    for sections that go one way, whatever their direction, and for those whose points are in no order along a
    line: joined in their order they are longer than joined from one side to the other.
    """
    back = total = 0.0
    for index in _curves(points).values():
        xyz = points.xyz[index]
        plane = frame.to_local(xyz)[:, :2]
        centred = plane - plane.mean(axis=0)
        along = centred @ np.linalg.svd(centred, full_matrices=False)[2][0]
        drawn, sorted_ = _chords(xyz)[-1], _chords(xyz[np.argsort(along, kind="stable")])[-1]
        steps = np.diff(along)
        forward, backward = steps[steps > 0].sum(), -steps[steps < 0].sum()
        if drawn < ORDERED * sorted_:
            back += min(forward, backward)
        # A steep section has next to no length in plan: measure against its length in space.
        total += max(forward + backward, 0.2 * drawn)
    return back / total if total > 0 else 0.0


def loft(points: PointSet) -> Loft:
    """Place the points of the sections on the surface that their curves span.

    Points off the sections get no place here (zeros): the fit projects them on the surface through the
    sections, and corrects their places as it changes (J. Hoschek, CAGD 5, 1988, 27-31).
    """
    curves = _curves(points)
    ties = _ties(points, curves)
    curves = {name: index for name, index in curves.items() if name not in ties}
    plane = np.zeros((len(points), 2))
    if len(curves) < 2:
        return Loft(plane, np.zeros(len(points), bool), np.zeros(len(curves)), ())
    offset = _offsets(points, curves)
    order = np.argsort(offset, kind="stable")
    indices = [list(curves.values())[k] for k in order]
    u = offset[order]
    parameters = _aligned([points.xyz[index] for index in indices])
    length = float(np.mean([_chords(points.xyz[index])[-1] for index in indices]))
    on_line = np.zeros(len(points), bool)
    for line, index, v in zip(u, indices, parameters, strict=True):
        plane[index] = np.column_stack([np.full(len(index), line), v * length])
        on_line[index] = True
    note = message(
        "fitting.section-curves",
        "{lines} section curves over {length:.0f} m, {count} points between them",
        lines=len(u),
        length=float(u[-1] - u[0]),
        count=int((~on_line).sum()),
    )
    if not ties:
        return Loft(plane, on_line, u, (note,))
    crossing = message(
        "fitting.sections-cross-others",
        "sections that cross the others in plan are not used as section curves; their points count as points between "
        "the curves: {names}",
        names=ties,
    )
    return Loft(plane, on_line, u, (note, crossing))


def _ties(points: PointSet, curves: dict[str, NDArray[np.int64]]) -> tuple[str, ...]:
    """Return the names of the sections that tie the others together, instead of showing the fold.

    Their lines in plan cross a section that is nearer to the common direction of those that run back. A line that does
    not run back itself may end before the section that it would cross at a large angle: it runs along the fold.
    """
    if len(curves) < 3:
        return ()
    names = list(curves)
    lines = [_line_in_plan(points.xyz[index]) for index in curves.values()]
    folded = np.array([_runs_back(points.xyz[index]) for index in curves.values()])
    common = _common_direction(
        [direction for k, (_, direction, _) in enumerate(lines) if folded[k] or not folded.any()]
    )
    off = [abs(_cross(direction, common)) for _, direction, _ in lines]
    kept: list[int] = []
    for k in np.argsort(off, kind="stable").tolist():
        alone = bool(folded.any() and not folded[k])
        if not any(off[k] > off[j] and _crosses(lines[k], lines[j], alone) for j in kept):
            kept.append(k)
    return tuple(name for k, name in enumerate(names) if k not in kept) if len(kept) >= 2 else ()


def _line_in_plan(xyz: Floats) -> tuple[Floats, Floats, float]:
    """Return the middle of a section in plan, its direction there, and half of its length."""
    direction = _direction(xyz)
    along = xyz[:, :2] @ direction
    middle = xyz[:, :2].mean(axis=0)
    low, high = along.min(), along.max()
    return middle + ((low + high) / 2 - middle @ direction) * direction, direction, float(high - low) / 2


def _runs_back(xyz: Floats) -> bool:
    steps = np.diff(xyz[:, :2] @ _direction(xyz))
    forward, backward = steps[steps > 0].sum(), -steps[steps < 0].sum()
    return bool(min(forward, backward) > FOLDED * _chords(xyz)[-1])


def _crosses(one: tuple[Floats, Floats, float], other: tuple[Floats, Floats, float], extended: bool) -> bool:
    """Whether one line in plan crosses another; of one that is ``extended``, whether it would at a large angle."""
    (middle, direction, half), (middle_b, direction_b, half_b) = one, other
    sine = _cross(direction, direction_b)
    if abs(sine) <= CROSSING:
        return False
    at, at_b = _cross(middle_b - middle, direction_b) / sine, _cross(middle_b - middle, direction) / sine
    return abs(at_b) <= half_b and (abs(at) <= half or (extended and abs(sine) > ALONG))


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _offsets(points: PointSet, curves: dict[str, NDArray[np.int64]]) -> Floats:
    """Return the distance of each section along the common normal of their lines in plan."""
    direction = _common_direction([_direction(points.xyz[index]) for index in curves.values()])
    normal = np.array([direction[1], -direction[0]])
    centre = points.xyz[:, :2].mean(axis=0)
    return np.array([((points.xyz[index, :2] - centre) @ normal).mean() for index in curves.values()])


def _direction(xyz: Floats) -> Floats:
    """Return the principal direction of places in plan."""
    centred = xyz[:, :2] - xyz[:, :2].mean(axis=0)
    direction: Floats = np.linalg.svd(centred, full_matrices=False)[2][0]
    return direction


def _common_direction(directions: list[Floats]) -> Floats:
    """Return the mean of directions, whichever way each points."""
    doubled = 0j
    for direction in directions:
        doubled += np.exp(2j * np.arctan2(direction[1], direction[0]))
    angle = np.angle(doubled) / 2
    return np.array([np.cos(angle), np.sin(angle)])


def _chords(xyz: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(xyz, axis=0), axis=1))])


def _aligned(lines: list[Floats]) -> list[Floats]:
    """Return v in 0..1 for each point of each line: one sense, chord length, each hinge at one v."""
    parameters, hinges = [], []
    reference: Floats | None = None
    for xyz in lines:
        chord = _chords(xyz)
        v = chord / chord[-1]
        shape = np.column_stack([np.interp(np.linspace(0, 1, 50), v, xyz[:, k]) for k in range(3)])
        turned = reference is not None and np.linalg.norm(shape - reference) > np.linalg.norm(shape[::-1] - reference)
        reference = shape[::-1] if turned else shape
        found = _hinges(xyz, v)
        parameters.append(1 - v if turned else v)
        hinges.append(1 - found[::-1] if turned else found)
    if len({len(found) for found in hinges}) > 1 or not len(hinges[0]):
        return parameters
    middle = np.concatenate([[0.0], np.mean(hinges, axis=0), [1.0]])
    return [
        np.interp(v, np.concatenate([[0.0], found, [1.0]]), middle) for v, found in zip(parameters, hinges, strict=True)
    ]


def _hinges(xyz: Floats, v: Floats) -> Floats:
    """Return v at the turning points of a line, in order: where it runs back by a share of its extent."""
    plan = xyz[:, :2] - xyz[:, :2].mean(axis=0)
    along = plan @ np.linalg.svd(plan, full_matrices=False)[2][0]
    turns = turning_points(along, PROMINENT * float(np.ptp(along)))
    return np.array([_summit(v[k - 1 : k + 2], along[k - 1 : k + 2]) for k in turns])


def turning_points(along: Floats, least: float) -> list[int]:
    """Return the rows at which values turn back by ``least`` or more: their peaks and pits of that prominence.

    As scipy.signal.find_peaks of the values and of their negatives finds them; loading that takes a third of a second.
    """
    turns: list[int] = []
    peak = pit = way = 0
    values = along.tolist()
    for k, value in enumerate(values):
        peak, pit = (k if value > values[peak] else peak), (k if value < values[pit] else pit)
        if way >= 0 and values[peak] - value >= least:
            # Before the first turn there may have been no way up that counts.
            turns += [peak] * way
            way, pit = -1, k
        elif way <= 0 and value - values[pit] >= least:
            turns += [pit] * -way
            way, peak = 1, k
    return turns


def _summit(v: Floats, along: Floats) -> float:
    """Return v at the summit of the parabola through three points."""
    a, b, _ = np.polyfit(v - v[1], along - along[1], 2)
    return float(np.clip(v[1] - b / (2 * a), v[0], v[2])) if a else float(v[1])
