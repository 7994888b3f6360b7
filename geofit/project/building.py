"""From a recipe to its surface: the fit, then the changes by hand, in their order.

What stands here runs in a process of its own, and tells by plain values what it did; without Qt.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from geofit.data.accuracy import Accuracy
from geofit.data.points import PointSet
from geofit.data.prediction import OffData
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.provenance import Apart, HandEdit, Move, Part, Pull, Recipe, without_rows

__all__ = ["Given", "beside", "changed", "edited", "examined", "fault_surfaces", "get_ready", "made", "make"]


@dataclass(frozen=True, eq=False)
class Given:
    """What surfaces are made from.

    The ``site`` has all points of the horizons that recipes name, study area, dips and ground; ``faults`` are surfaces
    that were made already.
    """

    site: Site
    faults: Mapping[Recipe, HorizonFit] = field(default_factory=dict)


def make(recipe: Recipe, given: Given, progress: Progress | None = None) -> HorizonFit:
    """Make a surface; the same recipe gives the same surface to the last bit.

    Raises
    ------
    GeofitError
        As :func:`~geofit.fitting.pipeline.fit_horizon`, :func:`~geofit.site.fault_blocks.fit_block` and manual edits.
    """
    from geofit.fitting.pipeline import fit_horizon

    points = without_rows(given.site.horizons[recipe.horizon], recipe.excluded)
    if recipe.part is None:
        surface = fit_horizon(points, recipe.settings, given.site.boundary, progress, name=recipe.horizon)
    else:
        surface = _block(recipe, recipe.part, points, given, progress)
    for edit in recipe.edits:
        tell(progress, "changes by hand", 1.0)
        surface = _pushed(surface, edit, given, progress) if isinstance(edit, Apart) else edited(surface, edit)
    return beside(surface, recipe, given.site)


def beside(surface: HorizonFit, recipe: Recipe, site: Site) -> HorizonFit:
    """Return a surface whose checks also ask whether it agrees with the site's dips and ground."""
    from geofit.site.site_checks import check_surroundings

    return check_surroundings(surface, site, "" if recipe.part is None else recipe.part.horizon)


def fault_surfaces(
    faults: Iterable[Recipe], given: Given, progress: Progress | None = None
) -> dict[Recipe, HorizonFit]:
    """Return the surfaces of faults; those that are not at hand are made."""
    return {one: given.faults[one] if one in given.faults else make(one, given, progress) for one in faults}


def _block(recipe: Recipe, part: Part, points: PointSet, given: Given, progress: Progress | None) -> HorizonFit:
    """Fit a block between its faults."""
    import shapely

    from geofit.site.fault import Fault
    from geofit.site.fault_blocks import fit_block

    area = shapely.Polygon(part.area)
    surfaces = fault_surfaces(
        (f for f, side in zip(part.faults, part.sides, strict=True) if side >= 0), given, progress
    )
    faults = [Fault.of(surface, k, area) for k, surface in enumerate(surfaces.values())]
    sides = tuple(side for side in part.sides if side >= 0)
    return fit_block(points, faults, sides, recipe.settings, area, progress, name=recipe.horizon)


def _pushed(surface: HorizonFit, edit: Apart, given: Given, progress: Progress | None) -> HorizonFit:
    """Make the neighbours as they were, and push all apart once more."""
    from geofit.site.separate import repair

    stack = {surface.name: surface, **{other.horizon: make(other, given, progress) for other in edit.others}}
    return repair(stack, edit.sequence, edit.minimum).surfaces[surface.name]


def edited(surface: HorizonFit, edit: HandEdit, progress: Progress | None = None) -> HorizonFit:
    """Return the surface after one change by hand."""
    from geofit.fitting.edit import adjust, pull_to, weigh

    tell(progress, "changes by hand", 0.0)
    if isinstance(edit, Move):
        return adjust(surface, edit.patch, edit.i, edit.j, edit.dz)
    if isinstance(edit, Pull):
        return pull_to(surface, edit.index, edit.share)
    return weigh(surface, edit.patch, edit.i, edit.j, edit.weight)


def made(recipe: Recipe, given: Given, *, progress: Progress) -> tuple[Recipe, HorizonFit]:
    """Make a surface, and say from what."""
    return recipe, make(recipe, given, progress)


def changed(
    recipe: Recipe, surface: HorizonFit, edit: HandEdit, given: Given, *, progress: Progress
) -> tuple[Recipe, Recipe, Accuracy | None, HorizonFit]:
    """Change a surface by hand; return its recipe before and after, the check before, and the new surface."""
    before = surface.accuracy
    if surface.model is None:
        surface = make(recipe, given, progress)
    after = replace(recipe, edits=(*recipe.edits, edit))
    return recipe, after, before, beside(edited(surface, edit, progress), after, given.site)


def examined(recipe: Recipe, surface: HorizonFit, *, progress: Progress) -> tuple[Recipe, OffData]:
    """Find out how far the rock may lie from a surface where nobody drilled."""
    from geofit.prediction.examine import examine

    return recipe, examine(surface, progress)


def get_ready() -> None:
    """Load what a fit and its drawing need, in the process that will run them."""
