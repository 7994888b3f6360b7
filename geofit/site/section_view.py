"""What a vertical section shows: surfaces with their bands, the ground, holes with lithology, points. Plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.data.prediction import Uncertainty
from geofit.data.site import Ground, Hole, Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.mesh import Mesh
from geofit.prediction.section_bands import SectionBand, section_bands
from geofit.sampling.cut import cut_section, section_line
from geofit.site.hole_logs import hole_intervals
from geofit.site.support import support_of
from geofit.surfaces.protocol import Surface

__all__ = [
    "BodyTrace",
    "HoleTrack",
    "Interval",
    "SectionView",
    "Trace",
    "lithologies",
    "parallel_lines",
    "section_view",
]

Floats = NDArray[np.float64]

#: Places of the ground along a section.
GROUND_PLACES = 400
#: Lines of a section need not be nearer to the surface than this, metres.
TOLERANCE = 0.05
#: Pieces of a hole to the thickness of a section, and pieces of a hole at most.
PIECES, MOST_PIECES = 16, 4000


@dataclass(frozen=True, eq=False)
class Trace:
    """A stretch of a surface: ``distance`` and ``z`` (n,), metres; ``band`` is its 90 % band, None if unknown.

    ``supported`` is false above the ground and beyond the points of the surface: such stretches are drawn dashed.
    """

    distance: Floats
    z: Floats
    supported: bool
    band: SectionBand | None = None


@dataclass(frozen=True, eq=False)
class Interval:
    """A logged interval of a hole: its code, its ``track`` (k, 2) of distance and elevation (m), its table's file."""

    code: str
    track: Floats
    table: str = ""


@dataclass(frozen=True, eq=False)
class HoleTrack:
    """A hole within the section's thickness: ``track`` (k, 2), and how near it comes ``beside`` it, metres."""

    name: str
    track: Floats
    beside: float
    intervals: tuple[Interval, ...] = ()


@dataclass(frozen=True, eq=False)
class BodyTrace:
    """A body on a section: ``rings`` are closed outlines (k, 2) of distance and elevation, metres, holes clockwise.

    ``band`` are the lines (k, 2) between which its surface lies with 80 % chance; empty where that is not known.
    """

    name: str
    colour: str
    rings: tuple[Floats, ...]
    band: tuple[Floats, ...] = ()


@dataclass(frozen=True, eq=False)
class SectionView:
    """A section along ``line`` (k, 2), map coordinates; everything else over the distance along it, metres.

    ``bends`` are the distances of the corners; ``points`` by horizon (n, 2), those within half of the ``thickness``.
    ``stale`` names the surfaces and bodies that are shown and are older than their data; ``blocks`` the horizons of
    which fault blocks are shown (:class:`~geofit.data.site.Site`).
    """

    name: str
    line: Floats
    bends: Floats
    thickness: float
    traces: Mapping[str, tuple[Trace, ...]]
    ground: Floats
    holes: tuple[HoleTrack, ...]
    points: Mapping[str, Floats]
    bodies: tuple[BodyTrace, ...] = ()
    stale: tuple[str, ...] = ()
    blocks: Mapping[str, str] = field(default_factory=dict)

    @property
    def length(self) -> float:
        """Length along the line, metres."""
        return float(self.bends[-1])

    @property
    def levels(self) -> tuple[float, float]:
        """Lowest and highest elevation of anything that is shown."""
        found = [one.z for traces in self.traces.values() for one in traces]
        found += [
            self.ground[:, 1],
            *(hole.track[:, 1] for hole in self.holes),
            *(p[:, 1] for p in self.points.values()),
            *(line[:, 1] for body in self.bodies for line in (*body.rings, *body.band)),
        ]
        z = np.concatenate([np.empty(0), *found])
        z = z[np.isfinite(z)]
        return (float(z.min()), float(z.max())) if len(z) else (0.0, 1.0)


