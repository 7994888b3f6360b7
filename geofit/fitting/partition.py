"""The partition D = D1 + D2 + ...: a dense core and its periphery (paper, sec. 3.2), as the settings ask for it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.data.settings import FitSettings
from geofit.fitting.density import split_auto
from geofit.fitting.parametrize import Parametrization
from geofit.fitting.split import Split, split_all, split_none, split_rectangle

__all__ = ["partition"]


def partition(parametrization: Parametrization, settings: FitSettings, kept: NDArray[np.bool_]) -> Split:
    """Split the points that are active; one that were dropped is in no core."""
    if settings.core == "none" and not parametrization.parametric:
        note = message("fitting.core-none", "core='none': every point is approximated")
        return split_none(parametrization.plane, note)
    plane = parametrization.plane if kept.all() else parametrization.plane[kept]
    if parametrization.parametric:
        reason = message("fitting.sections-span-surface", "the section curves span the whole surface")
        if settings.core == "none":
            reason = message(
                "fitting.fold-always-met",
                "core='none' does not apply to folded surfaces: the section curves are met exactly where control "
                "points allow, with their noise",
            ).with_severity("warning")
        found = split_all(plane, parametrization.area, reason)
    elif settings.core == "all":
        found = split_all(
            plane,
            parametrization.area,
            message("fitting.core-all", "core='all': every point is interpolated"),
        )
    elif settings.core == "auto":
        found = split_auto(plane, parametrization.area, parametrization.section[kept] != "")
    elif parametrization.frame.kind != "map":
        text = message(
            "fitting.core-polygon-in-other-frame",
            "core is a polygon of map coordinates, but the surface is fitted in the frame '{frame}'. Choose "
            "core='auto', 'all' or 'none', or frame='map'.",
            frame=parametrization.frame.kind,
        )
        raise FitError(text)
    else:
        corners = parametrization.frame.plan(np.array(settings.core))
        low = np.maximum(corners.min(axis=0), (parametrization.area[0], parametrization.area[2]))
        high = np.minimum(corners.max(axis=0), (parametrization.area[1], parametrization.area[3]))
        if (high <= low).any():
            raise FitError(
                message(
                    "fitting.core-polygon-outside",
                    "The core's polygon lies outside the study area. Check its coordinates and their order.",
                )
            )
        rectangle = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
        found = split_rectangle(
            plane, rectangle, parametrization.area, message("fitting.core-polygon-drawn", "the core's polygon as drawn")
        )
    inside = np.zeros(len(kept), bool)
    inside[kept] = found.inside
    return Split(found.core, inside, found.reason)
