"""Fit and examine the real sets as ``geofit fit`` does, score them on points left out, write ``docs/real_data.md``.

Run ``make real``, or ``python benchmarks/real.py [SET ...]`` for some sets (then only the table is printed).
Needs ``GEOFIT_DATA`` or ``../shared/data``; without them it reports it and exits with 2.
"""

from __future__ import annotations

import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path

from realdata.page import ERRORS, FITS, Fitted, Row, error_cells, fit_cells, markdown
from realdata.prediction import PREDICTION, Off, field_alone, off_cells, prediction
from realdata.score import Errors, left_out_errors
from realdata.sets import SETS, RealSet, data_folder
from realdata.why import Trial, try_out, worse

from geofit import FitSettings, GeofitError, fit_horizon
from geofit.cli.console import print_table
from geofit.data.accuracy import Check
from geofit.data.files import replacing
from geofit.prediction.examine import examine
from geofit.project.run import run_horizons
from geofit.report.result import HorizonResult

ROOT = Path(__file__).resolve().parents[1]
OUT, PAGE = ROOT / "real_out", ROOT / "docs" / "real_data.md"
PROCESSES = 2

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
    reasons = [] if a.passed else [f"sigma {a.sigma:.3f} m is not below epsilon {a.epsilon:g} m"]
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


def rows_of(keys: list[str]) -> list[Row]:
    """Run all sets in a few processes and return their rows in order."""
    names = [(key, name) for key in keys for name in real_set(key).site.horizons]
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as pool:
        scores = {pair: pool.submit(score_horizon, *pair) for pair in names}
        delivered = {key: pool.submit(deliver_set, key) for key in keys}
        scaled = {pair: pool.submit(fit_at_scale, *pair) for pair in names if real_set(pair[0]).scale}
        rows = []
        for pair in names:
            key, name = pair
            real = real_set(key)
            found = [delivered[key].result()[name], *([scaled[pair].result()] if pair in scaled else [])]
            for (fit, off), settings, (errors, trial) in zip(
                found, tolerances(real), scores[pair].result(), strict=True
            ):
                figures, failure = (None, fit) if isinstance(fit, str) else (fit, "")
                n = len(real.site.horizons[name])
                rows.append(Row(f"{real.title}: {name}", n, settings, figures, errors, trial, failure, off))
    return rows


def main() -> int:
    """Run the sets that are named, or all."""
    if data_folder() is None:
        print(
            "The real data are not here. Set GEOFIT_DATA to their folder, or lay them at ../shared/data.",
            file=sys.stderr,
        )
        return 2
    unknown = [key for key in sys.argv[1:] if key not in SETS]
    if unknown:
        print(f"There is no set '{unknown[0]}'; the sets are: {', '.join(SETS)}.", file=sys.stderr)
        return 2
    # One thread a process: two processes share two cores, and sums come out alike on every machine.
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    start = time.perf_counter()
    keys = [key for key in SETS if key in sys.argv[1:]] or list(SETS)
    rows = rows_of(keys)
    print_table(FITS, [fit_cells(row, exact_seconds=True) for row in rows])
    print_table(ERRORS, [error_cells(row) for row in rows])
    settled = [(row.title, row.settings.interior_tolerance, row.off) for row in rows if row.off is not None]
    print_table(PREDICTION, [off_cells(*figures) for figures in settled])
    print(f"{len(rows)} lines in {time.perf_counter() - start:.0f} s; surfaces and reports are in {OUT}")
    if len(keys) == len(SETS):
        given = [(real_set(key).title, real_set(key).given) for key in keys]
        with replacing(PAGE) as part:
            part.write_text(markdown(rows, given), encoding="utf-8")
        print(f"written: {PAGE}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
