"""The whole of a small site, and every way in which its files can be wrong."""

from __future__ import annotations

import hashlib
import re

import numpy as np
import pytest
from chinese import english_left

from geofit.data.errors import InputError
from geofit.io import read_site


def errors(site):
    return [issue for issue in site.issues if issue.severity == "error"]


def check_counts(site):
    assert all(count.read == count.used + count.listed for count in site.counts)
    assert all(count.used >= 0 and count.listed >= 0 for count in site.counts)


def test_small_site_has_every_point_where_it_belongs(make_site):
    path = make_site()
    site = read_site(path)
    assert (site.name, site.crs) == ("Small", "local grid")
    assert list(site.horizons) == ["T2-T1", "weathering"]
    points = site.horizons["T2-T1"]
    assert points.kind.tolist() == [
        "borehole", "borehole", "adit", "section", "section", "section", "outcrop", "geophysics", "map",
    ]  # fmt: skip
    expected = [
        [500100, 3100100, 110 - 20],
        [500200 + 20 * np.cos(np.radians(60)), 3100100, 111 - 20 * np.sin(np.radians(60))],
        [500050, 3100500, 90],
        [500000, 3100000, 80],
        [500150, 3100200, 81],
        [500300, 3100500, 82],
        [500500, 3100500, 110],  # half-way between the rows of the grid
        [500600, 3100600, 70],
        [500700, 3100600, 71],
    ]
    np.testing.assert_allclose(points.xyz, expected, atol=1e-6)
    assert points.hole.tolist() == ["B1", "B2", "PD1", "", "", "", "", "", ""]
    assert points.section.tolist() == [""] * 3 + ["C1"] * 3 + [""] * 3
    assert points.row.tolist() == [4, 6, 2, 2, 3, 4, 2, 2, 3]
    assert points.file[[0, 3]].tolist() == ["lithology.csv", "sections/C1.csv"]
    np.testing.assert_array_equal(points.accuracy, [0.03, 0.03, np.nan, 0.2, 0.2, 0.2, np.nan, 0.5, np.nan])
    np.testing.assert_allclose(site.horizons["weathering"].xyz, [[500100, 3100100, 102]], atol=1e-9)
    assert site.settings["T2-T1"].epsilon == 0.25
    assert site.settings["weathering"].epsilon == 0.5
    assert [hole.name for hole in site.holes] == ["B1", "B2", "B3", "PD1"]
    assert site.boundary.shape == (4, 2)
    assert not errors(site)
    check_counts(site)


def test_open_base_is_noted_and_gives_no_contact(make_site):
    site = read_site(make_site())
    notes = [issue.reason for issue in site.issues if issue.reason.code == "io.contacts-uncertain"]
    assert len(notes) == 1
    assert "B3" in str(notes[0].params["holes"])


def test_inputs_are_the_hashes_of_all_files(make_site):
    path = make_site()
    site = read_site(path)
    assert len(site.inputs) == 12
    for name, digest in site.inputs.items():
        assert digest == hashlib.sha256((path.parent / name).read_bytes()).hexdigest()


def test_horizons_of_the_data_where_the_site_file_names_none(make_site):
    text = '[picks]\nfile = "geophysics.csv"\n'
    site = read_site(make_site(text, geophysics="horizon,x,y,z\nA,0,0,1\nB,1,0,2\nA,2,0,3\n"))
    assert {name: len(points) for name, points in site.horizons.items()} == {"A": 2, "B": 1}
    assert site.horizons["A"].kind.tolist() == ["point", "point"]


def test_table_with_stated_columns_separator_decimal_and_encoding(make_site):
    entry = (
        '{ file = "collar.csv", sep = ";", decimal = ",", encoding = "gb18030", '
        'columns = { hole = "名", x = 3, y = "甲", z = "丙" } }'
    )
    text = make_site().read_text("utf-8").replace('collar = "collar.csv"', f"collar = {entry}")
    table = "名;甲;乙;丙\nB1;3100100,5;500100,25;110\nB2;3100100;500200;111\nB3;3100100;500300;112\n"
    site = read_site(make_site(text, collar=table.encode("gb18030")))
    np.testing.assert_allclose(site.holes[0].xyz[0], [500100.25, 3100100.5, 110])


