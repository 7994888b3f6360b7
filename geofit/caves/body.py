"""The body of surveyed passages: a swept section along each shot, sharp within a branch, blended where branches meet.

The section is made of four quarter ellipses, with semi-axes left, right, up and down, linear from one end of a shot to
the other. In caves up and down are measured vertically, so across a shot of inclination i they count with cos i; along
shots steeper than 60 degrees they lie along the passage, and the mean of left and right replaces them. Where a shot
ends, half an ellipsoid closes it, or fills the outer side of a bend; what was measured along the next shot is kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.implicit_body import OwnField
from geofit.caves.adjust import AdjustedSurvey, adjust_survey
from geofit.caves.columns import Columns, columns
from geofit.caves.sections import Sections, sections
from geofit.caves.survey import Survey
from geofit.caves.sweep_loops import SweepCells, ranges
from geofit.caves.sweeps import Sweeps
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message

__all__ = ["Ends", "PassageBody", "centreline_body"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Ends = Literal["round", "flat"]

#: Steeper shots are shafts: up and down lie along them, degrees.
STEEP = 60.0
#: A wall is no nearer than this, so that a station at a wall leaves a body, metres.
THIN = 0.05
#: Passages so many times as high as wide, or as wide as high, are slots. Cells as small as :attr:`PassageBody.fine` are
#: so many along their walls that volumes take wider ones, until there are this many, at most this part of the width.
SLOT, SLOT_CELLS, SLOT_WIDTH = 8.0, 200_000, 0.375


@arguments_checked
@dataclass(frozen=True, eq=False)
class PassageBody(OwnField):
    """The body of the passages of a survey; a field in the sense of :class:`geofit.implicit.Field`.

    Parameters
    ----------
    adjusted : AdjustedSurvey
        The survey with the coordinates of its stations and its loops.
    sections : Sections
        Walls at the ends of the shots, those that were filled among them.
    sweeps : Sweeps
        The swept sections.
    blend : float
        Radius of the smooth union where branches meet, metres: the body swells by a quarter of it at most.
    """

    most_cells: ClassVar[int] = 1 << 20

    adjusted: AdjustedSurvey
    sections: Sections
    sweeps: Sweeps
    blend: float

    def __repr__(self) -> str:
        return f"<PassageBody {self.name}: {len(self.sweeps.length)} passages, {self.length:.1f} m>"

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Corners of a box that contains the body, (3,) each, metres."""
        low, high = self.boxes
        return low.min(axis=0), high.max(axis=0)

    @cached_property
    def boxes(self) -> tuple[Floats, Floats]:
        """Corners (k, 3), (k, 3) of a box round each sweep, metres."""
        s = self.sweeps
        far = np.maximum(s.walls.max(axis=(1, 2)), s.cap.max(axis=1))[:, None] + self.blend / 4
        end = s.origin + s.length[:, None] * s.along
        return np.minimum(s.origin, end) - far, np.maximum(s.origin, end) + far

    @property
    def lipschitz(self) -> float:
        """Infinite: flat sections have steep fields. :meth:`range_in` bounds the values instead."""
        return np.inf

    def value(self, xyz: ArrayLike) -> Floats:
        """Return the field (n,) at points (n, 3), metres: negative inside; a distance where sections are round."""
        return self._cells.values(_points(xyz))

    def gradient(self, xyz: ArrayLike) -> Floats:
        """Return the gradients (n, 3) at points (n, 3), by central differences over 0.1 mm."""
        points, step = _points(xyz), 5e-5 * np.eye(3)
        return np.stack([(self.value(points + s) - self.value(points - s)) / 1e-4 for s in step], axis=1)

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds (k,), (k,) of the field in boxes with corners (k, 3)."""
        from geofit.implicit.field import box_corners

        return ranges(self.sweeps, self.blend, *box_corners(lower, upper))

    @property
    def name(self) -> str:
        """What files call it."""
        return "passages"

    @property
    def field(self) -> Self:
        """The body itself."""
        return self

    @property
    def spacing(self) -> float:
        """The spacing that resolves the narrowest passages, metres."""
        return self.fine

    @property
    def overview_spacing(self) -> float:
        """Edge of the overview's cells, metres: it resolves most passages; those thinner than it may be lost."""
        return self.fine

    def thinner_than(self, spacing: float) -> tuple[tuple[str, str], ...]:
        """Return the shots whose section is somewhere thinner than a spacing: triangles and volumes may lose them."""
        walls, survey = self.sweeps.walls, self.adjusted.survey
        thin = np.minimum(walls[..., 0] + walls[..., 1], walls[..., 2] + walls[..., 3]).min(axis=1) < spacing
        return tuple(
            (survey.stations[survey.start[shot]], survey.stations[survey.end[shot]])
            for shot in self.sections.shot[thin].tolist()
        )

    def columns(self, spacing: float | None = None) -> Columns:
        """Return the body as vertical intervals on a grid in plan, for volumes (:mod:`geofit.caves.columns`).

        The default spacing is :attr:`fine`, up to three times as much in a body of long slots, whose volume then errs
        by up to 0.2 %.
        """
        step = _spacing(spacing if spacing is not None else self._volume_spacing)
        return columns(self._cells, self.boxes, step)

    def volume(self, spacing: float | None = None) -> float:
        """Return the volume in cubic metres; overlaps of passages count once."""
        return self.columns(spacing).volume

    @property
    def _volume_spacing(self) -> float:
        across = self.sweeps.walls[..., ::2] + self.sweeps.walls[..., 1::2]
        if np.median(across.max(axis=2) / across.min(axis=2)) < SLOT:
            return self.fine
        area = 2 * float((self.sweeps.length * across.sum(axis=2).mean(axis=1)).sum())
        return float(np.clip(np.sqrt(area / SLOT_CELLS), self.fine, 8 * SLOT_WIDTH * self.fine))

    @cached_property
    def _cells(self) -> SweepCells:
        return SweepCells(self.sweeps, self.blend, self.bounds)

    @property
    def length(self) -> float:
        """Sum of the adjusted lengths of the passages that count, metres."""
        counted = self.adjusted.survey.counted[self.sections.shot]
        return float(self.sweeps.length[counted].sum())

    @property
    def fine(self) -> float:
        """A spacing that resolves most sections: an eighth of the median diameter, metres."""
        walls = self.sweeps.walls
        return float(np.median(np.minimum(walls[..., 0] + walls[..., 1], walls[..., 2] + walls[..., 3]))) / 8


