"""Closed outlines on sections to the contacts, inside and outside samples of a body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.data import BodyData, BodyIssue
from geofit.data.errors import PointsError, SettingsError
from geofit.data.messages import message
from geofit.geometry.clip import inside

__all__ = ["Outline", "SectionPlane", "from_outlines", "section_planes"]

Floats = NDArray[np.float64]

#: Distance from the plane of their section, as a share of the outlines' size, up to which corners count as flat.
FLAT = 0.01
#: A line that turns by more than this has a corner, in degrees: a circle of twelve corners is still one.
CORNER = 35.0
#: Steps along the side of a square as large as the median outline; contacts on the smallest outline, at least.
STEPS = 10
FEWEST = 8
#: Outside samples go this far beyond the outlines of a section, in sides of their box.
MARGIN = 0.5
#: Outlines whose corners agree within this share of their size are one line drawn twice.
SAME = 1e-3


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed line that bounds one part of a body, or a hole in it, on one section.

    Parameters
    ----------
    section : str
        Name of the section; all outlines of one name lie on one plane. One within another is a hole.
    xyz : (k, 3) array_like
        Corners in map coordinates, metres; the last need not repeat the first.

    Raises
    ------
    PointsError
        If there are fewer than three corners, or one is not finite.
    """

    section: str
    xyz: Floats

    def __init__(self, section: str, xyz: ArrayLike) -> None:
        corners = np.array(xyz, dtype=np.float64)
        if corners.ndim == 2 and corners.shape[1] == 3 and len(corners) > 1:
            corners = corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]
        if corners.ndim != 2 or corners.shape[1:] != (3,) or len(corners) < 3 or not np.isfinite(corners).all():
            raise PointsError(
                message(
                    "bodies.outline-wrong-shape",
                    "An outline of section '{section}' has shape {shape}: give three or more different, finite "
                    "corners, (k, 3), in metres.",
                    section=section,
                    shape=corners.shape,
                )
            )
        corners.setflags(write=False)
        object.__setattr__(self, "section", section)
        object.__setattr__(self, "xyz", corners)


@dataclass(frozen=True, eq=False)
class SectionPlane:
    """The plane of a section and its outlines on it.

    ``origin`` (3,) is the middle of the corners, ``axes`` (2, 3) span the plane, ``rings`` are outlines (k, 2) along
    the axes, anticlockwise, those of holes clockwise.
    """

    name: str
    origin: Floats
    axes: Floats
    rings: tuple[Floats, ...]

    @property
    def normal(self) -> Floats:
        """Unit normal (3,) of the plane."""
        return np.cross(self.axes[0], self.axes[1])

    @property
    def parts(self) -> tuple[Floats, ...]:
        """Outlines (k, 2) of parts of the body, without those of holes."""
        return tuple(ring for ring in self.rings if _area(ring) > 0)

    def to_map(self, plane: Floats) -> Floats:
        """Return map coordinates (n, 3) of places (n, 2) on the plane."""
        return np.asarray(self.origin + plane @ self.axes)

    def inside(self, plane: Floats) -> NDArray[np.bool_]:
        """Return whether (n, 2) places lie in the body: within an odd number of outlines."""
        return _within(plane, self.rings)


def section_planes(outlines: Sequence[Outline]) -> tuple[SectionPlane, ...]:
    """Return the planes of sections, in the order in which their names occur; repeated outlines count once.

    Raises
    ------
    PointsError
        If the outlines of a section do not lie on one plane, bound no area, or cross themselves or each other.
    """
    return _planes(_distinct(outlines)[0])


def _planes(outlines: Sequence[Outline]) -> tuple[SectionPlane, ...]:
    planes = []
    for name in dict.fromkeys(outline.section for outline in outlines):
        rings = [outline.xyz for outline in outlines if outline.section == name]
        corners = np.concatenate(rings)
        origin = corners.mean(axis=0)
        _, sizes, axes = np.linalg.svd(corners - origin, full_matrices=False)
        off = float(np.abs((corners - origin) @ axes[2]).max())
        if off > FLAT * sizes[0] / np.sqrt(len(corners)):
            raise PointsError(
                message(
                    "bodies.outlines-off-plane",
                    "The outlines of section '{section}' lie up to {off:.2f} m off one plane. Give each plane a name "
                    "of its own.",
                    section=name,
                    off=off,
                )
            )
        flat = [(ring - origin) @ axes[:2].T for ring in rings]
        _refuse_crossing(name, flat, origin, axes[:2])
        if any(abs(_area(ring)) < 1e-9 * sizes[0] ** 2 for ring in flat):
            raise PointsError(
                message(
                    "bodies.outline-without-area",
                    "An outline of section '{section}' bounds no area: its corners lie on one line.",
                    section=name,
                )
            )
        planes.append(SectionPlane(name, origin, axes[:2], tuple(_turned(flat))))
    return tuple(planes)