# file -> (content, words of the error)
BROKEN_FILES = {
    "empty file": ("collar", "", ["collar.csv", "empty"]),
    "blank lines only": ("collar", "\n\n \n", ["collar.csv", "empty"]),
    "header only": ("collar", "hole,x,y,z\n", ["collar.csv", "no rows"]),
    "missing column": ("collar", "hole,x,z\nB1,1,2\n", ["collar.csv", "'y'", "hole, x, z"]),
    "missing file": ("collar", None, ["collar.csv", "no such file"]),
    "no usable collar": ("collar", "hole,x,y,z\nB1,a,2,3\n", ["collar.csv", "None of the rows", "row 2"]),
    "longitude": ("collar", "hole,lon,lat,z\nB1,103.1,28.2,3\n", ["collar.csv", "Longitude", "Project"]),
    "workbook": ("collar", b"PK\x03\x04\x00\x00", ["collar.csv", "workbook"]),
    "binary": ("collar", bytes(range(256)) * 4, ["collar.csv", "not text"]),
    "two corners": ("boundary", "x,y\n0,0\n1,1\n", ["boundary.csv", "corners of the boundary: 2"]),
    "boundary without a corner's y": ("boundary", "x,y\n0,0\n1,\n1,1\n0,1\n", ["boundary.csv", "row 3"]),
    "boundary with an infinite corner": (
        "boundary",
        "x,y\n0,0\ninf,0\n1,1\n",
        ["boundary.csv", "row 3", "inf"],
    ),
    "boundary crosses itself": (
        "boundary",
        "x,y\n0,0\n10,10\n10,0\n0,10\n",
        ["boundary.csv", "crosses", "Self-intersection"],
    ),
    "boundary on a line": ("boundary", "x,y\n0,0\n1,1\n2,2\n", ["boundary.csv"]),
    "boundary swapped": (
        "boundary",
        "x,y\n3099900,499900\n3101000,499900\n3101000,501000\n3099900,501000\n",
        ["exchanged"],
    ),
    "ground without cells": (
        "ground.asc",
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\n",
        ["0 cells"],
    ),
    "ground with a word": (
        "ground.asc",
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\n1 2\n3 x\n",
        ["row 7", "'x'"],
    ),
    "ground without a head": ("ground.asc", "1 2\n3 4\n", ["ncols"]),
    "ground empty": ("ground.asc", "", ["ground.asc", "ncols"]),
    "all collars swapped": (
        "collar",
        "hole,x,y,z\nB1,3100100,500100,110\nB2,3100100,500200,111\n",
        ["collar.csv", "exchanged", "row 2"],
    ),
    "all picks swapped": (
        "geophysics",
        "horizon,x,y,z\nT2-T1,3100600,500600,70\n",
        ["geophysics.csv", "exchanged"],
    ),
    "picks with no usable row": ("geophysics", "horizon,x,y,z\nT2-T1,nan,1,70\n", ["geophysics.csv", "nan"]),
    "no hole carries the code": (
        "lithology",
        "hole,from,to,code\nB1,0,5,T3\nB1,5,9,T1\n",
        ["lithology.csv", "'T2'", "T1, T3"],
    ),
    "adit of one corner": (
        "adits",
        "adit,x,y,z\nPD1,500000,3100500,90\n",
        ["adits.csv", "two usable corners"],
    ),
}


@pytest.mark.parametrize("case", BROKEN_FILES)
def test_broken_file_is_named_in_the_error(make_site, case):
    file, text, words = BROKEN_FILES[case]
    with pytest.raises(InputError) as caught:
        read_site(make_site(**{file: text}))
    assert all(word in str(caught.value) for word in words), str(caught.value)
    assert not english_left(caught.value.message)


