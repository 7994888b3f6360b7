from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code
from scipy.signal import find_peaks
from truth import EASTING, NORTHING, fold_at, folded, paper_arrangement

from geofit import PointSet, fit_horizon
from geofit.fitting.fold import backtracking, loft, turning_points
from geofit.fitting.skin import curve_lines
from geofit.geometry.frame import map_frame


def back(points):
    return backtracking(points, map_frame(points))


def hinge_of(points, plane, section):
    """v of the turning points of a section: where x stops growing, and where it starts again."""
    index = np.flatnonzero(points.section == section)
    order = index[np.argsort(plane[index, 1])]
    x = points.xyz[order, 0]
    turn = np.flatnonzero(np.diff(np.sign(np.diff(x)))) + 1
    return plane[order[turn], 1]


def test_a_fold_runs_back_and_a_horizon_does_not():
    assert back(folded()) > 0.1
    assert back(paper_arrangement(0).points) == 0
    assert back(PointSet(np.random.default_rng(0).uniform(0, 9, (30, 3)))) == 0


def test_backtracking_does_not_mind_which_way_a_section_is_drawn():
    assert back(folded(reverse=(1, 2, 5))) == pytest.approx(back(folded()), rel=1e-9)


def test_each_section_is_a_line_of_constant_u_at_its_distance():
    points = folded()
    surface = loft(points)
    assert surface.on_line.all()
    np.testing.assert_allclose(np.diff(surface.u), 60, rtol=0.05)
    for name in np.unique(points.section):
        assert np.ptp(surface.plane[points.section == name, 0]) == 0
    np.testing.assert_allclose(np.unique(surface.plane[:, 0]), surface.u)


def test_v_grows_along_every_section_in_one_sense():
    for reverse in ((), (0,), (1, 4), (0, 1, 2)):
        points = folded(reverse=reverse)
        plane = loft(points).plane
        senses = []
        for name in np.unique(points.section):
            mine = points.section == name
            z, v = points.xyz[mine, 2], plane[mine, 1]
            assert (np.abs(np.diff(v)) > 0).all()
            senses.append(np.sign(np.corrcoef(z, v)[0, 1]))
        assert len(set(senses)) == 1, reverse


def shifted_hinges(lines=6, n=80):
    """A fold whose first limb grows from section to section: equal chord length would join limb to hinge."""
    xyz, names = [], []
    for i in range(lines):
        t = np.linspace(0, 1, n) ** (1 + 0.15 * i)
        line = fold_at(t, np.full(n, 60.0 * i))
        line[:, 0] += 12 * i * np.minimum(t, 0.3)
        xyz.append(line)
        names += [f"S{i}"] * n
    return PointSet(np.concatenate(xyz) + np.array((EASTING, NORTHING, 500)), section=names)


def test_hinges_stand_at_one_v_on_all_sections():
    points = shifted_hinges()
    plane = loft(points).plane
    hinges = [hinge_of(points, plane, name) for name in np.unique(points.section)]
    assert all(len(h) == 2 for h in hinges)
    length = np.ptp(plane[:, 1])
    # Half a step of a section is as near as points tell.
    assert (np.ptp(np.array(hinges), axis=0) / length).max() < 0.03


@pytest.mark.parametrize("n", [40, 41, 80])
def test_the_hinges_of_a_symmetric_fold_are_not_confused(n):
    points = folded(n=n)
    plane = loft(points).plane
    hinges = [hinge_of(points, plane, name) for name in np.unique(points.section)]
    assert (np.ptp(np.array(hinges), axis=0) / np.ptp(plane[:, 1])).max() < 0.03


def test_points_off_the_sections_have_no_place_yet():
    points = folded()
    more = PointSet(points.xyz[:5] + np.array([1.0, 30.0, 2.0]), hole="B1")
    surface = loft(PointSet.concatenate([points, more]))
    assert surface.on_line.tolist() == [True] * len(points) + [False] * 5
    assert surface.notes[0].params["count"] == 5


def test_fewer_than_two_sections_place_nothing():
    assert not loft(folded(lines=1)).on_line.any()
    assert not loft(folded().with_(section="")).on_line.any()


def test_parameters_do_not_repeat_on_irregular_sections():
    points = folded(seed=5, reverse=(2,))
    plane = loft(points).plane
    for name in np.unique(points.section):
        v = plane[points.section == name, 1]
        assert len(np.unique(v)) == len(v)


