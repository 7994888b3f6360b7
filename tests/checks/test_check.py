from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from surfaces import ORIGIN, height_field, horizon, nine, split

from geofit.checks import check as module
from geofit.checks.check import check, sigma
from geofit.data.accuracy import Conflict, Exceedance
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.splines.patch import Patch


def named(accuracy):
    return {one.name: one for one in accuracy.checks}


def flat(size=(100.0, 100.0), z=0.0):
    return height_field(8, 8, size=size, z=lambda x, y: np.full_like(x, z))


def above(*heights, at=(50.0, 50.0)):
    return np.array([[*at, h] for h in heights]) + ORIGIN


@pytest.mark.parametrize(
    ("residuals", "wanted"),
    [([0.3, -0.4], 0.5), ([1.0, 1, 1, 1, 1], np.sqrt(5 / 4)), ([-0.7], 0.7), ([], 0.0), ([0.0, 0.0], 0.0)],
)
def test_sigma_is_equation_3(residuals, wanted):
    assert sigma(np.array(residuals)) == pytest.approx(wanted, abs=1e-15)


def test_the_figures_of_planted_distances():
    d = np.array([0.3, -0.4, 0.05, 0.0])
    found = check(horizon([flat()], above(*d)))
    np.testing.assert_allclose(found.residuals, d, atol=1e-9)
    assert found.n == 4
    assert found.sigma == pytest.approx(np.sqrt((0.09 + 0.16 + 0.0025) / 3), abs=1e-9)
    assert found.max_abs == pytest.approx(0.4)
    assert found.mean == pytest.approx(d.mean())
    assert found.over == {"interior_tolerance": Exceedance(0.1, 2), "epsilon": Exceedance(0.5, 0)}
    assert found.worst == (1, 0, 2, 3)
    assert found.passed
    assert found.verdict == "PASS"


def test_sigma_equal_to_epsilon_does_not_pass():
    surface = horizon([flat()], above(0.6, -0.8))
    assert not check(surface.with_(settings=FitSettings(epsilon=0.99))).passed
    assert check(surface.with_(settings=FitSettings(epsilon=1.01))).passed


def test_groups_hold_their_own_figures_and_leave_the_nameless_out():
    d = np.array([0.3, -0.4, 0.2, 0.0, 0.6])
    points = PointSet(
        above(*d),
        kind=["borehole", "section", "section", "adit", "borehole"],
        hole=["B1", "", "", "A1", "B1"],
        section=["", "S1", "S1", "", ""],
    )
    found = check(horizon([flat()]).with_(points=points, core=np.zeros(5, bool)))
    assert set(found.by_kind) == {"borehole", "section", "adit"}
    assert set(found.by_hole) == {"B1", "A1"}
    assert set(found.by_section) == {"S1"}
    b1 = found.by_hole["B1"]
    assert (b1.n, b1.sigma, b1.max_abs, b1.mean) == pytest.approx((2, np.hypot(0.3, 0.6), 0.6, 0.45), abs=1e-9)
    assert found.by_patch["core"].n == 5
    assert sum(group.n for group in found.by_kind.values()) == 5


def test_points_are_counted_to_the_patch_they_lie_on():
    _, patches = nine()
    middles = np.array([p.evaluate(np.mean(p.domain[:2]), np.mean(p.domain[2:])) for p in patches]) + ORIGIN
    found = check(horizon(patches, middles))
    assert found.patch.tolist() == [p.name for p in patches]


def test_a_sound_surface_of_nine_patches_raises_nothing():
    whole, patches = nine()
    rng = np.random.default_rng(0)
    u, v = rng.uniform((0, 0), (1000, 700), (300, 2)).T
    found = check(horizon(patches, whole.evaluate(u, v) + ORIGIN, core=np.ones(300, bool)).with_(frame="map"))
    assert len(found.seams) == 12
    checks = named(found)
    shape = {"normals", "patches", "elevation range", "self-intersection", "oscillation", "trend"}
    assert set(checks) == {"core", "seam gap", "seam angle", *shape}
    assert all(one.passed for one in checks.values())
    assert checks["seam gap"].value < 1e-9
    assert checks["seam angle"].value < 1e-4


def planted(change, name="p11"):
    """Nine sound patches, one of them with changed control points."""
    whole, patches = nine()
    patches = [replace(p, control=change(p.control.copy())) if p.name == name else p for p in patches]
    u, v = np.random.default_rng(0).uniform((0, 0), (1000, 700), (50, 2)).T
    return named(check(horizon(patches, whole.evaluate(u, v) + ORIGIN).with_(frame="map")))


@pytest.mark.parametrize("gap", [2e-6, 0.01])
def test_a_gap_is_found(gap):
    def lift(control):
        control[0, :, 2] += gap
        return control

    checks = planted(lift)
    assert checks["seam gap"].passed is False
    assert checks["seam gap"].value == pytest.approx(gap, rel=0.2)
    assert checks["normals"].passed


