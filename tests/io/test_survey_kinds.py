"""Which files are surveys of passages, and which are other tables with the same endings."""

from __future__ import annotations

import pytest

from geofit.io.survey_kinds import is_survey

COMPASS = "Fulford Cave\nSURVEY NAME: A\nSURVEY DATE: 6 29 1987\n"


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("cave.svx", "*begin\n", True),
        ("cave.DAT", COMPASS, True),
        ("points.dat", "1 2 3\n4 5 6\n", False),
        ("line.csv", "x,y,z,radius\n0,0,0,1\n1,0,0,1\n", True),
        ("line.csv", "# adit 3\nline;east;north;elev;width;height\nA;0;0;0;2;3\n", True),
        ("line.csv", "Station\tX (m)\tY (m)\tZ (m)\tLeft\tRight\tUp\tDown\na\t0\t0\t0\t1\t1\t1\t1\n", True),
        ("collar.csv", "hole,x,y,z\nB1,0,0,0\n", False),
        ("picks.csv", "x,y,z,width\n0,0,0,1\n", False),
        ("empty.csv", "", False),
        ("site.toml", 'name = "a"\n', False),
    ],
)
def test_a_survey_is_known_by_its_ending_and_first_lines(tmp_path, name, text, found):
    path = tmp_path / name
    path.write_text(text)
    assert is_survey(path) == found


def test_what_is_no_text_or_not_there_is_no_survey(tmp_path):
    path = tmp_path / "volume.dat"
    path.write_bytes(bytes(range(256)) * 100)
    assert not is_survey(path)
    assert not is_survey(tmp_path / "missing.csv")


def test_a_long_header_and_a_cut_letter_do_no_harm(tmp_path):
    path = tmp_path / "long.csv"
    path.write_text("x,y,z,半径\n" + "0,0,0,1\n" * 5000, encoding="utf-8")
    assert is_survey(path)
    path.write_text("x,y,z,半径\n" + "洞" * 20000, encoding="utf-8")
    assert is_survey(path)
