"""Holes, dip signs and contacts."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.io import Source, read_boreholes, take_contacts

COLLAR = "hole,x,y,z,depth\nB1,0,0,100,50\n"


@pytest.fixture
def log(write):
    """Return a function that reads one vertical hole of 50 m with an interval table."""

    def read(rows):
        collar = write(COLLAR, "collar.csv")
        table = write("hole,from,to,code\n" + "".join(f"B1,{row}\n" for row in rows.split()), "log.csv")
        return read_boreholes(collar, None, [table])

    return read


@pytest.mark.parametrize(
    ("rows", "limit", "depth"),
    [
        ("0,10,A 10,30,B 30,50,C", {"base": "B"}, 30),
        ("0,10,A 10,30,B 30,50,C", {"top": "B"}, 10),
        ("0,10,A 10,20,B 20,30,B 30,50,C", {"top": "B"}, 10),
        ("0,10,A 10,20,B 20,30,B 30,50,C", {"base": "B"}, 30),
        ("20,30,B 30,50,C 0,10,A 10,20,B", {"base": "B"}, 30),  # rows out of order
        ("0,10,A 10,50,B", {"base": "B"}, None),  # open at the end
        ("0,10,B 10,50,A", {"top": "B"}, None),  # starts at the collar
        ("0,10,A 10,20,B 20,30,A 30,40,B 40,50,C", {"base": "B"}, 40),
        ("0,10,A 10,20,B 20,30,A 30,40,B 40,50,C", {"top": "B"}, 10),
        ("0,10,A 10,20,B 20,30,A 30,50,B", {"base": "B"}, None),  # its lowest base is not reached
        ("0,10,A 10,20,B 25,50,C", {"base": "B"}, 20),  # a gap below
        ("0,10,A 10,20,B", {"base": "B"}, 20),  # the log ends before the hole
        ("0,10,A 8,20,B 20,50,C", {"top": "B"}, None),  # contradicted by the overlap
        ("0,10,A 8,20,B 20,50,C", {"base": "B"}, 20),
        ("0,10,A 10,20,B 12,18,B 20,50,C", {"base": "B"}, 20),  # B inside B
        ("0,10,A 10,20,B 20,55,C", {"base": "B"}, 20),
    ],
)
def test_contact_of_a_log(log, rows, limit, depth):
    contacts = take_contacts(log(rows), **limit)
    expected = [] if depth is None else [100 - depth]
    np.testing.assert_allclose(contacts.points.xyz[:, 2], expected)
    assert all(issue.value in ("A", "B", "C") for issue in contacts.issues)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,10,A 10,20,B 20,30,A 30,40,B 40,50,C", "occurs 2 times; the lowest base at 40 m"),
        ("0,10,A 10,20,B 25,50,C", "nothing is logged for 5.00 m below"),
        ("0,10,A 10,20,B", "nothing is logged for 30.00 m below"),
    ],
)
def test_doubtful_contact_is_warned_of(log, rows, words):
    contacts = take_contacts(log(rows), base="B")
    assert any(words in str(issue.reason) and issue.severity == "warning" for issue in contacts.issues)


def test_unknown_code_names_the_known_ones(log):
    with pytest.raises(InputError, match=r"'b'.*A, B"):
        take_contacts(log("0,10,A 10,50,B"), base="b")


def survey(write, rows, dip=None):
    collar = write("hole,x,y,z,depth\nB1,0,0,0,100\nB2,9,9,0,100\n", "collar.csv")
    return read_boreholes(collar, write("hole,depth,azimuth,dip\n" + rows, "survey.csv"), dip=dip)


@pytest.mark.parametrize(
    ("rows", "dip", "end"),
    [
        ("B1,0,0,-60\n", None, -100 * np.sin(np.radians(60))),
        ("B1,0,0,60\n", None, -100 * np.sin(np.radians(60))),
        ("B1,0,0,-60\n", "down-positive", 100 * np.sin(np.radians(60))),
        ("B1,0,0,60\n", "down-negative", 100 * np.sin(np.radians(60))),
        ("B1,0,0,60\nB2,0,0,-80\nB2,50,0,-80\n", None, 100 * np.sin(np.radians(60))),
    ],
)
def test_dip_sign(write, rows, dip, end):
    holes = survey(write, rows, dip)
    assert holes.holes[0].xyz[-1, 2] == pytest.approx(end)
    assert any("by majority" in str(issue.reason) for issue in holes.issues) is (dip is None)


def test_dip_sign_that_is_not_clear_is_an_error(write):
    with pytest.raises(InputError, match='State dip = "down-positive"'):
        survey(write, "B1,0,0,60\nB2,0,0,-60\n")


def test_hole_without_survey_is_vertical_and_vertical_needs_no_azimuth(write):
    holes = survey(write, "B1,0,,-90\nB1,50,0,-89\n")
    np.testing.assert_allclose(holes.holes[1].xyz[-1], [9, 9, -100])
    assert any("B2 has no survey" in str(issue.reason) for issue in holes.issues)
    assert holes.counts[1].used == 2


def test_first_station_below_the_collar(write):
    holes = survey(write, "B1,40,90,45\nB1,80,90,45\n")
    np.testing.assert_allclose(holes.paths["B1"].at(40), [[40 * np.sqrt(0.5), 0, -40 * np.sqrt(0.5)]], atol=1e-12)
    assert any("no station at depth 0" in str(issue.reason) for issue in holes.issues)


def test_attitude_in_the_collar_table(write):
    collar = write("hole,x,y,z,depth,azimuth,dip\nB1,0,0,0,10,90,30\n", "collar.csv")
    holes = read_boreholes(collar, dip="down-positive")
    np.testing.assert_allclose(holes.holes[0].xyz[-1], [10 * np.sqrt(0.75), 0, -5], atol=1e-12)


COLLARS = "hole,x,y,z,depth\nA,0,0,100,50\nB,50,0,103,50\n"


def test_limits_as_elevations(write):
    collar = write(COLLARS, "collar.csv")
    survey = write("hole,depth,azimuth,dip\nB,0,90,30\n", "survey.csv")
    log = "hole,from,to,code\nA,100,88,Q\nA,88,50,T\nB,103,98,Q\nB,98,78,T\nB,98,120,T\n"
    holes = read_boreholes(collar, survey, [write(log, "log.csv")])
    assert any("taken as elevations" in str(issue.reason) for issue in holes.issues if issue.severity == "warning")
    np.testing.assert_allclose(holes.logs[0].base, [12, 50, 10, 50], atol=1e-6)
    assert (holes.counts[2].read, holes.counts[2].used) == (5, 4)
    stated = read_boreholes(collar, survey, [Source(path=write(log, "log.csv"), measure="depth")])
    assert stated.counts[2].used == 0
    named = "hole,top elevation,base elevation,code\nA,100,88,Q\n"
    assert read_boreholes(collar, None, [write(named, "n.csv")]).logs[0].base.tolist() == [12]


def test_declination_turns_the_azimuths(write):
    collar, survey = write(COLLARS, "collar.csv"), write("hole,depth,azimuth,dip\nB,0,80,60\n", "survey.csv")
    grid = read_boreholes(collar, survey, dip="down-positive")
    assert any("relative to grid north" in str(issue.reason) for issue in grid.issues if issue.severity == "note")
    magnetic = read_boreholes(collar, survey, dip="down-positive", declination=10.0)
    np.testing.assert_allclose(magnetic.holes[1].xyz[-1], [75, 0, 103 - 50 * np.sin(np.pi / 3)], atol=1e-9)


@pytest.mark.parametrize("header", ["Azimuth (mag)", "Mag. Azimuth", "AZI MAG", "磁方位角"])
@pytest.mark.parametrize("inclined", [True, False])
def test_magnetic_azimuths_without_a_declination_are_warned_of(write, header, inclined):
    dip = 60 if inclined else 90
    survey = write(f"hole,depth,{header},dip\nB,0,80,{dip}\n", "survey.csv")
    collar = write(COLLARS, "collar.csv")
    for declination, warned in ((None, inclined), (0.0, False), (-3.0, False)):
        found = read_boreholes(collar, survey, dip="down-positive", declination=declination)
        warnings = [issue.column for issue in found.issues if issue.reason.code == "io.azimuths-magnetic"]
        assert warnings == [header] * warned
    both = write(f"hole,depth,{header},grid azimuth,dip\nB,0,80,90,60\n", "both.csv")
    np.testing.assert_allclose(read_boreholes(collar, both, dip="down-positive").holes[1].xyz[-1][0], 75.0)


@pytest.mark.parametrize(("mark", "full"), [("gon", 400.0), ("rad", 2 * np.pi)])
def test_angles_in_other_units_are_converted(write, mark, full):
    collar = write(COLLARS, "collar.csv")
    rows = [("A", 0.3, 0.2), ("B", 0.99, 0.15)]
    degrees = "hole,depth,azimuth,dip\n" + "".join(f"{h},0,{a * 360},{d * 360}\n" for h, a, d in rows)
    other = f"hole,depth,azimuth [{mark}],dip ({mark})\n"
    other += "".join(f"{h},0,{a * full:.12g},{d * full:.12g}\n" for h, a, d in rows)
    one, two = (
        read_boreholes(collar, write(text, f"{k}.csv"), dip="down-positive") for k, text in enumerate((degrees, other))
    )
    for a, b in zip(one.holes, two.holes, strict=True):
        np.testing.assert_allclose(a.xyz, b.xyz, atol=1e-8)
    assert [issue.reason.code for issue in two.issues].count("io.angles-converted") == 2


def test_azimuths_that_may_be_gon_are_warned_of(write):
    collar = write(COLLARS, "collar.csv")
    text = "hole,depth,azimuth,dip\nA,0,390,60\nA,5,399,60\nB,0,{last},60\n"
    for last, count in ((120, 1), (512, 0)):
        found = read_boreholes(collar, write(text.format(last=last), "survey.csv"), dip="down-positive")
        assert [issue.reason.code for issue in found.issues].count("io.azimuths-like-gon") == count


def test_tangential_is_asked_for(write):
    collar = write(COLLARS, "collar.csv")
    survey = write("hole,depth,azimuth,dip\nA,0,0,90\nA,20,90,60\n", "survey.csv")
    holes = read_boreholes(collar, survey, dip="down-positive", method="tangential")
    np.testing.assert_allclose(holes.holes[0].xyz[-1], [15, 0, 80 - 30 * np.sin(np.pi / 3)], atol=1e-9)
    curved = read_boreholes(collar, survey, dip="down-positive")
    assert curved.holes[0].xyz[-1, 0] > 15.1


@pytest.mark.parametrize(("unit", "metres"), [("ft", 0.3048), ("ft-us", 1200 / 3937), ("m", 1.0)])
def test_stated_units(write, unit, metres):
    holes = read_boreholes(Source(path=write("hole,x,y,z_ft,depth\nA,10,20,100,50\n"), unit=unit))
    np.testing.assert_allclose(holes.holes[0].xyz[-1], np.array([10, 20, 50]) * metres, atol=1e-9)


def test_intervals_of_a_refused_collar_point_to_its_row(write):
    collar = write("hole,x,y,z,depth\nZK1,0,0,100,50\nZK10,50,0,1o3,50\n", "collar.csv")
    log = write("hole,from,to,code\nZK1,0,10,Q\nZK10,0,12,Q\nZK11,0,9,Q\n", "log.csv")
    found = read_boreholes(collar, None, [log])
    remedies = {issue.value: issue.remedy for issue in found.issues if issue.file == "log.csv"}
    assert remedies["ZK10"].code == "io.referred-row-not-used"
    assert "collar.csv, row 3" in str(remedies["ZK10"])
    assert remedies["ZK11"].code == "io.did-you-mean"


def test_holes_match_whatever_their_case(write):
    collar = write("hole,x,y,z,depth\nBH-1,0,0,100,50\nBH-2,90,0,100,50\nbh-2,0,90,100,50\n", "collar.csv")
    survey = write("hole,depth,azimuth,dip\nBh-1,0,90,60\n", "survey.csv")
    log = write("hole,from,to,code\nbh-1,0,10,A\nbh-1,10,50,B\nBH-2,0,9,A\nbh-2,0,8,A\nBh-2,0,7,A\n", "log.csv")
    holes = read_boreholes(collar, survey, [log], "down-positive")
    assert holes.logs[0].hole.tolist() == ["BH-1", "BH-1", "BH-2", "bh-2"]
    assert holes.paths["BH-1"].at(np.array([50.0]))[0, 0] == pytest.approx(25)
    merged = [issue for issue in holes.issues if issue.reason.code == "io.names-matched-by-case"]
    assert [issue.file for issue in merged] == ["survey.csv", "log.csv"]
    # Two holes could be meant.
    assert [issue.row for issue in holes.issues if issue.reason.code == "io.name-unknown"] == [6]


def test_collars_that_are_all_at_zero_are_warned_of(write):
    collars = "hole,x,y,z,depth\nB1,0,0,{0},50\nB2,90,0,{1},50\n"
    for heights, count in (((0, 0), 1), ((0, 3), 0)):
        holes = read_boreholes(write(collars.format(*heights), "collar.csv"), None, [])
        assert sum(issue.reason.code == "io.collars-all-at-zero" for issue in holes.issues) == count


def test_a_hole_whose_stations_are_refused_is_not_one_without_a_survey(write):
    collar = write("hole,x,y,z,depth\nB1,0,0,100,50\nB2,90,0,100,50\n", "collar.csv")
    survey = write("hole,depth,azimuth,dip\nB1,0,N45E,-60\nB1,25,N45E,-60\n", "survey.csv")
    found = [issue for issue in read_boreholes(collar, survey, []).issues if issue.severity == "warning"]
    assert {issue.value: issue.reason.code for issue in found} == {
        "B1": "io.hole-of-refused-stations",
        "B2": "io.hole-taken-as-vertical",
    }


def test_dashes_that_a_word_processor_made_of_minus_signs(write):
    collar = write("hole,x,y,z,depth\nB1,0,0,100,50\n", "collar.csv")
    survey = write("hole,depth,azimuth,dip\nB1,0,90,\u201360\n", "survey.csv")
    holes = read_boreholes(collar, survey, [], dip="down-negative")
    np.testing.assert_allclose(holes.paths["B1"].at(20.0)[0], [10, 0, 100 - 20 * np.sqrt(0.75)], atol=1e-9)


def test_names_in_letters_that_look_alike_are_one_hole_with_a_warning(write):
    collar = write("hole,x,y,z,depth\nBH1,0,0,100,50\n", "collar.csv")
    table = write("hole,from,to,code\n\u0412\u041d1,0,10,A\n\u0412\u041d1,10,50,B\n", "log.csv")
    holes = read_boreholes(collar, None, [table])
    assert take_contacts(holes, base="A").points.xyz[:, 2].tolist() == [90]
    assert [issue.reason.code for issue in holes.issues if issue.severity != "note"] == ["io.names-matched-by-marks"]
