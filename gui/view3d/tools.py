"""Measuring, the section plane, and the clip box: what a person does in the scene besides looking."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPlaneCollection

from geofit.gui.view3d.actors import ActorPart, lines, poly, triangles
from geofit.gui.view3d.axes import grouped
from geofit.gui.view3d.handles import Handle
from geofit.gui.view3d.item import Look

__all__ = ["ClipBox", "Measure", "SectionTool"]

Floats = NDArray[np.float64]

#: The section plane reaches above and below the scene by this share of its height; its colour.
BEYOND = 0.04
PLANE = "#d98a2b"


class Measure:
    """Two places and what lies between them, in true metres."""

    def __init__(self) -> None:
        self.places: list[Floats] = []

    def add(self, xyz: Floats) -> None:
        """Take a place; a third one begins anew."""
        self.places = [xyz] if len(self.places) == 2 else [*self.places, xyz]

    def figures(self) -> tuple[float, float, float, float, float] | None:
        """Return distance, horizontal distance, rise (m), azimuth, and dip below the horizontal (degrees)."""
        if len(self.places) < 2:
            return None
        east, north, up = (self.places[1] - self.places[0]).tolist()
        flat = float(np.hypot(east, north))
        azimuth = float(np.degrees(np.arctan2(east, north)) % 360)
        return float(np.hypot(flat, up)), flat, up, azimuth, float(np.degrees(np.arctan2(-up, flat)))

    def text(self, template: str) -> str:
        """Return the figures in words; the template names distance, flat, rise, azimuth and dip."""
        figures = self.figures()
        if figures is None:
            return ""
        distance, flat, rise, azimuth, dip = figures
        return template.format(
            distance=grouped(round(distance, 2)),
            flat=grouped(round(flat, 2)),
            rise=f"{rise:+.2f}".replace("-", "−"),
            azimuth=f"{azimuth % 360:05.1f}",
            dip=f"{dip:.1f}".replace("-", "−"),
        )


class SectionTool:
    """A vertical plane along a line of the plan, (k, 2) map coordinates, with a thickness in metres."""

    def __init__(self, changed: Callable[[], None], dropped: Callable[[], None]) -> None:
        self.line: Floats | None = None
        self.thickness = 0.0
        self._changed, self._dropped = changed, dropped

    def parts(self, box: Floats, look: Look) -> list[ActorPart]:
        """Return what is drawn: the plane, its rim, and the two sides of the slice."""
        if self.line is None:
            return []
        low, high = box[0, 2], box[1, 2]
        rise = BEYOND * max(high - low, 1.0)
        levels = low - rise, high + rise
        parts = []
        for offset, opacity in ((0.0, 0.28), *(((s * self.thickness / 2), 0.1) for s in (-1, 1) if self.thickness)):
            xyz, faces, rim = self._wall(offset, levels)
            parts.append(ActorPart(triangles(poly(xyz - look.origin, faces=faces), PLANE), opacity=opacity))
            parts.append(ActorPart(lines(poly(xyz - look.origin, runs=[rim]), PLANE), width=2.0 if not offset else 1.0))
        return parts

    def _wall(self, offset: float, levels: tuple[float, float]) -> tuple[Floats, NDArray[np.int64], Any]:
        assert self.line is not None
        plan = self.line + offset * _sideways(self.line)
        n = len(plan)
        xyz = np.concatenate([np.column_stack([plan, np.full(n, z)]) for z in levels])
        k = np.arange(n - 1)
        faces = np.concatenate([np.stack([k, k + 1, n + k + 1], axis=1), np.stack([k, n + k + 1, n + k], axis=1)])
        rim = np.concatenate([np.arange(n), np.arange(2 * n - 1, n - 1, -1), [0]])
        return xyz, faces, rim

    def handles(self, box: Floats) -> list[Handle]:
        """Return a handle at each corner of the line, and one at its middle that moves the whole."""
        if self.line is None:
            return []
        line, top = self.line, box[1, 2] + BEYOND * max(box[1, 2] - box[0, 2], 1.0)
        middle = line.mean(axis=0)

        def corner(k: int) -> Callable[[Floats], None]:
            def moved(xyz: Floats) -> None:
                others = np.delete(line, k, axis=0)
                if np.linalg.norm(others - xyz[:2], axis=1).min() > 1e-3:
                    self._set(np.vstack([line[:k], xyz[None, :2], line[k + 1 :]]))

            return moved

        handles = [Handle(np.append(line[k], top), corner(k), dropped=self._dropped) for k in range(len(line))]
        whole = Handle(np.append(middle, top), lambda xyz: self._set(line + xyz[:2] - middle), dropped=self._dropped)
        return [*handles, whole]

    def _set(self, line: Floats) -> None:
        self.line = line
        self._changed()


def _sideways(line: Floats) -> Floats:
    """Return the unit vectors to the left of a line at its corners."""
    way = np.diff(line, axis=0)
    left = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.linalg.norm(way, axis=1, keepdims=True)
    mean = np.vstack([left[:1], left[:-1] + left[1:], left[-1:]])
    return np.asarray(mean / np.linalg.norm(mean, axis=1, keepdims=True))


class ClipBox:
    """A box along the map's axes outside of which nothing is drawn; ``box`` (2, 3) or None."""

    def __init__(self, changed: Callable[[], None]) -> None:
        self.box: Floats | None = None
        self._limits = np.zeros((2, 3))
        self._changed = changed

    def open(self, box: Floats) -> None:
        """Begin with a box that holds everything."""
        middle, half = box.mean(axis=0), np.maximum(np.diff(box, axis=0)[0] / 2, 0.5) * 1.02
        self.box = self._limits = np.stack([middle - half, middle + half])

    def take_over(self, other: ClipBox) -> None:
        """Become as another box is."""
        self.box, self._limits = other.box, other._limits

    def planes(self, origin: Floats, stretch: float) -> Any:
        """Return the six planes in the scene's coordinates."""
        assert self.box is not None
        planes = vtkPlaneCollection()
        for end, sign in ((0, 1.0), (1, -1.0)):
            place = (self.box[end] - origin) * (1.0, 1.0, stretch)
            for axis in range(3):
                plane = vtkPlane()
                plane.SetOrigin(*place)
                plane.SetNormal(*(sign * np.eye(3)[axis]))
                planes.AddItem(plane)
        return planes

    def parts(self, look: Look) -> list[ActorPart]:
        """Return the edges of the box."""
        if self.box is None:
            return []
        x, y, z = self.box.T
        corners = np.array([[a, b, c] for c in z for a, b in ((x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1]))])
        runs = [np.array([0, 1, 2, 3, 0]), np.array([4, 5, 6, 7, 4]), *(np.array([k, k + 4]) for k in range(4))]
        return [ActorPart(lines(poly(corners - look.origin, runs=runs), PLANE), width=1.5)]

    def handles(self) -> list[Handle]:
        """Return a handle in the middle of each side."""
        if self.box is None:
            return []
        middle = self.box.mean(axis=0)
        handles = []
        for end in (0, 1):
            for axis in range(3):
                place = middle.copy()
                place[axis] = self.box[end, axis]
                handles.append(Handle(place, self._mover(end, axis), np.eye(3)[axis]))
        return handles

    def _mover(self, end: int, axis: int) -> Callable[[Floats], None]:
        def moved(xyz: Floats) -> None:
            assert self.box is not None
            box = self.box.copy()
            thin = 0.01 * float(self._limits[1, axis] - self._limits[0, axis])
            low = self._limits[0, axis] if end == 0 else box[0, axis] + thin
            high = self._limits[1, axis] if end == 1 else box[1, axis] - thin
            box[end, axis] = min(max(float(xyz[axis]), low), high)
            self.box = box
            self._changed()

        return moved
