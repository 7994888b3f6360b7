"""Encodings, separators, decimal marks, headers, and the lines of rows."""

from __future__ import annotations

import os
import sys
import zipfile

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.journal import Journal
from geofit.io.picks import read_points
from geofit.io.source import Source
from geofit.io.tables import parse_numbers, read_table
from geofit.project.importing import import_files


def read(path, **stated):
    journal = Journal()
    return read_table(Source(path=path, **stated), journal), journal


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "gb18030"])
def test_chinese_header_in_every_encoding(write, encoding):
    text = "孔号,坐标X,坐标Y,孔口高程,岩性\nZK1,500000.5,3100000,1200,强风化花岗岩\n"
    table, _ = read(write(text, encoding=encoding))
    assert table.header == ("孔号", "坐标X", "坐标Y", "孔口高程", "岩性")
    assert table.columns[4] == ("强风化花岗岩",)


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
def test_german_letters(write, encoding):
    table, _ = read(write("Bohrung;Höhe;Schicht\nMüller;1,5;Löß\nGröße;2,5;Mäander\n", encoding=encoding))
    assert table.header[1] == "Höhe"
    assert table.columns[2] == ("Löß", "Mäander")
    assert (table.sep, table.decimal) == (";", ",")


def test_cyrillic_letters(write):
    table, _ = read(write("x;y;z;horizon\n1,5;2;3;Кровля\n1,5;2;4;Подошва слоя\n", encoding="cp1251"))
    assert (table.encoding, table.columns[3]) == ("cp1251", ("Кровля", "Подошва слоя"))


@pytest.mark.parametrize(
    ("text", "sep", "decimal"),
    [
        ("x,y,z\n1.5,2.5,3\n", ",", "."),
        ("x;y;z\n1.5;2.5;3\n", ";", "."),
        ("x;y;z\n1,5;2,5;3\n", ";", ","),
        ("x\ty\tz\n1,5\t2,5\t3\n", "\t", ","),
        ("x|y|z\n1.5|2.5|3\n", "|", "."),
        ("x y  z\n1.5 2.5   3\n", " ", "."),
        ("  x y  z\n 1,5 2,5   3\n", " ", ","),
        ("x;y;z\n" + "1;2;3\n" * 500 + "1,5;2;3\n", ";", ","),
        ("x;y;z\n1.5;2;a, b, c\n1.5;2;d, e\n", ";", "."),
        ("x;y;z\n500.636,96;4.300.550,76;1.220,23\n500.040,97;4.300.531,89;1.242,66\n", ";", ","),
        ("x;y;z\n500,636.96;4,300,550.76;1,220.23\n500,040.97;4,300,531.89;1,242.66\n", ";", "."),
        ("x y z\n500.636,96 4.300.550,76 1.220,23\n500.040,97 4.300.531,89 1.242,66\n", " ", ","),
        ('x,y,z\n"500636,96","4300550,7","1220,2"\n"500040,97","4300531,8",1242\n', ",", ","),
        ("x;y;z\n500.637;4.300.551;1.220\n", ";", ","),
    ],
)
def test_separator_and_decimal_mark(write, text, sep, decimal):
    table, _ = read(write(text))
    assert (table.sep, table.decimal) == (sep, decimal)
    assert table.header == ("x", "y", "z")


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_lines_count_as_an_editor_does(write, newline):
    lines = ["# exported", "", "x,y", "1,2", "", ",", "3,4", "5,6"]
    table, journal = read(write(newline.join(lines)))
    assert table.lines.tolist() == [4, 7, 8]
    assert table.columns == (("1", "3", "5"), ("2", "4", "6"))
    assert {("io.comment-lines", 1), ("io.empty-lines", 1)} <= {
        (issue.reason.code, issue.reason.params.get("count")) for issue in journal.issues
    }


def test_quotes_hold_separators_and_line_breaks(write):
    table, _ = read(write('a,"b\n(m)",c\n1,"x, y",2\n3,"two\nlines",4\n5,6,7\n'))
    assert table.header == ("a", "b\n(m)", "c")
    assert table.columns[1] == ("x, y", "two\nlines", "6")
    assert table.lines.tolist() == [3, 4, 6]


def test_unclosed_quote_does_not_swallow_rows(write):
    table, _journal = read(write('a,b,c\n1,2,"clay\n3,4,5\n6,7,"sand\n8,9,10\n'))
    assert table.read == 4
    assert table.columns[0] == ("1", "3", "6", "8")


def test_rows_of_the_wrong_width(write):
    table, journal = read(write("a,b,c\n1,2\n1,2,3,\n1,2,3,4\n"))
    assert table.columns == (("1", "1"), ("2", "2"), ("", "3"))
    assert table.read == 3
    (issue,) = [issue for issue in journal.issues if issue.severity == "error"]
    assert (issue.row, issue.reason.code) == (4, "io.row-cells-differ")
    assert issue.reason.params == {"count": 4, "width": 3}