@arguments_checked
def centreline_body(
    survey: Survey | AdjustedSurvey,
    *,
    radius: float | None = None,
    ends: Ends = "round",
    blend: float | None = None,
) -> PassageBody:
    """Return the body of the passages of a survey.

    Parameters
    ----------
    survey : Survey or AdjustedSurvey
        Stations, shots and walls; a survey is adjusted with its default errors.
    radius : float, optional
        Distance of the walls where a survey has none at all, metres.
    ends : {"round", "flat"}
        How a passage ends at its last station: half an ellipsoid beyond it, or a plane through it (tunnels).
    blend : float, optional
        Radius of the smooth union where branches meet, metres; by default half of the median wall distance.

    Returns
    -------
    PassageBody
        A field in metres, negative in the passages; walls that were filled are listed in ``sections.filled``.

    Raises
    ------
    SurveyError
        If stations are unconnected, or passages have no size.
    SettingsError
        If a setting is out of its range.

    Notes
    -----
    A section of four quarter ellipses at each station, swept to the next one, and a smooth union of the sweeps; loops
    are adjusted first (:func:`geofit.caves.adjust_survey`).
    """
    if ends not in ("round", "flat"):
        raise SettingsError(
            message("caves.ends-unknown", "The ends '{ends}' are unknown; give 'round' or 'flat'.", ends=ends)
        )
    if (blend is not None and not blend >= 0) or (radius is not None and not radius > 0):
        raise SettingsError(
            message("caves.blend-or-radius-unusable", "The blend must be 0 or more, the radius above 0, in metres.")
        )
    adjusted = adjust_survey(survey) if isinstance(survey, Survey) else survey
    found = sections(adjusted, radius)
    sweeps = _sweeps(adjusted, found, ends)
    return PassageBody(adjusted, found, sweeps, float(np.median(sweeps.walls)) / 2 if blend is None else float(blend))


