"""What is done with a real set, each task by itself: other processes and machines import this module."""

from __future__ import annotations

import time
from functools import cache
from pathlib import Path
from typing import Any

from geofit import FitSettings, GeofitError, fit_horizon
from geofit.data.accuracy import Check
from geofit.prediction.examine import examine
from geofit.project.run import run_horizons
from geofit.report.result import HorizonResult
from realdata.page import Fitted
from realdata.prediction import Off, field_alone, prediction
from realdata.score import Errors, left_out_errors
from realdata.sets import SETS, RealSet, data_folder
from realdata.why import Trial, try_out, worse

OUT = Path(__file__).resolve().parents[2] / "real_out"
Found = tuple[Fitted | str, Off | None]


@cache
def real_set(key: str) -> RealSet:
    """Read a set, once a process."""
    folder = data_folder()
    assert folder is not None
    return SETS[key](folder)


def deliver_set(key: str) -> dict[str, Found]:
    """Fit all horizons of a set with the default settings and leave their files; figures, or why a horizon failed."""
    real = real_set(key)
    result = run_horizons(real.site, OUT / key)
    found: dict[str, Found] = {name: (str(reason), None) for name, reason in result.failures.items()}
    return found | {result.name: (fitted(result), off_of(result, FitSettings())) for result in result.results}


def fit_at_scale(key: str, name: str) -> Found:
    """Fit one horizon with the tolerances of the set's own scale."""
    real = real_set(key)
    start = time.perf_counter()
    try:
        surface = fit_horizon(real.site.horizons[name], real.scale, real.site.boundary, name=name)
    except GeofitError as error:
        return str(error), None
    result = HorizonResult(
        surface, real.site, seconds={"fit": time.perf_counter() - start}, prediction=examine(surface)
    )
    return fitted(result), off_of(result, surface.settings)


def off_of(result: HorizonResult, settings: FitSettings) -> Off | None:
    """Take the figures away from the data from a result, with the field alone where another method is nearer."""
    off = prediction(result.surface, result.prediction)
    return off and field_alone(off, result.surface.points, settings, result.site.boundary)


def fitted(result: HorizonResult) -> Fitted:
    """Take the figures of the table from a result."""
    a, core = result.accuracy, int(result.core.sum())
    reasons = [] if a.sigma < a.epsilon else [f"sigma {a.sigma:.3f} m is not below epsilon {a.epsilon:g} m"]
    checks = (*a.checks, *(result.read_back.checks if result.read_back else ()))
    reasons += [_failing(check) for check in checks if check.passed is False]
    notes = map(str, a.notes)
    reasons += [note for note in notes if "tolerance" in note or "contradict" in note]
    return Fitted(
        core,
        a.n - core,
        a.sigma,
        a.verdict,
        result.surface.control_points,
        result.seconds["fit"],
        tuple(dict.fromkeys(reasons)),
    )


def _failing(check: Check) -> str:
    """Say by how much a check fails, where its words do not."""
    text = str(check.text)
    if check.unit != "m" or f"{check.value:.1f} m" in text:
        return text
    return f"{text}: {check.value:.3g} m (limit {check.limit:.3g} m)"


def score_horizon(key: str, name: str) -> list[tuple[Errors, Trial | None]]:
    """Score one horizon on points left out, at each of its tolerances; try out why where the thin plate is nearer.

    The regional field alone chases no tolerance, so one trial serves all.
    """
    real = real_set(key)
    given, left_out = real.site.horizons[name], real.left_out.get(name)
    errors = [left_out_errors(given, left_out, settings) for settings in tolerances(real)]
    beaten = [any(worse(e)) for e in errors]
    trial = try_out(given, left_out, FitSettings()) if any(beaten) else None
    return [(e, trial if lost else None) for e, lost in zip(errors, beaten, strict=True)]


def tolerances(real: RealSet) -> list[FitSettings]:
    """Return the settings that a set is fitted with, the defaults first."""
    return [FitSettings()] if real.scale is None else [FitSettings(), real.scale]


def done(task: tuple[str, tuple[str, ...]]) -> Any:
    """Do one task: the name of a function of this module, and its arguments."""
    name, given = task
    return {work.__name__: work for work in (score_horizon, deliver_set, fit_at_scale)}[name](*given)
