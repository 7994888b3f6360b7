"""From a provenance to its surface: the fit, then the manual edits, in their order.

What is here runs in a process of its own, and returns plain values; without Qt.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from geofit.data.accuracy import Accuracy
from geofit.data.points import PointSet
from geofit.data.prediction import PredictionResult
from geofit.data.progress import Progress, tell, within
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.provenance import ManualEdit, Move, MoveToPointEdit, Part, Provenance, SeparationEdit, without_rows

__all__ = [
    "Given",
    "around",
    "changed",
    "edited",
    "examined",
    "fault_surfaces",
    "get_ready",
    "given_of",
    "made",
    "make",
    "with_site_checks",
]


@dataclass(frozen=True, eq=False)
class Given:
    """What surfaces are made from.

    The ``site`` has all points of the horizons that provenances name, study area, dips and ground; ``faults`` are
    surfaces that were made already.
    """

    site: Site
    faults: Mapping[Provenance, HorizonFit] = field(default_factory=dict)


def given_of(site: Site, provenance: Provenance) -> Given:
    """Return what a surface is made from, of a site whose horizons are whole: nothing is made already."""
    horizons = {}
    for one in provenance.ancestors():
        if one.part is None:
            horizons[one.horizon] = site.horizons[one.horizon]
        else:
            horizons[one.horizon] = one.part.of(site.horizons[one.part.horizon])
    return Given(around(site, horizons))


def around(site: Site, horizons: Mapping[str, PointSet]) -> Site:
    """Return horizons with what surfaces are compared with: study area, ground, dips, logged holes, faults."""
    return Site(
        site.name,
        horizons,
        boundary=site.boundary,
        ground=site.ground,
        orientations=site.orientations,
        holes=site.holes,
        boreholes=site.boreholes,
        faults=site.faults,
    )


def make(provenance: Provenance, given: Given, progress: Progress | None = None) -> HorizonFit:
    """Make a surface; the same provenance gives the same surface to the last bit.

    Raises
    ------
    GeofitError
        As :func:`~geofit.fitting.pipeline.fit_horizon`, :func:`~geofit.site.fault_blocks.fit_block` and manual edits.
    """
    from geofit.fitting.pipeline import fit_horizon

    points = without_rows(given.site.horizons[provenance.horizon], provenance.excluded)
    if provenance.part is None:
        surface = fit_horizon(
            points,
            provenance.settings,
            given.site.boundary,
            progress,
            name=provenance.horizon,
            orientations=given.site.orientations,
        )
    else:
        surface = _block(provenance, provenance.part, points, given, progress)
    for edit in provenance.edits:
        tell(progress, "manual edits", 1.0)
        surface = _pushed(surface, edit, given, progress) if isinstance(edit, SeparationEdit) else edited(surface, edit)
    return with_site_checks(surface, provenance, given.site)


def with_site_checks(surface: HorizonFit, provenance: Provenance, site: Site) -> HorizonFit:
    """Return a surface whose checks also check whether it agrees with what surrounds it."""
    from geofit.site.site_checks import add_site_checks

    return add_site_checks(surface, site, "" if provenance.part is None else provenance.part.horizon)


def fault_surfaces(
    faults: Iterable[Provenance], given: Given, progress: Progress | None = None
) -> dict[Provenance, HorizonFit]:
    """Return the surfaces of faults; those that are not available are made."""
    return {one: given.faults[one] if one in given.faults else make(one, given, progress) for one in faults}


def _block(provenance: Provenance, part: Part, points: PointSet, given: Given, progress: Progress | None) -> HorizonFit:
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
    dips = (given.site.orientations, part.horizon)
    return fit_block(points, faults, sides, provenance.settings, area, progress, name=provenance.horizon, dips=dips)


def _pushed(surface: HorizonFit, edit: SeparationEdit, given: Given, progress: Progress | None) -> HorizonFit:
    """Make the neighbours as they were, and separate all again."""
    from geofit.site.separate import separate_horizons

    stack = {surface.name: surface, **{other.horizon: make(other, given, progress) for other in edit.others}}
    return separate_horizons(stack, edit.sequence, edit.minimum, within(progress, 1.0, 1.0)).surfaces[surface.name]


def edited(surface: HorizonFit, edit: ManualEdit, progress: Progress | None = None) -> HorizonFit:
    """Return the surface after one manual edit."""
    from geofit.fitting.edit import adjust, move_to, weigh

    tell(progress, "manual edits", 0.0)
    if isinstance(edit, Move):
        return adjust(surface, edit.patch, edit.i, edit.j, edit.dz, edit.aside)
    if isinstance(edit, MoveToPointEdit):
        return move_to(surface, edit.index, edit.share)
    return weigh(surface, edit.patch, edit.i, edit.j, edit.weight)


def made(provenance: Provenance, given: Given, *, progress: Progress) -> tuple[Provenance, HorizonFit]:
    """Make a surface, and say from what."""
    return provenance, make(provenance, given, progress)


def changed(
    provenance: Provenance, surface: HorizonFit, edit: ManualEdit, given: Given, *, progress: Progress
) -> tuple[Provenance, Provenance, Accuracy | None, HorizonFit]:
    """Edit a surface manually; return its provenance before and after, the check before, and the new surface."""
    before = surface.accuracy
    if surface.model is None:
        surface = make(provenance, given, progress)
    after = replace(provenance, edits=(*provenance.edits, edit))
    return provenance, after, before, with_site_checks(edited(surface, edit, progress), after, given.site)


def examined(provenance: Provenance, surface: HorizonFit, *, progress: Progress) -> tuple[Provenance, PredictionResult]:
    """Find the prediction error of a surface away from its data."""
    from geofit.prediction.examine import examine

    return provenance, examine(surface, progress)


def get_ready() -> None:
    """Load what a fit and its drawing need, in the process that will run them."""