# what is replaced in the site file -> (by what, words of the error)
BROKEN_SITES = {
    "unknown key": ("epsilon = 0.25", "epsillon = 0.25", ["epsillon", "Did you mean 'epsilon'"]),
    "unknown table": ("[traces]", "[trace]", ["'trace'", "Did you mean 'traces'"]),
    "unknown key of a file": (
        'file = "outcrops.csv"',
        'fil = "outcrops.csv"',
        ["'fil'", "Did you mean 'file'"],
    ),
    "unknown role": (
        'file = "outcrops.csv"',
        'file = "outcrops.csv"\ncolumns = { horizn = "h" }',
        ["Did you mean 'horizon'"],
    ),
    "unknown column": (
        'file = "outcrops.csv"',
        'file = "outcrops.csv"\ncolumns = { x = "E" }',
        ["'E'", "horizon, x, y"],
    ),
    "section without its line": (
        "line = [[500000, 3100000], [500300, 3100400], [500300, 3100900]]\n",
        "",
        ["section 'C1'", "line"],
    ),
    "section line of one corner": (
        "line = [[500000, 3100000], [500300, 3100400], [500300, 3100900]]",
        "line = [[500000, 3100000]]",
        ["section 'C1'", "two or more"],
    ),
    "section line swapped": (
        "line = [[500000, 3100000], [500300, 3100400], [500300, 3100900]]",
        "line = [[3100000, 500000], [3100400, 500300]]",
        ["section 'C1'", "exchanged"],
    ),
    "section line of words": (
        "line = [[500000, 3100000], [500300, 3100400], [500300, 3100900]]",
        'line = [["a", "b"]]',
        ["section 'C1'"],
    ),
    "section scale of zero": ('name = "C1"', 'name = "C1"\nscale = 0', ["scale", "above 0"]),
    "setting out of range": ("epsilon = 0.25", "epsilon = -1", ["horizon 'T2-T1'", "-1"]),
    "setting of the wrong type": ("epsilon = 0.25", 'epsilon = "x"', ["horizon 'T2-T1'", "'x'"]),
    "cap of the wrong type": ("epsilon = 0.25", 'max_control_points = "x"', ["horizon 'T2-T1'"]),
    "top and base": ('base = "T2"', 'base = "T2"\ntop = "T1"', ["both top and base"]),
    "unknown dip": ('dip = "down-positive"', 'dip = "down"', ["dip", "down-negative"]),
    "unknown kind": ("borehole = 0.03", "borhole = 0.03", ["borhole", "Did you mean 'borehole'"]),
    "accuracy of zero": ("borehole = 0.03", "borehole = 0", ["accuracy", "above 0"]),
    "horizon without a point": (
        'name = "weathering"\nbase = "强风化"',
        'name = "fault"',
        ["'fault'", "no point"],
    ),
    "one name twice": ('name = "weathering"', 'name = "T2-T1"', ["the same name"]),
    "no collar": ('collar = "collar.csv"\n', "", ["collar"]),
    "not valid TOML": ("[traces]", "[traces", ["TOML", "row 21"]),
    "separator of two characters": (
        'file = "outcrops.csv"',
        'file = "outcrops.csv"\nsep = ";;"',
        ["separator"],
    ),
    "unknown encoding": ('file = "outcrops.csv"', 'file = "outcrops.csv"\nencoding = "x"', ["encoding"]),
}


@pytest.mark.parametrize("case", BROKEN_SITES)
def test_broken_site_file_is_explained(make_site, case):
    old, new, words = BROKEN_SITES[case]
    text = make_site().read_text("utf-8")
    assert old in str(text)
    with pytest.raises(InputError) as caught:
        read_site(make_site(str(text).replace(old, new)))
    assert all(word in str(caught.value) for word in words), str(caught.value)
    assert not english_left(caught.value.message)


