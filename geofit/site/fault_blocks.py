"""Horizons that a fault cuts: each block fitted apart, and the displacement along the fault.

A fault is a surface (fitted over its best plane) or its trace in plan. The points of a horizon are split by the side of
each fault they lie on; each block's surface ends where it meets the fault, so that on an inclined fault the blocks end
at two different lines, with the heave between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import FitError, InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import Message, message, plural_message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings
from geofit.data.site import Orientations, Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.pipeline import fit_horizon
from geofit.fitting.request import study_area_of
from geofit.site.dips import dips_within
from geofit.site.fault import BEYOND_TRACE, Fault, Height, longer, longer_side
from geofit.site.height_field import HeightField
from geofit.site.throw import FaultCut, Sides, throws

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry

__all__ = ["BlockFit", "BlockMembers", "area_of", "fit_block", "fit_blocks", "fit_faulted", "part"]

Floats = NDArray[np.float64]

#: Points that a block needs to bend by itself; below three there is no surface at all.
FEW, FEWEST = 6, 3
#: A piece of a block that is a smaller share of the study area needs no surface of its own.
SLIVER = 0.005
#: How far a block's surface is laid beyond its fault, as a share of the area's longer side, before it is cut there.
BEYOND = 0.1


@dataclass(frozen=True, eq=False)
class BlockMembers:
    """The points of a horizon, members by faults.

    ``faults`` are those that part them. ``names`` and ``sides`` of the blocks, those with more points first; ``block``
    (n,) is the number of the block of each point. ``notes`` reports faults that do not cut, and of small blocks.
    """

    faults: tuple[Fault, ...]
    names: tuple[str, ...]
    sides: tuple[Sides, ...]
    block: NDArray[np.int64]
    notes: tuple[Message, ...]


@dataclass(frozen=True, eq=False)
class BlockFit:
    """The blocks of a faulted horizon, each trimmed at its faults, and what the faults displace.

    ``block`` (n,) is the number of the block of each point.
    """

    blocks: tuple[HorizonFit, ...]
    block: NDArray[np.int64]
    cuts: tuple[FaultCut, ...]
    notes: tuple[Message, ...]


def fit_faulted(site: Site, name: str, progress: Progress | None = None) -> BlockFit:
    """Fit the faults that cut a horizon of a site (``site.faults``), then the horizon block by block.

    Raises
    ------
    InputError
        If the site has no such horizon, or no fault that cuts it.
    FitError, SettingsError
        As :func:`fit_blocks`.
    """
    if name not in site.horizons:
        raise InputError(
            message("data.horizon-unknown", "There is no horizon '{name}'", name=name),
            message("data.known-horizons", "The horizons are: {names}.", names=", ".join(site.horizons)),
        )
    cutting = [fault for fault, cut in site.faults.items() if name in cut]
    if not cutting:
        raise InputError(
            message("site.horizon-not-faulted", "No fault of the site cuts '{name}'", name=name),
            message("site.write-fault", 'Write F1 = ["{name}"] under [faults].', name=name),
        )
    faults = []
    for k, fault in enumerate(cutting):
        tell(progress, message("site.fault-name", "fault {name}", name=fault), 0.5 * k / len(cutting))
        settings = site.settings.get(fault, FitSettings())
        faults.append(
            fit_horizon(site.horizons[fault], settings, site.boundary, name=fault, orientations=site.orientations)
        )
    settings = site.settings.get(name, FitSettings())
    return fit_blocks(
        site.horizons[name],
        faults,
        settings,
        site.boundary,
        name=name,
        progress=progress,
        orientations=site.orientations,
    )


@arguments_checked
def fit_blocks(
    points: PointSet,
    faults: Sequence[HorizonFit | ArrayLike],
    settings: FitSettings | None = None,
    boundary: ArrayLike | None = None,
    *,
    name: str = "horizon",
    progress: Progress | None = None,
    orientations: Orientations | None = None,
) -> BlockFit:
    """Fit a horizon apart on each side of its faults, and measure how far they displace it.

    Parameters
    ----------
    points : PointSet
        All points of the horizon.
    faults : sequence of HorizonFit or (k, 2) array_like
        Steep surfaces, or traces in plan (map coordinates), which are continued straight at their ends.
    settings : FitSettings, optional
        Of each block's fit.
    boundary : (k, 2) array_like, optional
        Corners of the study area; without it, of the points' rectangle.
    name : str
        Name of the horizon; its blocks are called "NAME (A)", "NAME (B)", ...
    progress : callable, optional
        Called as ``progress(stage, fraction)``.
    orientations : Orientations, optional
        Measured dips of the site; those that name the horizon go to the block that they lie in.

    Returns
    -------
    BlockFit
        Blocks, the larger ones first. A fault that leaves all points on one side does not cut; a note reports it.

    Raises
    ------
    FitError
        If a block has fewer than three points, or a fault ends before it parts the area.
    SettingsError
        If a fault is neither a surface nor a line in plan.

    Notes
    -----
    A fault that dies out inside the area is continued through it: its throw there is what the blocks' data say.
    """
    area = area_of(points, boundary)
    members = part(points, faults, area, name)
    blocks: list[tuple[Sides, HorizonFit]] = []
    for k, (title, sides) in enumerate(zip(members.names, members.sides, strict=True)):
        tell(progress, message("site.block-name", "block {name}", name=title), 0.5 + 0.5 * k / len(members.names))
        mine = points[np.flatnonzero(members.block == k)]
        dips = (orientations, name)
        blocks.append((sides, fit_block(mine, members.faults, sides, settings, area, name=title, dips=dips)))
    cuts = throws(blocks, members.faults, name, area)
    return BlockFit(tuple(block for _, block in blocks), members.block, cuts, members.notes)


def area_of(points: PointSet, boundary: ArrayLike | None) -> Polygon:
    """Return the study area in map coordinates; without one, the rectangle of the points."""
    import shapely

    if (corners := study_area_of(boundary)) is not None:
        return shapely.Polygon(corners)
    (x0, y0), (x1, y1) = points.xyz[:, :2].min(axis=0), points.xyz[:, :2].max(axis=0)
    return shapely.Polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def part(points: PointSet, faults: Sequence[HorizonFit | ArrayLike], area: Polygon, name: str) -> BlockMembers:
    """Part the points of a horizon by the side of each fault they lie on, and by the pieces that the area has there.

    Parameters and errors as :func:`fit_blocks`; ``area`` is the study area.
    """
    known = [Fault.of(fault, k, area) for k, fault in enumerate(faults)]
    notes: list[Message] = []
    cutting, sides = [], [np.zeros((len(points), 0), np.int64)]
    for fault in known:
        side = fault.side(points.xyz)
        if side.min() == side.max():
            notes.append(
                message(
                    "site.points-on-one-side",
                    "all points of {horizon} lie on one side of {fault}",
                    horizon=name,
                    fault=fault.name,
                ).with_severity("warning")
            )
        else:
            cutting.append(fault)
            sides.append(side[:, None])
    signs, which = np.unique(np.hstack(sides), axis=0, return_inverse=True)
    groups: list[tuple[Sides, NDArray[np.int64]]] = []
    for k, row in enumerate(map(tuple, signs.tolist())):
        mine = np.flatnonzero(which.ravel() == k)
        found, lacking = _by_piece(points.xyz, mine, cutting, row, area, name)
        groups += [(row, one) for one in found]
        notes += lacking
    groups.sort(key=lambda group: -len(group[1]))
    block = np.empty(len(points), np.int64)
    names = [f"{name} ({chr(ord('A') + k)})" if len(groups) > 1 else name for k in range(len(groups))]
    for k, (title, (_, mine)) in enumerate(zip(names, groups, strict=True)):
        block[mine] = k
        if len(mine) < FEWEST:
            text = message(
                "site.block-too-few-points",
                "Too few points in the block '{block}' of {horizon}: {count} ({points}); at least "
                "{least} are needed to fit a surface. Give more points there, or leave the fault out.",
                block=title,
                horizon=name,
                count=len(mine),
                points=tuple(points.describe(int(i)) for i in mine),
                least=FEWEST,
            )
            raise FitError(text)
        if len(mine) < FEW:
            notes.append(
                plural_message(
                    "site.block-rests-on-points",
                    "{block} rests on {count} point only",
                    "{block} rests on {count} points only",
                    block=title,
                    count=len(mine),
                ).with_severity("warning")
            )
    return BlockMembers(tuple(cutting), tuple(names), tuple(row for row, _ in groups), block, tuple(notes))


def _by_piece(
    xyz: Floats, mine: NDArray[np.int64], faults: Sequence[Fault], sides: Sides, area: Polygon, name: str
) -> tuple[list[NDArray[np.int64]], list[Message]]:
    """Part the points of one block by the pieces of its area, as in the arms of a concave one.

    A piece with too few points for a surface has none, and a note; its points stay with the nearest one.
    """
    import shapely

    whole = [piece for piece in _pieces(area, _plane(xyz[mine]), faults, sides) if piece.area > SLIVER * area.area]
    if len(whole) < 2:
        return [mine], []
    places = np.asarray(shapely.points(xyz[mine, :2]))
    away = shapely.distance(places[:, None], np.array(whole, dtype=object))
    count = np.bincount(away.argmin(axis=1), minlength=len(whole))
    notes = [
        message(
            "site.piece-without-surface",
            "{area:whole} m² of the study area of {horizon} lie apart from the rest of their block and have no "
            "surface: points there: {count}, needed: {least}",
            area=piece.area,
            horizon=name,
            count=int(n),
            least=FEWEST,
        ).with_severity("warning")
        for piece, n in zip(whole, count, strict=True)
        if n < FEWEST
    ]
    kept = np.flatnonzero(count >= FEWEST)
    if not len(kept):
        return [mine], notes
    nearest = away[:, kept].argmin(axis=1)
    return [mine[nearest == k] for k in range(len(kept))], notes


def fit_block(
    points: PointSet,
    faults: Sequence[Fault],
    sides: Sides,
    settings: FitSettings | None,
    area: Polygon,
    progress: Progress | None = None,
    *,
    name: str,
    dips: tuple[Orientations | None, str] = (None, ""),
) -> HorizonFit:
    """Fit one block to somewhat beyond its faults, then cut it where its surface meets them.

    Parameters
    ----------
    points : PointSet
        Points of the block.
    faults : sequence of Fault
        Those that part the horizon; ``sides`` says for each on which side the block lies.
    settings : FitSettings, optional
        Of the fit.
    area : shapely.Polygon
        The study area.
    progress : callable, optional
        Called as ``progress(stage, fraction)``.
    name : str
        Name of the block.
    dips : tuple of Orientations and str
        Measured dips of the site, and the name of the horizon that the block belongs to.

    Raises
    ------
    FitError
        If the block's surface has no area on its side of a fault, or the fit fails.
    """
    import shapely

    plan = points.xyz[:, :2]
    guess = _cut(area, _plane(points.xyz), faults, sides, name, plan)
    widened = _home(
        shapely.intersection(shapely.buffer(guess, BEYOND * longer_side(area), join_style="mitre"), area), plan
    )
    corners = shapely.get_coordinates(widened.exterior)[:-1]
    measured = dips_within(*dips, guess, name)
    surface = fit_horizon(points, settings, corners, progress, name=name, orientations=measured)
    height_field = HeightField(surface)
    held = _home(shapely.intersection(area, height_field.area()), plan)
    outline = _cut(held, height_field, faults, sides, name, plan)
    return surface.ended_at(shapely.get_coordinates(outline.exterior)[:-1])


def _plane(xyz: Floats) -> Height:
    """Return the height of the least-squares plane through points (n, 3)."""
    centre = xyz.mean(axis=0)
    slope = np.linalg.lstsq((xyz - centre)[:, :2], xyz[:, 2] - centre[2], rcond=None)[0]

    def height(x: Floats, y: Floats) -> Floats:
        return np.asarray(centre[2] + slope[0] * (x - centre[0]) + slope[1] * (y - centre[1]))

    return height


def _cut(area: Polygon, height: Height, faults: Sequence[Fault], sides: Sides, title: str, plan: Floats) -> Polygon:
    """Return the part of an area, with most of the points (n, 2), where a surface lies on one side of every fault."""
    rest = area
    for fault, sign in zip(faults, sides, strict=True):
        pieces = _pieces(rest, height, [fault], (sign,), area)
        if not pieces:
            text = message(
                "site.block-outside-surface",
                "The block '{block}' has points on a side of {fault} where its surface has no area. "
                "Check the points next to the fault: one on the wrong side makes a block of its own.",
                block=title,
                fault=fault.name,
            )
            raise FitError(text)
        rest = _most(pieces, plan)
    return rest


def _pieces(
    shape: Polygon, height: Height, faults: Sequence[Fault], sides: Sides, area: Polygon | None = None
) -> list[Polygon]:
    """Return all polygons of a shape in which a surface lies on the given side of every fault.

    Traces are those within ``area``, by default the shape.
    """
    import shapely
    from shapely.ops import split

    area, pieces = shape if area is None else area, [shape]
    for fault, sign in zip(faults, sides, strict=True):
        for line in fault.traces(area, height):
            whole = longer(line, BEYOND_TRACE * longer_side(area))
            cut = (one for piece in pieces for one in split(piece, shapely.LineString(whole)).geoms)
            pieces = [one for one in cut if isinstance(one, shapely.Polygon)]
        if not pieces:
            break
        inner = shapely.get_coordinates([shapely.point_on_surface(piece) for piece in pieces])
        side = fault.side(np.column_stack([inner, height(*inner.T)]))
        pieces = [piece for piece, one in zip(pieces, side, strict=True) if one == sign]
    return pieces


def _home(shape: BaseGeometry, plan: Floats) -> Polygon:
    """Return the polygon, of those that an intersection left, with most of the points (n, 2)."""
    import shapely

    return _most([one for one in shapely.get_parts(shape) if isinstance(one, shapely.Polygon)], plan)


def _most(pieces: Sequence[Polygon], plan: Floats) -> Polygon:
    import shapely

    return max(pieces, key=lambda piece: (int(shapely.intersects_xy(piece, *plan.T).sum()), piece.area))