def section_view(
    site: Site,
    surfaces: Mapping[str, Surface],
    line: ArrayLike,
    thickness: float,
    *,
    name: str = "",
    uncertainty: Mapping[str, Uncertainty] | None = None,
    meshes: Mapping[str, Mesh] | None = None,
) -> SectionView:
    """Cut a site along a line in plan.

    Parameters
    ----------
    site : Site
        Points, ground, holes and their interval tables.
    surfaces : mapping of str to Surface
        Surfaces by horizon.
    line : (k, 2) array_like
        Corners of the section in plan, map coordinates, metres.
    thickness : float
        Holes and points within half of this to each side are shown, metres.
    name : str
        Name of the section.
    uncertainty : mapping of str to Uncertainty, optional
        Standard deviations, for the 90 % bands.
    meshes : mapping of str to Mesh, optional
        Triangles of the surfaces, where several sections are cut.

    Raises
    ------
    SettingsError
        If the line has fewer than two different corners, or the thickness is not above 0.
    """
    if not thickness > 0:
        raise SettingsError(
            message(
                "site.section-thickness-not-positive",
                "The section's thickness is {value:g} m. Give one above 0.",
                value=thickness,
            )
        )
    corners = section_line(line)
    bends = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    bands = uncertainty or {}
    traces = {}
    for horizon, surface in surfaces.items():
        points = site.horizons.get(horizon)
        support = None if points is None else support_of(points.xyz, site.ground)
        found: list[Trace] = []
        mesh = None if meshes is None else meshes.get(horizon)
        cuts = cut_section(surface, corners, tolerance=TOLERANCE, mesh=mesh)
        known: tuple[SectionBand | None, ...] = (None,) * len(cuts)
        if isinstance(surface, HorizonFit):
            known = section_bands(surface, bands.get(horizon), corners, cuts)
        for cut, band in zip(cuts, known, strict=True):
            held = np.ones(len(cut.distance), bool) if support is None else support.within(cut.xyz)
            for run in _runs(held):
                part = None if band is None else band.part(run)
                found.append(Trace(cut.distance[run], cut.xyz[run, 2], bool(held[run.start]), part))
        traces[horizon] = tuple(found)
    shown = {}
    for horizon, points in site.horizons.items():
        along, beside = _onto(corners, bends, points.xyz[:, :2])
        near = beside <= thickness / 2
        shown[horizon] = np.column_stack([along[near], points.xyz[near, 2]])
    holes = tuple(track for hole in site.holes if (track := _hole(site, hole, corners, bends, thickness)) is not None)
    ground = _ground(site.ground, corners, bends)
    return SectionView(name, corners, bends, thickness, traces, ground, holes, shown, blocks=site.blocks)


def parallel_lines(axis: ArrayLike, spacing: float, half: float) -> dict[str, Floats]:
    """Return sections across an axis, every so many metres along it, named by their chainage ("0+100").

    Parameters
    ----------
    axis : (k, 2) array_like
        The axis in plan, a dam's for one; metres.
    spacing : float
        Distance between two sections along the axis, metres.
    half : float
        Length of each section to the left and to the right of the axis, metres. Sections run from left to right,
        looking along the axis.

    Raises
    ------
    SettingsError
        If the spacing or the length is not above 0, or there would be more than 500 sections.

    Examples
    --------
    >>> lines = parallel_lines([[0, 0], [0, 250]], 100.0, 30.0)
    >>> list(lines), lines["0+100"].tolist()
    (['0+000', '0+100', '0+200'], [[-30.0, 100.0], [30.0, 100.0]])
    """
    corners = section_line(axis)
    steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    start = np.concatenate([[0.0], np.cumsum(steps)])
    if not (spacing > 0 and half > 0) or start[-1] / spacing > 500:
        raise SettingsError(
            message(
                "site.section-spacing-unusable",
                "Sections every {spacing:g} m along {length:.0f} m, {half:g} m to each side: give a spacing and a "
                "length above 0, and at most 500 sections.",
                spacing=spacing,
                length=float(start[-1]),
                half=half,
            )
        )
    lines = {}
    for at in np.arange(0.0, start[-1] + 1e-9 * spacing, spacing):
        k = min(int(np.searchsorted(start, at, side="right")) - 1, len(steps) - 1)
        way = (corners[k + 1] - corners[k]) / steps[k]
        right = np.array([way[1], -way[0]])
        place = corners[k] + (at - start[k]) * way
        whole, rest = divmod(round(float(at), 3), 1000.0)
        chainage = f"{whole:.0f}+{rest:03.0f}" if abs(rest - round(rest)) < 1e-6 else f"{whole:.0f}+{rest:07.3f}"
        lines[chainage] = np.stack([place - half * right, place + half * right])
    return lines