# file -> (rows appended to the sound ones, column of the issue, words of its reason)
LISTED_ROWS = {
    "text in a number": ("geophysics", "T2-T1,500600,abc,70,,\n", "y", "not a finite number"),
    "nan": ("geophysics", "T2-T1,500600,3100600,NaN,,\n", "z", "not a finite number"),
    "infinity": ("geophysics", "T2-T1,500600,3100600,-inf,,\n", "z", "not a finite number"),
    "a number with a Python underscore": (
        "geophysics",
        "T2-T1,500600,3100600,1_0,,\n",
        "z",
        "not a finite number",
    ),
    "empty number": ("geophysics", "T2-T1,500600,3100600,,,\n", "z", "empty"),
    "a no-data mark": ("geophysics", "T2-T1,500600,3100600,-9999,,\n", "z", "no data"),
    "accuracy of zero": ("geophysics", "T2-T1,500600,3100600,7,,0\n", "accuracy", "above 0"),
    "unknown horizon": ("geophysics", "T2-T3,500600,3100600,70,,\n", "horizon", "T2-T3"),
    "a cell too many": ("geophysics", "T2-T1,500600,3100600,70,,0.5,7\n", "", "row: 7"),
    "one swapped pick": ("geophysics", "T2-T1,3100600,500600,70,,\n", "x", "exchanged"),
    "one swapped collar": ("collar", "B9,3100600,500600,70,20\n", "x", "exchanged"),
    "duplicate collar": ("collar", "B1,500100,3100100,110,50\n", "hole", "row 2 already, at the same place"),
    "second collar of a hole": ("collar", "B1,500900,3100100,110,50\n", "hole", "row 2 already, at another"),
    "negative depth of a hole": ("collar", "B9,500900,3100100,110,-5\n", "depth", "negative"),
    "a hole without collar": ("lithology", "B7,0,5,T2\n", "hole", "'B7' is not in the collar table"),
    "a survey without its hole": ("survey", "B7,0,0,90\n", "hole", "'B7' is not in the collar table"),
    "reversed interval": ("lithology", "B1,45,44,T1\n", "to", "reversed"),
    "interval without length": ("lithology", "B1,45,45,T1\n", "to", "zero length"),
    "interval above the collar": ("lithology", "B1,-1,0,T1\n", "from", "above the collar"),
    "interval beyond the hole": ("lithology", "B1,50,55,T1\n", "from", "beyond the hole's end"),
    "interval twice": ("lithology", "B1,20,50,T1\n", "from", "repeats row 5"),
    "station twice": ("survey", "B2,30,90,60\n", "depth", "repeats the depth of row 3"),
    "station above the collar": ("survey", "B2,-3,90,60\n", "depth", "above the collar"),
    "impossible dip": ("survey", "B2,40,90,95\n", "dip", "between -90 and 90"),
    "impossible azimuth": ("survey", "B2,40,400,60\n", "azimuth", "between 0 and 360"),
    "azimuth missing": ("survey", "B2,40,,60\n", "azimuth", "empty"),
    "impossible turn": ("survey", "B2,40,90,-60\n", "dip", "turns by 120 degrees"),
    "distance beyond the line": (
        "sections/C1.csv",
        "T2-T1,1000.5,80\n",
        "distance",
        "not on the line of section C1",
    ),
    "distance before the line": (
        "sections/C1.csv",
        "T2-T1,-5,80\n",
        "distance",
        "not on the line of section C1",
    ),
    "chainage beyond the adit": ("adit_contacts", "PD1,300,T2-T1\n", "chainage", "not on adit PD1"),
    "contact of an unknown adit": ("adit_contacts", "PD2,30,T2-T1\n", "adit", "'PD2' is not in"),
    "outcrop off the ground": ("outcrops", "T2-T1,509500,3100500\n", "x", "off the ground"),
}


@pytest.mark.parametrize("case", LISTED_ROWS)
def test_bad_row_is_listed_and_not_used(make_site, files, case):
    file, rows, column, words = LISTED_ROWS[case]
    name = file if "." in file else file + ".csv"
    sound = read_site(make_site())
    site = read_site(make_site(**{file: files[name] + rows}))
    check_counts(site)
    (issue,) = errors(site)
    assert (issue.file, issue.row, issue.column) == (name, files[name].count("\n") + 1, column)
    assert words in str(issue.reason)
    assert not [text for one in site.issues for text in english_left(one.reason) + english_left(one.remedy)]
    (count,) = [count for count in site.counts if count.file == name]
    assert (count.read, count.listed) == (files[name].count("\n"), 1)
    for horizon, points in sound.horizons.items():
        np.testing.assert_array_equal(site.horizons[horizon].xyz, points.xyz)


WARNED_ROWS = {
    "overlapping interval": ("lithology", "B2,55,58,T3\n", "overlaps that of row 7 by 3.00 m"),
    "interval across the hole's end": ("lithology", "B3,39,45,T2\n", "5.00 m beyond the hole's end"),
    "two elevations at one location": (
        "geophysics",
        "T2-T1,500600,3100600,75,,\n",
        "two elevations at one location, +5.000 m",
    ),
    "far off": ("geophysics", "T2-T1,700600,3100600,75,,\n", "far outside the study area"),
    "two holes at one collar": ("collar", "B9,500100,3100100,110,50\n", "where hole B1 (row 2) starts"),
}


@pytest.mark.parametrize("case", WARNED_ROWS)
def test_doubtful_row_is_used_with_a_warning(make_site, files, case):
    file, rows, words = WARNED_ROWS[case]
    site = read_site(make_site(**{file: files[file + ".csv"] + rows}))
    check_counts(site)
    assert not errors(site)
    last = files[file + ".csv"].count("\n") + 1
    assert any(words in str(i.reason) for i in site.issues if i.severity == "warning" and i.row == last)


