"""The results as JSON: one schema for NAME.json, report.json and --json, published as ``result.schema.json``.

A document is a serialised dataclass: the names of its fields, null for None, a message as its code, severity, English
text and parameters. ``kind`` names which document it is, ``schema_version`` which schema; a change that a reader would
misread makes it one more. ``tools/schema.py`` writes the schema from the dataclasses.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geofit.data.accuracy import plain
from geofit.data.errors import GeofitError, InputError
from geofit.data.files import replacing
from geofit.data.messages import EMPTY, Message
from geofit.report.accuracy_report import AccuracyReport, RejectedRow
from geofit.report.gather import horizon_report, inputs_of, rejected_rows, versions
from geofit.report.result import HorizonResult

__all__ = [
    "SCHEMA_FILE",
    "VERSION",
    "ErrorReport",
    "enveloped",
    "error_document",
    "failed_document",
    "horizon_document",
    "report_document",
    "result_schema",
    "write_json",
]

#: Version of the schema.
VERSION = 1
SCHEMA_FILE = Path(__file__).with_name("result.schema.json")


def result_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of every document that holds results."""
    found: dict[str, Any] = json.loads(SCHEMA_FILE.read_text(encoding="utf-8"))
    return found


def enveloped(kind: str, result: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document: what kind of result it is and by which schema, then the result as plain data."""
    return {"schema_version": VERSION, "kind": kind, **plain(result)}


def report_document(report: AccuracyReport) -> dict[str, Any]:
    """Return the document of a site: what ``report.json`` and ``geofit fit --json`` hold."""
    return enveloped("report", plain(report))


def failed_document(failures: Mapping[str, Message]) -> dict[str, Any]:
    """Return the document of a run of which nothing could be fitted."""
    return enveloped("failure", {"failures": plain(failures), "versions": dict(versions())})


@dataclass(frozen=True)
class ErrorReport:
    """Why a command ended without results.

    ``text`` is the line on stderr; ``reason`` states what is wrong, ``remedy`` what to do about it: null where the
    reason includes it. ``rejected`` holds the rows of tables that were found until then.
    """

    exit_code: int
    text: str
    reason: Message
    remedy: Message | None
    file: str | None
    row: int | None
    column: str | None
    value: str | None
    rejected: tuple[RejectedRow, ...]


def error_document(error: GeofitError, exit_code: int) -> dict[str, Any]:
    """Return the document of a command that ended with an error: what ``--json`` prints in place of results."""
    reason, remedy = (error.reason, error.remedy) if isinstance(error, InputError) else (error.message, EMPTY)
    file, row, column, value = (getattr(error, name, None) for name in ("file", "row", "column", "value"))
    rejected = rejected_rows(error.issues)
    grave = reason.with_severity("error")
    report = ErrorReport(exit_code, str(error), grave, remedy or None, file, row, column, value, rejected)
    return enveloped("error", plain(report))


def horizon_document(result: HorizonResult) -> dict[str, Any]:
    """Return the document of one horizon, ``NAME.json``: an entry of the report's ``horizons``, and its origin."""
    site = result.site
    origin = {
        "site": site.name,
        "crs": site.crs,
        "inputs": inputs_of(site),
        "rejected": rejected_rows(result.rejected),
        "versions": versions(),
        "seconds": result.seconds,
    }
    return enveloped("horizon", {**plain(horizon_report(result)), **plain(origin)})


def write_json(document: Mapping[str, Any], path: Path) -> None:
    """Write a document as JSON (UTF-8)."""
    with replacing(path) as part:
        part.write_text(to_json(document), encoding="utf-8", newline="\n")


def to_json(document: Mapping[str, Any]) -> str:
    """Return a document as JSON text."""
    return json.dumps(document, ensure_ascii=False, indent=1, allow_nan=False) + "\n"
