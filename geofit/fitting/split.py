"""A core and a periphery in the plane of a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message

__all__ = ["Rectangle", "Split", "in_rectangle", "split_all", "split_none", "split_rectangle", "widened"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Split:
    """Core and periphery in the plane of the surface.

    ``core`` is the rectangle (u0, u1, v0, v1), or None without a core; ``inside`` (n,) marks its points;
    ``reason`` states what was chosen and why; ``lost`` that a core was found and could not be kept.
    """

    core: Rectangle | None
    inside: NDArray[np.bool_]
    reason: Message
    lost: bool = False


def split_none(plane: Floats, reason: Message) -> Split:
    """Return the split without a core: approximation alone."""
    return Split(None, np.zeros(len(plane), bool), reason)


def split_all(plane: Floats, area: Rectangle, reason: Message) -> Split:
    """Return the split without a periphery: interpolation alone."""
    return Split(area, np.ones(len(plane), bool), reason)


def split_rectangle(plane: Floats, core: Rectangle, area: Rectangle, reason: Message) -> Split:
    """Return the split by a given rectangle, widened to the area's edges where nothing lies beyond it."""
    core = widened(core, plane, area)
    inside = in_rectangle(plane, core)
    if not inside.any():
        return split_none(
            plane,
            message(
                "fitting.no-point-inside", "{reason}; no point lies inside, so all are approximated", reason=reason
            ).with_severity("warning"),
        )
    if inside.all():
        return split_all(
            plane,
            area,
            message(
                "fitting.no-point-outside", "{reason}; no point lies outside, so all are interpolated", reason=reason
            ),
        )
    counts = {"within": int(inside.sum()), "outside": int((~inside).sum())}
    return Split(
        core,
        inside,
        message(
            "fitting.points-inside-outside",
            "{reason}: {within} points inside, {outside} outside",
            reason=reason,
            **counts,
        ),
    )


def widened(core: Rectangle, plane: Floats, area: Rectangle) -> Rectangle:
    """Move each side to the area's edge if the strip between them is narrow and holds next to no points."""
    sides = list(core)
    inner = in_rectangle(plane, core)
    density = max(inner.sum(), 1) / max((core[1] - core[0]) * (core[3] - core[2]), 1e-9)
    for side in range(4):
        axis = side // 2
        strip = abs(sides[side] - area[side])
        extent = core[2 * axis + 1] - core[2 * axis]
        beyond = plane[:, axis] < sides[side] if side % 2 == 0 else plane[:, axis] > sides[side]
        across = (plane[:, 1 - axis] >= core[2 - 2 * axis]) & (plane[:, 1 - axis] <= core[3 - 2 * axis])
        expected = density * strip * (core[3 - 2 * axis] - core[2 - 2 * axis])
        points = (beyond & across).sum()
        if strip < 0.15 * extent and (not beyond.any() or points <= 2 or points > 0.5 * expected):
            sides[side] = area[side]
    return sides[0], sides[1], sides[2], sides[3]


def in_rectangle(plane: Floats, core: Rectangle) -> NDArray[np.bool_]:
    """Return which places (n, 2) lie in a rectangle, its edges included."""
    edge = 1e-9 * max(core[1] - core[0], core[3] - core[2], 1.0)
    u, v = plane.T
    inside: NDArray[np.bool_] = (
        (u >= core[0] - edge) & (u <= core[1] + edge) & (v >= core[2] - edge) & (v <= core[3] + edge)
    )
    return inside