@pytest.mark.parametrize("degrees", [0.2, 5.0])
def test_a_kink_is_found(degrees):
    """The second row of control points is lifted: the edge stays, the tangent plane turns."""
    first = flat((500.0, 700.0), 0.0)
    second = flat((500.0, 700.0), 0.0)
    control = second.control.copy()
    control[..., 2] = control[..., 0] * np.tan(np.radians(degrees))
    control[..., 0] += 500.0
    second = replace(second, name="east", control=control)
    checks = named(check(horizon([first, second])))
    assert checks["seam gap"].passed
    assert checks["seam angle"].passed is False
    assert checks["seam angle"].value == pytest.approx(degrees, rel=1e-6)
    allowed = named(check(horizon([first, second], seam="position")))
    assert allowed["seam angle"].passed is None
    assert allowed["seam angle"].text.code == "checks.largest-seam-angle-breaks-allowed"


def test_a_fold_in_a_height_field_is_found():
    def fold(control):
        control[3:6, :, 0] -= 250.0
        return control

    assert planted(fold)["normals"].passed is False


def test_a_fold_that_is_meant_is_none():
    patch = height_field(12, 12)
    control = patch.control.copy()
    control[4:8, :, 0] -= 700.0
    surface = horizon([Patch("core", (3, 3), patch.knots_u, patch.knots_v, control)])
    assert named(check(surface.with_(frame="map")))["normals"].passed is False
    assert named(check(surface.with_(frame="sections")))["normals"].passed


@pytest.mark.parametrize("sign", [1, -1])
def test_an_elevation_far_out_is_found(sign):
    def spike(control):
        control[2, 2, 2] += sign * 4000.0
        return control

    checks = planted(spike)
    assert checks["elevation range"].passed is False
    assert checks["elevation range"].value > 400
    assert checks["elevation range"].text.code == "data.elevations-beyond-data"


def test_a_narrow_spike_is_found():
    patch = height_field(203, 203, z=lambda x, y: 0.2 * x)
    control = patch.control.copy()
    control[103, 103, 2] += 2000.0
    u, v = np.random.default_rng(0).uniform((0, 0), (1000, 700), (50, 2)).T
    surface = horizon([replace(patch, control=control)], patch.evaluate(u, v) + ORIGIN)
    assert named(check(surface.with_(frame="map")))["elevation range"].passed is False


def test_flat_data_have_no_range_to_leave():
    found = check(horizon([flat()], above(0, 0, 0)))
    assert "elevation range" not in named(found)


def test_a_core_point_off_the_surface_is_found_but_one_that_gave_way_is_not_held_against_it():
    surface = horizon([flat()], above(0.0, 2e-6), core=np.array([True, True]))
    assert named(check(surface))["core"].passed is False
    settled = named(check(surface, [Conflict(0, 1, 2e-6, "settled")]))
    assert settled["core"].passed
    assert check(surface, [Conflict(0, 1, 2e-6, "settled")]).n == 2


def test_points_beyond_the_interior_tolerance_are_counted():
    checks = named(check(horizon([flat()], above(0.05, 0.2, -0.3))))
    assert checks["interior tolerance"].passed is False
    assert checks["interior tolerance"].text.params == {"count": 2, "total": 3}
    assert checks["interior tolerance"].value == pytest.approx(0.3)


def test_a_surface_without_points_has_figures_too():
    found = check(horizon([flat()]))
    assert (found.n, found.sigma, found.max_abs, found.mean) == (0, 0.0, 0.0, 0.0)


def test_notes_and_conflicts_are_handed_on():
    conflict = Conflict(0, 1, 0.5, "text")
    found = check(horizon([flat()], above(0.0, 0.5)), [conflict], ["a note"])
    assert found.conflicts == (conflict,)
    assert found.notes == ("a note",)


def test_a_cut_surface_measures_as_the_whole():
    whole = height_field()
    u, v = np.unique(whole.knots_u), np.unique(whole.knots_v)
    patches = split(whole, [u[6]], [v[4]])
    points = np.random.default_rng(1).uniform((0, 0, -60), (1000, 700, 60), (200, 3)) + ORIGIN
    cut, one = check(horizon(patches, points)), check(horizon([whole], points))
    np.testing.assert_allclose(cut.residuals, one.residuals, atol=1e-9)


def test_the_check_of_very_many_points_is_that_of_all_at_once(monkeypatch):
    rng = np.random.default_rng(3)
    patches = split(height_field(12, 12, z=lambda x, y: 3 * np.sin(x / 30) + 0.01 * y), [50.0], [])
    plan = rng.uniform(1, 99, (600, 2))
    surface = horizon(patches, np.column_stack([plan, 3 * np.sin(plan[:, 0] / 30) + rng.normal(0, 0.3, 600)]) + ORIGIN)
    at_once = check(surface, [Conflict(3, 7, 0.1, "")])
    monkeypatch.setattr(module, "STEP", 250)
    in_parts = check(surface, [Conflict(3, 7, 0.1, "")])
    np.testing.assert_array_equal(in_parts.residuals, at_once.residuals)
    np.testing.assert_array_equal(in_parts.patch, at_once.patch)
    assert in_parts.checks == at_once.checks
    assert {"oscillation", "normals", "interior tolerance"} <= {one.name for one in in_parts.checks}


def test_what_fails_while_very_many_points_are_measured_is_noted(monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(module, "oscillation", broken)
    monkeypatch.setattr(module, "STEP", 5)
    found = check(horizon([flat()], above(*np.linspace(0, 0.1, 12))))
    assert "checks.check-not-made" in [note.code for note in found.notes]
    assert "normals" in named(found)
