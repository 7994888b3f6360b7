"""Fit the horizons of a site together: faulted ones block by block, crossings separated if asked, order compared."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from geofit.data.errors import FitError, PointsError, SettingsError
from geofit.data.given import arguments_checked
from geofit.data.guard import guarded
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell, within
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.pipeline import fit_horizon
from geofit.site.fault_blocks import fit_blocks
from geofit.site.order import Order, compare_pairs
from geofit.site.separate import Contradiction, separate_horizons
from geofit.site.site_checks import add_site_checks
from geofit.site.throw import FaultCut
from geofit.streaming.executors import Where

__all__ = ["SiteFit", "compare_in_order", "fit_site"]


@dataclass(eq=False)
class SiteFit:
    """What was fitted of a site.

    ``surfaces`` by name in the order of the site; in the place of a faulted horizon its blocks. ``horizon`` names the
    horizon of each surface, ``seconds`` the time of its fit, ``cuts`` the displacement between blocks along the
    ``faults``. ``failures`` gives by horizon why it could not be fitted. ``moved`` and ``contradictions`` are those of
    the separation; ``warnings`` what else is to be told.
    """

    surfaces: dict[str, HorizonFit] = field(default_factory=dict)
    horizon: dict[str, str] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    failures: dict[str, Message] = field(default_factory=dict)
    faults: dict[str, HorizonFit] = field(default_factory=dict)
    cuts: tuple[FaultCut, ...] = ()
    moved: dict[str, float] = field(default_factory=dict)
    contradictions: tuple[Contradiction, ...] = ()
    warnings: tuple[Message, ...] = ()

    def __repr__(self) -> str:
        parts = [f"{name} {fit.accuracy.verdict}" for name, fit in self.surfaces.items() if fit.accuracy is not None]
        return f"<SiteFit: {', '.join([*parts, *(f'{name} not fitted' for name in self.failures)])}>"


@arguments_checked
def fit_site(
    site: Site,
    names: Sequence[str] = (),
    changes: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    *,
    separate: bool = False,
    scheduler: str | None = None,
    workers: int | None = None,
    fitted: Callable[[HorizonFit], None] | None = None,
    folder: Path | None = None,
) -> SiteFit:
    """Fit horizons of a site, and ask of each what the dips and the ground of the site say.

    Parameters
    ----------
    site : Site
        ``site.faults`` names the horizons that are fitted block by block.
    names : sequence of str
        Horizons of the site; empty: all.
    changes : mapping
        Settings that take the place of the site's.
    progress : callable, optional
        Called as ``progress("horizon: stage", fraction)``.
    separate : bool
        Whether horizons of ``site.order`` that cross are separated (:func:`geofit.site.separate.separate_horizons`).
    scheduler, workers : str, int, optional
        Where the horizons are fitted, side by side (:func:`geofit.streaming.executors.run_tasks`); by default one after
        the other in this process. The surfaces are the same.
    fitted : callable, optional
        Called with each surface as soon as it is fitted and checked, before the others are.
    folder : Path, optional
        Where a scheduler's fits are kept: a run that was stopped, or lost its scheduler, goes on with the other
        horizons.

    Returns
    -------
    SiteFit
        Surfaces by name, and by horizon why one could not be fitted: a failure of one does not stop the others.

    Raises
    ------
    Cancelled
        If ``progress`` returned False.
    ArgumentError
        If ``site`` is of another type.
    SchedulerError
        If the scheduler is lost.

    Notes
    -----
    Each horizon as :func:`geofit.fit_horizon` does it; each block of a faulted one as :func:`geofit.fit_blocks`.
    """
    names = tuple(names) or tuple(site.horizons)
    if scheduler is None:
        found = _one_by_one(site, names, changes or {}, progress, fitted or _deaf)
    else:
        where = Where(scheduler, workers, folder)
        found = _side_by_side(site, names, changes or {}, progress, fitted or _deaf, where)
    if separate:
        tell(progress, "separation", 1.0)
        _separate_horizons(site, found, within(progress, 1.0, 1.0))
    found.surfaces = {
        name: add_site_checks(surface, site, "" if found.horizon[name] == name else found.horizon[name])
        for name, surface in found.surfaces.items()
    }
    return found


def _deaf(surface: HorizonFit) -> None:
    """Hear nothing."""


def _one_by_one(
    site: Site,
    names: Sequence[str],
    changes: Mapping[str, Any],
    progress: Progress | None,
    fitted: Callable[[HorizonFit], None] = _deaf,
) -> SiteFit:
    fits, found = _Fits(site, changes), SiteFit()
    for k, name in enumerate(names):

        def listen(stage: str | Message, fraction: float, /, name: str = name, k: int = k) -> None:
            tell(
                progress,
                message("data.stage-of-name", "{name}: {stage}", name=name, stage=stage),
                (k + min(max(fraction, 0.0), 1.0)) / len(names),
            )

        def failed(reason: Message, name: str = name) -> None:
            found.failures[name] = reason

        known = set(found.surfaces)
        guarded(partial(fits.add, name, found, listen), None, failed)
        for surface in [one for title, one in found.surfaces.items() if title not in known]:
            fitted(surface)
    return found


def _side_by_side(
    site: Site,
    names: Sequence[str],
    changes: Mapping[str, Any],
    progress: Progress | None,
    fitted: Callable[[HorizonFit], None],
    where: Where,
) -> SiteFit:
    """Fit each horizon with the faults that cut it where a scheduler sends it, and put all together in their order."""
    tasks = [(_alone(site, name), name, dict(changes)) for name in names]
    parts: dict[int, SiteFit] = {}
    for k, part in where.run(_fitted_alone, tasks):
        parts[k] = part
        for surface in part.surfaces.values():
            fitted(surface)
        text = message("data.stage-of-name", "{name}: {stage}", name=names[k], stage="done")
        tell(progress, text, len(parts) / len(names))
    found = SiteFit()
    for _, part in sorted(parts.items()):
        for name in ("surfaces", "horizon", "seconds", "failures", "faults"):
            getattr(found, name).update(getattr(part, name))
        found.cuts += part.cuts
    return found


def _alone(site: Site, name: str) -> Site:
    """Return the site with the points of one horizon and its faults alone; of the others the names stay."""
    needed = {name, *(fault for fault, cut in site.faults.items() if name in cut)}
    empty = PointSet(np.empty((0, 3)))
    return replace(site, horizons={key: one if key in needed else empty for key, one in site.horizons.items()})


def _fitted_alone(task: tuple[Site, str, dict[str, Any]]) -> SiteFit:
    site, name, changes = task
    return _one_by_one(site, (name,), changes, None)


class _Fits:
    """The fits of one site; each fault is fitted once, for itself and for the horizons that it cuts."""

    def __init__(self, site: Site, changes: Mapping[str, Any]) -> None:
        self._site, self._changes = site, changes
        self._known: dict[str, HorizonFit] = {}

    def add(self, name: str, found: SiteFit, listen: Progress) -> None:
        """Fit a horizon and put it, or its blocks, where they belong."""
        start = time.perf_counter()
        faults = [fault for fault, cut in self._site.faults.items() if name in cut]
        if faults:
            blocks = fit_blocks(
                self._site.horizons[name],
                [self._fault(fault, found, listen) for fault in faults],
                self._settings(name),
                self._site.boundary,
                name=name,
                progress=listen,
                orientations=self._site.orientations,
            )
            surfaces = [_noted(block, blocks.notes) for block in blocks.blocks]
            found.cuts += blocks.cuts
        else:
            surfaces = [self._whole(name, listen)]
        taken = [surface.name for surface in surfaces if surface.name in (*found.surfaces, *self._site.horizons)]
        if faults and any(title != name for title in taken):
            raise SettingsError(
                message(
                    "data.block-name-taken",
                    "A block of '{name}' is called '{block}', and so is a horizon. Rename the horizon.",
                    name=name,
                    block=taken[0],
                )
            )
        seconds = (time.perf_counter() - start) / len(surfaces)
        for surface in surfaces:
            found.surfaces[surface.name] = surface
            found.horizon[surface.name], found.seconds[surface.name] = name, seconds

    def _fault(self, name: str, found: SiteFit, listen: Progress) -> HorizonFit:
        try:
            found.faults[name] = self._whole(name, listen)
        except (FitError, PointsError) as error:
            raise FitError(
                message(
                    "site.fault-not-fitted",
                    "the fault {fault} cannot be fitted: {reason}",
                    fault=name,
                    reason=error.message,
                )
            ) from None
        return found.faults[name]

    def _whole(self, name: str, listen: Progress) -> HorizonFit:
        if name not in self._known:
            site = self._site
            self._known[name] = fit_horizon(
                site.horizons[name],
                self._settings(name),
                site.boundary,
                listen,
                name=name,
                orientations=site.orientations,
            )
        return self._known[name]

    def _settings(self, name: str) -> FitSettings:
        return replace(self._site.settings.get(name, FitSettings()), **self._changes)


def _noted(block: HorizonFit, notes: Sequence[Message]) -> HorizonFit:
    assert block.accuracy is not None
    return block.with_(accuracy=replace(block.accuracy, notes=(*block.accuracy.notes, *notes)))


def _separate_horizons(site: Site, found: SiteFit, progress: Progress | None) -> None:
    """Separation the horizons of the order that are one surface each; say which are not."""
    sequence = [name for name in site.order if name in found.surfaces]
    blocked = [name for name in site.order if name in found.horizon.values() and name not in found.surfaces]
    if blocked:
        text = message(
            "site.faulted-not-separated",
            "{names}: cut by a fault, so not separated from other horizons",
            names=", ".join(blocked),
        )
        found.warnings += (text.with_severity("warning"),)
    if len(sequence) < 2:
        if blocked:
            return
        found.warnings += (
            message(
                "site.order-names-no-pair",
                "not separated: the order of the site names fewer than two fitted horizons without a fault",
            ).with_severity("warning"),
        )
        return
    try:
        done = separate_horizons(found.surfaces, sequence, progress=progress)
    except SettingsError as error:
        found.warnings += (
            message("site.not-separated", "not separated: {reason}", reason=error).with_severity("warning"),
        )
        return
    found.surfaces.update(done.surfaces)
    found.moved, found.contradictions = dict(done.moved), done.contradictions


def compare_in_order(site: Site, found: SiteFit) -> tuple[Order, ...]:
    """Compare every two horizons of the site's order; of faulted ones the blocks on the same side of their faults.

    Raises
    ------
    SettingsError
        If one of them is not a height field over the map.
    """
    layers = [[name for name, horizon in found.horizon.items() if horizon == layer] for layer in site.order]
    pairs = [
        (a, b)
        for upper, lower in combinations(layers, 2)
        for a in upper
        for b in lower
        if _same_side(site, found, a, b)
    ]
    return compare_pairs(found.surfaces, pairs, site.ground)


def _same_side(site: Site, found: SiteFit, a: str, b: str) -> bool:
    """Whether two surfaces lie on one side of each fault that cuts the horizons of both."""
    for fault, plane in found.faults.items():
        if not {found.horizon[a], found.horizon[b]} <= set(site.faults[fault]):
            continue
        # All points of a block lie on one side of the fault.
        sides = [float(plane.distance(found.surfaces[name].points.xyz[:1])[0]) > 0 for name in (a, b)]
        if sides[0] != sides[1]:
            return False
    return True
