"""Real, messy files: what they are known to hold must be found."""

from __future__ import annotations

import pytest

from geofit.io import Source, read_boreholes, read_points, take_contacts
from geofit.io.formats import read_any_table
from geofit.io.journal import Journal


@pytest.fixture
def folder(real_data, request):
    def find(name):
        path = real_data / name
        if not path.is_dir():
            pytest.skip(f"{path} is not there; set GEOFIT_DATA")
        return path

    return find


def count(issues, words):
    return sum(words in str(issue.reason) for issue in issues)


def test_copper_creek(folder):
    path = folder("copper_creek")
    holes = read_boreholes(path / "collar.csv", path / "survey.csv", [path / "lithology.csv"])
    assert count(holes.issues, "Read as utf-8-sig") == 3
    assert count(holes.issues, "5731 are negative, 29 positive") == 1
    assert count(holes.issues, "points upwards") == 29
    assert count(holes.issues, "no station at depth 0") == 101
    assert count(holes.issues, "one station only") == 88 + 1  # 33 vertical ones are one note
    assert count(holes.issues, "collar lies exactly where") == 39
    assert count(holes.issues, "overlaps that of row") == 7
    assert [(c.read, c.used, c.listed) for c in holes.counts] == [
        (545, 545, 0),
        (5822, 5822, 0),
        (7150, 7150, 0),
    ]
    assert len(holes.holes) == 545
    assert len(take_contacts(holes, base="gd").points) > 20


def test_weka_hills(folder):
    path = folder("weka_hills")
    holes = read_boreholes(path / "Location.csv", intervals=[path / "Geol.csv"])
    assert [(c.read, c.used, c.listed) for c in holes.counts] == [(99, 99, 0), (252, 227, 25)]
    assert count(holes.issues, "The code is empty") == 25
    assert len(take_contacts(holes, base="Alluvium").points) == 8


def test_babbitt(folder):
    path = folder("babbitt")
    holes = read_boreholes(path / "collar_BABBITT.csv", path / "survey_BABBITT.csv")
    assert len(holes.holes) == 399
    assert count(holes.issues, "taken as down-positive by majority") == 1
    assert [(c.read, c.used) for c in holes.counts] == [(399, 399), (2628, 2628)]


@pytest.mark.parametrize(
    ("file", "columns", "used", "listed"),
    [
        ("claudius/APoints.csv", {}, 5000, 0),
        ("claudius/ASection.csv", {}, 259, 0),
        ("claudius/CPoints.csv", {}, 5000, 0),
        ("claudius/CSection.csv", {}, 268, 0),
        ("claudius/Fault.csv", {}, 93, 0),
        ("muensterland/base_cretaceous.csv", {}, 1481, 0),
        ("oise/Oise_Thickness.csv", {"z": "Thickness"}, 1025, 0),
        ("chamaya/Wells.dat", {"z": "top"}, 189, 0),
        ("kimberlina/kim_ready.csv", {"z": "_top_abs"}, 652, 69),
        ("import_fixtures/geometry_xyz.csv", {}, 20, 0),
        ("import_fixtures/geometry_xyz_invalid_data.csv", {}, 3, 1),
        ("import_fixtures/geometry_xyz_missing_header.csv", {"x": 2, "y": 3, "z": 4}, 20, 0),
    ],
)
def test_picks(folder, file, columns, used, listed):
    name, table = file.split("/")
    picks = read_points(folder(name) / table, **columns)
    assert (picks.counts[0].used, picks.counts[0].listed) == (used, listed)
    assert sum(map(len, picks.horizons.values())) == used


def test_ags_of_kai_tak_and_east_west_rail(folder):
    path = folder("ags")
    holes = read_boreholes(path / "kaitak_ags3.ags", intervals=[path / "kaitak_ags3.ags"])
    assert [(c.read, c.used, c.listed) for c in holes.counts] == [(80, 80, 0), (1603, 1603, 0)]
    journal = Journal()
    table = read_any_table(Source(path=path / "east_west_rail_ags4.ags", table="LOCA"), journal)
    assert (len(table), table.read) == (1788, 1788)
    for encoding, name in (("cp1252", "cp1252"), ("cp1252", "latin1"), ("utf-8", "utf8")):
        found = read_any_table(Source(path=path / f"4.1-rule1-{name}.ags", table="LOCA"), journal)
        assert found.encoding == encoding


def test_ags_against_the_ags_package(folder):
    theirs = pytest.importorskip("python_ags4.AGS4")
    path = folder("ags") / "east_west_rail_ags4.ags"
    groups, _ = theirs.AGS4_to_dict(str(path))
    for name in ("LOCA", "GEOL", "ABBR"):
        table = read_any_table(Source(path=path, table=name), Journal())
        for header, cells in zip(table.header, table.columns, strict=True):
            assert list(cells) == groups[name][header][2:]
