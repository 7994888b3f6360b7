"""The viewpoint: turns about the vertical like a turntable, so that north and up are never lost."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["VIEWS", "Viewpoint", "framed", "viewpoint_between"]

Floats = NDArray[np.float64]

#: Angle of view, degrees.
ANGLE = 28.0
#: From where the standard views look: azimuth of the viewpoint (clockwise from north) and its height, degrees.
VIEWS = {
    "top": (180.0, 90.0),
    "north": (0.0, 0.0),
    "south": (180.0, 0.0),
    "east": (90.0, 0.0),
    "west": (270.0, 0.0),
    "iso": (212.0, 32.0),
}
#: The viewpoint comes no nearer than this to what it looks at, metres.
NEAREST = 0.5


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """Where the viewpoint is: about ``centre`` (scene coordinates), at an azimuth and height (degrees), so far away."""

    centre: Floats
    azimuth: float
    height: float
    distance: float
    parallel: bool = False

    @property
    def axes(self) -> Floats:
        """Unit vectors to the right, upwards in the picture, and towards the viewpoint, as rows."""
        a, h = math.radians(self.azimuth), math.radians(self.height)
        towards = [math.sin(a) * math.cos(h), math.cos(a) * math.cos(h), math.sin(h)]
        up = [-math.sin(a) * math.sin(h), -math.cos(a) * math.sin(h), math.cos(h)]
        return np.array([np.cross(up, towards), up, towards])

    @property
    def half(self) -> float:
        """Half the height of the picture at the centre, metres."""
        return self.distance * math.tan(math.radians(ANGLE / 2))

    def turned(self, right: float, up: float) -> Viewpoint:
        """Return the viewpoint moved round the centre by degrees."""
        height = min(max(self.height + up, -90.0), 90.0)
        return replace(self, azimuth=(self.azimuth + right) % 360, height=height)

    def shifted(self, right: float, up: float) -> Viewpoint:
        """Return the viewpoint moved sideways by metres of the scene."""
        axes = self.axes
        return replace(self, centre=self.centre + right * axes[0] + up * axes[1])

    def nearer(self, factor: float, right: float = 0.0, up: float = 0.0) -> Viewpoint:
        """Return the viewpoint ``factor`` times nearer; the place ``right``, ``up`` (metres at the centre) stays."""
        distance = max(self.distance / factor, NEAREST)
        stay = 1 - distance / self.distance
        return replace(self.shifted(right * stay, up * stay), distance=distance)

    def seen_from(self, view: str) -> Viewpoint:
        """Return the viewpoint at a standard view (see VIEWS)."""
        azimuth, height = VIEWS[view]
        return replace(self, azimuth=azimuth, height=height)

    def put(self, camera: Any) -> None:
        """Set a VTK camera."""
        axes = self.axes
        camera.SetFocalPoint(*self.centre)
        camera.SetPosition(*(self.centre + self.distance * axes[2]))
        camera.SetViewUp(*axes[1])
        camera.SetViewAngle(ANGLE)
        camera.SetParallelScale(self.half)
        camera.SetParallelProjection(self.parallel)


def framed(viewpoint: Viewpoint, box: Floats, aspect: float) -> Viewpoint:
    """Return the viewpoint so that a box (2, 3) of the scene fills the picture, seen from where it looks now."""
    corners = np.array([[box[i, 0], box[j, 1], box[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    centre = box.mean(axis=0)
    seen = (corners - centre) @ viewpoint.axes.T
    middle = (seen[:, :2].max(axis=0) + seen[:, :2].min(axis=0)) / 2
    centre = centre + middle @ viewpoint.axes[:2]
    seen[:, :2] -= middle
    slope = math.tan(math.radians(ANGLE / 2))
    depth = 0.0 if viewpoint.parallel else seen[:, 2]
    across = np.abs(seen[:, 0]) / max(aspect, 1e-3)
    needed = np.maximum(across, np.abs(seen[:, 1])) / slope + depth
    return replace(viewpoint, centre=centre, distance=max(1.12 * float(needed.max()), NEAREST))


def viewpoint_between(start: Viewpoint, end: Viewpoint, share: float) -> Viewpoint:
    """Return the viewpoint on its way from one place to another: slow, fast, slow; it turns the shorter way."""
    s = share * share * (3 - 2 * share)
    turn = (end.azimuth - start.azimuth + 180) % 360 - 180
    return replace(
        end,
        centre=start.centre + s * (end.centre - start.centre),
        azimuth=(start.azimuth + s * turn) % 360,
        height=start.height + s * (end.height - start.height),
        distance=start.distance * (end.distance / start.distance) ** s,
    )
