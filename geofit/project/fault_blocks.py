"""Horizons that faults cut, members into blocks; without Qt: the parting runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.data.progress import Progress
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.building import Given, fault_surfaces
from geofit.project.provenance import Part, Provenance, runs
from geofit.site.fit_site import SiteFit
from geofit.site.throw import FaultCut

if TYPE_CHECKING:
    from geofit.site.fault_blocks import BlockMembers

__all__ = ["Blocks", "SplitHorizon", "cuts_measured", "same_side", "site_fit", "site_with_blocks", "split_at_faults"]


@dataclass(frozen=True, eq=False)
class SplitHorizon:
    """A horizon's blocks by name, the faults' surfaces by provenance, and what there is to tell."""

    horizon: str
    blocks: Mapping[str, Part]
    faults: Mapping[Provenance, HorizonFit]
    notes: tuple[Message, ...]


@dataclass(frozen=True, eq=False)
class Blocks:
    """Blocks with their surfaces, by name, and what their faults are made from."""

    surfaces: Mapping[str, tuple[Part, HorizonFit]]
    given: Given


def site_with_blocks(site: Site, parts: Mapping[str, Part]) -> Site:
    """Return a site with blocks in the place of the horizons that were split."""
    if not parts:
        return site
    blocks: dict[str, dict[str, Part]] = {}
    for name, part in parts.items():
        blocks.setdefault(part.horizon, {})[name] = part
    horizons = {
        name: points if part is None else part.of(points)
        for whole, points in site.horizons.items()
        for name, part in blocks.get(whole, {whole: None}).items()
    }
    return replace(site, horizons=horizons, blocks={name: part.horizon for name, part in parts.items()})


def split_at_faults(
    horizon: str,
    faults: tuple[Provenance, ...],
    left_out: Sequence[int],
    given: Given,
    digest: str,
    *,
    progress: Progress,
) -> SplitHorizon:
    """Part a horizon at its faults. No blocks: no fault parts it.

    Points ``left_out`` make no block; they belong to the one that lies on their side, if there is one.

    Raises
    ------
    GeofitError
        If a fault cannot be fitted, or a block would have fewer than three points.
    """
    from geofit.site.fault_blocks import area_of, part

    surfaces = fault_surfaces(faults, given, progress)
    points = given.site.horizons[horizon]
    kept = np.setdiff1d(np.arange(len(points)), np.asarray(left_out, int))
    area = area_of(points, given.site.boundary)
    found = part(points[kept], list(surfaces.values()), area, horizon)
    number = {fault.name: k for k, fault in enumerate(found.faults)}
    out = np.asarray(left_out, int)
    block = np.full(len(points), -1)
    block[kept], block[out] = found.block, _block_of(points.xyz[out], points.xyz[kept], found)
    notes = list(found.notes)
    homeless = [points.describe(int(i)) for i in out if block[i] < 0]
    if homeless:
        notes.append(
            message("project.excluded-no-block", "excluded, and in no block: {points}", points=tuple(homeless))
        )
    corners = tuple((float(x), float(y)) for x, y in list(area.exterior.coords)[:-1])
    blocks = {
        name: Part(
            horizon,
            digest,
            faults,
            tuple(sides[number[f.horizon]] if f.horizon in number else -1 for f in faults),
            runs(np.flatnonzero(block == k)),
            corners,
        )
        for k, (name, sides) in enumerate(zip(found.names, found.sides, strict=True))
    }
    return SplitHorizon(horizon, blocks if len(blocks) > 1 else {}, surfaces, tuple(notes))


def _block_of(places: NDArray[np.float64], known: NDArray[np.float64], members: BlockMembers) -> NDArray[np.int64]:
    """Return the number of the block to which places (n, 3) belong, -1 where there is none.

    It lies on their side of the faults; of several, as in the arms of an area, it is that of the nearest known point.
    """
    sides = np.array([fault.side(places) for fault in members.faults]).reshape(len(members.faults), len(places)).T
    found = np.full(len(places), -1)
    for i, side in enumerate(map(tuple, sides.tolist())):
        same = np.flatnonzero(np.isin(members.block, [k for k, one in enumerate(members.sides) if one == side]))
        if len(same):
            away = np.linalg.norm(known[same, :2] - places[i, :2], axis=1)
            found[i] = members.block[same[away.argmin()]]
    return found


def same_side(parts: Mapping[str, Part], one: str, other: str) -> bool:
    """Whether two surfaces can lie above each other: not two blocks of one horizon, nor members by a fault of both."""
    first, second = parts.get(one), parts.get(other)
    if first is None or second is None:
        return True
    if first.horizon == second.horizon:
        return False
    of_first, of_second = _sides(first), _sides(second)
    return all(of_first[fault] == of_second[fault] for fault in of_first.keys() & of_second.keys())


def cuts_measured(blocks: Blocks, *, progress: Progress | None) -> tuple[FaultCut, ...]:
    """Measure how far faults displace the horizons that surfaces are blocks of."""
    import shapely

    from geofit.site.fault import Fault
    from geofit.site.throw import throws

    cuts: tuple[FaultCut, ...] = ()
    known = blocks.surfaces.values()
    for horizon in dict.fromkeys(part.horizon for part, _ in known):
        mine = [(part, surface) for part, surface in known if part.horizon == horizon]
        first = mine[0][0]
        area = shapely.Polygon(first.area)
        surfaces = fault_surfaces(first.faults, blocks.given, progress)
        cutting = [k for k, side in enumerate(first.sides) if side >= 0]
        faults = [Fault.of(surfaces[first.faults[k]], k, area) for k in cutting]
        by_sides = [(tuple(part.sides[k] for k in cutting), surface) for part, surface in mine]
        cuts += throws(by_sides, faults, horizon, area)
    return cuts


def site_fit(surfaces: Mapping[str, HorizonFit], blocks: Blocks, progress: Progress | None) -> SiteFit:
    """Return surfaces as a fit of their whole site has them: which are blocks of what, and the throws."""
    whole = {name: part.horizon for name, (part, _) in blocks.surfaces.items()}
    provenances = dict.fromkeys(fault for part, _ in blocks.surfaces.values() for fault in part.faults)
    faults = fault_surfaces(provenances, blocks.given, progress)
    return SiteFit(
        dict(surfaces),
        {name: whole.get(name, name) for name in surfaces},
        faults={provenance.horizon: surface for provenance, surface in faults.items()},
        cuts=cuts_measured(blocks, progress=progress),
    )


def _sides(part: Part) -> dict[str, int]:
    return {fault.horizon: side for fault, side in zip(part.faults, part.sides, strict=True) if side >= 0}
