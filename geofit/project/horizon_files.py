"""What one horizon leaves: examination, STEP file as read back, pictures, tables, figures."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.accuracy import Check
from geofit.data.guard import guarded
from geofit.data.languages import Language, language
from geofit.data.messages import Message, message
from geofit.data.progress import Progress
from geofit.data.site import Section, Site
from geofit.project.step_files import Signed, certified
from geofit.report.result import HorizonResult
from geofit.streaming.executors import HERE, Where
from geofit.streaming.kept import clear_kept

if TYPE_CHECKING:
    from geofit.checks.storage import Storage
    from geofit.data.prediction import PredictionResult
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.report.profile import Profile

__all__ = ["Made", "section_profiles", "storage_compared", "write_horizon"]


@dataclass(frozen=True)
class Made:
    """One surface with its files: result, pictures by name, and what is to be reported."""

    result: HorizonResult
    images: Mapping[str, bytes]
    warnings: tuple[Message, ...]


def write_horizon(
    surface: HorizonFit,
    site: Site,
    stem: Path,
    code: str,
    seconds: float,
    bands: bool,
    sections: Sequence[Section],
    where: Where = HERE,
    signed: Signed | None = None,
    horizon: str = "",
    orders: tuple[Check, ...] = (),
    progress: Progress | None = None,
) -> Made | Message:
    """Examine a surface, and write what belongs to it: ``.step``, ``.png``, ``.json`` and ``_residuals.csv``.

    Parameters
    ----------
    surface : HorizonFit
        The fit, checked.
    site : Site
        Where it belongs.
    stem : Path
        Folder and name of the files.
    code : str
        Language of the pictures: its catalogue need not travel to another process.
    seconds : float
        Time of the fit.
    bands : bool
        Whether the surfaces of the 90 % band are written too.
    sections : sequence of Section
        Lines along which the report cuts the horizon.
    where : Where
        Where fits without a fold of the cross-validation are made.
    signed : Signed, optional
        What the STEP files state, and whether they get a certificate.
    horizon : str
        Name of the horizon where the surface is one fault block of it.
    orders : tuple of Check
        How the horizon lies to its neighbours.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    Made or Message
        The message states what unforeseen error the work ended with.
    """
    failed: list[Message] = []
    t, heard, stated = language(code), progress or _deaf, signed or Signed()
    made = guarded(
        lambda: _written(surface, site, stem, heard, t, seconds, bands, sections, where, stated, horizon, orders),
        None,
        failed.append,
    )
    return failed[0] if made is None else made


def _deaf(stage: str | Message, fraction: float, /) -> None:
    """Hear nothing."""


def _written(
    surface: HorizonFit, site: Site, stem: Path, progress: Progress, t: Language, fit: float, bands: bool,
    sections: Sequence[Section], where: Where, signed: Signed, horizon: str, orders: tuple[Check, ...],
) -> Made:  # fmt: skip
    from geofit.cad.step import write_step
    from geofit.prediction.examine import examine
    from geofit.report.pictures import draw_pictures, write_picture
    from geofit.report.schema import horizon_document, write_json
    from geofit.report.tables import write_residuals

    clock = _Clock(fit)
    folds = stem.with_name(stem.name + "_folds")
    prediction = examine(
        surface,
        lambda stage, share: progress(stage, 0.45 * share),
        scheduler=where.scheduler,
        workers=where.workers,
        folder=folds,
    )
    clear_kept(folds)
    clock.stop("examination")
    progress("STEP and read-back", 0.45)
    path = stem.with_name(stem.name + ".step")
    found = write_step({surface.name: surface}, path, **signed.fields)
    back = found[surface.name]
    certified(path, found, {surface.name: surface.settings.epsilon}, signed)
    warnings = _write_bands(surface, prediction, stem, signed) if bands else ()
    clock.stop("STEP and read-back")
    progress("pictures", 0.7)
    storage, missing = storage_compared(surface)
    result = HorizonResult(
        surface, site, back, storage, path.stat().st_size, prediction=prediction, orders=orders, horizon=horizon
    )
    profiles, uncut = section_profiles(result, sections)
    result = replace(result, profiles=profiles)
    pictures = draw_pictures(result, t)
    write_picture(result, pictures, stem.with_name(stem.name + ".png"), t)
    clock.stop("pictures")
    result = replace(result, seconds=clock.seconds)
    write_residuals(result, stem.with_name(stem.name + "_residuals.csv"), t)
    write_json(horizon_document(result), stem.with_name(stem.name + ".json"))
    return Made(result, pictures.images, (*warnings, *missing, *uncut))


def section_profiles(
    result: HorizonResult, sections: Sequence[Section]
) -> tuple[Mapping[str, tuple[Profile, ...]], tuple[Message, ...]]:
    """Return what the sections of the report cut of a horizon; say why where that fails."""
    from geofit.report.profile import profiles

    missing: list[Message] = []
    nothing: Mapping[str, tuple[Profile, ...]] = {}
    found = guarded(
        lambda: profiles(result.surface, result.prediction, sections),
        nothing,
        lambda reason: missing.append(
            message(
                "project.sections-not-cut",
                "{name} is missing from the geological sections: {reason}",
                name=result.name,
                reason=reason,
            )
        ),
    )
    return found, tuple(missing)


def storage_compared(surface: HorizonFit) -> tuple[Storage | None, tuple[Message, ...]]:
    """Compare the storage of a surface with that of a TIN and a grid; say why where that fails."""
    from geofit.checks.storage import equal_accuracy

    missing: list[Message] = []
    found = guarded(
        lambda: equal_accuracy(surface, surface.settings.interior_tolerance),
        None,
        lambda reason: missing.append(
            message(
                "project.storage-not-compared",
                "{name}: its storage was not compared: {reason}",
                name=surface.name,
                reason=reason,
            )
        ),
    )
    return found, tuple(missing)


def _write_bands(surface: HorizonFit, prediction: PredictionResult, stem: Path, signed: Signed) -> tuple[Message, ...]:
    """Write the surfaces that bound the 90 % prediction band; return why there are none."""
    from geofit.cad.step import write_step
    from geofit.prediction.bands import band

    if prediction.uncertainty is None:
        return (
            message(
                "project.no-band-without-deviation",
                "{name}: no 90 % surfaces, its standard deviation is not known",
                name=surface.name,
            ),
        )
    missing: list[Message] = []

    def without(reason: Message) -> None:
        missing.append(
            message(
                "project.band-missing", "{name}: a 90 % surface is missing: {reason}", name=surface.name, reason=reason
            )
        )

    # A band that crosses itself or cannot be sewn says nothing against the surface between.
    none: tuple[HorizonFit, ...] = ()
    for side, one in zip(("upper", "lower"), guarded(lambda: band(surface, prediction), none, without), strict=False):
        path = stem.with_name(f"{stem.name}_{side}90.step")
        if guarded(partial(write_step, {one.name: one}, path, **signed.fields), None, without) is None:
            path.unlink(missing_ok=True)
    return tuple(missing)


class _Clock:
    """Seconds since the last stop, by name."""

    def __init__(self, fit: float) -> None:
        self.seconds: dict[str, float] = {"fit": round(fit, 3)}
        self._since = time.perf_counter()

    def stop(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name] = round(now - self._since, 3)
        self._since = now
