"""The table of the real sets, printed and as ``docs/real_data.md``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite

from geofit import FitSettings

from .prediction import PREDICTION, Off, off_cells, summary, why_lost
from .score import Errors, Score
from .why import Trial, metres, why

__all__ = ["ERRORS", "FITS", "Fitted", "Row", "error_cells", "fit_cells", "markdown"]

FITS = (
    "set", "n", "core/ periphery", "sigma, m", "epsilon, m", "tolerance, m", "verdict", "control points", "a point",
    "fit, s",
)  # fmt: skip
ERRORS = (
    "set", "tolerance, m", "compared", "geofit", "thin plate", "linear", "all", "geofit, all", "thin plate, all",
)  # fmt: skip
#: Seconds are written as classes: the page must not change from run to run.
CLASSES = (20, 120)


@dataclass(frozen=True)
class Fitted:
    """Figures of the fit to all given points; ``holds_not`` names which checks fail, and why."""

    core: int
    periphery: int
    sigma: float
    verdict: str
    control_points: int
    seconds: float
    holds_not: tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """One horizon of one set with one choice of tolerances; ``fitted`` is None where ``failure`` states why.

    ``off`` is its error away from the data, None where nothing can be left out.
    """

    title: str
    n: int
    settings: FitSettings
    fitted: Fitted | None
    errors: Errors
    trial: Trial | None
    failure: str = ""
    off: Off | None = None


def fit_cells(row: Row, exact_seconds: bool) -> list[str]:
    """Return a row of the table of fits."""
    tolerances = [f"{row.settings.epsilon:g}", f"{row.settings.interior_tolerance:g}"]
    fit = row.fitted
    if fit is None:
        return [row.title, str(row.n), "–", "–", *tolerances, "ERROR", "–", "–", "–"]
    seconds = f"{fit.seconds:.1f}" if exact_seconds else _class(fit.seconds)
    return [
        row.title, str(row.n), f"{fit.core}/{fit.periphery}", f"{fit.sigma:.3f}", *tolerances, fit.verdict,
        f"{fit.control_points:,}", f"{fit.control_points / row.n:.1f}", seconds,
    ]  # fmt: skip


def error_cells(row: Row) -> list[str]:
    """Return a row of the table of errors."""
    e = row.errors
    compared = [str(e.common), *map(_score, (e.ours, e.plate, e.line))]
    return [
        row.title,
        f"{row.settings.interior_tolerance:g}",
        *compared,
        str(e.defined),
        *map(_score, (e.ours_all, e.plate_all)),
    ]


def markdown(rows: Sequence[Row], given: Sequence[tuple[str, str]]) -> str:
    """Return the page."""
    lines = [_INTRODUCTION, "## Fits", "", *_table(FITS, [fit_cells(row, False) for row in rows]), ""]
    lines += ["What was given:", "", *(f"- {title}: {words}." for title, words in given), ""]
    lines += ["## Errors at points left out", "", _SCORES, *_table(ERRORS, map(error_cells, rows)), ""]
    lines += ["## Prediction error, and calibration", "", _ABOUT_PREDICTION, *_table(PREDICTION, _off_rows(rows)), ""]
    lines += [summary([row.off for row in rows if row.off is not None]), ""]
    told = [(row, why_lost(row.off)) for row in rows if row.off is not None]
    lines += [f"- **{_named(row)}**: {words}." for row, words in told if words]
    lines += ["", "## What does not hold", ""]
    lines += [f"- **{_named(row)}**: {'; '.join(_reasons(row))}." for row in rows if _reasons(row)]
    lines += ["", "## Where the thin plate is nearer, and why", "", _TRIALS]
    lines += [f"- **{_named(row)}** ({_margin(row.errors)}): {why(row.errors, row.trial)}" for row in rows if row.trial]
    return "\n".join(lines) + "\n"


_INTRODUCTION = """# Real data

Made by `make real` (`benchmarks/real.py`); do not edit. The data lie outside the project (`GEOFIT_DATA`, else
`../shared/data`); what they are and under which licences is told in the README beside them.

Each set is read by geofit's readers and goes through what `geofit fit` does: fit, check, STEP, read-back, report. Its
files are left under `real_out/`. Settings are the defaults (epsilon 0.5 m, interior tolerance 0.1 m); where a set is so
large or coarse that these say little, a second line has tolerances of its own scale.

Seconds are those of fit and check alone, on one core, by class, so that this page does not change from run to run.
"""

_SCORES = """Elevations at points that the surface has not seen: root mean square (standard deviation), metres. Claudius
leaves points out by the file's own random numbers; the others are scored by ten folds over holes, or over places where
no hole is named (seed 2011), with the rectangle around all points as study area. The columns after "compared" hold
geofit, scipy's exact thin-plate spline and scipy's linear interpolation at the same points: those where the linear one
is defined. "all" counts also the points beyond the given points' hull.
"""

_ABOUT_PREDICTION = """What `geofit report` finds away from the data: every hole (or point, where no hole is named) is
left out in turn and predicted from all others, by geofit's own linear algebra (smoothing, knots and the choice of
points stay), by the exact thin-plate spline, and by ordinary kriging, at the same places. Root mean square errors,
metres; steep horizons are measured across their best plane. "inside 90 %" is the share of the holes left out that lie
within the 90 % band, "before" the share before the standard deviation was held to the errors that points left out
show, "factor" by how much that changed it. "CRPS" is the mean continuous ranked probability score of the predicted
distribution of a hole's contact (lower is better), followed by that of a dense Gaussian process with a plane as drift
and the likelihood's choice of exponential, Matérn 3/2, Matérn 5/2 and Gaussian kernels. Where another method is nearer,
the same was done with the regional field alone, no point pulled and none interpolated, to show why.
"""

_TRIALS = """Found by trying, for each line whose error is more than 2 % above the thin plate's: the same folds with the
regional field alone (no point pulled, none interpolated), and that with ten times and a tenth of its smoothing.
"""


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return ["| " + " | ".join(line) + " |" for line in lines]


def _off_rows(rows: Sequence[Row]) -> list[list[str]]:
    return [off_cells(row.title, row.settings.interior_tolerance, row.off) for row in rows if row.off is not None]


def _named(row: Row) -> str:
    return f"{row.title}, {row.settings.epsilon:g} / {row.settings.interior_tolerance:g} m"


def _reasons(row: Row) -> list[str]:
    left = [f"{len(row.errors.failures)} folds failed: {row.errors.failures[0]}"] if row.errors.failures else []
    e = row.errors
    if e.defined < e.left_out and not e.failures:
        left.append(f"the surface has no elevation at {e.left_out - e.defined} of {e.left_out} points left out")
    found = [row.failure] if row.fitted is None else list(row.fitted.holds_not)
    return [text.rstrip(".") for text in found + left]


def _margin(errors: Errors) -> str:
    inside = errors.ours.rms / errors.plate.rms
    whole = errors.ours_all.rms / errors.plate_all.rms
    return f"{inside:.2f} x among the points compared, {whole:.2f} x over all"


def _score(score: Score) -> str:
    return f"{metres(score.rms)} ({metres(score.std)})" if isfinite(score.rms) else "–"


def _class(seconds: float) -> str:
    return next((f"< {limit}" for limit in CLASSES if seconds < limit), f"> {CLASSES[-1]}")
