"""Local frames: where a surface is a height field, and where the numbers keep their digits (METHOD, sec. 8)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.long_arrays import blocks, covariance
from geofit.data.points import PointSet

__all__ = ["Frame", "FrameKind", "best_plane_frame", "map_frame", "plane_axes", "section_azimuth"]

Floats = NDArray[np.float64]
#: What a frame lies along: the map, the points' best plane, or the map below a folded surface, a height over no plane.
FrameKind = Literal["map", "best-plane", "sections"]


@dataclass(frozen=True, eq=False)
class Frame:
    """A right-handed frame: ``local = axes @ (world - origin)``.

    Parameters
    ----------
    origin : (3,) array
        Map coordinates of the local origin, metres.
    axes : (3, 3) array
        Rows are the unit vectors of u, v and the height w.
    kind : FrameKind
        "map", "best-plane" or "sections".
    """

    origin: Floats
    axes: Floats
    kind: FrameKind

    def to_local(self, xyz: ArrayLike) -> Floats:
        """Return (n, 3) local coordinates of (n, 3) map coordinates."""
        world = np.asarray(xyz, float)
        local = np.empty(world.shape)
        for part, rows in blocks(world.reshape(-1, 3), local.reshape(-1, 3)):
            x, y, z = (part - self.origin).T
            # Not a matrix product: its last digits depend on how many points there are.
            for k, (a, b, c) in enumerate(self.axes.tolist()):
                rows[:, k] = a * x + b * y + c * z
        return local

    def turn_back(self, local: ArrayLike) -> Floats:
        """Return local coordinates (..., 3) turned to the map's axes, still about the origin."""
        return np.asarray(local, float) @ self.axes

    def plan(self, xy: ArrayLike) -> Floats:
        """Return (n, 2) in-plane coordinates of (n, 2) map coordinates; for the map frame only."""
        xy = np.asarray(xy, float)
        return (xy - self.origin[:2]) @ self.axes[:2, :2].T


def section_azimuth(plan: Floats, section: NDArray[np.str_]) -> float | None:
    """Return the direction that most sections run in, radians anticlockwise from east, or None.

    The axial mean of the sections' principal directions, each weighted by its number of points; None where
    no section has three points in a line, or the sections run every way.
    """
    doubled, total = 0j, 0.0
    for name in np.unique(section[section != ""]):
        line = plan[section == name]
        if len(line) < 3:
            continue
        centred = line - line.mean(axis=0)
        _, extent, directions = np.linalg.svd(centred, full_matrices=False)
        if extent[0] > 0 and extent[1] < 0.2 * extent[0]:
            angle = np.arctan2(directions[0, 1], directions[0, 0])
            doubled += len(line) * np.exp(2j * angle)
            total += len(line)
    if total == 0 or abs(doubled) < 0.3 * total:
        return None
    return float(np.angle(doubled) / 2)


def map_frame(points: PointSet, along: float | None = None) -> Frame:
    """Return a height-field frame over the map, its v axis along ``along`` (radians from east).

    Without a direction the axes stay east and north. A direction within 45 degrees of east makes u the
    section direction's normal all the same: v always runs along the sections.
    """
    v = np.array([0.0, 1.0]) if along is None else np.array([np.cos(along), np.sin(along)])
    if v[1] < -1e-9 or (abs(v[1]) <= 1e-9 and v[0] < 0):
        v = -v
    v[np.abs(v) < 1e-12] = 0.0
    axes = np.array([[v[1], -v[0], 0.0], [v[0], v[1], 0.0], [0.0, 0.0, 1.0]])
    return Frame(_origin(points.xyz), axes, "map")


def best_plane_frame(points: PointSet) -> Frame:
    """Return a frame over the plane of least squares: u along the strike, v up the dip, w upwards."""
    # Eigenvectors of the 3 x 3 moments: a million points need no decomposition of their own.
    return Frame(_origin(points.xyz), plane_axes(covariance(points.xyz)[1]), "best-plane")


def plane_axes(products: Floats) -> Floats:
    """Return the (3, 3) axes of the plane of least squares from the products of coordinates about their mean."""
    normal = np.linalg.eigh(products)[1][:, 0]
    if normal[2] < 0:
        normal = -normal
    strike = np.cross([0.0, 0.0, 1.0], normal)
    if np.linalg.norm(strike) < 1e-9:
        strike = np.array([1.0, 0.0, 0.0])
    strike /= np.linalg.norm(strike)
    return np.array([strike, np.cross(normal, strike), normal])


def _origin(xyz: Floats) -> Floats:
    """Whole metres near the centre: exact in the STEP file, and easy to read there."""
    # Column by column: along the short rows of a million points it takes five times as long.
    middle: Floats = np.round([(column.min() + column.max()) / 2 for column in xyz.T])
    return middle