def test_header_with_numbers_among_its_names(write):
    assert read(write("x,y,7,name\n1,2,3,a\n2,3,4,b\n"))[0].named


def test_no_header(write):
    table, _ = read(write("1,2,3\n4,5,6\n"))
    assert not table.named
    assert table.header == ("column 1", "column 2", "column 3")
    assert table.lines.tolist() == [1, 2]


def test_titles_and_units_rows_are_no_data(write):
    table, _journal = read(write("Dam site,,\nhole,x,y\n-,m,ft\nB1,1,2\nB2,3,4\n"))
    assert table.header == ("hole", "x", "y")
    assert table.units == ("-", "m", "ft")
    assert table.lines.tolist() == [4, 5]


def test_numbers():
    cells = ("1.5", " -2e3 ", "\u22123", "", "nan", "inf", "1_0", "1,5", "12 m", "1e400")
    values, bad = parse_numbers(cells, ".")
    assert bad.tolist() == [3, 4, 5, 6, 7, 8, 9]
    np.testing.assert_array_equal(values[:3], [1.5, -2000, -3])
    values, bad = parse_numbers(("1,5", "1.5", "2"), ",")
    assert bad.tolist() == [1]
    np.testing.assert_array_equal(values[[0, 2]], [1.5, 2])


@pytest.mark.parametrize("decimal", [".", ","])
def test_thousands_are_read_where_only_one_number_can_be_meant(decimal):
    cells = ("1,234.5", "-1.234,5", "1 234", "1\u202f234\u202f567", "1'234", "1,234,567", "1.234.567")
    values, bad = parse_numbers(cells, decimal)
    assert not bad.size
    np.testing.assert_array_equal(values, [1234.5, -1234.5, 1234, 1234567, 1234, 1234567, 1234567])
    other = "," if decimal == "." else "."
    doubtful = (f"1{other}234", f"1 234{other}5", "12 34", "1 2345", "1,23.5", "0,123.5", "1'234 567")
    assert parse_numbers(doubtful, decimal)[1].tolist() == list(range(len(doubtful)))


@pytest.mark.parametrize(("text", "decimal"), [("1,234.5;1,234", "."), ("1.234,5;1.234", ",")])
def test_decimal_mark_is_that_of_numbers_with_both_marks(write, text, decimal):
    table, _ = read(write(f"x;y\n{text}\n"))
    assert table.decimal == decimal
    assert parse_numbers(table.columns[1], decimal)[1].tolist() == [0]  # 1234, or a slip for 1.234


@pytest.mark.parametrize(
    ("row", "mark", "other"),
    [("500.637;4.300.551;1.220", ",", "."), ("500,637;4,300,551;1,220", ".", ","), ("1.5;2,5;3,5", ",", ".")],
)
def test_numbers_with_two_decimal_marks_name_both(write, row, mark, other):
    with pytest.raises(InputError) as caught:
        points_of(write(f"x;y;z\n{row}\n"))
    reasons = [issue.reason for issue in caught.value.issues if issue.severity == "error"]
    assert {reason.code for reason in reasons} == {"io.cell-of-other-decimal"}
    assert (reasons[0].params["mark"], reasons[0].params["other"]) == (mark, other)


def test_first_row_of_thousands_is_no_header(write):
    assert len(read(write("1 000,5;2 000,5;7,1\n1 010,5;2 000,5;7,2\n"))[0]) == 2


def test_stated_encoding_that_does_not_fit(write):
    with pytest.raises(InputError, match="not written in utf-8"):
        read(write("孔号\n1\n", encoding="gb18030"), encoding="utf-8")


def test_decimal_comma_as_separator_is_refused(write):
    with pytest.raises(InputError, match="both separator and decimal"):
        read(write("a\n"), sep=",", decimal=",")


def points_of(path):
    from geofit.io import read_points

    return read_points(path)


def test_a_quoted_cell_of_any_length_is_read(tmp_path):
    (tmp_path / "p.csv").write_text('x,y,z,kind\n1,2,3,"' + "a" * 200_000 + '"\n4,5,6,b\n7,8,1,c\n')
    assert len(points_of(tmp_path / "p.csv").horizons["p"]) == 3


@pytest.mark.parametrize("quote", ["", '"'])
def test_a_header_wider_than_any_sheet_is_refused(tmp_path, quote):
    header = ",".join(f"{quote}c{k}{quote}" for k in range(300_000))
    (tmp_path / "p.csv").write_text(header + "\n" + ",".join("1" * 300_000) + "\n")
    with pytest.raises(
        InputError, match="300\N{NO-BREAK SPACE}000 columns; at most 16\N{NO-BREAK SPACE}384"
    ) as refused:
        points_of(tmp_path / "p.csv")
    assert len(str(refused.value)) < 400


