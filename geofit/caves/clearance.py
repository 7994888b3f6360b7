"""Distance of passages from a planned excavation."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.caves.adjust import AdjustedSurvey
from geofit.caves.body import PassageBody
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message

__all__ = ["Clearance", "clearance", "excavation_points"]

Floats = NDArray[np.float64]

#: Triangles nearest by their centres that are measured exactly.
_NEAREST = 24
#: Passages thinner than so many spacings may be missing from the triangles.
_THIN = 2.0


@dataclass(frozen=True, eq=False)
class Clearance:
    """Distance of each point of an excavation from the nearest passage wall.

    Parameters
    ----------
    points : (n, 3) array
        Points of the excavation, metres; of a polyline, points along it.
    distance : (n,) array
        Distance from the wall, metres, less the radius of the excavation; below 0 inside a passage.
    wall : (n, 3) array
        The nearest point of a wall.
    station : tuple of str
        The station of the survey nearest to that wall.
    sigma : (n,) array
        Standard deviation of that station's position, metres: the length of its three components.
    """

    points: Floats
    distance: Floats
    wall: Floats
    station: tuple[str, ...]
    sigma: Floats

    @property
    def nearest(self) -> int:
        """Index of the point that is nearest to a passage, or deepest inside one."""
        return int(np.argmin(self.distance))

    @property
    def least(self) -> float:
        """The smallest distance, metres."""
        return float(self.distance[self.nearest])


@arguments_checked
def clearance(
    body: PassageBody,
    excavation: ArrayLike,
    *,
    polyline: bool = True,
    radius: float = 0.0,
    step: float = 1.0,
    spacing: float | None = None,
) -> Clearance:
    """Return the distance of an excavation from the walls of passages.

    Parameters
    ----------
    body : PassageBody
        The passages.
    excavation : (n, 3) array
        Corners of the excavation's axis, or points of it, metres.
    polyline : bool
        Whether they are corners, to be joined, or single points.
    radius : float
        Radius of the excavation about these points, metres.
    step : float
        Distance of the points along a polyline at most, metres.
    spacing : float, optional
        Lattice of the triangles of the walls, metres; by default :attr:`PassageBody.fine` times 2. The walls of
        passages that are too thin for it are points at half of it.

    Raises
    ------
    SettingsError
        If the excavation is not an array of points, or a length is out of its range.
    """
    corners = np.asarray(excavation, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1:] != (3,) or not len(corners) or not np.isfinite(corners).all():
        raise SettingsError(
            message(
                "caves.excavation-wrong-shape",
                "The excavation has shape {shape}; give finite points (n, 3) in metres.",
                shape=corners.shape,
            )
        )
    if not (radius >= 0 and step > 0):
        raise SettingsError(
            message("caves.radius-or-step-unusable", "The radius must be 0 or more and the step above 0, in metres.")
        )
    from scipy.spatial import cKDTree

    points = _along(corners, step) if polyline and len(corners) > 1 else corners
    mesh_spacing = spacing if spacing is not None else 2 * body.fine
    mesh = body.triangulate(mesh_spacing)
    triangles = mesh.vertices[mesh.triangles]
    near = cKDTree(triangles.mean(axis=1)).query(points, k=min(_NEAREST, len(triangles)))[1].reshape(len(points), -1)
    foot = _nearest_on_triangles(points, triangles, near)
    thin = _thin_walls(body, mesh_spacing)
    if len(thin):
        away, nearest = map(np.asarray, cKDTree(thin).query(points))
        lost = away < np.linalg.norm(points - foot, axis=1)
        foot[lost] = thin[nearest[lost]]
    inside = body.value(points) < 0
    distance = np.linalg.norm(points - foot, axis=1) * np.where(inside, -1.0, 1.0) - radius
    adjusted = body.adjusted
    stations = np.unique([adjusted.survey.start[body.sections.shot], adjusted.survey.end[body.sections.shot]])
    closest = stations[cKDTree(adjusted.xyz[stations]).query(foot)[1]]
    return Clearance(
        points,
        distance,
        foot,
        tuple(adjusted.survey.stations[i] for i in closest.tolist()),
        np.linalg.norm(adjusted.sigma, axis=1)[closest],
    )


def _thin_walls(body: PassageBody, spacing: float) -> Floats:
    """Return points (n, 3) on the walls of passages that triangles may lose, about half a spacing apart.

    A section is as in :mod:`geofit.caves.body`: four quarter ellipses, linear along the shot.
    """
    sweeps = body.sweeps
    across = (sweeps.walls[..., ::2] + sweeps.walls[..., 1::2]).min(axis=(1, 2))
    parts = [np.zeros((0, 3))]
    for k in np.flatnonzero(across < _THIN * spacing).tolist():
        walls = sweeps.walls[k]
        t = np.linspace(0.0, 1.0, int(np.ceil(2 * sweeps.length[k] / spacing)) + 1)[:, None, None]
        # The girth is at most 2 pi times the longest semi-axis, so the points are at most half a spacing apart.
        turn = np.linspace(0, 2 * np.pi, 13 * int(np.ceil(walls.max() / spacing)) + 3, endpoint=False)[:, None]
        axes = (1 - t) * walls[0] + t * walls[1]
        side, level = np.cos(turn), np.sin(turn)
        right = side * np.where(side >= 0, axes[..., 1:2], axes[..., 0:1])
        up = level * np.where(level >= 0, axes[..., 2:3], axes[..., 3:4])
        way = sweeps.length[k] * t * sweeps.along[k] + right * sweeps.right[k] + up * sweeps.up[k]
        parts.append((sweeps.origin[k] + way).reshape(-1, 3))
    points = np.concatenate(parts)
    # A point inside another passage is not on a wall.
    return np.asarray(points[body.value(points) > -(body.blend / 4 + 1e-6)])


def excavation_points(excavation: AdjustedSurvey, step: float = 1.0) -> tuple[Floats, float]:
    """Return points (n, 3) along all shots of a planned excavation, no farther apart than a step, and its radius.

    The radius is that of its largest section: the distance of the farthest wall from the axis, metres.
    """
    from geofit.caves.sections import sections

    survey, found = excavation.survey, sections(excavation)
    parts = [_along(excavation.xyz[[survey.start[shot], survey.end[shot]]], step) for shot in found.shot.tolist()]
    return np.unique(np.vstack(parts), axis=0), float(found.walls.max())


def _along(corners: Floats, step: float) -> Floats:
    """Return points along a polyline, its corners among them, no farther apart than a step."""
    parts = []
    for a, b in pairwise(corners):
        count = max(int(np.ceil(np.linalg.norm(b - a) / step)), 1)
        parts.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.vstack([*parts, corners[-1:]])


def _nearest_on_triangles(points: Floats, triangles: Floats, near: NDArray[np.int64]) -> Floats:
    """Return the nearest point (n, 3) on the triangles (m, 3, 3) that are candidates (n, k) of each point."""
    p = np.repeat(points, near.shape[1], axis=0)
    a, b, c = (triangles[near.ravel(), corner] for corner in range(3))
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(axis=1), 1e-300)
    # The foot on the plane by barycentric coordinates; outside the triangle the nearest of its edges.
    u = (np.cross(p - a, c - a) * normal).sum(axis=1) / square
    v = (np.cross(b - a, p - a) * normal).sum(axis=1) / square
    best = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    away = np.where((u >= 0) & (v >= 0) & (u + v <= 1), np.linalg.norm(p - best, axis=1), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        t = np.clip(((p - start) * edge).sum(axis=1) / np.maximum((edge**2).sum(axis=1), 1e-300), 0, 1)
        foot = start + t[:, None] * edge
        distance = np.linalg.norm(p - foot, axis=1)
        nearer = distance < away
        best[nearer], away = foot[nearer], np.minimum(away, distance)
    choice = away.reshape(near.shape).argmin(axis=1)
    return np.asarray(best.reshape(*near.shape, 3)[np.arange(len(points)), choice])