@pytest.mark.parametrize("seed", range(100))
def test_turning_points_are_the_peaks_and_pits_of_that_prominence(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 300))
    line = np.cumsum(rng.standard_normal(n)) if seed % 2 else np.sin(np.linspace(0, 20, n)) + rng.normal(0, 0.1, n)
    least = rng.uniform(0.01, 0.6) * np.ptp(line)
    turns = [find_peaks(sign * line, prominence=least)[0] for sign in (1, -1)] if n > 2 else [[]]
    assert turning_points(line, least) == sorted(np.concatenate(turns).tolist())


def arch_at(t, y):
    """Places on a cylinder of 100 m radius, 230 degrees of it, that plunges gently; t in 0..1 along a section."""
    angle = np.radians(230 * t - 115)
    return np.column_stack([100 * np.sin(angle), y, 100 * np.cos(angle) + 0.15 * y])


def arch(offsets, n=30, noise=0.0, seed=1):
    rng = np.random.default_rng(seed)
    xyz = []
    for y in offsets:
        t = np.sort(np.concatenate([[0, 1], rng.uniform(0, 1, n - 2)]))
        xyz.append(arch_at(t, np.full(n, float(y))) + rng.normal(0, 1, (n, 3)) * (noise, 0, noise))
    return PointSet(np.concatenate(xyz), section=np.repeat([f"S{k}" for k in range(len(offsets))], n), kind="section")


def error_of(surface, inside=(0.05, 0.95)):
    """Largest distance of the surface from places of the arch between its sections."""
    rng = np.random.default_rng(9)
    return np.abs(surface.distance(arch_at(rng.uniform(*inside, 500), rng.uniform(5, 495, 500)))).max()


@pytest.mark.parametrize("close", [500.5, 490.0, 410.0, 50.03])
def test_a_section_close_to_another_leaves_the_core_of_a_fold_exact(close):
    points = arch(sorted([0, 50, 100, 400, 450, 500, close]))
    surface = fit_horizon(points)
    assert surface.core.all()
    assert np.abs(surface.distance(points.xyz)).max() < 1e-6
    assert error_of(surface) < 0.5


@pytest.mark.parametrize("gap", [0.05, 2.0, 8.0])
def test_noise_of_close_sections_is_not_carried_to_the_next_ones(gap):
    apart, pair = (
        fit_horizon(arch(y, noise=0.05)) for y in ([0, 100, 250, 400, 500], [0, 100, 250, 250 + gap, 400, 500])
    )
    assert error_of(pair) < 2 * error_of(apart)


def test_curves_at_one_place_are_one_line_and_others_are_all_lines():
    assert curve_lines(np.repeat([0.0, 50.0, 50.01, 100.0], 5)).u.tolist() == [0, 50, 100]
    assert curve_lines(np.arange(100.0)).u.tolist() == list(range(100))
    assert not curve_lines(np.zeros(5)).straight


@pytest.mark.parametrize(
    ("y", "t"), [((0, 500), (0.2, 0.2)), ((0, 500), (0.2, 0.8)), ((200, 300), (0.45, 0.55)), ((215, 285), (0.6, 0.6))]
)
def test_a_section_along_a_fold_does_not_tear_it(y, t):
    tie = PointSet(arch_at(np.linspace(*t, 20), np.linspace(*y, 20)), section="TIE", kind="section")
    points = PointSet.concatenate([arch(np.linspace(0, 500, 8)), tie])
    surface = fit_horizon(points)
    assert with_code(surface.accuracy.notes, "fitting.sections-cross-others").params["names"] == ("TIE",)
    assert np.abs(surface.distance(points.xyz)).max() < 1e-6
    assert error_of(surface) < 0.5


def test_sections_in_a_fan_or_turned_a_little_are_section_curves():
    for angles in (np.linspace(-60, 60, 9), np.array([0, 8, -8, 5, 0])):
        lines = []
        for k, angle in enumerate(np.radians(angles)):
            x, _, z = fold_at(np.linspace(0, 1, 40), np.zeros(40)).T
            across, along = (x + 600, 0 * x) if len(angles) == 9 else (x, np.full(40, 60.0 * k))
            lines.append(np.column_stack([across * np.cos(angle), along + across * np.sin(angle), z]))
        surface = loft(PointSet(np.concatenate(lines), section=np.repeat([f"S{k}" for k in range(len(angles))], 40)))
        assert surface.on_line.all()
        assert len(surface.u) == len(angles)


def test_as_many_ties_as_sections_leave_the_sections():
    ties = [PointSet(arch_at(np.full(20, t), np.linspace(0, 500, 20)), section=f"T{t}") for t in (0.2, 0.5, 0.7)]
    surface = loft(PointSet.concatenate([*ties, arch([0, 250, 500])]))
    assert surface.on_line.tolist() == [False] * 60 + [True] * 90
