"""Compass files: a real cave with every line accounted for, and one rule of the format a test."""

from __future__ import annotations

import re

import numpy as np
import pytest

from geofit.caves.adjust import adjust_survey
from geofit.caves.body import centreline_body
from geofit.data.errors import InputError
from geofit.io.compass import read_compass
from geofit.io.journal import Journal

HEAD = "CAVE\nSURVEY NAME: A\nSURVEY DATE: 7 10 79  COMMENT:x\nSURVEY TEAM:\nSOMEBODY\n"
TITLES = "\nFROM TO LENGTH BEARING INC LEFT UP DOWN RIGHT FLAGS COMMENTS\n\n"


def survey(tmp_path, rows, declination="0.00", form="DDDDUDLRLADN", more="CORRECTIONS: 0.00 0.00 0.00", journal=None):
    path = tmp_path / "cave.dat"
    head = f"{HEAD}DECLINATION: {declination}  FORMAT: {form}  {more}\n{TITLES}"
    path.write_bytes((head + "\n".join(rows) + "\n\f\n\x1a").replace("\n", "\r\n").encode("cp1252"))
    return read_compass(path, journal)


def test_fulford_is_read_in_full(fulford):
    """Against a count that knows nothing of the reader: every line whose third cell is a number."""
    lines = [line.split() for line in fulford.read_text(encoding="latin-1").splitlines()]
    shots = [c for c in lines if len(c) >= 9 and re.fullmatch(r"-?\d+\.\d+", c[2]) and re.fullmatch(r"-?[\d.]+", c[8])]
    found = read_compass(fulford)
    (count,) = found.counts
    assert count.read == count.used == len(shots) == 262
    assert count.listed == 0
    assert set(found.stations) == {name for c in shots for name in c[:2]}
    assert len(found.stations) == 247
    apart = [c for c in shots if c[0] != c[1]]
    assert len(found.start) == len(apart) == 260
    assert found.length / 0.3048 == pytest.approx(sum(float(c[2]) for c in shots), rel=1e-9)
    assert found.length / 0.3048 == pytest.approx(5324.19, abs=1e-6)
    missing = sum(float(cell) < 0 for c in shots for cell in c[5:9])
    zeros = sum(4 for c in shots if all(float(cell) == 0 for cell in c[5:9]))
    assert np.isnan(found.walls).sum() == missing + zeros


def test_fulford_closes_its_loops(fulford):
    adjusted = adjust_survey(read_compass(fulford))
    assert len(adjusted.loops) == 260 - 247 + 1
    assert len(np.unique(adjusted.survey.part_of())) == 1
    assert max(loop.percent for loop in adjusted.loops) < 6
    # Stations by a walk over the shots alone, without loops: never farther off than the misclosures allow.
    assert np.abs(adjusted.residual).max() < max(loop.distance for loop in adjusted.loops)


def test_fulford_gets_a_body(fulford):
    body = centreline_body(read_compass(fulford))
    assert body.length == pytest.approx(5324.19 * 0.3048, rel=0.03)
    volumes = [body.volume(h) for h in (0.8, 0.4)]
    assert volumes[0] == pytest.approx(volumes[1], rel=0.02)
    assert 0.8 < volumes[1] / body.sweeps.volumes.sum() < 1.1
    names = {f.station for f in body.sections.filled}
    assert "A5" in names


