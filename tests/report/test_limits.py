"""What the summary says of the surface away from its data names what was left out."""

from __future__ import annotations

from dataclasses import replace

import pytest
from results import examined, horizon

from geofit.data.languages import EN
from geofit.report.document import Paragraph, ReportTable
from geofit.report.gather import accuracy_report
from geofit.report.limits import away_from_data, limits_of_use


def summary(schemes, epsilon):
    result = examined(horizon(epsilon=epsilon))
    kept = tuple(one for one in result.prediction.left_out if one.scheme in schemes)
    report = accuracy_report([replace(result, prediction=replace(result.prediction, left_out=kept))])
    (table,) = (block for block in away_from_data(report, EN) if isinstance(block, ReportTable))
    limits = [block.text for block in limits_of_use(report, (), EN) if isinstance(block, Paragraph)]
    return dict(zip([column.title for column in table.columns], table.rows[0], strict=True)), limits


@pytest.mark.parametrize(
    ("schemes", "inside", "start"),
    [
        (
            ("hole", "section"),
            "90.4",
            "3. Between boreholes the typical error exceeds the control error for: T3/T2 (0.28",
        ),
        (("section",), "–", "3. Away from the data the typical error exceeds the control error for: T3/T2 (0.777"),
    ],
)
def test_figures_of_sections_left_out_are_not_said_of_holes(schemes, inside, start):
    """A site without holes had "Holes left out: in the band 97 %", and an error between boreholes."""
    row, limits = summary(schemes, 0.2)
    assert row["Holes left out: in the band"].startswith(inside)
    (text,) = [text for text in limits if "typical error" in text]
    assert text.startswith(start)
    assert not any("unknown" in text for text in limits)


def test_an_error_within_epsilon_is_no_limit_and_an_unknown_one_is():
    assert not any("typical error" in text for text in summary(("hole",), 0.5)[1])
    assert any("away from the data is unknown" in text for text in summary((), 0.5)[1])
