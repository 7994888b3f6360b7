"""The report as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from geofit.deliver import Form, Reports, write_reports
from geofit.progress import Progress
from geofit.report.language import language
from geofit.report.result import HorizonResult

__all__ = ["write_report_files"]


def write_report_files(
    results: Sequence[HorizonResult],
    folder: Path,
    code: str,
    forms: Sequence[Form],
    examined: bool,
    date: str,
    *,
    progress: Progress,
) -> Reports:
    """Write the accuracy report of surfaces; errors as :func:`geofit.deliver.write_reports`.

    ``code`` is the language's ("en", "zh"): its catalogue need not travel to another process.
    """
    return write_reports(results, folder, progress, language=language(code), forms=forms, examined=examined, date=date)
