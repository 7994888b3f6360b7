"""A run over the horizons of a site, and what the command line prints of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.cli.console import list_issues, print_counts, print_json, print_results, say

if TYPE_CHECKING:
    from geofit.data.languages import Language
    from geofit.data.progress import Progress
    from geofit.data.site import Site
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.project.side_by_side import Crew
    from geofit.project.step_files import Signed

__all__ = ["run_site"]


def run_site(
    site: Site,
    out: Path,
    horizons: tuple[str, ...],
    changes: dict[str, Any],
    as_json: bool,
    progress: Progress | None,
    language: Language | None = None,
    *,
    pdf: bool = False,
    separate: bool = False,
    bands: bool = False,
    scheduler: str | None = None,
    workers: int | None = None,
    bodies: tuple[str, ...] = (),
    signed: Signed | None = None,
    hands: Crew | None = None,
) -> int:
    """Fit, write and report the horizons of a site; print what was found; return the exit code.

    The verdict at the data is printed as soon as a horizon is fitted: all that follows takes ten times as long.
    """
    from geofit.data.languages import EN
    from geofit.project.run import run_horizons
    from geofit.project.side_by_side import available
    from geofit.report.schema import failed_document, report_document

    list_issues(site.issues, out)
    print_counts(site.counts)
    result = run_horizons(
        site, out, horizons, changes, progress, language=language or EN, pdf=pdf, separate=separate, bands=bands,
        bodies=bodies, scheduler=scheduler, workers=workers or available(), signed=signed, hands=hands,
        fitted=None if as_json else _print_fitted,
    )  # fmt: skip
    if as_json:
        found = report_document(result.report) if result.report else failed_document(result.failures)
        print_json({**found, "out": str(out)})
    elif result.results:
        print_results(result.results)
    for order in result.orders:
        if order.check().passed is False:
            say(f"Order: {order.check().text}")
    for sentence in (*(one.text for one in result.contradictions), *(cut.text for cut in result.cuts)):
        say(sentence)
    for warning in result.warnings:
        say(warning)
    for name, text in result.failures.items():
        say(f"geofit: {name}: {text}")
    if result.results:
        pages = f"{out / 'report.html'}{', .pdf' if pdf else ''}"
        say(f"Report: {pages} and .json; surfaces and tables in the same folder")
    return result.exit_code


def _print_fitted(surface: HorizonFit) -> None:
    """Print the verdict at the data; the examination and the files of the horizon are still to come."""
    from geofit.data.verdict import verdict_of

    assert surface.accuracy is not None
    verdict = verdict_of(surface.accuracy)
    word = "PASS" if verdict.data.level == "pass" else "FAIL"
    say(f"{surface.name}: {word} at the data: {verdict.data.text}, {verdict.checks.text}; examination follows")
    sys.stderr.flush()