def test_declination_and_corrections_are_added(tmp_path):
    found = survey(
        tmp_path, ["A B 10.0 80.0 5.0 1 2 3 4"], "8.00", more="CORRECTIONS: 2.00 -5.00 0.50", form="DDDDUDLRLADN"
    )
    np.testing.assert_allclose(found.offset, [[10.5 * 0.3048, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(found.walls, np.array([[1, 4, 2, 3]]) * 0.3048)


def test_negative_walls_are_missing_and_four_zeros_too(tmp_path):
    found = survey(tmp_path, ["A B 1 0 0 -9.90 0 2 -9999.00", "B C 1 0 0 0 0 0 0"])
    assert np.isnan(found.walls).tolist() == [[True, True, False, False], [True] * 4]
    assert "io.walls-not-measured" in {issue.reason.code for issue in found.issues}


def test_flags(tmp_path):
    rows = ["A B 1 0 0 1 1 1 1 #|L# twice", "B C 1 0 0 1 1 1 1 #|X#", "B D 1 0 0 1 1 1 1 #|PC#", "B E 1 0 0 1 1 1 1"]
    found = survey(tmp_path, rows)
    assert found.stations == ("A", "B", "D", "E")
    assert found.counted.tolist() == [False, True, True]
    assert found.passage.tolist() == [True, False, True]
    assert found.rigid.tolist() == [False, True, False]
    assert [issue.reason.code for issue in found.issues] == ["io.shot-excluded"]
    assert found.counts[0].listed == 1


def test_walls_of_the_second_station(tmp_path):
    found = survey(tmp_path, ["A B 1 0 0 1 1 1 1"], form="DDDDUDLRLADNT")
    assert found.stations[found.wall_station[0]] == "B"
    assert survey(tmp_path, ["A B 1 0 0 1 1 1 1"], form="DDDDUDLRLADadNF").wall_station[0] == 0


def test_backsights_are_averaged_and_disagreement_is_listed(tmp_path):
    rows = ["A B 10 359 10 1 1 1 1 181 -12", "B C 10 90 0 1 1 1 1 300 0", "C D 10 -999 0 1 1 1 1 10 0"]
    found = survey(tmp_path, rows, form="DDDDUDLRLADBF")
    bearing = np.degrees(np.arctan2(found.offset[:, 0], found.offset[:, 1]))
    np.testing.assert_allclose(bearing, [0, 105, -170], atol=1e-9)
    assert np.degrees(np.arcsin(found.offset[0, 2] / 3.048)) == pytest.approx(11)
    assert [issue.row for issue in found.issues] == [11]


@pytest.mark.parametrize(
    "row",
    [
        "A B 1e300 0 0 1 1 1 1",
        "A B ten 0 0 1 1 1 1",
        "A B 10 0 0 1 1",
        "A B -5 0 0 1 1 1 1",
        "A B 5 0 95 1 1 1 1",
        "A A 5 0 0 1 1 1 1",
    ],
)
def test_a_line_that_is_no_shot_is_listed(tmp_path, row):
    found = survey(tmp_path, ["P Q 1 0 0 1 1 1 1", row])
    assert found.counts[0].listed == 1
    (issue,) = found.issues
    assert issue.severity == "error"
    assert issue.row == 11


def test_a_bearing_that_no_compass_shows_is_used_with_a_warning(tmp_path):
    found = survey(tmp_path, ["A B 10 400 0 1 1 1 1", "B C 10 360 0 1 1 1 1"])
    (issue,) = found.issues
    assert (issue.severity, issue.row, issue.reason.code) == ("warning", 10, "io.bearing-out-of-range")
    assert found.counts[0].used == 2


def test_a_shot_of_no_length_carries_the_last_walls(tmp_path):
    found = survey(tmp_path, ["A B 10 90 0 1 1 1 1", "B B 0 0 0 2 3 4 5"])
    assert len(found.start) == 1
    assert found.wall_shot.tolist() == [0, 0]
    assert found.stations[found.wall_station[1]] == "B"


def test_another_file_is_refused(tmp_path):
    path = tmp_path / "x.dat"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="not a Compass survey"):
        read_compass(path)


def test_the_journal_gets_the_file_and_its_hash(tmp_path):
    journal = Journal()
    survey(tmp_path, ["A B 1 0 0 1 1 1 1"], journal=journal)
    assert set(journal.inputs) == {"cave.dat"}


@pytest.mark.parametrize(
    ("declination", "more", "words", "what"),
    [
        ("8,50", "CORRECTIONS: 0 0 0", "DECLINATION", "directions"),
        ("east", "CORRECTIONS: 0 0 0", "DECLINATION", "directions"),
        ("8.5", "CORRECTIONS: 2,00 0 0,5", "CORRECTIONS", "lengths and directions"),
        ("", "CORRECTIONS: x", "DECLINATION, CORRECTIONS", "lengths and directions"),
    ],
)
def test_shots_without_a_correction_that_cannot_be_read_are_counted(tmp_path, declination, more, words, what):
    """A declination of 8,50 had been read as 8, one of other text as 0, without a word."""
    found = survey(tmp_path, ["A B 10.0 80.0 5.0 1 2 3 4", "B C 10.0 80.0 5.0 1 2 3 4"], declination, more=more)
    (warning,) = [issue for issue in found.issues if issue.reason.code == "io.shots-uncorrected"]
    assert (warning.severity, warning.row) == ("warning", 6)
    params = warning.reason.params
    assert (params["count"], params["word"], str(params["what"])) == (2, words, what)


def test_a_survey_without_its_header_does_not_take_that_of_another(tmp_path):
    path = tmp_path / "two.dat"
    shot = "{} {} 10.0 90.0 0.0 1 1 1 1\n"
    second = f"\f\n{HEAD}{TITLES}{shot.format('B', 'C')}"
    path.write_text(f"{HEAD}DECLINATION: 90.00  FORMAT: DDDDUDLRLADN\n{TITLES}{shot.format('A', 'B')}{second}")
    found = read_compass(path)
    np.testing.assert_allclose(found.offset[1] / 0.3048, [10, 0, 0], atol=1e-9)
    (warning,) = [issue for issue in found.issues if issue.reason.code == "io.shots-uncorrected"]
    assert warning.reason.params["count"] == 1


def test_numbers_of_the_header_may_end_in_a_point_or_stand_before_a_word(tmp_path):
    found = survey(tmp_path, ["A B 10.0 80.0 5.0 1 2 3 4"], "8.", more="CORRECTIONS: 2. -5. .5 DISCOVERY: 1 2 79")
    np.testing.assert_allclose(found.offset, [[10.5 * 0.3048, 0, 0]], atol=1e-12)
    assert not found.issues