def _sweeps(adjusted: AdjustedSurvey, found: Sections, ends: Ends) -> Sweeps:
    survey = adjusted.survey
    start, end = found.place.T
    vector = adjusted.xyz[survey.end[found.shot]] - adjusted.xyz[survey.start[found.shot]]
    length = np.linalg.norm(vector, axis=1)
    along = vector / length[:, None]
    flat = np.hypot(along[:, 0], along[:, 1])
    # A vertical shot has no right hand: east, as good as any.
    right = np.where(
        flat[:, None] > 1e-6, np.column_stack([along[:, 1], -along[:, 0], np.zeros(len(along))]), [1.0, 0, 0]
    )
    right /= np.linalg.norm(right, axis=1)[:, None]
    walls = np.maximum(found.walls, THIN) if survey.across else across(found.walls, flat)
    # A shot that was surveyed again is the same passage, not another branch.
    links, same = np.unique(np.sort(np.column_stack([start, end]), axis=1), axis=0, return_inverse=True)
    degree = np.bincount(links.ravel(), minlength=len(survey.stations))
    up = np.cross(right, along)
    # A lone round section ends in half a ball.
    cap = (walls[..., 0] + walls[..., 1] + walls[..., 2] + walls[..., 3]) / 4
    if ends == "flat":
        cap = np.where(np.column_stack([degree[start], degree[end]]) == 1, 0.0, cap)
    onward = np.zeros((len(start), 2, 3))
    _bend(cap, onward, np.column_stack([start, end]), same.ravel(), along, (right, up), walls)
    branch = _branches(start, end, degree, same.ravel())
    return Sweeps(adjusted.xyz[survey.start[found.shot]], along, right, up, length, walls, cap, onward, branch)


def _bend(
    cap: Floats, onward: Floats, place: Ints, same: Ints, along: Floats, frame: tuple[Floats, Floats], walls: Floats
) -> None:
    """Set (in place) cap and way onward of each end where other shots go on, (k, 2) and (k, 2, 3).

    The cap fills the outer side of a bend as far as the wall there is from the axis: the mean of all walls would reach
    through the walls of a slot that turns. Where three or more shots meet no plane bounds it, and it would reach into
    narrower ones: there it goes no farther than theirs.
    """
    at: dict[int, list[tuple[int, int]]] = {}
    for shot, ends in enumerate(place.tolist()):
        for end, station in enumerate(ends):
            at.setdefault(station, []).append((shot, end))

    def leaving(shot: int, end: int) -> Floats:
        return np.asarray((1 - 2 * end) * along[shot])

    def reach(shot: int, end: int, way: Floats) -> float:
        side, level = (-float(way @ axis[shot]) for axis in frame)
        a, b = walls[shot, end, 1 if side >= 0 else 0], walls[shot, end, 2 if level >= 0 else 3]
        turn = np.hypot(side, level)
        return float(turn / np.hypot(side / a, level / b) if turn > 1e-6 else min(a, b))

    for meeting in at.values():
        for shot, end in meeting:
            others = {int(same[k]): (k, e) for k, e in meeting if same[k] != same[shot]}
            if not others:
                continue
            # Beyond a bend the next shot counts; where more shots meet, none is wider than its own walls there.
            if len(others) == 1:
                (other,) = others.values()
                onward[shot, end] = leaving(*other)
                cap[shot, end] = reach(shot, end, onward[shot, end])
            else:
                cap[shot, end] = max(min(reach(shot, end, leaving(*k)), walls[k].max()) for k in others.values())


def across(walls: Floats, cosine: Floats) -> Floats:
    """Return the semi-axes (k, 2, 4) across shots from walls as they were measured and cosines of inclination (k,)."""
    steep = cosine < np.cos(np.radians(STEEP))
    mean = walls[..., :2].mean(axis=2, keepdims=True)
    vertical = np.where(steep[:, None, None], mean, walls[..., 2:] * cosine[:, None, None])
    return np.asarray(np.maximum(np.concatenate([walls[..., :2], vertical], axis=2), THIN))


def _branches(start: Ints, end: Ints, degree: Ints, same: Ints) -> Ints:
    """Return the branch (k,) of each shot.

    Shots share it that meet at a station with two neighbours, or join the same stations: those have equal ``same``.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(start)
    first: dict[int, int] = {}
    pairs = list(zip(np.unique(same, return_index=True)[1][same].tolist(), range(count), strict=True))
    for shot, ends in enumerate(zip(start.tolist(), end.tolist(), strict=True)):
        for station in ends:
            if degree[station] == 2:
                pairs.append((first.setdefault(station, shot), shot))
    links = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _points(xyz: ArrayLike) -> Floats:
    from geofit.implicit.field import points_of

    return points_of(xyz)


def _spacing(spacing: float) -> float:
    if not (np.isfinite(spacing) and spacing > 0):
        raise SettingsError(
            message("caves.spacing-not-positive", "The spacing is {spacing}; give metres above 0.", spacing=spacing)
        )
    return float(spacing)
