"""Splays: shots to walls give the sections of stations that have no measured ones."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.caves.adjust import adjust_survey
from geofit.caves.body import centreline_body
from geofit.caves.sections import sections
from geofit.caves.splays import walls_of_splays
from geofit.io.compass import read_compass
from geofit.io.survex import read_survex

AXES = np.array([2.0, 3.0, 1.5, 0.8])


def on_ellipse(turn, axes=AXES):
    """A point (side, height) of four quarter ellipses, to the right at 0, up at 90 degrees."""
    c, s = np.cos(turn), np.sin(turn)
    return (axes[1] if c >= 0 else axes[0]) * c, (axes[2] if s >= 0 else axes[3]) * s


def frame(azimuth, inclination):
    """Direction of a passage, its right, degrees."""
    a, i = np.radians([azimuth, inclination])
    return np.array([np.sin(a) * np.cos(i), np.cos(a) * np.cos(i), np.sin(i)]), np.array([np.cos(a), -np.sin(a), 0.0])


@pytest.mark.parametrize("azimuth", [0.0, 70.0, 250.0])
@pytest.mark.parametrize("inclination", [0.0, -35.0, 50.0])
@pytest.mark.parametrize("turns", [np.radians([180, 0, 90, 270]), np.radians(np.arange(7, 360, 31))])
def test_walls_of_a_prismatic_passage_come_back(azimuth, inclination, turns):
    """Splays that slant along the passage too: heights are vertical, as those that are measured are."""
    along, right = frame(azimuth, inclination)
    rng = np.random.default_rng(3)
    splays = []
    for turn in turns:
        side, height = on_ellipse(turn)
        slant = rng.uniform(-0.4, 0.4) * np.hypot(side, height)
        splays.append((0, 2, slant * along + side * right + height * np.array([0, 0, 1.0])))
    ((station, shot, walls),), used = walls_of_splays([(5, 0, 1, 10 * along)], splays)
    assert (station, shot, used) == (0, 5, len(turns))
    np.testing.assert_allclose(walls, AXES, rtol=1e-3)


def test_a_wall_that_no_splay_points_to_is_missing():
    """Interpolated along the passage and listed, as any wall that was not measured."""
    (found,), _ = walls_of_splays([(0, 0, 1, np.array([0, 9.0, 0]))], [(0, 2, np.array([2.0, 0, 0]))])
    np.testing.assert_allclose(found[2], [np.nan, 2, np.nan, np.nan], rtol=1e-3)


def test_splays_along_the_passage_give_no_wall():
    found, used = walls_of_splays([(0, 0, 1, np.array([0, 9.0, 0]))], [(0, 2, np.array([1.0, 8, 0]))])
    assert (found, used) == ([], 0)


def test_a_bend_has_its_section_half_way_round():
    """Left and right bisect the bend; seen along the first shot or the second they are the same walls."""
    passages = [(0, 0, 1, np.array([0, 10.0, 0])), (1, 1, 2, np.array([10.0, 0, 0]))]
    across = np.array([1.0, -1.0, 0]) / np.sqrt(2)
    splays = [(1, 3, 2 * across), (1, 4, -4 * across), (1, 5, np.array([0, 0, 1.0])), (6, 1, np.array([0, 0, 0.5]))]
    ((station, _, walls),), used = walls_of_splays(passages, splays)
    assert (station, used) == (1, 4)
    # The last one was measured from the wall.
    np.testing.assert_allclose(walls, [4, 2, 1, 0.5], rtol=1e-3)


def test_a_shaft_has_the_area_of_its_section():
    splays = [(0, k, np.array([np.cos(t), 2 * np.sin(t), 0.1])) for k, t in enumerate(np.arange(0.2, 6.4, 0.5), 2)]
    ((_, _, walls),), _ = walls_of_splays([(0, 0, 1, np.array([0.1, 0, -20.0]))], splays)
    np.testing.assert_allclose(walls[:2], np.sqrt(2), rtol=0.02)


def svx(tmp_path, text):
    path = tmp_path / "cave.svx"
    path.write_text(text, encoding="utf-8")
    return read_survex(path)


@pytest.mark.parametrize("mark", ["-", "..", "."])
def test_splays_of_a_survex_file_form_the_body(tmp_path, mark):
    """They were read and gave no walls, without a word: the body had a radius that was given, or no size at all."""
    lines = ["*declination 0 degrees", "1 2 20 0 0", "2 3 20 0 0"]
    for station in "123":
        for k in range(24):
            side, height = on_ellipse(np.radians(15 * k))
            distance, climb = np.hypot(side, height), np.degrees(np.arctan2(height, abs(side)))
            lines.append(f"{station} {mark} {distance:.4f} {90 if side >= 0 else 270} {climb:.3f}")
    survey = svx(tmp_path, "\n".join(lines))
    body = centreline_body(survey, ends="flat")
    area = np.pi / 4 * (AXES[0] + AXES[1]) * (AXES[2] + AXES[3])
    assert body.volume() == pytest.approx(40 * area, rel=0.01)
    assert not body.sections.filled
    (note,) = [issue for issue in survey.issues if issue.reason.code == "io.walls-of-splays"]
    assert (note.reason.params["count"], note.reason.params["stations"]) == (72, 3)


def test_points_inside_the_passage_are_no_walls(tmp_path):
    """Survex ends a splay to a wall at "..", and one to a point inside the passage at "."."""
    survey = svx(tmp_path, "1 2 9 0 0\n1 .. 3 90 0\n1 . 1 270 0\n")
    np.testing.assert_allclose(survey.walls, [[np.nan, 3, np.nan, np.nan]], rtol=1e-3)


def test_three_separators_name_a_station_of_the_passage(tmp_path):
    survey = svx(tmp_path, "*alias station - ..\n1 2 9 0 0\n2 ... 9 0 0\n")
    assert survey.passage.tolist() == [True, True]
    assert not survey.issues


def test_measured_walls_come_first_and_splays_fill_the_others(tmp_path):
    survey = svx(
        tmp_path, "1 2 9 0 0\n1 - 5 90 0\n1 - 4 270 0\n*data passage station left right up down\n1 1 - 2 2\n2 1 1 1 1\n"
    )
    found = sections(adjust_survey(survey))
    np.testing.assert_allclose(found.walls[0, 0], [1, 5, 2, 2], rtol=1e-3)


def test_unused_splays_are_listed(tmp_path):
    survey = svx(tmp_path, "1 2 9 0 0\n1 - 8 10 0\n")
    (note,) = [issue for issue in survey.issues if issue.reason.code == "io.splays-unused"]
    assert note.reason.params["count"] == 1


DAT = """Cave
SURVEY NAME: A
SURVEY DATE: 6 29 1987
SURVEY TEAM:

DECLINATION: 0.00  FORMAT: DDDDUDLRLADN  CORRECTIONS: 0.00 0.00 0.00

        FROM           TO   LENGTH  BEARING      INC     LEFT       UP     DOWN    RIGHT   FLAGS  COMMENTS

{rows}
\x0c
"""


def dat(tmp_path, rows):
    path = tmp_path / "cave.dat"
    path.write_text(DAT.format(rows="\n".join(rows)), encoding="cp1252")
    return read_compass(path)


def test_splays_of_a_compass_file(tmp_path):
    """Flag S; flag P only keeps a shot from being plotted."""
    missing = "-9999 -9999 -9999 -9999"
    rows = [f"A1 A2 100 0 0 {missing}", *(f"A1 s{k} {5 + k} {90 + 180 * k} 0 {missing} #|S#" for k in range(2)),
            f"A2 p 50 90 0 {missing} #|P#"]  # fmt: skip
    survey = dat(tmp_path, rows)
    walls = survey.walls[np.isfinite(survey.walls).any(axis=1)]
    np.testing.assert_allclose(walls / 0.3048, [[6, 5, np.nan, np.nan]], rtol=1e-3)


def test_walls_in_the_line_of_a_splay_keep_left_and_right_of_the_passage(tmp_path):
    """The splay came first: left and right at its station referred to it, and changed sides between two shots."""
    rows = ["A1 A2 100 1 0 2 9 9 6", "A2 s 4 92 0 2 9 9 6 #|S#", "A2 A3 100 3 0 -9999 -9999 -9999 -9999"]
    found = sections(adjust_survey(dat(tmp_path, rows)))
    np.testing.assert_allclose(found.walls[:, :, :2] / 0.3048, [[[2, 6], [2, 6]], [[2, 6], [2, 6]]], rtol=1e-3)
