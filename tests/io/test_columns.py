"""Roles guessed from headers of many programs."""

from __future__ import annotations

import pytest

from geofit.data.errors import InputError
from geofit.io import columns, read_points
from geofit.io.guess import find_columns
from geofit.io.journal import Journal
from geofit.io.rows import read_rows
from geofit.io.source import Source
from geofit.io.tables import read_table


def find(path, schema, **stated):
    journal = Journal()
    source = Source(path=path, columns=stated)
    return find_columns(read_table(source, journal), schema, source, journal), journal


@pytest.mark.parametrize(
    ("schema", "header"),
    [
        (columns.COLLAR, "hole,x,y,z,depth"),
        (columns.COLLAR, "HoleID,East,North,Elev,MaxDepth"),
        (columns.COLLAR, "BHID,XCOLLAR,YCOLLAR,ZCOLLAR,DEPTH"),
        (columns.COLLAR, "LocationID,Easting,Northing,GroundLevel,FinalDepth"),
        (columns.COLLAR, "hole_ID, X (m), Y [m], Z_m, Total Depth (m)"),
        (columns.COLLAR, "钻孔编号,坐标X,坐标Y,孔口高程,终孔深度"),
        (columns.COLLAR, "孔号,X坐标(m),Y坐标(m),孔口标高（m）,孔深(m)"),
        (columns.COLLAR, "Bohrung,Rechtswert,Hochwert,Höhe,Depth"),
        (columns.COLLAR, "Bohrloch,Ostwert,Nordwert,Geländehöhe,Endteufe (m)"),
        (columns.SURVEY, "Bohrung,Tiefe,Azimut (gon),Neigung"),
        (columns.INTERVALS, "Bohrung,von,bis,Schicht"),
        (columns.SURVEY, "BHID,AT,BRG,DIP"),
        (columns.SURVEY, "孔号,测点深度,方位角(°),倾角(°)"),
        (columns.INTERVALS, "hole_ID,depth_from,to_depth,rock code"),
        (columns.INTERVALS, "BHID,FROM,TO,ROCK"),
        (columns.INTERVALS, "孔号,起始深度,终止深度,地层代号"),
        (columns.SECTION, "horizon,distance,elevation"),
        (columns.SECTION, "层位,距离,高程"),
        (columns.ADIT_PATH, "平硐编号,X,Y,Z"),
        (columns.ADIT_CONTACTS, "平硐,桩号,层位"),
        (columns.BOUNDARY, "X,Y"),
    ],
)
def test_spellings(write, schema, header):
    width = header.count(",") + 1
    found, journal = find(write(header + "\n" + ",".join(["1"] * width) + "\n"), schema)
    roles = [*schema.required, *schema.optional][:width]
    assert [found[role] for role in roles] == list(range(width))
    guesses = [issue for issue in journal.issues if "is taken as" in str(issue.reason)]
    assert len(guesses) == width
    assert all(issue.severity == "note" for issue in guesses)


def test_gempy_and_loopstructural_picks(write):
    assert find(write("X,Y,Z,surface\n1,2,3,A\n"), columns.PICKS)[0]["horizon"] == 3
    assert find(write("X,Y,Z,feature_name,val\n1,2,3,A,0\n"), columns.PICKS)[0]["horizon"] == 3


def test_surest_spelling_wins_and_the_others_are_named(write):
    found, journal = find(write("hole,from,to,rock unit,rock code\nB1,0,1,a,b\n"), columns.INTERVALS)
    assert found["code"] == 4
    assert any("also possible: 'rock unit'" in str(issue.reason) for issue in journal.issues)


def test_stated_columns_win(write):
    path = write("x,y,E,N,z\n1,2,3,4,5\n")
    found, _ = find(path, columns.PICKS, x="E", y=4)
    assert (found["x"], found["y"], found["z"]) == (2, 3, 4)


def test_missing_column_names_what_is_there(write):
    with pytest.raises(InputError) as caught:
        find(write("hole,from,code\nB1,0,a\n"), columns.INTERVALS)
    assert "'to'" in str(caught.value)
    assert "hole, from, code" in str(caught.value)
    assert caught.value.row == 1


def test_no_header_is_taken_in_order_with_a_warning(write):
    found, journal = find(write("1,2,3\n4,5,6\n"), columns.PICKS)
    assert found == {"x": 0, "y": 1, "z": 2}
    assert any(issue.severity == "warning" for issue in journal.issues)
    with pytest.raises(InputError, match="without a header; its columns: 4"):
        find(write("1,2,3,4\n4,5,6,7\n"), columns.PICKS)


def test_feet_are_converted_and_warned_of(write):
    journal = Journal()
    rows = read_rows(Source(path=write("hole,x,y,z_ft\nB1,1,2,3\n")), columns.COLLAR, journal)
    assert rows.numbers("z").tolist() == [3 * 0.3048]
    assert rows.numbers("x").tolist() == [1.0]
    assert any("feet" in str(issue.reason) for issue in journal.issues if issue.severity == "warning")


def test_of_two_columns_of_one_name_the_first_counts_and_a_warning_names_both(write):
    found = read_points(write("x,y,z,z\n0,0,1,7\n5,0,2,8\n0,5,3,9\n"))
    assert next(iter(found.horizons.values())).xyz[:, 2].tolist() == [1, 2, 3]
    (doubt,) = [issue for issue in found.issues if issue.severity == "warning"]
    assert doubt.reason.code == "io.column-alternatives"
    assert "'z (2)'" in str(doubt.reason)


def test_depths_next_to_the_elevation_of_collars_are_warned_of(write):
    text = "hole,x,y,z,depth_to_top,horizon\nB1,0,0,200,12,T2\nB2,50,0,201,15,T2\nB3,0,50,202,17,T2\n"
    (doubt,) = [issue for issue in read_points(write(text)).issues if issue.severity == "warning"]
    assert doubt.reason.code == "io.depths-not-read"
    assert doubt.column == "depth_to_top"
    assert not [issue for issue in read_points(write(text), z="z").issues if issue.severity == "warning"]


def test_a_depth_that_is_named_as_elevation_is_warned_of(write, tmp_path):
    text = "x,y,depth (m)\n0,0,12\n50,0,15\n0,50,17\n"
    (doubt,) = [issue for issue in read_points(write(text), z="depth (m)").issues if issue.severity == "warning"]
    assert doubt.reason.code == "io.depth-taken-as-elevation"


def test_two_equal_columns_of_one_name_are_no_warning(write):
    found = read_points(write("x,y,z,z\n0,0,1,1\n5,0,2,2\n0,5,3,3\n"))
    assert {issue.severity for issue in found.issues} == {"note"}
