"""Large texts are read column by column: every row, number and issue is the one of the reader of single cells."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from geofit.data.errors import InputError
from geofit.io import big_text, tables
from geofit.io.cell_loops import read_cells
from geofit.io.journal import Journal
from geofit.io.picks import read_points
from geofit.io.source import Source
from geofit.io.tables import parse_numbers, read_table

NUMBERS = st.one_of(
    st.floats(-1e7, 1e7).map(repr),
    st.decimals(-1000000, 1000000, places=3, allow_nan=False).map(str),
    st.integers(-(10**20), 10**20).map(str),
    st.floats(-1e7, 1e7).map("{:.18e}".format),
    st.tuples(st.decimals(0, 10**19, places=19), st.integers(-30, 30)).map("{0[0]}E{0[1]:+d}".format),
    st.tuples(st.integers(0, 10**18), st.integers(1, 10**9)).map("0.00{0[0]}{0[1]}".format),
    st.sampled_from(
        [
            "",
            " ",
            " 1.5",
            "2 ",
            "+3",
            "1e",
            "1e+",
            "1e5",
            "1.e2",
            "5",
            "0e99",
            "1e400",
            "1,e5",
            "-0",
            "-0.0",
            ".5",
            "5.",
            "1e3",
            "nan",
            "inf",
            "1_000",
            "−4",
            "1,5",
        ]
    ),
    st.sampled_from(
        ["9007199254740993", "0.1234567890123456789", "１２", "1.2.3", "--1", "+-2", ".", "-", "1\x0b", "é"]
    ),
)
WORDS = st.sampled_from(
    ["A", "B1", "B1 ", "", "钻孔", "x" * 300, '"q"', '"a,b"', '""', 'say "so"', '5"', "T\tU", "a b"]
)


@st.composite
def texts(draw):
    sep = draw(st.sampled_from([",", ";", "\t", " ", "|"]))
    rows = draw(st.lists(st.tuples(NUMBERS, NUMBERS, WORDS), max_size=30))
    lines = [sep.join(row) for row in rows]
    extra = [sep, "", " ", sep * 2, sep * 5, f"1{sep}2", f"1{sep}2{sep}c{sep}d", '1,2,"open', 'close"', "\x0b", '"'] * 2
    for line in draw(st.lists(st.sampled_from(extra), max_size=6)):
        lines.insert(draw(st.integers(0, len(lines))), line)
    if draw(st.booleans()):
        lines = [line + sep for line in lines]
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    return end.join([sep.join(("x", "y", "name")), *lines]) + draw(st.sampled_from(["", end, end * 2])), sep


def read(path, monkeypatch, *, big: bool, **stated):
    monkeypatch.setattr(tables, "BIG", 0 if big else 10**12)
    journal = Journal()
    try:
        table = read_table(Source(path=path, **stated), journal)
    except InputError as error:
        return str(error), journal, None
    columns = [list(column) for column in table.columns]
    numbers = [parse_numbers(column, table.decimal) for column in table.columns]
    cells = [[column[i] for i in range(len(table))] for column in table.columns]
    found = (table.header, table.units, table.read, table.decimal, table.encoding, table.sep, table.lines.tolist())
    return found, journal, (columns, cells, [(v.view(np.int64).tolist(), bad.tolist()) for v, bad in numbers])


@settings(max_examples=400, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(texts(), st.sampled_from([64, 1 << 20]), st.booleans())
@example(("x,y,name\n1,2,a\n\n , ,\n3,4,b", ","), 64, True)
@example(('x,y,name\n1,2,"two\nlines"\n,,\n"5","6","c"\n', ","), 64, True)
def test_every_cell_number_and_issue_is_that_of_the_small_reader(monkeypatch, tmp_path, made, piece, stated):
    text, sep = made
    path = tmp_path / "t.csv"
    path.write_bytes(text.encode())
    monkeypatch.setattr(big_text, "PIECE", piece)
    options = {"sep": sep} if stated else {}
    small, said, cells = read(path, monkeypatch, big=False, **options)
    large, also, found = read(path, monkeypatch, big=True, **options)
    assert large == small
    assert also.issues == said.issues
    assert found == cells


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize(("sep", "quote"), [(";", ""), (";", '"'), (" ", "")])
def test_columns_read_together_are_those_read_alone(tmp_path, monkeypatch, decimal, sep, quote):
    rng = np.random.default_rng(7)
    rows = [[*map(repr, rng.normal(0, 10.0 ** rng.integers(-30, 30), 3).tolist()), f"H{i % 5}"] for i in range(500)]
    rows += [row.split(";") for row in ("nan;1;2;H1", "+1;2; ;H0", "1_0;2;3;H0", ";2 ;3;H1", "1e999;0;-0;H", "9;8;7;")]
    if sep == " ":
        rows = [row for row in rows if all(cell.strip() for cell in row)]
    lines = [sep.join(quote + cell.replace(".", decimal) + quote for cell in row) for row in rows]
    path = tmp_path / "t.csv"
    path.write_text("\n".join([sep.join(("x", "y", "z", "name")), *lines]), encoding="utf-8")
    monkeypatch.setattr(tables, "BIG", 0)
    table = read_table(Source(path=path, sep=sep, decimal=decimal), Journal())
    table.columns[0].prepare([0, 2], [3], decimal)
    assert list(table.columns[3]) == [row[3].strip() for row in rows]
    for column in (table.columns[2], table.columns[0], table.columns[1]):
        values, bad = parse_numbers(column, decimal)
        expected, wrong = parse_numbers(tuple(column), decimal)
        assert values.tobytes() == expected.tobytes()
        assert bad.tolist() == wrong.tolist()


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "gb18030", "cp1252"])
@pytest.mark.parametrize("text", ["x;y;name\r\n" + "1,5;2,5;Löß\r\n" * 40, "x,y,name\n" + "1.5,2.5,T2\n" * 9])
def test_encodings_and_decimal_commas(monkeypatch, tmp_path, encoding, text):
    path = tmp_path / "t.csv"
    path.write_bytes(text.encode(encoding))
    small, large = (read(path, monkeypatch, big=big) for big in (False, True))
    assert large[0] == small[0]
    assert large[2] == small[2]


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False).map(repr) | NUMBERS, min_size=1, max_size=60))
def test_plain_numbers_are_those_of_python(cells):
    text = np.frombuffer("\n".join(cells).encode() + b"\n", np.uint8)
    ends = np.flatnonzero(text == 10)
    values, start, end = np.empty((1, len(cells))), *(np.empty((1, len(cells)), np.int64) for _ in range(2))
    begins = np.concatenate([[0], ends[:-1] + 1])
    read_cells(text, begins, np.array([0]), np.array([True]), ord(";"), ord("."), values, start, end)
    for value, low, cell in zip(values[0].tolist(), start[0].tolist(), cells, strict=True):
        if low < 0:
            assert np.float64(value).tobytes() == np.float64(float(cell.strip('" '))).tobytes()
        if re.fullmatch(r"[+-]?\d{1,9}(\.\d{0,6})?", cell, re.ASCII):
            assert low < 0


def test_points_of_a_large_file_are_those_of_a_small_one(monkeypatch, tmp_path):
    rng = np.random.default_rng(3)
    lines = ["x,y,z,horizon,hole,accuracy,kind"]
    for i in range(3000):
        x, y = rng.uniform(0, 500, 2)
        lines.append(f"{x:.2f},{y:.2f},{rng.normal():.3f},T{i % 3},B{i // 7},{'' if i % 5 else 0.5},Borehole")
    lines[500], lines[501], lines[900] = lines[500] + ",9", "a,1,2,T1,,,", '1,2,3,"T1","B ""x""",,'
    lines[700] = lines[699]
    path = tmp_path / "picks.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    found = []
    for big in (10**12, 0):
        monkeypatch.setattr(tables, "BIG", big)
        monkeypatch.setattr(big_text, "PIECE", 4000)
        found.append(read_points(path))
    small, large = found
    assert large.issues == small.issues
    assert large.counts == small.counts
    assert large.inputs == small.inputs
    assert list(large.horizons) == list(small.horizons)
    for name, points in small.horizons.items():
        other = large.horizons[name]
        for column in ("xyz", "accuracy", "row"):
            assert getattr(other, column).tobytes() == getattr(points, column).tobytes()
        for label in ("kind", "hole", "section", "file"):
            assert getattr(other, label).tolist() == getattr(points, label).tolist()
