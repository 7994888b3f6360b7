"""Survex files: one rule of the format a test; what is not read is listed."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.caves.adjust import adjust_survey
from geofit.caves.survey import SurveyError
from geofit.data.errors import InputError
from geofit.io.survex import read_survex


@pytest.fixture
def svx(tmp_path):
    def read(text, name="cave.svx"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return read_survex(path)

    return read


def angles(offset):
    return np.degrees(np.arctan2(offset[:, 0], offset[:, 1])) % 360, np.degrees(
        np.arcsin(offset[:, 2] / np.linalg.norm(offset, axis=1))
    )


def test_names_are_lower_case_with_their_surveys_and_settings_end_with_the_block(svx):
    found = svx("*begin Cave\n*begin Up\n*calibrate tape 1\nA B 11 0 0\n*end Up\nA B 10 0 0\n*end Cave\n")
    assert found.stations == ("cave.up.a", "cave.up.b", "cave.a", "cave.b")
    np.testing.assert_allclose(found.offset[:, 1], [10, 10])
    assert svx("*case preserve\nA a 1 0 0\n").stations == ("A", "a")


def test_order_units_and_comments(svx):
    found = svx(
        "*units tape feet\n*units compass grads\n*units clino percent\n"
        "*data normal from to compass clino tape ignoreall\n"
        "1 2 100 100 10 a remark ; comment\n"
    )
    bearing, inclination = angles(found.offset)
    assert (bearing[0], inclination[0]) == pytest.approx((90, 45))
    assert np.linalg.norm(found.offset) == pytest.approx(3.048)


@pytest.mark.parametrize(
    ("line", "length"),
    [
        ("*calibrate tape +0.3", 9.7),
        ("*calibrate tape 0.3 0.9", 9.7 * 0.9),
        ("*calibrate tape 1 feet", 10 - 0.3048),
        ("*calibrate length 1 feet 0.9", 9 - 0.3048),
        ("*units tape 2 metres", 20.0),
    ],
)
def test_calibrations(svx, line, length):
    """Value = (reading - zero error) scale; a zero error with a unit is not scaled."""
    assert np.linalg.norm(svx(f"{line}\n1 2 10 0 0\n").offset) == pytest.approx(length)


def test_declination_in_both_spellings(svx):
    assert angles(svx("*declination 4 degrees\n1 2 10 86 0\n").offset)[0][0] == pytest.approx(90)
    assert angles(svx("*calibrate declination -4\n1 2 10 86 0\n").offset)[0][0] == pytest.approx(90)


def test_plumbs_equates_and_fixes(svx):
    found = svx(
        "1 2 5 - UP\n2 3 5 - -V\n*infer plumbs on\n*calibrate clino 3\n3 4 5 0 -90\n*infer equates on\n4 5 0 0 0\n"
        "*equate 5 6 7\n7 8 5 90 3\n*fix 1 100 200 300\n*fix nowhere 0 0 0\n*declination 0 degrees\n"
    )
    np.testing.assert_allclose(found.offset, [[0, 0, 5], [0, 0, -5], [0, 0, -5], [5, 0, 0]], atol=1e-12)
    assert found.stations == ("1", "2", "3", "4", "8")
    adjusted = adjust_survey(found)
    np.testing.assert_allclose(adjusted.xyz[-1], [105, 200, 295])
    assert [issue.value for issue in found.issues] == ["nowhere"]


def test_backsights_and_omitted_readings(svx):
    found = svx(
        "*data normal from to tape compass backcompass clino backclino\n1 2 10 359 181 10 -12\n2 3 10 - 270 - -\n"
    )
    bearing, inclination = angles(found.offset)
    np.testing.assert_allclose(np.sin(np.radians(bearing)), [0, 1], atol=1e-9)
    np.testing.assert_allclose(inclination, [11, 0], atol=1e-9)


def test_flags_and_splays(svx):
    found = svx(
        "*flags duplicate surface\n1 2 1 0 0\n*flags not surface\n2 3 1 0 0\n"
        "*flags not duplicate\n3 . 1 0 0\n3 4 1 0 0\n"
    )
    assert found.passage.tolist() == [False, True, False, True]
    assert found.counted.tolist() == [False, False, False, True]


def test_passage_data_follow_the_tube(svx):
    found = svx(
        "1 2 10 90 0\n3 2 10 270 0\n2 4 5 0 0\n*data passage station left right up down ignoreall\n"
        "1 1 2 3 4 first\n2 1 2 3 -\n3 1 2 3 4\n*data\n2 5 6 7 8\n4 5 6 7 8\n"
    )
    # The shot from 3 to 2 is against the tube: left and right change places.
    assert found.wall_shot.tolist() == [0, 1, 1, 2, 2]
    np.testing.assert_allclose(found.walls[:3, :2], [[1, 2], [2, 1], [2, 1]])
    assert np.isnan(found.walls[1, 3])


def test_what_is_not_read_is_listed(svx):
    found = svx(
        "*title x\n*team y\n*team z\n1 2 10 0 0\n*cartesian grid\n*data diving from to tape compass fromdepth todepth\n"
        "2 3 1 0 0 0\n*data ignore\n4 5 6 7 8\n*data default\n2 3 oops 0 0\n*calibrate moon 3\n"
    )
    listed = [(issue.severity, issue.row) for issue in found.issues]
    assert ("warning", 5) in listed
    assert {row for severity, row in listed if severity == "error"} == {6, 7, 11, 12}
    assert ("note", 9) in listed
    (remarks,) = [issue.reason for issue in found.issues if issue.reason.code == "io.commands-ignored"]
    assert str(remarks.params["names"]) == "*team (2), *title (1)"
    (count,) = found.counts
    assert (count.read, count.used, count.listed) == (4, 1, 3)


@pytest.mark.parametrize(
    ("line", "readings"),
    [
        ("*units tape furlongs", "tape"),
        ("*units length furlongs", "tape"),
        ("*units tape degrees", "tape"),
        ("*units tape 0 feet", "tape"),
        ("*units tape 2 3 feet", "tape"),
        ("*units compass feet", "compass"),
        ("*units compass percent", "compass"),
        ("*units tpae feet", "tape"),
        ("*units feet", "tape"),
        ("*units", "tape"),
    ],
)
def test_readings_in_an_unknown_unit_are_not_used(svx, line, readings):
    """A tape in furlongs must not count as metres."""
    found = svx(f"1 2 10 90 0\n{line}\n2 3 10 90 0\n*units tape metres\n*units compass degrees\n")
    command, shot = found.issues
    assert (command.severity, command.row, command.reason.code) == ("error", 2, "io.command-unreadable")
    assert (shot.severity, shot.row, shot.reason.code) == ("error", 3, "io.reading-unit-unknown")
    assert shot.reason.params["reading"] == readings
    assert found.stations == ("1", "2")


def test_a_unit_counts_again_once_it_is_known_or_its_block_ends(svx):
    found = svx(
        "*units tape furlongs\n*units tape feet\n1 2 10 90 0\n*begin\n*units tape furlongs\n2 3 10 90 0\n*end\n"
        "2 4 10 90 0\n"
    )
    assert found.stations == ("1", "2", "4")
    np.testing.assert_allclose(found.offset[:, 0], [3.048, 3.048])


def test_units_of_walls_and_of_other_data(svx):
    found = svx(
        "*units dx dy dz feet\n*units left right furlongs\n1 2 10 90 0\n"
        "*data passage station left right up down\n1 1 1 1 1\n2 - - 1 1\n"
    )
    assert [(issue.row, issue.reason.code) for issue in found.issues] == [
        (2, "io.command-unreadable"), (5, "io.reading-unit-unknown")
    ]  # fmt: skip
    np.testing.assert_allclose(found.walls, [[np.nan, np.nan, 1, 1]])


def test_included_files_keep_the_settings(svx, tmp_path):
    (tmp_path / "part.svx").write_text("2 3 10 90 0\n")
    found = svx("*calibrate tape 1\n1 2 10 90 0\n*include part\n")
    np.testing.assert_allclose(found.offset[:, 0], [9, 9])
    with pytest.raises(InputError, match="cannot be read"):
        svx("*include nothing\n")


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("1 2 10 inf 0", "io.line-out-of-order"),
        ("1 2 nan 0 0", "io.line-out-of-order"),
        ("1 2 1e308 90 0", "caves.shot-too-long"),
        ("1 2 1000000 90 0", "caves.shot-too-long"),
        ("1 2 10 90 95", "io.shot-without-readings"),
        ("1 2 - 90 0", "io.shot-without-readings"),
        ("1 1 5 90 0", "io.shot-joins-itself"),
    ],
)
@pytest.mark.filterwarnings("ignore:Mean of empty slice")
def test_readings_that_make_no_shot_are_listed(svx, line, code):
    found = svx(f"{line}\n2 3 10 0 0\n")
    (issue,) = found.issues
    assert (issue.severity, issue.row, issue.reason.code) == ("error", 1, code)
    assert found.stations == ("2", "3")
    assert (found.counts[0].used, found.counts[0].listed) == (1, 1)


@pytest.mark.parametrize(
    ("lines", "codes"),
    [
        ("1 2 10 400 0", ["io.bearing-out-of-range"]),
        ("1 2 -10 -30 0", ["io.tape-below-zero", "io.bearing-out-of-range"]),
        ("*units compass grads\n1 2 10 400 0", []),
        ("*calibrate compass 5\n1 2 10 2 0", []),
        ("*data normal from to tape compass backcompass clino\n1 2 10 359 179 0\n2 3 10 180 361 0",
         ["io.bearing-out-of-range"]),
        ("*data normal from to tape backtape compass clino\n1 2 - -10 30 0", ["io.tape-below-zero"]),
    ],
)  # fmt: skip
def test_readings_that_no_instrument_shows_are_used_with_a_warning(svx, lines, codes):
    """As Survex does; zero errors and units come before or after the check as they do there."""
    found = svx(f"{lines}\n")
    assert [issue.reason.code for issue in found.issues] == codes
    assert {issue.severity for issue in found.issues} <= {"warning"}
    assert found.counts[0].listed == 0


@pytest.mark.parametrize(
    "command",
    ["*fix 1 nan 0 0", "*declination inf degrees", "*calibrate tape nan", "*units tape inf metres"],
)
def test_settings_are_finite(svx, command):
    issue = svx(f"1 2 1 0 0\n{command}\n2 3 1 0 0\n").issues[0]
    assert (issue.severity, issue.reason.code) == ("error", "io.command-unreadable")


@pytest.mark.parametrize("wall", ["-1", "1e9"])
def test_walls_out_of_range_are_listed(svx, wall):
    found = svx(f"1 2 1 0 0\n*data passage station left right up down\n1 1 {wall} 1 1\n2 1 1 1 1\n")
    (issue,) = found.issues
    assert (issue.severity, issue.row, issue.reason.code) == ("error", 3, "caves.wall-out-of-range")
    assert len(found.walls) == 1


def test_a_survey_without_a_shot_says_why_and_lists_its_rows(svx):
    with pytest.raises(SurveyError) as wrong:
        svx("*data nosurvey from to\n1 2\n")
    assert wrong.value.code == "caves.no-shot-because"
    assert [issue.row for issue in wrong.value.issues] == [1, 2]
    with pytest.raises(SurveyError) as empty:
        svx("")
    assert (empty.value.code, empty.value.issues) == ("caves.survey-without-shot", ())


def test_an_end_names_its_own_block(svx):
    with pytest.raises(InputError) as wrong:
        svx("*begin a\n1 2 10 90 0\n*end b\n")
    assert (wrong.value.code, wrong.value.row) == ("io.end-of-other-block", 3)
    with pytest.raises(InputError):
        svx("*begin\n1 2 10 90 0\n*end a\n")
    assert len(svx("*begin A\n1 2 10 90 0\n*end a\n*begin b\n3 4 1 0 0\n*end\n").start) == 2


@pytest.mark.parametrize("text", ["*begin a\n1 2 1 0 0\n", "1 2 1 0 0\n*end\n"])
def test_blocks_must_match(svx, text):
    with pytest.raises(InputError, match="begin"):
        svx(text)


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("1 2 20000 90 0", "The shot is 20 000 m long; at most 10 000 m are allowed"),
        ("1 2 10000.001 90 0", "The shot is 10 001 m long; at most 10 000 m are allowed"),
        ("1 2 1e308 90 0", "The shot is 1e+308 m long; at most 10 000 m are allowed"),
    ],
)
def test_lengths_in_messages_are_metres_in_groups(svx, line, text):
    (issue,) = svx(f"{line}\n2 3 10 0 0\n").issues
    assert str(issue.reason).replace("\N{NO-BREAK SPACE}", " ") == text


@pytest.mark.parametrize(("wall", "text"), [("20000", "20 000 m"), ("-0.5", "−0.5 m"), ("-1e300", "−1e+300 m")])
def test_walls_in_messages_are_metres_in_groups(svx, wall, text):
    (issue,) = svx(f"1 2 10 0 0\n*data passage station left right up down\n1 {wall} 1 1 1\n2 1 1 1 1\n").issues
    assert str(issue.reason).replace("\N{NO-BREAK SPACE}", " ") == f"A wall is {text} away; 0 to 10 000 m are possible"


@pytest.mark.parametrize(
    ("command", "what"),
    [
        ("*declination auto 36 12 800", "directions"),
        ("*declination 10", "directions"),
        ("*declination 4,5 degrees", "directions"),
        ("*calibrate compass x", "directions"),
        ("*calibrate tape", "lengths"),
        ("*calibrate tape compass", "lengths and directions"),
        ("*calibrate moon 3", "lengths and directions"),
    ],
)
def test_shots_without_a_correction_that_cannot_be_read_are_counted(svx, command, what):
    """A cave that is turned by 10 degrees must not pass for one that is not."""
    found = svx(f"1 2 10 86 0\n*begin\n{command}\n2 3 10 0 0\n3 4 10 0 0\n*end\n4 5 10 0 0\n")
    (warning,) = [issue for issue in found.issues if issue.reason.code == "io.shots-uncorrected"]
    assert (warning.severity, warning.row, warning.value) == ("warning", 3, command)
    assert (warning.reason.params["count"], str(warning.reason.params["what"])) == (2, what)
    assert warning.remedy


@pytest.mark.parametrize(
    ("fixed", "stated", "warned"),
    [
        ("500000 4100000 30", "", True),
        ("500000 4100000 30", "*declination 0 degrees", False),
        ("500000 4100000 30", "*calibrate declination -3", False),
        ("0 0 0", "", False),
    ],
)
def test_bearings_of_a_cave_on_the_map_need_a_declination(svx, fixed, stated, warned):
    found = svx(f"{stated}\n*fix 1 {fixed}\n1 2 10 86 0\n2 3 10 - up\n3 4 10 10 3\n")
    counts = [issue.reason.params["count"] for issue in found.issues if issue.reason.code == "io.shots-uncorrected"]
    assert counts == [2] * warned


def test_a_correction_that_is_stated_anew_is_read(svx):
    found = svx("*declination auto 1 2 3\n*declination 4 degrees\n*calibrate moon 3\n*calibrate default\n1 2 10 86 0\n")
    assert not [issue for issue in found.issues if issue.reason.code == "io.shots-uncorrected"]


def test_decimal_commas_are_not_taken_for_other_readings(svx):
    """Survex takes a comma for a blank: 10,5 90,0 0,5 was read as 10 m along 5 degrees, straight up."""
    found = svx("1 2 10 90 0\n2 3 10,5 90,0 0,5\n")
    (issue,) = found.issues
    assert (len(found.start), issue.severity, issue.row) == (1, "error", 2)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_surveys_in_other_encodings(tmp_path, encoding):
    path = tmp_path / "a.svx"
    path.write_bytes("*begin höhle\n1 2 10 90 0\n*end höhle\n".encode(encoding))
    assert read_survex(path).stations == ("höhle.1", "höhle.2")
