"""Wide tables: one row a hole, one column a horizon; against known elevations, and with planted faults."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.data.languages import ZH, translate
from geofit.io import read_points, read_site
from geofit.io.mapping import ColumnMapping, load_mappings
from geofit.io.preview import preview_file
from geofit.project.importing import import_files

WELLS = """\
well,X,Y,KB,T1,T2 base,T3
W1,100,200,50,40,30.5,20
W2,110,200,51,41,,21
W3,120,210,52,42,32,-9999
W4,130,210,53,,,
"""
#: Elevations of each horizon by line.
TRUTH = {"T1": {2: 40, 3: 41, 4: 42}, "T2 base": {2: 30.5, 4: 32}, "T3": {2: 20, 3: 21}}


@pytest.fixture
def read(write):
    """Return a function that reads a wide table through a site file."""

    def read(table, keys='horizons = ["T1", "T2 base", "T3"]', rest=""):
        write(table, "wells.csv")
        return read_site(write(f'[horizon_columns]\nfile = "wells.csv"\n{keys}\n{rest}', "site.toml"))

    return read


def elevations(site):
    return {name: dict(zip(p.row.tolist(), p.xyz[:, 2].tolist(), strict=True)) for name, p in site.horizons.items()}


def balance(site):
    (count,) = site.counts
    assert count.read == count.used + count.listed
    return count.read, count.used


def about(site, words):
    return [issue for issue in site.issues if words in str(issue.reason)]


def test_each_column_is_a_horizon_of_its_header(read):
    site = read(WELLS)
    assert elevations(site) == TRUTH
    t1 = site.horizons["T1"]
    assert t1.xyz[:, :2].tolist() == [[100, 200], [110, 200], [120, 210]]
    assert (t1.hole.tolist(), set(t1.kind)) == (["W1", "W2", "W3"], {"borehole"})


def test_empty_cells_are_counted_and_a_row_of_them_is_listed(read):
    site = read(WELLS)
    assert balance(site) == (4, 3)
    (note,) = about(site, "which give no pick")
    assert note.severity == "note"
    assert str(note.reason).endswith(": T2 base 1, T3 1")
    assert translate(note.reason, ZH).endswith("：T2 base 1, T3 1")
    (lost,) = about(site, "no horizon's value")
    assert (lost.row, lost.severity) == (5, "error")
    assert about(site, "taken as elevations")[0].severity == "note"


def test_depths_count_from_the_collar(read):
    rows = [(w, x, y, kb, [kb - v for v in values]) for w, x, y, kb, values in (
        ("W1", 100, 200, 50, (40, 30.5, 20)), ("W2", 110, 200, 51, (41, 30, 21)),
    )]  # fmt: skip
    table = "well,X,Y,KB,T1,T2 base,T3\n" + "".join(
        f"{w},{x},{y},{kb},{','.join(map(str, v))}\n" for w, x, y, kb, v in rows
    )
    keys = 'horizons = ["T1", "T2 base", "T3"]\nmeasure = "depth"\ncolumns = { z = "KB" }'
    site = read(table, keys)
    assert elevations(site) == {"T1": {2: 40, 3: 41}, "T2 base": {2: 30.5, 3: 30}, "T3": {2: 20, 3: 21}}
    assert about(site, "taken straight down from z")
    with pytest.raises(InputError, match="Depths need the elevation"):
        read(table, keys.splitlines()[0] + '\nmeasure = "depth"')
    above = read(table.replace("50,10", "50,-10"), keys)
    assert 2 not in elevations(above)["T1"]
    assert (about(above, "depth is negative")[0].row, balance(above)) == (2, (2, 2))


def test_a_cell_that_is_no_number_makes_no_pick_but_its_row_is_used(read):
    site = read(WELLS.replace("30.5", "3o.5"))
    assert elevations(site) == TRUTH | {"T2 base": {4: 32}}
    (bad,) = about(site, "not a finite number")
    assert (bad.row, bad.column, bad.value, bad.severity) == (2, "T2 base", "3o.5", "warning")
    assert balance(site) == (4, 3)


def test_a_row_without_a_place_gives_nothing(read):
    site = read(WELLS.replace("110,200", ",200"))
    assert [sorted(rows) for rows in elevations(site).values()] == [[2, 4], [2, 4], [2]]
    assert balance(site) == (4, 2)


def test_feet_of_one_column_are_converted(read):
    site = read(WELLS.replace("T3", "T3_ft"), 'horizons = [5, "T3_ft"]')
    assert elevations(site)["T1"] == TRUTH["T1"]
    assert elevations(site)["T3_ft"] == {2: pytest.approx(6.096), 3: pytest.approx(6.4008)}


def test_only_horizons_of_the_site_are_read(read):
    site = read(WELLS, rest='[[horizon]]\nname = "t1"\n')
    assert elevations(site) == {"t1": TRUTH["T1"]}
    assert {issue.column for issue in about(site, "is not a horizon of the site")} == {"T2 base", "T3"}


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("", "No column is named as a horizon"),
        ('horizons = ["T9"]', "There is no column 'T9' for horizons"),
        ('horizons = "T1"', "must be a list"),
        ('horizon = ["T1"]', "has no key 'horizon'"),
    ],
)
def test_what_is_missing_is_said(read, keys, words):
    with pytest.raises(InputError, match=words):
        read(WELLS, keys)


def test_a_table_without_any_value_is_refused(read):
    with pytest.raises(InputError, match="None of the rows can be used; row 2: The row contains no horizon's value"):
        read("x,y,T1\n1,2,\n3,4,\n", 'horizons = ["T1"]')


def test_import_by_a_mapping_and_never_by_a_guess(write, tmp_path):
    wells = write(WELLS, "wells.csv")
    assert "horizon columns" not in preview_file(wells)[0].kinds
    write('[[table]]\nfile = "wells.csv"\nkind = "horizon columns"\nhorizons = ["T1", 7]\n', "how.toml")
    (mapping,) = load_mappings(tmp_path / "how.toml")
    assert mapping == ColumnMapping(file="wells.csv", kind="horizon columns", horizons=("T1", 7))
    done = import_files([wells], tmp_path / "site.toml", mappings=[mapping])
    assert (done.exit_code, balance(done)) == (0, (4, 3))
    assert elevations(read_site(done.site_file)) == {name: TRUTH[name] for name in ("T1", "T3")}
    done = import_files([wells], tmp_path / "site.toml", mappings=load_mappings(done.mapping_file))
    assert elevations(done.site) == {name: TRUTH[name] for name in ("T1", "T3")}
    with pytest.raises(InputError, match="a list of headers or numbers"):
        load_mappings(write('[[table]]\nfile = "a"\nkind = "horizon columns"\nhorizons = "T1"\n', "bad.toml"))


def test_two_horizons_of_chamaya(real_data, write, tmp_path):
    folder = real_data / "chamaya"
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there; set GEOFIT_DATA")
    mapping = ColumnMapping(file="Wells.dat", kind="horizon columns", horizons=("top", "bot"))
    site = import_files([folder / "Wells.dat"], tmp_path / "site.toml", mappings=[mapping]).site
    assert balance(site) == (189, 189)
    for name in ("top", "bot"):
        expected = read_points(folder / "Wells.dat", z=name).horizons["Wells"].xyz
        np.testing.assert_array_equal(site.horizons[name].xyz, expected)