def _refuse_crossing(name: str, rings: Sequence[Floats], origin: Floats, axes: Floats) -> None:
    """Refuse rings (k, 2) that cross themselves or each other: they do not say what lies inside.

    Kinks and overlaps below :data:`SAME` of a ring's area are left to the drawing's accuracy.
    """
    import shapely

    polygons = [shapely.Polygon(ring) for ring in rings]
    sound = [shapely.make_valid(polygon) for polygon in polygons]
    for ring, polygon, whole in zip(rings, polygons, sound, strict=True):
        if abs(whole.area - abs(_area(ring))) > SAME * whole.area:
            # Split where it crosses: the first part ends there.
            crossing = shapely.get_coordinates(shapely.get_parts(shapely.node(polygon.exterior))[0])[-1]
            raise PointsError(
                message(
                    "bodies.outline-crosses-itself",
                    "An outline of section '{section}' crosses itself at {place}. Draw each part of the body and each "
                    "hole as an outline of its own.",
                    section=name,
                    place=_words(crossing, origin, axes),
                )
            )
    for first, second in shapely.STRtree(sound).query(sound, predicate="intersects").T.tolist():
        least = min(sound[first].area, sound[second].area)
        shared = shapely.intersection(sound[first], sound[second]).area
        if first < second and SAME * least < shared < (1 - SAME) * least:
            crossing = shapely.get_coordinates(shapely.intersection(sound[first].boundary, sound[second].boundary))
            raise PointsError(
                message(
                    "bodies.outlines-cross",
                    "Two outlines of section '{section}' cross at {place}. Draw them as one outline, or apart; one "
                    "that lies within another is a hole.",
                    section=name,
                    place=_words(crossing[0], origin, axes),
                )
            )


def _words(place: Floats, origin: Floats, axes: Floats) -> str:
    """Return map coordinates of a place (2,) on a plane, in words."""
    return ", ".join(f"{value:.2f}" for value in (origin + place @ axes).tolist())


def from_outlines(outlines: Sequence[Outline], step: float | None = None, *, margin: float | None = None) -> BodyData:
    """Return contacts on outlines, and samples inside and outside them on their planes.

    Parameters
    ----------
    outlines : sequence of Outline
        Of two or more sections.
    step : float, optional
        Distance of contacts along outlines and of samples on the planes, metres; by default a tenth of the side of a
        square as large as the median outline.
    margin : float, optional
        How far beyond its outlines each section is known to be outside, metres; by default half the longer side of
        the box around them.

    Returns
    -------
    BodyData
        The names of sections take the place of those of holes. Its contacts have no normals: an outline shows only
        their part in its plane, and a body fitted as if it crossed its sections at right angles was worse on every
        planted body, left-out sections overlapping by 0.91 in place of 0.998.

    Raises
    ------
    PointsError
        If outlines are not flat, bound no area, or cross themselves or each other.
    SettingsError
        If no outline is given, or a length is not positive.
    """
    if not outlines:
        raise SettingsError(
            message(
                "bodies.no-outline",
                "There is no outline. Give the closed outlines of two or more sections.",
            )
        )
    for name, length in (("step", step), ("margin", margin)):
        if length is not None and not (np.isfinite(length) and length > 0):
            raise SettingsError(
                message(
                    "bodies.length-not-positive",
                    "{setting} is {value}; a finite number of metres above 0 is needed.",
                    setting=name,
                    value=repr(length),
                )
            )
    distinct, repeated = _distinct(outlines)
    planes = _planes(distinct)
    areas = [abs(_area(ring)) for plane in planes for ring in plane.rings]
    step = float(np.sqrt(np.median(areas))) / STEPS if step is None else step
    contacts: list[Floats] = []
    within: list[Floats] = []
    outside: list[Floats] = []
    names: list[list[str]] = [[], [], []]
    for plane in planes:
        on = _resampled(plane.rings, step)
        samples = _samples(plane, on, step, margin)
        side = plane.inside(samples)
        for places, kept, owner in zip(
            (on, samples[side], samples[~side]), (contacts, within, outside), names, strict=True
        ):
            kept.append(plane.to_map(places))
            owner += [plane.name] * len(places)
    return BodyData(
        np.concatenate(contacts),
        np.concatenate(within),
        np.concatenate(outside),
        hole=names[0],
        inside_hole=names[1],
        outside_hole=names[2],
        issues=tuple(_repeated(outline) for outline in repeated),
    )