def test_a_long_line_is_folded_where_it_is_listed(tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z\n1,2,3\n" + "9" * 2_000_000 + "\n4,5,6\n")
    picks = points_of(tmp_path / "p.csv")
    assert max(len(issue.value) for issue in picks.issues) < 300
    (tmp_path / "q.csv").write_text("9" * 2_000_000)
    with pytest.raises(InputError) as refused:
        points_of(tmp_path / "q.csv")
    assert len(str(refused.value)) < 1000


def test_findings_that_are_alike_are_counted(monkeypatch):
    monkeypatch.setattr("geofit.io.journal.MOST", 5)
    journal = Journal()
    for row in range(100):
        journal.add("note", "a.csv", message("test.alike", "alike"), row=row)
        journal.add("note", "a.csv", message("test.text", "alike too {row}", row=row), row=row)
    journal.add("note", "a.csv", message("test.another", "another"), row=7)
    assert len(journal.issues) == 13
    more = [issue for issue in journal.issues if issue.reason.code == "io.more-alike"]
    assert [issue.reason.params["count"] for issue in more] == [95, 95]
    assert [issue.row for issue in more] == [99, 99]


def test_many_repeated_points_are_counted(tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z\n" + "1,2,3\n" * 30_000 + "4,5,6\n")
    picks = points_of(tmp_path / "p.csv")
    assert len(picks.horizons["p"]) == 30_001
    assert len(picks.issues) < 10_100
    (more,) = [issue.reason for issue in picks.issues if issue.reason.code == "io.horizon-points-repeated"]
    assert more.params["count"] == 29_999


def sheet(path, xml):
    """A workbook of one sheet with the given rows as XML."""
    openpyxl = pytest.importorskip("openpyxl")
    openpyxl.Workbook().save(path)
    with zipfile.ZipFile(path) as book:
        parts = {name: book.read(name) for name in book.namelist()}
    head = '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>'
    parts["xl/worksheets/sheet1.xml"] = f"{head}{xml}</sheetData></worksheet>".encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        for name, data in parts.items():
            book.writestr(name, data)


@pytest.mark.parametrize(
    ("xml", "code"),
    [
        (
            '<row r="1"><c r="A1"><v>1</v></c></row><row r="2000000000"><c r="A2000000000"><v>1</v></c></row>',
            "io.sheet-rows",
        ),
        ("".join(f'<row r="{k}"><c r="XFD{k}"><v>1</v></c></row>' for k in range(1, 3000)), "io.sheet-cells"),
    ],
    ids=["a row far below", "cells far right"],
)
def test_a_workbook_that_claims_more_than_a_sheet_holds_is_refused(tmp_path, xml, code):
    sheet(tmp_path / "bomb.xlsx", xml)
    with pytest.raises(InputError) as wrong:
        points_of(tmp_path / "bomb.xlsx")
    assert wrong.value.code == code


def test_a_workbook_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("geofit.io.workbook.MOST_BYTES", 5_000)
    sheet(tmp_path / "bomb.xlsx", "<!--" + " " * 10_000 + "-->")
    with pytest.raises(InputError, match="unpacks to"):
        points_of(tmp_path / "bomb.xlsx")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names are bytes on Linux only")
def test_a_file_whose_name_is_not_utf8_is_read_under_a_legible_one(tmp_path):
    path = tmp_path / os.fsdecode("层面.csv".encode("gbk"))
    path.write_text("x,y,z\n1,2,3\n4,5,6\n7,8,1\n")
    picks = points_of(path)
    assert list(picks.horizons) == ["层面"]
    assert set(picks.horizons["层面"].file.tolist()) == {"层面.csv"}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with a name are for Linux and macOS")
def test_a_pipe_and_a_name_with_nul_are_refused(tmp_path):
    os.mkfifo(tmp_path / "p.csv")
    with pytest.raises(InputError, match="a pipe or a device"):
        points_of(tmp_path / "p.csv")
    with pytest.raises(InputError, match="NUL"):
        points_of(f"{tmp_path}/p\0.csv")


def test_decimal_commas_in_quotes_between_commas_may_be_stated(write):
    """An import states what it guessed, and its own statement was refused."""
    rows = [f'"B{i}","50{i},5","310{i},25","12,75"' for i in range(5)]
    file = write("\n".join(['"hole","x","y","z"', *rows]) + "\n", "collar.csv")
    found = import_files([file], file.with_name("site.toml"))
    assert [(count.file, count.used) for count in found.counts] == [("collar.csv", 5)]
    with pytest.raises(InputError) as caught:
        read_points(write("x,y,z\n1,5,2,5,3,5\n", "picks.csv"), sep=",", decimal=",")
    assert caught.value.reason.code == "io.comma-ambiguous"
