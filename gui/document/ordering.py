"""The comparison of all horizons as a task; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping

from threadpoolctl import threadpool_limits

from geofit.order import Order, orders
from geofit.progress import Progress, tell
from geofit.site import Ground
from geofit.surface import HorizonSurface

__all__ = ["all_orders"]


def all_orders(
    surfaces: Mapping[str, HorizonSurface], ground: Ground | None, *, progress: Progress
) -> tuple[Order, ...]:
    """Compare every two horizons, given the highest first."""
    tell(progress, "order", 0.1)
    with threadpool_limits(limits=1):
        return orders(surfaces, tuple(surfaces), ground)