def _distinct(outlines: Sequence[Outline]) -> tuple[list[Outline], list[Outline]]:
    """Return the outlines without those that repeat an earlier one, and the latter.

    Within itself a repeated outline would be a hole, with the body between the two lines.
    """
    kept: list[Outline] = []
    repeated: list[Outline] = []
    middles, counts = np.array([outline.xyz.mean(axis=0) for outline in outlines]), np.zeros(len(outlines), int)
    for k, outline in enumerate(outlines):
        size = float(np.linalg.norm(np.ptp(outline.xyz, axis=0)))
        near = (counts[:k] == len(outline.xyz)) & (np.abs(middles[:k] - middles[k]).max(axis=1) <= SAME * size)
        if any(_same(outlines[m].xyz, outline.xyz, SAME * size) for m in np.flatnonzero(near).tolist()):
            repeated.append(outline)
        else:
            counts[k] = len(outline.xyz)
            kept.append(outline)
    return kept, repeated


def _same(ring: Floats, other: Floats, tolerance: float) -> bool:
    """Return whether two rings (k, 3) have the same corners in one order, from any corner and in either direction."""
    for turned in (other, other[::-1]):
        first = int(np.argmin(((turned - ring[0]) ** 2).sum(axis=1)))
        if np.abs(np.roll(turned, -first, axis=0) - ring).max() <= tolerance:
            return True
    return False


def _repeated(outline: Outline) -> BodyIssue:
    x, y, z = outline.xyz.mean(axis=0).tolist()
    text = message(
        "bodies.outline-repeated",
        "An outline of section '{section}' with {corners} corners repeats another one: it counts once",
        section=outline.section,
        corners=len(outline.xyz),
    )
    return BodyIssue("coincident", text, (x, y, z))


def _area(ring: Floats) -> float:
    """Signed area of (k, 2) corners, positive anticlockwise."""
    x, y = ring.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def _within(places: Floats, rings: Sequence[Floats]) -> NDArray[np.bool_]:
    """Return whether (n, 2) places lie within an odd number of rings."""
    return np.asarray(sum((inside(ring, places) for ring in rings), np.zeros(len(places), int)) % 2 == 1)


def _turned(rings: Sequence[Floats]) -> list[Floats]:
    """Return the rings anticlockwise; those within an odd number of others clockwise."""
    turned = []
    for k, ring in enumerate(rings):
        others = [other for m, other in enumerate(rings) if m != k]
        hole = bool(_within(ring, others).mean() > 0.5)
        turned.append(ring if (_area(ring) > 0) != hole else ring[::-1])
    return turned


def _resampled(rings: Sequence[Floats], step: float) -> Floats:
    """Return places (n, 2) evenly along rings, on arcs where the corners are those of a smooth line."""
    places = []
    for ring in rings:
        edge = np.roll(ring, -1, axis=0) - ring
        length = np.linalg.norm(edge, axis=1)
        ends = np.append(0.0, np.cumsum(length))
        count = max(FEWEST, int(np.ceil(ends[-1] / step)))
        at = (np.arange(count) + 0.5) * ends[-1] / count
        k = np.clip(np.searchsorted(ends, at, side="right") - 1, 0, len(ring) - 1)
        t = (at - ends[k]) / length[k]
        right = np.column_stack([edge[:, 1], -edge[:, 0]])[k]
        places.append(ring[k] + t[:, None] * edge[k] + (t * (1 - t) * _bulge(edge, length)[k])[:, None] * right)
    return np.concatenate(places)


def _bulge(edge: Floats, length: Floats) -> Floats:
    """Return the angle (k,), radians, between each edge (k, 2) and the arc that it cuts short, positive to the right.

    Corners on a curve are joined by chords, which lie inside where it bulges: a body of such outlines would be too
    small by their sagittas. A corner's turn is shared by its two edges as by two chords of one circle; of an edge's
    ends the one with the smaller share counts, none where they differ in sign. A line that turns by more has a corner
    of its own there, and its edges stay straight.
    """
    after = np.roll(edge, -1, axis=0)
    turn = np.arctan2(edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0], (edge * after).sum(axis=1))
    turn[np.abs(turn) > np.radians(CORNER)] = 0.0
    shared = length + np.roll(length, -1)
    own, next_one = turn * length / shared, turn * np.roll(length, -1) / shared
    former = np.roll(next_one, 1)
    return np.where(own * former > 0, np.sign(own) * np.minimum(np.abs(own), np.abs(former)), 0.0)


def _samples(plane: SectionPlane, on: Floats, step: float, margin: float | None) -> Floats:
    """Return places (n, 2) of a raster around the outlines, half a step or more off them."""
    from scipy.spatial import cKDTree

    corners = np.concatenate(plane.rings)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    beyond = MARGIN * float((upper - lower).max()) if margin is None else margin
    axes = [np.arange(lower[a] - beyond, upper[a] + beyond + step / 2, step) for a in (0, 1)]
    raster = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    # Each part has a sample of its own side, however small it is.
    middles = np.array([ring.mean(axis=0) for ring in plane.rings])
    raster = np.concatenate([raster, middles])
    gap = cKDTree(on).query(raster)[0]
    return np.asarray(raster[gap > np.minimum(step, np.sqrt(abs(min(map(_area, plane.parts))))) / 2])
