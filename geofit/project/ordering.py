"""Comparing all horizons, and separating them, as tasks; without Qt: they run in a process of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from threadpoolctl import threadpool_limits

from geofit.data.progress import Progress, tell
from geofit.data.site import Ground, Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.elevation import plan_map
from geofit.project.fault_blocks import same_side
from geofit.project.provenance import Part
from geofit.site.order import Order, compare_pairs
from geofit.site.separate import Separation, separate_horizons
from geofit.site.site_checks import add_site_checks

__all__ = ["all_orders", "comparable", "over_map", "separated"]


def over_map(surfaces: Mapping[str, HorizonFit]) -> dict[str, HorizonFit]:
    """Return those that lie over the map: of a fault nothing lies above or below."""
    return {
        name: surface
        for name, surface in surfaces.items()
        if surface.patches and all(plan_map(patch) is not None for patch in surface.patches)
    }


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
    with threadpool_limits(limits=1):
        return compare_pairs(surfaces, pairs, ground, lambda share: tell(progress, "order", share))


def separated(surfaces: Mapping[str, HorizonFit], minimum: float, site: Site, *, progress: Progress) -> Separation:
    """Push horizons apart, given the highest first; those that moved are asked again what the ``site`` says of them."""
    found = separate_horizons(surfaces, tuple(surfaces), minimum, progress)
    moved = {name: add_site_checks(found.surfaces[name], site) for name in found.moved}
    return replace(found, surfaces={**found.surfaces, **moved})
