"""Interval tables with lower limits only, against the same logs with both limits, and with planted faults."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.data.languages import ZH, translate
from geofit.io import Source, read_boreholes, take_contacts
from geofit.io.preview import preview_file
from geofit.project.importing import import_files

COLLAR = "hole,x,y,z,depth\nA,0,0,100,60\nB,50,0,103,60\nC,90,10,98.5,60\n"
#: (hole, base, code): the truth, from the top down.
LAYERS = [
    *(("A", 10, "Q"), ("A", 25.5, "T2"), ("A", 38, "T1"), ("A", 60, "P")),
    *(("B", 8, "Q"), ("B", 30, "T2"), ("B", 41, "T1"), ("B", 60, "P")),
    *(("C", 12, "Q"), ("C", 27, "T2"), ("C", 39, "T1"), ("C", 60, "P")),
]


def text(layers, head="hole,to,code"):
    return head + "\n" + "".join(f"{hole},{base},{code}\n" for hole, base, code in layers)


def reread(write, layers, head="hole,to,code", **stated):
    table = Source(path=write(text(layers, head), "log.csv"), **stated)
    return read_boreholes(write(COLLAR, "collar.csv"), None, [table])


def limits(found):
    log = found.logs[0]
    return {(str(h), str(c)): (t, b) for h, t, b, c in zip(log.hole, log.top, log.base, log.code, strict=True)}


def truth():
    rows, top = {}, {}
    for hole, base, code in LAYERS:
        rows[hole, code] = (top.get(hole, 0), base)
        top[hole] = base
    return rows


def listed(found):
    """Return the rows that are not used, and check that each row is used or listed."""
    count = found.counts[-1]
    errors = {issue.row for issue in found.issues if issue.severity == "error" and issue.file == "log.csv"}
    assert (count.read, count.listed) == (count.used + count.listed, len(errors))
    assert count.used == len(found.logs[0].row)
    return sorted(errors)


def test_upper_limits_come_from_the_row_above_and_that_is_said(write):
    found = reread(write, LAYERS)
    assert limits(found) == truth()
    assert listed(found) == []
    (note,) = [issue for issue in found.issues if issue.reason.code == "io.upper-limits-taken-from-above"]
    assert (note.severity, note.column) == ("note", "to")
    assert "层顶取自同孔上一行的层底" in translate(note.reason, ZH)
    both = "hole,from,to,code\n" + "".join(f"{h},{t},{b},{c}\n" for (h, c), (t, b) in truth().items())
    usual = read_boreholes(write(COLLAR, "collar.csv"), None, [write(both, "both.csv")])
    assert not [issue for issue in usual.issues if issue.reason.code == "io.upper-limits-taken-from-above"]
    for limit in ({"base": "T2"}, {"top": "T2"}, {"top": "P"}):
        expected = take_contacts(usual, **limit).points.xyz
        assert len(expected) == 3
        np.testing.assert_allclose(take_contacts(found, **limit).points.xyz, expected, atol=1e-12)


def test_holes_may_alternate(write):
    assert limits(reread(write, sorted(LAYERS, key=lambda layer: layer[1]))) == truth()


def test_rows_in_another_order_are_sorted_with_a_warning(write):
    for order in (LAYERS[::-1], sorted(LAYERS, key=lambda layer: layer[2])):
        found = reread(write, order)
        assert limits(found) == truth()
        (told,) = [issue for issue in found.issues if issue.reason.code == "io.rows-out-of-order"]
        assert told.severity == "warning"
    assert not [issue for issue in reread(write, LAYERS).issues if issue.reason.code == "io.rows-out-of-order"]


def test_a_step_back_takes_both_rows_and_what_hangs_on_them_out(write):
    layers = list(LAYERS)
    layers[6] = ("B", 14, "T1")  # typed for 41
    found = reread(write, layers)
    assert listed(found) == [7, 8, 9]
    assert limits(found) == {key: value for key, value in truth().items() if key[0] != "B" or key[1] == "Q"}
    reasons = {issue.row: issue.reason for issue in found.issues if issue.severity == "error"}
    for row in (7, 8):
        assert reasons[row].code == "io.lower-limit-contradicts"
        assert reasons[row].params == {"first": 7, "last": 8}
    assert (reasons[9].code, reasons[9].params["row"]) == ("io.upper-limit-unknown", 8)
    assert list(take_contacts(found, base="T2").points.hole) == ["A", "C"]


@pytest.mark.parametrize(
    ("fault", "rows", "words"),
    [
        (("A", 10, "T2"), [3], "zero length"),  # the depth of the row above once more
        (("A", "2x5", "T2"), [3, 4], "not a finite number"),
        (("A", "", "T2"), [3, 4], "is empty"),
        (("A", 25.5, ""), [3], "The code is empty"),  # it still ends T1
        (("Z", 25.5, "T2"), [3, 4], "not in the collar table"),  # it may be one of A
        (("", 25.5, "T2"), [3, 4], "The hole is empty"),
    ],
)
def test_planted_faults(write, fault, rows, words):
    found = reread(write, [LAYERS[0], fault, *LAYERS[2:]])
    assert listed(found) == rows
    assert any(words in str(issue.reason) and issue.row == rows[0] for issue in found.issues)
    wanted = {key: value for key, value in truth().items() if key != ("A", "T2")}
    if fault[1] == 10:
        wanted["A", "T1"] = (10, 38)
    if len(rows) == 2:
        del wanted["A", "T1"]
    assert limits(found) == wanted


def test_rows_of_holes_without_a_collar_touch_no_other_hole(write):
    strangers = [("Y", 5, "Q"), ("Y", 9, "T2"), ("Z", 7, "Q")]
    found = reread(write, [*LAYERS[:4], *strangers, *LAYERS[4:]])
    assert listed(found) == [6, 7, 8]
    assert limits(found) == truth()
    among = reread(write, [*LAYERS[:2], *strangers[:2], *LAYERS[2:]])
    assert listed(among) == [4, 5]
    assert limits(among) == truth()


def test_a_row_without_a_depth_hides_its_hole_where_rows_are_sorted(write):
    layers = [*LAYERS[::-1]]
    layers[6] = ("B", "", "T2")
    found = reread(write, layers)
    assert listed(found) == [6, 7, 8, 9]
    assert limits(found) == {key: value for key, value in truth().items() if key[0] != "B"}


@pytest.mark.parametrize("head", ["孔号,层底高程(m),岩土名称", "hole,base elevation,code", "hole,to,code"])
def test_lower_limits_as_elevations(write, head):
    mouth = {"A": 100, "B": 103, "C": 98.5}
    layers = [(hole, mouth[hole] - base, code) for hole, base, code in LAYERS]
    layers[1] = (*layers[1][:2], "")
    found = reread(write, layers, head, measure="elevation" if head.startswith("hole,to") else None)
    assert listed(found) == [3]
    wanted = {key: value for key, value in truth().items() if key != ("A", "T2")}
    assert limits(found) == {key: pytest.approx(value, abs=1e-9) for key, value in wanted.items()}
    assert not [issue for issue in found.issues if issue.reason.code == "io.rows-out-of-order"]


def test_depths_go_before_elevations_and_are_not_mixed_with_them(write):
    head = "孔号,层底深度,岩土名称,层底高程"
    rows = "".join(f"{hole},{base},{code},{1000 - base}\n" for hole, base, code in LAYERS)
    collar = write(COLLAR, "collar.csv")
    assert limits(read_boreholes(collar, None, [write(f"{head}\n{rows}", "log.csv")])) == truth()
    mixed = write("孔号,层顶高程,层底深度,地层\nA,100,10,Q\nA,90,25,T2\n", "mixed.csv")
    with pytest.raises(InputError, match="'层顶高程' and '层底深度' are not both"):
        read_boreholes(collar, None, [mixed])


@pytest.mark.parametrize(
    ("kind", "rows"),
    [
        ("intervals", "hole,to,code\nA,10,Q\nA,25,T\nB,8,Q\n"),
        (
            "intervals",
            "钻孔编号,地层编号,层底深度(m),层厚(m),岩土名称\nZK1,1,2.3,2.3,填土\nZK1,2,7.9,5.6,黏土\nZK2,1,3.1,3.1,填土\n",
        ),
        ("intervals", "BHID,bottom depth,rock\nA,10,Q\nA,25,T\nB,8,Q\n"),
        ("collar", "hole,x,y,z,end,geology\nA,1,2,3,40,Q\nB,5,6,7,50,T\nC,6,7,8,50,T\n"),
        ("picks", "hole,x,y,z,base,formation\nA,1,2,3,40,Q\nA,1,2,1,50,T\nC,6,7,8,50,T\n"),
        ("survey", "hole,depth,azimuth,dip\nB1,0,10,60\nB1,20,11,61\n"),
        ("", "hole,to\nA,10\nA,25\n"),
        ("", "hole,bottom,geology\nA,40,Q\nB,50,T\nC,50,T\n"),
    ],
)
def test_kinds_stay_apart(write, kind, rows):
    (preview,) = preview_file(write(rows))
    assert preview.kind == kind
    assert not preview.missing


def test_import_makes_a_site_of_lower_limits(write, tmp_path):
    log = write(text(LAYERS, "孔号,层底深度,地层代号"), "地层.csv")
    done = import_files([write(COLLAR, "collar.csv"), log], tmp_path / "site.toml")
    assert done.exit_code == 0
    assert all(count.read == count.used + count.listed for count in done.counts)
    assert any(issue.reason.code == "io.upper-limits-taken-from-above" for issue in done.issues)
    np.testing.assert_allclose(done.site.horizons["base of T2"].xyz[:, 2], [74.5, 73, 71.5])
    np.testing.assert_allclose(done.site.horizons["base of T1"].xyz[:, 2], [62, 62, 59.5])


def test_weka_hills_without_its_upper_limits(real_data, write):
    folder = real_data / "weka_hills"
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there; set GEOFIT_DATA")
    with (folder / "Geol.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.reader(file))
    at = rows[0].index("from")
    lines = io.StringIO()
    csv.writer(lines).writerows(row[:at] + row[at + 1 :] for row in rows)
    table = write(lines.getvalue(), "log.csv")
    assert preview_file(table)[0].kind == "intervals"
    expected = read_boreholes(folder / "Location.csv", None, [folder / "Geol.csv"]).logs[0]
    found = read_boreholes(folder / "Location.csv", None, [table]).logs[0]
    assert len(expected.row) == 227
    for array in ("hole", "top", "base", "code", "row"):
        np.testing.assert_array_equal(getattr(found, array), getattr(expected, array))