def test_one_point_is_warned_of(make_site):
    site = read_site(make_site())
    assert any("weathering has one point only" in str(issue.reason) for issue in site.issues)


def test_names_that_differ_in_marks_are_one_horizon(make_site):
    site = read_site(make_site(outcrops="horizon,x,y\nT2_T1,500500,3100500\nt2-t1,500510,3100500\n"))
    assert list(site.horizons) == ["T2-T1", "weathering"]
    outcrops = site.horizons["T2-T1"].xyz[site.horizons["T2-T1"].kind == "outcrop"]
    assert outcrops[:, 0].tolist() == [500500, 500510]


def test_a_site_without_a_horizon_states_why(tmp_path):
    (tmp_path / "s.csv").write_text("horizon,distance,elevation\nT2,1000,700\nT2,1100,701\n")
    line = "[[500000, 3100000], [500500, 3100000]]"
    (tmp_path / "site.toml").write_text(f'[[section]]\nname = "C"\nline = {line}\nfile = "s.csv"\n')
    with pytest.raises(InputError, match=r"no horizon; .*: 2, the first is s\.csv, row 2: The distance 1000") as wrong:
        read_site(tmp_path / "site.toml")
    assert [issue.reason.code for issue in wrong.value.issues if issue.severity == "error"] == [
        "io.distance-off-section"
    ] * 2


def test_outcrop_without_ground_is_an_error(make_site):
    text = re.sub(r"\[ground\]\nfile = \S+\n", "", make_site().read_text("utf-8"))
    with pytest.raises(InputError, match="no ground on which to place"):
        read_site(make_site(text))


def test_trace_with_its_own_elevation_is_not_draped(make_site):
    site = read_site(make_site(outcrops="horizon,x,y,z\nT2-T1,500500,3100500,77\nT2-T1,500600,3100500,\n"))
    points = site.horizons["T2-T1"]
    np.testing.assert_allclose(points.xyz[points.kind == "outcrop", 2], [77, 110])


def test_progress_can_cancel(make_site):
    from geofit.data.errors import Cancelled

    with pytest.raises(Cancelled):
        read_site(make_site(), progress=lambda stage, fraction: fraction < 0.3)


def test_sample_site_reads_without_an_error(request):
    path = request.config.rootpath / "sample_data" / "site.toml"
    if not path.exists():
        pytest.skip("sample_data/site.toml is not there; run the generator")
    site = read_site(path)
    check_counts(site)
    assert len(site.horizons) >= 5
    assert len(site.boundary) >= 3
    assert site.ground is not None


def test_the_title_block_of_the_report_is_read_and_its_errors_name_the_key(make_site):
    path = make_site()
    text = path.read_text(encoding="utf-8")
    path.write_text(
        text
        + '\n[report]\nproject = 2026\nclient = "River Company"\nstatus = "draft"\n'
        + '[[report.revision]]\nmark = "A"\ndate = 2026-01-02\n[[report.revision]]\nmark = 1\ntext = "second"\n',
        encoding="utf-8",
    )
    title = read_site(path).title
    assert (title.project, title.client, title.status, title.author) == ("2026", "River Company", "draft", "")
    assert [(one.mark, one.date, one.text) for one in title.revisions] == [("A", "2026-01-02", ""), ("1", "", "second")]
    assert title.revision == "1"
    for bad, key in (
        ("cleint = 'x'", "cleint"),
        ("client = 3.5", "client"),
        ("[[report.revision]]\ntext = 'x'", "mark"),
    ):
        path.write_text(f"{text}\n[report]\n{bad}\n", encoding="utf-8")
        with pytest.raises(InputError) as refused:
            read_site(path)
        assert refused.value.column == key


@pytest.mark.parametrize(
    "text", ["[picks", "picks = " + "[" * 3000, "a = " + "1" * 5000], ids=["cut off", "deep", "long"]
)
def test_added_tables_that_are_no_toml_are_refused(tmp_path, text):
    site = tmp_path / "site.toml"
    site.write_text('[site]\nname = "Dam"\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"TOML|nested") as caught:
        read_site(site, added=(text,))
    assert caught.value.file == "site.toml"
