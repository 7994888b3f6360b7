"""Compare a horizon's surface with the rest of its site: measured dips, the study area, the ground and holes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geofit.data.guard import guarded
from geofit.data.messages import Message, message
from geofit.data.site import Ground, Orientations, Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.clip import inside
from geofit.site.dips import check_dips
from geofit.site.hole_contacts import check_holes
from geofit.site.topography import check_ground

__all__ = ["add_site_checks", "ground_tolerance", "measured_on"]

#: What a grid of the ground does not show between its nodes, as a share of its cell: 2 m at cells of 20 m. So far off
#: is a bilinear cell where the slope changes by 40 % from one cell to the next, along both axes (cell^2 / 8 times the
#: curvature of each).
CELL_SHARE = 0.1


def add_site_checks(surface: HorizonFit, site: Site, horizon: str = "") -> HorizonFit:
    """Return a checked surface with further checks: whether it agrees with dips, ground and holes.

    Parameters
    ----------
    surface : HorizonFit
        With its accuracy.
    site : Site
        Its ``orientations`` that name the horizon, its ``ground`` and ``holes``.
    horizon : str
        Name of the horizon where the surface is one block of it: then the dips within the block's outline count.
    """
    accuracy = surface.accuracy
    if accuracy is None:
        return surface
    missing: list[Message] = []
    tolerance = 0.0 if site.ground is None else ground_tolerance(site.ground, surface.settings.interior_tolerance)
    measured = site.orientations
    asked = (
        guarded(
            lambda: check_dips(surface, measured_on(measured, surface, horizon) if horizon else measured)[1],
            None,
            lambda reason: missing.append(
                message("site.dips-not-compared", "the dips were not compared: {reason}", reason=reason)
            ),
        ),
        guarded(
            lambda: check_ground(surface, site.ground, tolerance),
            None,
            lambda reason: missing.append(
                message("site.ground-not-compared", "the ground was not compared: {reason}", reason=reason)
            ),
        ),
        guarded(
            lambda: check_holes(surface, site, horizon),
            None,
            lambda reason: missing.append(
                message("site.holes-not-compared", "the holes were not compared: {reason}", reason=reason)
            ),
        ),
    )
    found = [check for check in asked if check is not None]
    kept = [check for check in accuracy.checks if check.name not in {one.name for one in found}]
    return surface.with_(
        accuracy=replace(accuracy, checks=(*kept, *found), notes=(*accuracy.notes, *missing)),
    )


def ground_tolerance(ground: Ground, least: float) -> float:
    """Return how far a horizon may stand above a grid of the ground: a tenth of its cell, at least ``least``; metres.

    Examples
    --------
    >>> x = np.arange(0.0, 100.0, 20.0)
    >>> ground_tolerance(Ground(x, x, np.zeros((5, 5))), 0.1)
    2.0
    """
    cell = max(float(np.diff(ground.x).max(initial=0.0)), float(np.diff(ground.y).max(initial=0.0)))
    return max(CELL_SHARE * cell, least)


def measured_on(orientations: Orientations | None, block: HorizonFit, horizon: str) -> Orientations | None:
    """Return the measurements of a horizon that stand within a block's outline, as the block's own."""
    if orientations is None or block.outline is None:
        return None
    plan = orientations.xyz[:, :2] - block.origin[:2]
    mine = (orientations.horizon == horizon) & inside(block.outline - block.origin[:2], plan)
    return replace(orientations, horizon=np.where(mine, block.name, ""))
