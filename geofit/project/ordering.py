"""Comparing all horizons, and separating them, as tasks; without Qt: they run in a process of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.messages import Message, message
from geofit.data.progress import Progress, tell
from geofit.data.site import Ground, Site
from geofit.data.threads import one_thread
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.elevation import plan_map
from geofit.project.fault_blocks import same_side
from geofit.project.provenance import Part
from geofit.site.order import Order, compare_pairs
from geofit.site.separate import Separation, separate_horizons
from geofit.site.site_checks import add_site_checks

__all__ = ["JoinedBlocks", "all_orders", "comparable", "joined", "order_not_examined", "over_map", "separated"]


def over_map(surfaces: Mapping[str, HorizonFit]) -> dict[str, HorizonFit]:
    """Return those that lie over the map: of a fault nothing lies above or below."""
    return {
        name: surface
        for name, surface in surfaces.items()
        if surface.patches and all(plan_map(patch) is not None for patch in surface.patches)
    }


@dataclass(frozen=True, eq=False)
class JoinedBlocks:
    """Fault blocks of a horizon as one height field: at each place that of the block that reaches there."""

    blocks: tuple[HorizonFit, ...]

    def elevation(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Return the heights at map coordinates, nan between the blocks and beyond them; arrays broadcast."""
        first, *others = (np.asarray(block.elevation(x, y), float) for block in self.blocks)
        for other in others:
            first = np.where(np.isnan(first), other, first)
        return first


def joined(surfaces: Mapping[str, HorizonFit], parts: Mapping[str, Part]) -> dict[str, HorizonFit | JoinedBlocks]:
    """Return surfaces by their horizons, the fault blocks of each as one."""
    wholes: dict[str, list[HorizonFit]] = {}
    for name, surface in surfaces.items():
        wholes.setdefault(parts[name].horizon if name in parts else name, []).append(surface)
    return {name: found[0] if len(found) == 1 else JoinedBlocks(tuple(found)) for name, found in wholes.items()}


def comparable(names: Sequence[str], parts: Mapping[str, Part]) -> tuple[tuple[str, str], ...]:
    """Return every two surfaces, given the highest first, that no fault parts."""
    return tuple((one, other) for one, other in combinations(names, 2) if same_side(parts, one, other))


def all_orders(
    surfaces: Mapping[str, HorizonFit],
    pairs: Sequence[tuple[str, str]],
    ground: Ground | None,
    *,
    progress: Progress,
) -> tuple[Order, ...]:
    """Compare pairs of horizons, the upper one first."""
    with one_thread():
        return compare_pairs(surfaces, pairs, ground, lambda share: tell(progress, "order", share))


def order_not_examined(reason: str | Message) -> Message:
    """Return that the horizons could not be compared, and why."""
    return message("project.order-not-examined", "The order of the horizons was not examined: {reason}", reason=reason)


def separated(surfaces: Mapping[str, HorizonFit], minimum: float, site: Site, *, progress: Progress) -> Separation:
    """Push horizons apart, given the highest first; those that moved are asked again what the ``site`` says of them."""
    found = separate_horizons(surfaces, tuple(surfaces), minimum, progress)
    moved = {name: add_site_checks(found.surfaces[name], site) for name in found.moved}
    return replace(found, surfaces={**found.surfaces, **moved})
