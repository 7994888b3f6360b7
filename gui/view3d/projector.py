"""Between the map and the picture: where a place is drawn, and which line of sight a pixel is. No Qt, no VTK."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Projector"]

Floats = NDArray[np.float64]

#: A way that is drawn shorter than this share of its length runs along the line of sight.
STEEP = 0.2


@dataclass(frozen=True, eq=False)
class Projector:
    """The camera at one moment.

    Parameters
    ----------
    matrix : (4, 4) array
        From the scene's coordinates to the cube -1..1 (OpenGL's clip coordinates).
    width, height : float
        Size of the picture in logical pixels; y counts downwards.
    origin : (3,) array
        Map coordinates of the scene's zero, metres.
    stretch : float
        Vertical exaggeration.
    """

    matrix: Floats
    width: float
    height: float
    origin: Floats
    stretch: float

    def screen(self, xyz: Floats) -> Floats:
        """Return (n, 3) pixel columns, rows and depths (0 near, 1 far; nan behind the viewpoint) of map coordinates."""
        scene = (np.atleast_2d(np.asarray(xyz, float)) - self.origin) * (1.0, 1.0, self.stretch)
        clip = scene @ self.matrix[:, :3].T + self.matrix[:, 3]
        w = np.where(clip[:, 3] > 1e-9, clip[:, 3], np.nan)
        ndc = clip[:, :3] / w[:, None]
        return np.stack(
            [(ndc[:, 0] + 1) / 2 * self.width, (1 - ndc[:, 1]) / 2 * self.height, (ndc[:, 2] + 1) / 2], axis=1
        )

    def ray(self, column: float, row: float) -> tuple[Floats, Floats]:
        """Return two places in map coordinates on the line of sight through a pixel: near and far."""
        x, y = 2 * column / self.width - 1, 1 - 2 * row / self.height
        ends = np.array([[x, y, -1.0, 1.0], [x, y, 1.0, 1.0]]) @ np.linalg.inv(self.matrix).T
        scene = ends[:, :3] / ends[:, 3:]
        near, far = scene / (1.0, 1.0, self.stretch) + self.origin
        return near, far

    def on_level(self, column: float, row: float, z: float) -> Floats | None:
        """Return where a line of sight meets the level ``z``, None if it runs along it or away from it."""
        near, far = self.ray(column, row)
        drop = far[2] - near[2]
        if abs(drop) < 1e-9 * np.linalg.norm(far - near):
            return None
        share = (z - near[2]) / drop
        return None if share < 0 else np.asarray(near + share * (far - near))

    def in_picture_plane(self, start: Floats, by: tuple[float, float]) -> Floats | None:
        """Return where ``start`` is after a move by pixels in the plane of the picture; None behind the viewpoint."""
        column, row, depth = self.screen(start)[0].tolist()
        x, y = 2 * (column + by[0]) / self.width - 1, 1 - 2 * (row + by[1]) / self.height
        end = np.linalg.inv(self.matrix) @ np.array([x, y, 2 * depth - 1, 1.0])
        place = end[:3] / end[3] / (1.0, 1.0, self.stretch) + self.origin
        return np.asarray(place) if np.isfinite(place).all() else None

    def pulled(self, start: Floats, way: Floats, by: tuple[float, float]) -> float | None:
        """Return how far along ``way`` (3,) from ``start`` a hand that moves ``by`` pixels pulls something, in lengths.

        Seen along the way itself, up in the picture pulls forward along it. None behind the viewpoint.
        """
        stretched = np.array([1.0, 1.0, self.stretch])
        near, far = self.ray(*self.screen(start)[0, :2].tolist())
        side = np.linalg.svd(((far - near) * stretched)[None])[2][1] / stretched * np.linalg.norm(way * stretched)
        drawn = self.screen(np.stack([start, start + way, start + side]))[:, :2]
        if not np.isfinite(drawn).all():
            return None
        step, across = drawn[1] - drawn[0], float(np.linalg.norm(drawn[2] - drawn[0]))
        if np.linalg.norm(step) < STEEP * across:
            return -by[1] / across
        return float(np.dot(by, step) / (step @ step))
