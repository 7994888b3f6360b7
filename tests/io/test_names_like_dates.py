"""Names that a spreadsheet turned into dates: the hole or unit was lost without a word."""

from __future__ import annotations

import datetime

import pytest

from geofit.io import read_boreholes, read_points


@pytest.mark.parametrize(
    "name",
    ["2020-03-12", "2020-03-12 00:00:00", "12.03.2020", "3/12/2020", "12-Mar", "12. Mrz", "12-Mar-20", "3月12日"],
)
def test_a_hole_named_by_a_date_is_warned_of(name, tmp_path):
    rows = [f"T1,B{i},{7 * i % 31},{5 * i % 29},{i}" for i in range(9)]
    (tmp_path / "a.csv").write_text("\n".join(["horizon,hole,x,y,z", *rows, f"T1,{name},3,4,5"]), "utf-8")
    (issue,) = [one for one in read_points(tmp_path / "a.csv").issues if one.reason.code == "io.names-like-dates"]
    assert (issue.severity, issue.row, issue.value) == ("warning", 11, name)


@pytest.mark.parametrize("name", ["3-12", "ZK2020-03-12", "12.5", "2020", "K 1.2.3", "S3-Mari", "2 Marl", "20-1-20-5"])
def test_other_names_are_not(name, tmp_path):
    rows = [f"T1,B{i},{7 * i % 31},{5 * i % 29},{i}" for i in range(9)]
    (tmp_path / "a.csv").write_text("\n".join(["horizon,hole,x,y,z", *rows, f"T1,{name},3,4,5"]), "utf-8")
    assert not [one for one in read_points(tmp_path / "a.csv").issues if one.reason.code == "io.names-like-dates"]


def test_a_unit_that_a_workbook_stores_as_a_day_is_warned_of(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.title = "collar"
    for row in [["hole", "x", "y", "z", "depth"], *([f"B{i}", 10 * i, 7 * i % 5, 100, 30] for i in range(5))]:
        book.active.append(row)
    logs = book.create_sheet("log")
    logs.append(["hole", "from", "to", "lithology"])
    for i in range(5):
        logs.append([f"B{i}", 0, 10, datetime.datetime(2020, 3, 1) if i == 2 else "loess"])
        logs.append([f"B{i}", 10, 30, "clay"])
    book.save(tmp_path / "a.xlsx")
    from geofit.io import Source

    sheets = [Source(path=tmp_path / "a.xlsx", table=name) for name in ("collar", "log")]
    found = read_boreholes(sheets[0], intervals=sheets[1:])
    (issue,) = [one for one in found.issues if one.reason.code == "io.names-like-dates"]
    assert (issue.row, issue.column, issue.value) == (6, "lithology", "2020-03-01")
