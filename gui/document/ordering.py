"""Comparing all horizons, and pushing them apart, as tasks; without Qt: they run in a process of their own."""

from __future__ import annotations

from collections.abc import Mapping

from threadpoolctl import threadpool_limits

from geofit.geometry.elevation import plan_map
from geofit.progress import Progress, tell
from geofit.site import Ground
from geofit.stack.order import Order, orders
from geofit.stack.repair import Repair, repair
from geofit.surface import HorizonSurface

__all__ = ["all_orders", "over_map", "pushed_apart"]


def over_map(surfaces: Mapping[str, HorizonSurface]) -> dict[str, HorizonSurface]:
    """Return those that lie over the map: of a fault nothing lies above or below."""
    return {
        name: surface
        for name, surface in surfaces.items()
        if surface.patches and all(plan_map(patch) is not None for patch in surface.patches)
    }


def all_orders(
    surfaces: Mapping[str, HorizonSurface], ground: Ground | None, *, progress: Progress
) -> tuple[Order, ...]:
    """Compare every two horizons, given the highest first."""
    tell(progress, "order", 0.1)
    with threadpool_limits(limits=1):
        return orders(surfaces, tuple(surfaces), ground)


def pushed_apart(surfaces: Mapping[str, HorizonSurface], minimum: float, *, progress: Progress) -> Repair:
    """Push horizons apart, given the highest first."""
    tell(progress, "push apart", 0.1)
    return repair(surfaces, tuple(surfaces), minimum)
