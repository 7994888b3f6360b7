"""From a recipe to its surface: the fit, then the changes by hand, in their order.

What stands here runs in a process of its own, and tells by plain values what it did; without Qt.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.accuracy import Accuracy
from geofit.gui.document.recipe import Apart, HandEdit, Move, Pull, Recipe, without_rows
from geofit.offdata import OffData
from geofit.points import PointSet
from geofit.progress import Progress, tell
from geofit.surface import HorizonSurface

__all__ = ["changed", "edited", "examined", "get_ready", "made", "make"]

Floats = NDArray[np.float64]
#: Points by horizon.
Given = Mapping[str, PointSet]


def make(
    recipe: Recipe,
    points: PointSet,
    boundary: Floats | None,
    progress: Progress | None = None,
    given: Given | None = None,
) -> HorizonSurface:
    """Make a surface; the same recipe gives the same surface to the last bit.

    ``points`` are those that take part; ``given`` all points of the other horizons that its changes name.

    Raises
    ------
    GeofitError
        As :func:`geofit.pipeline.fit_horizon` and the changes by hand.
    """
    from geofit.pipeline import fit_horizon

    surface = fit_horizon(points, recipe.settings, boundary, progress, name=recipe.horizon)
    for edit in recipe.edits:
        tell(progress, "changes by hand", 1.0)
        if isinstance(edit, Apart):
            surface = _pushed(surface, edit, boundary, given or {}, progress)
        else:
            surface = edited(surface, edit)
    return surface


def _pushed(
    surface: HorizonSurface, edit: Apart, boundary: Floats | None, given: Given, progress: Progress | None
) -> HorizonSurface:
    """Make the neighbours as they were, and push all apart once more."""
    from geofit.stack.repair import repair

    stack = {surface.name: surface}
    for other in edit.others:
        points = without_rows(given[other.horizon], other.excluded)
        stack[other.horizon] = make(other, points, boundary, progress, given)
    return repair(stack, edit.sequence, edit.minimum).surfaces[surface.name]


def edited(surface: HorizonSurface, edit: HandEdit, progress: Progress | None = None) -> HorizonSurface:
    """Return the surface after one change by hand."""
    from geofit.handwork import adjust, pull_to, weigh

    tell(progress, "changes by hand", 0.0)
    if isinstance(edit, Move):
        return adjust(surface, edit.patch, edit.i, edit.j, edit.dz)
    if isinstance(edit, Pull):
        return pull_to(surface, edit.index, edit.share)
    return weigh(surface, edit.patch, edit.i, edit.j, edit.weight)


def made(
    recipe: Recipe, points: PointSet, boundary: Floats | None, given: Given, *, progress: Progress
) -> tuple[Recipe, HorizonSurface]:
    """Make a surface, and say from what."""
    return recipe, make(recipe, points, boundary, progress, given)


def changed(
    recipe: Recipe,
    surface: HorizonSurface,
    edit: HandEdit,
    points: PointSet,
    boundary: Floats | None,
    given: Given,
    *,
    progress: Progress,
) -> tuple[Recipe, Recipe, Accuracy | None, HorizonSurface]:
    """Change a surface by hand; return its recipe before and after, the check before, and the new surface."""
    before = surface.accuracy
    if surface.model is None:
        surface = make(recipe, points, boundary, progress, given)
    return recipe, replace(recipe, edits=(*recipe.edits, edit)), before, edited(surface, edit, progress)


def examined(recipe: Recipe, surface: HorizonSurface, *, progress: Progress) -> tuple[Recipe, OffData]:
    """Find out how far the rock may lie from a surface where nobody drilled."""
    from geofit.prediction.examine import examine

    return recipe, examine(surface, progress)


def get_ready() -> None:
    """Load what a fit and its drawing need, in the process that will run them."""
    import geofit.gui.view3d.drawn
    import geofit.pipeline  # noqa: F401