def lithologies(views: list[SectionView]) -> tuple[str, ...]:
    """Return the codes of all intervals that sections show, sorted: the legend of their colours and patterns."""
    return tuple(sorted({one.code for view in views for hole in view.holes for one in hole.intervals}))


def _runs(held: NDArray[np.bool_]) -> list[slice]:
    """Return stretches of equal support; one ends where the next begins."""
    ends = [0, *(np.flatnonzero(np.diff(held)) + 1).tolist(), len(held)]
    return [slice(a, min(b + 1, len(held))) for a, b in pairwise(ends)]


def _ground(ground: Ground | None, corners: Floats, bends: Floats) -> Floats:
    if ground is None:
        return np.empty((0, 2))
    distance = np.union1d(np.linspace(0.0, bends[-1], GROUND_PLACES), bends)
    x, y = (np.interp(distance, bends, corners[:, k]) for k in range(2))
    return np.column_stack([distance, ground.elevation(x, y)])


def _onto(corners: Floats, bends: Floats, plan: Floats) -> tuple[Floats, Floats]:
    """Return how far along the line each (n, 2) place is, and how far beside it, metres; infinite beyond its ends."""
    along, beside = np.zeros(len(plan)), np.full(len(plan), np.inf)
    for k in range(len(corners) - 1):
        way = corners[k + 1] - corners[k]
        free = (plan - corners[k]) @ way / (way @ way)
        share = np.clip(free, 0.0, 1.0)
        away = np.linalg.norm(plan - corners[k] - share[:, None] * way, axis=1)
        beyond = (free < 0) if k == 0 else np.zeros(len(plan), bool)
        beyond |= (free > 1) if k == len(corners) - 2 else False
        away = np.where(beyond, np.inf, away)
        nearer = away < beside
        along[nearer], beside[nearer] = (bends[k] + share * (bends[k + 1] - bends[k]))[nearer], away[nearer]
    return along, beside


def _hole(site: Site, hole: Hole, corners: Floats, bends: Floats, thickness: float) -> HoleTrack | None:
    track, beside = _near(hole.xyz, corners, bends, thickness)
    if len(track) < 2:
        return None
    intervals: list[Interval] = []
    for one in hole_intervals(site, hole):
        part, _ = _near(one.xyz, corners, bends, thickness)
        if len(part) >= 2:
            intervals.append(Interval(one.code, part, one.table))
    return HoleTrack(hole.name, track, beside, tuple(intervals))


def _near(xyz: Floats, corners: Floats, bends: Floats, thickness: float) -> tuple[Floats, float]:
    """Return distance and elevation (k, 2) of the part of a path within the thickness, and how near it comes, metres.

    An inclined hole may have no vertex there: it is looked at in pieces shorter than the section is thick.
    """
    length = np.linalg.norm(np.diff(xyz, axis=0), axis=1)
    pieces = max(float(thickness) / PIECES, float(length.sum()) / MOST_PIECES)
    count = np.maximum(np.ceil(length / pieces), 1).astype(int) if pieces > 0 else np.ones(len(length), int)
    share = np.concatenate([*(k + np.arange(n) / n for k, n in enumerate(count.tolist())), [len(length)]])
    fine = np.column_stack([np.interp(share, np.arange(len(xyz)), column) for column in xyz.T])
    along, beside = _onto(corners, bends, fine[:, :2])
    near = beside <= thickness / 2
    # Of the pieces only those stay at which the path enters and leaves.
    ends = near & ~(np.r_[False, near[:-1]] & np.r_[near[1:], False])
    kept = near & ((share == np.round(share)) | ends)
    return np.column_stack([along[kept], fine[kept, 2]]), float(beside.min())
