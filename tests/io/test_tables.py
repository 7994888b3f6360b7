"""Encodings, separators, decimal marks, headers, and the lines of rows."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io.journal import Journal
from geofit.io.source import Source
from geofit.io.tables import parse_numbers, read_table


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
    assert {("import.comment-lines-head-not", 1), ("import.lines-without-cell-filled", 1)} <= {
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
    assert (issue.row, issue.reason.code) == (4, "import.cells-row-header")
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


def test_stated_encoding_that_does_not_fit(write):
    with pytest.raises(InputError, match="not written in utf-8"):
        read(write("孔号\n1\n", encoding="gb18030"), encoding="utf-8")


def test_decimal_comma_as_separator_is_refused(write):
    with pytest.raises(InputError, match="both separator and decimal"):
        read(write("a\n"), sep=",", decimal=",")
