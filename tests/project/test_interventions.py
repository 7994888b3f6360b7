"""What a person did to a surface reaches its report: rows left out as points, changes in words."""

from __future__ import annotations

from dataclasses import replace

from results import horizon

from geofit.data.languages import EN, ZH
from geofit.project.interventions import interventions_of
from geofit.project.provenance import Move, MoveToPointEdit, Provenance, Row, SeparationEdit, Weigh
from geofit.report.chapters import document
from geofit.report.document import Paragraph, ReportTable
from geofit.report.gather import accuracy_report


def test_excluded_rows_become_points_and_edits_become_sentences():
    result = horizon()
    points = result.site.horizons["T3/T2"]
    rows = (Row.of(points, 7), Row.of(points, 3), Row("gone.csv", 4))
    edits = (
        Move("west", 2, 3, 0.5),
        MoveToPointEdit(11, 0.8),
        Weigh("east", 1, 1, 2.0),
        SeparationEdit(("T3/T2", "T2/T1"), 1.5, ()),
    )
    excluded, told = interventions_of(result.site, Provenance("T3/T2", result.surface.settings, "", rows, edits))
    assert excluded.row.tolist() == points.row[[3, 7]].tolist()
    assert [one.code for one in told] == [
        "project.moved",
        "project.moved-towards-point",
        "project.weighed",
        "project.separated",
    ]
    assert told[1].params == {"number": 12, "share": 80.0}
    assert interventions_of(result.site, Provenance("T3/T2", result.surface.settings, "")) == (None, ())

    report = accuracy_report([replace(result, excluded=excluded, edits=told)], date="2026-01-02")
    assert [line.row for line in report.horizons[0].excluded] == [5, 9]
    for language in (EN, ZH):
        (chapter,) = [one for one in document(report, language).chapters if any(_lists(one, excluded))]
        numbered = [block.text for block in chapter.blocks if isinstance(block, Paragraph) and block.text[:1].isdigit()]
        assert [text[:2] for text in numbered] == ["1.", "2.", "3.", "4."]


def _lists(chapter, excluded):
    rows = {tuple(row[:2]) for block in chapter.blocks if isinstance(block, ReportTable) for row in block.rows if row}
    yield all((str(f), str(r)) in rows for f, r in zip(excluded.file, excluded.row, strict=True))
