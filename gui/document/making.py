"""From a recipe to its surface: the fit, then the changes by hand, in their order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.gui.document.recipe import HandEdit, Move, Recipe
from geofit.points import PointSet
from geofit.progress import Progress, tell
from geofit.surface import HorizonSurface

__all__ = ["edited", "make"]


def make(
    recipe: Recipe, points: PointSet, boundary: NDArray[np.float64] | None, progress: Progress | None = None
) -> HorizonSurface:
    """Make a surface; the same recipe gives the same surface to the last bit.

    Raises
    ------
    GeofitError
        As :func:`geofit.pipeline.fit_horizon` and the changes by hand.
    """
    from geofit.pipeline import fit_horizon

    surface = fit_horizon(points, recipe.settings, boundary, progress, name=recipe.horizon)
    for edit in recipe.edits:
        tell(progress, "changes by hand", 1.0)
        surface = edited(surface, edit)
    return surface


def edited(surface: HorizonSurface, edit: HandEdit, progress: Progress | None = None) -> HorizonSurface:
    """Return the surface after one change by hand."""
    from geofit.handwork import adjust, pull_to

    tell(progress, "changes by hand", 0.0)
    if isinstance(edit, Move):
        return adjust(surface, edit.patch, edit.i, edit.j, edit.dz)
    return pull_to(surface, edit.index, edit.share)
