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
    blocks: dict[Sides, HorizonFit] = {}
    for k, (title, sides) in enumerate(zip(members.names, members.sides, strict=True)):
        tell(progress, message("site.block-name", "block {name}", name=title), 0.5 + 0.5 * k / len(members.names))
        mine = points[np.flatnonzero(members.block == k)]
        dips = (orientations, name)
        blocks[sides] = fit_block(mine, members.faults, sides, settings, area, name=title, dips=dips)
    cuts = throws(blocks, members.faults, name, area)
    return BlockFit(tuple(blocks.values()), members.block, cuts, members.notes)


def area_of(points: PointSet, boundary: ArrayLike | None) -> Polygon:
    """Return the study area in map coordinates; without one, the rectangle of the points."""
    import shapely

    if (corners := study_area_of(boundary)) is not None:
        return shapely.Polygon(corners)
    (x0, y0), (x1, y1) = points.xyz[:, :2].min(axis=0), points.xyz[:, :2].max(axis=0)
    return shapely.Polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def part(points: PointSet, faults: Sequence[HorizonFit | ArrayLike], area: Polygon, name: str) -> BlockMembers:
    """Part the points of a horizon by the side of each fault they lie on.

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
    signs, block, count = np.unique(np.hstack(sides), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(-count, kind="stable")
    block = np.argsort(order)[block.ravel()]
    names = [f"{name} ({chr(ord('A') + k)})" if len(signs) > 1 else name for k in range(len(signs))]
    for k, title in enumerate(names):
        mine = np.flatnonzero(block == k)
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
    rows = tuple(tuple(row) for row in signs[order].tolist())
    return BlockMembers(tuple(cutting), tuple(names), rows, block, tuple(notes))


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

    centre = points.xyz.mean(axis=0)
    slope = np.linalg.lstsq((points.xyz - centre)[:, :2], points.xyz[:, 2] - centre[2], rcond=None)[0]

    def plane(x: Floats, y: Floats) -> Floats:
        return np.asarray(centre[2] + slope[0] * (x - centre[0]) + slope[1] * (y - centre[1]))

    guess = _cut(area, plane, faults, sides, name)
    widened = _largest(
        shapely.intersection(shapely.buffer(guess, BEYOND * longer_side(area), join_style="mitre"), area)
    )
    corners = shapely.get_coordinates(widened.exterior)[:-1]
    measured = dips_within(*dips, guess, name)
    surface = fit_horizon(points, settings, corners, progress, name=name, orientations=measured)
    height_field = HeightField(surface)
    held = _largest(shapely.intersection(area, height_field.area()))
    outline = _cut(held, height_field, faults, sides, name)
    return surface.ended_at(shapely.get_coordinates(outline.exterior)[:-1])


def _cut(area: Polygon, height: Height, faults: Sequence[Fault], sides: Sides, title: str) -> Polygon:
    """Return the part of an area where a surface lies on the given side of every fault."""
    import shapely
    from shapely.ops import split

    rest = area
    for fault, sign in zip(faults, sides, strict=True):
        pieces = [rest]
        for line in fault.traces(area, height):
            whole = longer(line, BEYOND_TRACE * longer_side(area))
            cut = (one for piece in pieces for one in split(piece, shapely.LineString(whole)).geoms)
            pieces = [one for one in cut if isinstance(one, shapely.Polygon)]
        inner = shapely.get_coordinates([shapely.point_on_surface(piece) for piece in pieces])
        side = fault.side(np.column_stack([inner, height(*inner.T)]))
        mine = [piece for piece, one in zip(pieces, side, strict=True) if one == sign]
        if not mine:
            text = message(
                "site.block-outside-surface",
                "The block '{block}' has points on a side of {fault} where its surface has no area. "
                "Check the points next to the fault: one on the wrong side makes a block of its own.",
                block=title,
                fault=fault.name,
            )
            raise FitError(text)
        rest = max(mine, key=shapely.area)
    return rest


def _largest(shape: BaseGeometry) -> Polygon:
    """Return the largest polygon of what an intersection left."""
    import shapely

    return max((one for one in shapely.get_parts(shape) if isinstance(one, shapely.Polygon)), key=shapely.area)
