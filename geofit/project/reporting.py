"""The report as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from geofit.data.languages import language
from geofit.data.messages import Message, Untranslated, message
from geofit.data.prediction import PredictionResult
from geofit.data.progress import Progress, tell
from geofit.data.stale import stale_warning
from geofit.project.body_building import BodyResult
from geofit.project.fault_blocks import Blocks, site_fit
from geofit.project.run import Form, write_reports
from geofit.project.single_reports import BodyPart, body_part
from geofit.report.result import HorizonResult
from geofit.site.order import Order

__all__ = ["ReportFiles", "not_in_report", "write_report_files"]


@dataclass(frozen=True, eq=False)
class ReportFiles:
    """What was written, by form, and what is to be told about it.

    ``prediction`` is what was found out for it away from the data, a horizon; not of surfaces with nothing behind
    them: of those nothing can be found out yet. ``orders`` states how its horizons lie to each other.
    """

    files: Mapping[Form, Path]
    warnings: tuple[Message, ...]
    prediction: Mapping[str, PredictionResult]
    orders: tuple[Order, ...] = ()


def write_report_files(
    results: Sequence[HorizonResult],
    blocks: Blocks,
    folder: Path,
    code: str,
    forms: Sequence[Form],
    examined: bool,
    date: str,
    bodies: Mapping[str, BodyResult] | None = None,
    unfitted: Sequence[str] = (),
    *,
    progress: Progress,
) -> ReportFiles:
    """Write the accuracy report of surfaces; errors as :func:`geofit.project.run.write_reports`.

    ``code`` is the language's ("en", "zh"): its catalogue need not travel to another process. ``bodies`` that were
    fitted get a chapter each; of others the summary states that there is none. It names horizons that are ``unfitted``.
    """
    tell(progress, "order", 0.0)
    fits = site_fit({result.name: result.surface for result in results}, blocks, progress)
    parts, failed = _parts(bodies or {}, results, code, progress)
    if unfitted:
        failed.insert(0, not_in_report(unfitted))
    made = write_reports(
        results, folder, progress, language=language(code), forms=forms, examined=examined, date=date, fits=fits,
        bodies=parts, notes=failed,
    )  # fmt: skip
    new = {
        after.name: after.prediction
        for before, after in zip(results, made.results, strict=True)
        if before.prediction is None and after.prediction is not None and before.surface.model is not None
    }
    stale = [*(result.name for result in results if result.stale), *(part.name for part in parts if part.stale)]
    warnings = (*([stale_warning(stale)] if stale else []), *made.warnings, *failed)
    return ReportFiles(made.files, warnings, new, made.orders)


def not_in_report(names: Sequence[str]) -> Message:
    """Return that horizons without a surface have no chapter."""
    return message(
        "project.unfitted-not-in-report", "Not fitted, so not in the report: {names}.",
        names=tuple(map(Untranslated, names)),
    )  # fmt: skip


def _parts(
    bodies: Mapping[str, BodyResult], results: Sequence[HorizonResult], code: str, progress: Progress
) -> tuple[list[BodyPart], list[Message]]:
    """Return the chapters of bodies, and why there is none of others."""
    horizons = {result.name: result.surface for result in results}
    parts: list[BodyPart] = []
    failed: list[Message] = []
    for name, result in bodies.items():
        body, volumes = result.fitted, result.volumes
        if body is None or volumes is None:
            # A closed mesh from a file, or a fit of an opened project that is still being made again.
            failed.append(
                message(
                    "project.body-without-fit",
                    "Body {name} has no chapter: its triangles are available, but no fit.",
                    name=Untranslated(name),
                )
            )
            continue
        tell(progress, message("data.stage-of-name", "{name}: {stage}", name=name, stage="body"), 0.0)
        part = body_part(replace(body, name=name), volumes, None, horizons, language(code), stale=result.stale)
        if isinstance(part, Message):
            failed.append(message("project.body-unreported", "Body {name}: {reason}", name=name, reason=part))
        else:
            parts.append(part)
    return parts, failed
