"""Tables as CSV: the residual of every point, and what the readers found."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.data.files import replacing, spreadsheet_cell
from geofit.data.languages import EN, Language, translate
from geofit.data.site import ImportIssue
from geofit.report.result import HorizonResult

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["write_contacts", "write_issues", "write_residuals"]

RESIDUAL_HEADER = (
    "file", "row", "kind", "hole", "section", "x", "y", "z", "residual_m", "patch", "exact", "used", "reason",
)  # fmt: skip
CONTACT_HEADER = ("hole", "x", "y", "z", "residual_m")
ISSUE_HEADER = ("severity", "file", "row", "column", "value", "reason", "remedy")


def write_residuals(result: HorizonResult, path: Path, language: Language = EN) -> None:
    """Write one line a point, in the order they were read; only the reasons are written in the language.

    Metres; residuals are positive above the surface. ``exact`` marks the points that the core interpolates;
    ``used`` is "no" for a point that lost a conflict, and ``reason`` states why.
    """
    points, a, core, dropped = result.surface.points, result.accuracy, result.core, result.dropped
    rows = (
        (
            points.file[i],
            points.row[i] or "",
            points.kind[i],
            points.hole[i],
            points.section[i],
            *(f"{value:.4f}" for value in points.xyz[i]),
            f"{a.residuals[i]:.9f}",
            a.patch[i],
            "yes" if core[i] else "no",
            "no" if i in dropped else "yes",
            translate(dropped.get(i, ""), language),
        )
        for i in range(len(points))
    )
    _write(path, RESIDUAL_HEADER, rows)


def write_contacts(body: BodyFit, path: Path) -> None:
    """Write one line a contact of a body, in their order; metres, residuals are positive outside the surface."""
    assert body.accuracy is not None
    rows = zip(body.data.hole.tolist(), body.data.contacts, body.accuracy.residuals.tolist(), strict=True)
    _write(
        path,
        CONTACT_HEADER,
        ((hole, *(f"{value:.4f}" for value in xyz), f"{residual:.9f}") for hole, xyz, residual in rows),
    )


def write_issues(issues: Sequence[ImportIssue], path: Path, language: Language = EN) -> None:
    """Write everything that the readers found, errors first; only reasons and remedies are written in the language."""
    order = {"error": 0, "warning": 1, "note": 2}
    rows = (
        (
            i.severity,
            i.file,
            i.row or "",
            i.column,
            i.value,
            translate(i.reason, language),
            translate(i.remedy, language),
        )
        for i in sorted(issues, key=lambda i: order[i.severity])
    )
    _write(path, ISSUE_HEADER, rows)


def _write(path: Path, header: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    # The byte-order mark tells spreadsheets that the text is UTF-8.
    with replacing(path) as part, part.open("w", encoding="utf-8-sig", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([spreadsheet_cell(cell) for cell in row] for row in rows)
