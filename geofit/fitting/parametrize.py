"""Charts: where each point stands on the surface (u, v in metres) and what the surface must take there.

A height field over the map or over the best plane takes heights (n,). An overturned fold is not a height field in
any frame: its parametrization is fitted through the section curves, and it takes coordinates (n, 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from geofit.checks.outside import outside
from geofit.data.errors import FitError
from geofit.data.long_arrays import Rows, blocks, covariance
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.fold import Loft, backtracking, loft
from geofit.fitting.sections import section_labels
from geofit.geometry.frame import Frame, best_plane_frame, map_frame, section_azimuth
from geofit.geometry.hull import hull_corners

__all__ = ["STEEP", "Parametrization", "direction_of", "ends_at", "parametrize", "plan_box", "turns_over"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]

#: A surface steeper than this, degrees, is fitted over its best plane.
STEEP = 55.0
#: Points within this distance of each other are at one location, metres.
SAME = 1e-6
#: Thickness of the points across their best plane, relative to either extent in it, that still counts as a plane.
PLANAR = 0.3
#: Share of a section's length that may run backwards before the section counts as overturned.
OVERTURNED = 0.02
#: Points narrower than this share of their length in their best plane lie in a row.
ROW = 0.2
#: Ratio of F by which heights must follow the places across a row before they show a dip there.
SHOWN = 16.0
#: The surface's axes turn along a side of the study area, or of the points' hull, where the rectangle there has less
#: than this share of the area of the one along the map's axes. Chance alone tilts fewer points than the last number.
TILTED_AREA, TILTED_POINTS, TILTED_ENOUGH = 0.8, 0.6, 10
#: Points within the study area that a surface needs to end there, if it is not a height field over the map.
FEWEST = 3
#: Share of the points at which a surface must turn over to be no height field over the map, and the cosine of its dip
#: there, 93 degrees.
TURNED, PAST_VERTICAL = 0.05, -0.05
#: Neighbours of a point that show the slope there, the share of it up the dip that they must resolve, and by how many
#: times its error it must be beyond that of a vertical surface; at most so many points are looked at.
NEIGHBOURS, RESOLVED, CERTAIN, LOOKED_AT = 8, 0.95, 3.0, 5000
#: Slope over the best plane that at least this share of the points must not exceed: what is folded back over the plane
#: looks turned over, and is steep there in between.
GENTLE, FACING = 1.0, 0.95


@dataclass(frozen=True, eq=False)
class Parametrization:
    """Places and values of all points.

    Parameters
    ----------
    frame : Frame
        Local frame.
    plane : (n, 2) array
        u and v of each point, metres.
    values : (n,) or (n, 3) array
        Heights in the frame, or coordinates about the origin, metres.
    area : (u0, u1, v0, v1)
        The rectangle that the surface covers.
    notes : tuple of str
        What was chosen, and why.
    parametrized : (n,) array of bool
        Points whose place is known; the others are projected on the surface of these.
    section : (n,) array of str
        Section of each point, as named or as found; empty for the others.
    boundary : (k, 2) array, optional
        Corners of the study area where it ends the surface, map coordinates.
    """

    frame: Frame
    plane: Floats
    values: Floats
    area: Rectangle
    notes: tuple[Message, ...]
    parametrized: NDArray[np.bool_]
    section: NDArray[np.str_]
    boundary: Floats | None = None

    @property
    def parametric(self) -> bool:
        """Whether the values are coordinates instead of heights."""
        return self.values.ndim == 2

    @property
    def places(self) -> Floats:
        """Where each point stands: (n, 2) in the plane, or (n, 3) in space for a folded surface."""
        return self.values if self.parametric else self.plane

    @property
    def heights(self) -> Floats:
        """What the surface must take there, (n,) metres."""
        return self.values[:, 2] if self.parametric else self.values

    def with_plane(self, plane: Floats) -> Parametrization:
        """Return the parametrization with corrected parameters."""
        return replace(self, plane=plane)


def parametrize(points: PointSet, settings: FitSettings, boundary: Floats | None) -> Parametrization:
    """Choose the frame (METHOD, sec. 8) and place the points in it.

    Raises
    ------
    FitError
        If "sections" is asked for and fewer than two sections are named.
    """
    kind, reason = _choose_kind(points, settings)
    ended, lying_outside = _ended_by(boundary, points, kind)
    notes = [reason, *lying_outside]
    if kind == "sections":
        return replace(_parametrize_over_sections(points, notes), boundary=ended)
    section = section_labels(points)
    upright = kind == "best-plane"
    frame = best_plane_frame(points) if upright else map_frame(points, direction_of(section, points.xyz, boundary))
    local = frame.to_local(points.xyz)
    area = plan_box(local[:, :2])
    if section is not points.section and (section != "").any():
        lines = len(np.unique(section[section != ""]))
        notes.append(
            message("fitting.section-lines-found", "{lines} section lines found in the points' plan", lines=lines)
        )
    if boundary is not None and kind == "map":
        corners = frame.plan(boundary)
        ends = [end(axis) for axis in local[:, :2].T for end in (np.min, np.max)]
        area = plan_box(np.concatenate([np.reshape(ends, (2, 2)).T, corners]))
    placed = np.ones(len(points), bool)
    return Parametrization(frame, local[:, :2], local[:, 2], area, tuple(notes), placed, section, ended)


def ends_at(boundary: Floats, kind: str, xyz: Rows) -> bool:
    """Whether a study area ends a surface in a kind of frame: over the map, or if enough points lie within the area.

    A surface that the area barely meets would have no face left, and no file.
    """
    within = 0
    for (part,) in blocks(xyz):
        if kind == "map" or within >= FEWEST:
            break
        within += int((~outside(boundary, part)).sum())
    return kind == "map" or within >= FEWEST


def _ended_by(boundary: Floats | None, points: PointSet, kind: str) -> tuple[Floats | None, list[Message]]:
    """Return the study area where it ends the surface, and a warning if points lie outside."""
    if boundary is None:
        return None, []
    count, total = int(outside(boundary, points.xyz).sum()), len(points)
    if not ends_at(boundary, kind, points.xyz):
        note = message(
            "fitting.study-area-not-applied",
            "the study area does not end this surface: points outside it: {count} of {total}; at least {least} inside "
            "are needed",
            count=count,
            total=total,
            least=FEWEST,
        )
        return None, [note.with_severity("warning")]
    if not count:
        return boundary, []
    note = message(
        "fitting.points-beyond-study-area",
        "points outside the study area: {count} of {total}; the surface is fitted to them and they count "
        "in sigma, but files of it end at the study area",
        count=count,
        total=total,
    )
    return boundary, [note.with_severity("warning")]


def _choose_kind(points: PointSet, settings: FitSettings) -> tuple[str, Message]:
    if settings.frame != "auto":
        return settings.frame, message("fitting.frame-requested", "frame '{frame}' as requested", frame=settings.frame)
    plane = best_plane_frame(points)
    dip = _dip(points, plane)
    over_map = backtracking(points, map_frame(points))
    if dip < STEEP and over_map <= OVERTURNED:
        return "map", message("fitting.frame-map", "height field over the map (mean dip {dip:.0f}°)", dip=dip)
    extent = np.ptp(plane.to_local(points.xyz), axis=0)
    if over_map <= OVERTURNED and min(extent[:2]) < ROW * max(extent[:2]) and not _upright(points):
        return "map", message(
            "fitting.frame-map-in-a-row",
            "height field over the map: the points lie in a row of {length:.0f} m and do not show that the surface is "
            "steep, neither from one to the next nor across the row; an upright fault there needs frame='best-plane'",
            length=float(max(extent[:2])),
        )
    thin = extent[2] <= PLANAR * min(extent[0], extent[1])
    over_plane = backtracking(points, plane)
    steep = message("fitting.frame-best-plane", "height field over its best plane: it dips {dip:.0f}°", dip=dip)
    if dip >= STEEP and thin and over_plane <= OVERTURNED:
        return "best-plane", steep
    if over_map > OVERTURNED and len(np.unique(points.section[points.section != ""])) >= 2:
        return (
            "sections",
            message(
                "fitting.frame-sections",
                "parametric surface through its sections: {share:.0f} % of their length runs backwards "
                "(overturned), so it is not a height field",
                share=100 * over_map,
            ),
        )
    if over_map <= OVERTURNED and dip >= STEEP and over_plane <= OVERTURNED and turns_over(points, plane):
        return "best-plane", message(
            "fitting.frame-best-plane-turning-over",
            "height field over its best plane, which dips {dip:.0f}°: parts of the surface are steeper than vertical",
            dip=dip,
        )
    if over_map <= OVERTURNED:
        return "map", message(
            "fitting.frame-map-despite-dip",
            "height field over the map: as a whole the points dip {dip:.0f}°, but they scatter across that "
            "plane by {thickness:.0f} m over {length:.0f} x {width:.0f} m; a surface that reaches the vertical needs "
            "frame='best-plane'",
            dip=dip,
            thickness=float(extent[2]),
            length=float(max(extent[:2])),
            width=float(min(extent[:2])),
        )
    if dip >= STEEP:
        return "best-plane", steep
    return "map", message(
        "fitting.frame-map-despite-overturned",
        "height field over the map; some section lines run backwards, check the residuals there; a surface that "
        "overhangs needs frame='sections' and two named sections or more",
    )


def _dip(points: PointSet, plane: Frame) -> float:
    """Return the mean dip in degrees; of points in one line in plan, the dip along that line."""
    moments, axes = np.linalg.eigh(covariance(points.xyz)[1][:2, :2])
    if moments[0] < 0.02**2 * moments[1]:
        xyz = points.xyz - points.xyz.mean(axis=0)
        along = xyz[:, :2] @ axes[:, 1]
        rise = np.abs(np.diff(xyz[np.argsort(along, kind="stable"), 2])).sum()
        if rise > max(4.0, len(xyz) / 6) * np.ptp(xyz[:, 2]):
            # Up and down from point to point: scattered over a vertical plane, no section of a horizon.
            return 90.0
        steep = np.linalg.svd(np.column_stack([along, xyz[:, 2]]), full_matrices=False)[2][0]
        return float(np.degrees(np.arctan2(abs(steep[1]), abs(steep[0]))))
    return float(np.degrees(np.arccos(np.clip(plane.axes[2, 2], -1, 1))))


def turns_over(points: PointSet, plane: Frame) -> bool:
    """Return whether points lie on a height field over their best plane that is steeper than vertical in places.

    What a surface rises up the dip of the plane decides: the strike is level. It is that of a plane through the
    neighbours of a point, where they are not in a row along the strike and lie near enough to that plane. Over a height
    field over the map no such plane turns over; nor do those through points scattered in a volume.
    """
    local = plane.to_local(points.xyz)
    if len(local) <= NEIGHBOURS:
        return False
    at = local[:: -(-len(local) // LOOKED_AT)]
    around = local[KDTree(local[:, :2]).query(at[:, :2], k=NEIGHBOURS + 1)[1]]
    around = around - around.mean(axis=1, keepdims=True)
    places, heights = around[:, :, :2], around[:, :, 2]
    inverse = np.linalg.pinv(places, rcond=0.1)
    slope = (inverse @ heights[:, :, None])[:, :, 0]
    scatter = np.linalg.norm(heights - (places @ slope[:, :, None])[:, :, 0], axis=1) / np.sqrt(NEIGHBOURS - 2)
    rise = slope[:, 1] - CERTAIN * scatter * np.linalg.norm(inverse[:, 1], axis=1)
    upward = (plane.axes[2, 2] - rise * plane.axes[1, 2]) / np.sqrt(1 + slope[:, 0] ** 2 + rise**2)
    resolved = (inverse @ places)[:, 1, 1] > RESOLVED
    gentle = np.mean(np.hypot(*slope.T) > GENTLE) <= 1 - FACING
    return bool(gentle and np.mean(resolved & (upward < PAST_VERTICAL)) >= TURNED)


def _upright(points: PointSet) -> bool:
    """Return whether a row of points shows that the surface is steep: from one to the next, or across the row.

    Rough heights of holes in one row are as thin as a plane that stands on edge, but their neighbours differ little in
    height for their distance, and their heights do not follow the places across the row.
    """
    xyz = points.xyz - points.xyz.mean(axis=0)
    along, across = (xyz[:, :2] @ axis for axis in np.linalg.svd(xyz[:, :2], full_matrices=False)[2])
    step = np.abs(np.diff(xyz[np.argsort(along, kind="stable")], axis=0))
    if np.median(step[:, 2]) > np.tan(np.radians(STEEP)) * np.median(np.hypot(step[:, 0], step[:, 1])):
        return True
    height = xyz[:, 2] - along * (along @ xyz[:, 2]) / (along @ along)
    explained = (across @ height) ** 2
    left = (across @ across) * (height @ height) - explained
    return bool(explained * (len(xyz) - 3) > SHOWN * left)


def direction_of(section: NDArray[np.str_], xyz: Rows, boundary: Floats | None) -> float | None:
    """Return the direction of v: along the sections, else along a side of a tilted study area, or of tilted points."""
    along = section_azimuth(xyz[:, :2], section)
    if along is not None or (boundary is None and len(xyz) < TILTED_ENOUGH):
        return along
    corners, most = boundary, TILTED_AREA
    if corners is None:
        # Some of very many points have the same direction.
        some = np.asarray(xyz[:: -(-len(xyz) // LOOKED_AT)])
        corners, most = hull_corners(some[:, :2]), TILTED_POINTS
    best, angle = most * np.prod(np.ptp(corners, axis=0)), None
    for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side = second - first
        if not side.any():
            continue
        c, s = side / np.hypot(*side)
        size = np.prod(np.ptp(corners @ np.array([[c, -s], [s, c]]), axis=0))
        if size < best:
            best, angle = size, float(np.arctan2(s, c))
    return angle


def _parametrize_over_sections(points: PointSet, notes: Sequence[Message]) -> Parametrization:
    surface: Loft = loft(points)
    lines = len(surface.u)
    if lines < 2:
        text = message(
            "fitting.frame-needs-sections",
            "frame='sections' needs at least two named sections with ordered points; {lines} were given. Name them in "
            "the section column, or choose frame='map' or 'best-plane'.",
            lines=lines,
        )
        raise FitError(text)
    frame = replace(map_frame(points), kind="sections")
    local = frame.to_local(points.xyz)
    area = plan_box(surface.plane[surface.on_line])
    return Parametrization(frame, surface.plane, local, area, (*notes, *surface.notes), surface.on_line, points.section)


def plan_box(plane: Floats) -> Rectangle:
    """Return the rectangle of (n, 2) places, at least a strip wide."""
    low, high = (np.array([end(axis) for axis in plane.T]) for end in (np.min, np.max))
    # A line of points still needs a strip to stand on.
    extent = float((high - low).max())
    short = 0.05 * (extent if extent > SAME else 1.0)
    pad = np.where(high - low < short, short, 0.0)
    low, high = low - pad, high + pad
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])
