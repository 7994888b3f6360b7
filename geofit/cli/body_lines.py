"""What is printed of a body: its figures, without the body itself, which a process that prints need not know."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from geofit.project.body_run import BodyRun

__all__ = ["BodyLines", "body_lines", "fit_and_describe"]


@dataclass(frozen=True)
class BodyLines:
    """Rows of the table of a body, sentences below it, its exit code, and the number of its files."""

    name: str
    rows: tuple[tuple[str, str], ...]
    sentences: tuple[str, ...]
    exit_code: int
    files: int


def fit_and_describe(site_file: Path, code: str, out: Path) -> BodyLines:
    """Fit the body of a code that a site file's boreholes log, write its files, and describe it."""
    from geofit.io.site_file import load_site
    from geofit.project.body_run import run_body

    return body_lines(run_body(load_site(site_file), out, codes=code))


def body_lines(run: BodyRun) -> BodyLines:
    """Describe a body."""
    from geofit.report.digits import metres

    a, volumes, file = run.accuracy, run.volumes, run.read_back
    sound = not run.failed_checks
    reasons = [str(check.text) for check in file.checks if check.name in ("grade", "thin parts")]
    rows = (
        ("verdict", run.verdict.word if sound or not a.passed else f"{run.verdict.word} (!)"),
        ("contacts", str(a.n)),
        ("sigma, m", f"{metres(a.sigma)} {'<' if a.passed else '>='} {a.epsilon:g}"),
        ("largest residual, m", metres(a.max_abs)),
        ("volume, m3", f"{volumes.best:.6g}"),
        ("its numerical error, m3", f"{volumes.error:.1f}"),
        ("volume P10, m3", f"{volumes.p10:.6g}"),
        ("volume P50, m3", f"{volumes.p50:.6g}"),
        ("volume P90, m3", f"{volumes.p90:.6g}"),
        ("logged, m", f"{a.logged_length:.2f}"),
        ("logged inside, lies outside, m", f"{a.missed_length:.2f}"),
        ("logged outside, lies inside, m", f"{a.excess_length:.2f}"),
        ("surface far from data", f"{a.far_share:.1%} beyond {a.far_distance:.1f} m"),
        (
            "STEP, read back",
            f"solids: {file.solids}, {file.grade}, {'passed' if file.passed else 'FAILED'}",
        ),
    )
    warnings = [f"{run.body.name}: {note}" for note in a.warnings]
    sentences = (f"{run.body.name}: {run.verdict.text}", *reasons, *warnings)
    return BodyLines(run.body.name, rows, sentences, run.exit_code, len(run.files))
