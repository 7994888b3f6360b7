"""Sparse points are met, as far as the ground between them may vary; what contradicts them is not."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code
from truth import EASTING, NORTHING

from geofit import FitSettings, PointSet, fit_horizon

SIDE = 2000.0
CORNER = np.array([EASTING, NORTHING])


def rough(n, seed, relief, below, places=None):
    """Return n contacts of gentle relief (m) and of what varies below their spacing (1 sigma, m)."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, SIDE, (n, 2)) if places is None else places
    z = relief * np.sin(xy[:, 0] / 500) * np.cos(xy[:, 1] / 620) + below * rng.normal(size=len(xy))
    return np.column_stack([xy + CORNER, 900.0 + z])


def jittered(per_side, seed):
    """Return places of a grid, each moved at random: none is near another."""
    step = SIDE / per_side
    grid = step * np.stack(np.meshgrid(*[np.arange(per_side)] * 2), axis=-1).reshape(-1, 2)
    return grid + np.random.default_rng(seed).uniform(0, 0.6 * step, grid.shape)


def reason_of(surface):
    return with_code(surface.accuracy.notes, "fitting.tolerance-not-met").params["reason"]


@pytest.mark.parametrize("stated", [False, True])
@pytest.mark.parametrize(("per_side", "seed"), [(5, 0), (8, 1), (12, 2)])
def test_holes_far_apart_are_met_although_they_scatter_about_every_smooth_surface(per_side, seed, stated):
    xyz = rough(0, seed, relief=4.0, below=4.0, places=jittered(per_side, seed))
    accuracy = np.full(len(xyz), 0.05) if stated else None
    surface = fit_horizon(PointSet(xyz, accuracy=accuracy))
    assert surface.diagnostics["noise"] > 2.0
    assert np.abs(surface.distance(xyz)).max() <= 0.1


@pytest.mark.parametrize("n", [60, 100, 250])
def test_the_cap_yields_to_sparse_points(n):
    xyz = rough(n, n, relief=60.0, below=2.0)
    surface = fit_horizon(PointSet(xyz))
    apart = np.linalg.norm(xyz[:, None, :2] - xyz[:, :2], axis=2) + 1e9 * np.eye(n)
    rise = np.abs(xyz[:, None, 2] - xyz[:, 2])
    cliff = (rise > 0.4 * apart).any(axis=1)
    assert (np.abs(surface.distance(xyz))[~cliff] <= 0.1).all()


def test_a_cap_that_was_given_holds_and_the_note_states_what_it_would_take():
    points = PointSet(rough(100, 100, relief=60.0, below=2.0))
    surface = fit_horizon(points, FitSettings(max_control_points=1_000))
    assert surface.control_points <= 1_000
    reason = reason_of(surface)
    assert reason.code == "fitting.control-points-used-up"
    assert reason.params["most"] == 1_000
    more = fit_horizon(points, FitSettings(max_control_points=reason.params["asked"]))
    assert more.accuracy.max_abs <= 0.1


def test_points_that_ask_for_too_many_control_points_are_told_how_many():
    surface = fit_horizon(PointSet(rough(3_000, 0, relief=60.0, below=1.0)), FitSettings(core="none"))
    assert surface.control_points <= 20_000
    reason = reason_of(surface)
    assert reason.code == "fitting.control-points-used-up"
    assert reason.params["asked"] > 120_000


def with_twin(rise):
    """Return 41 contacts, of which 7 and 40 are four metres apart."""
    xyz = rough(40, 3, relief=30.0, below=1.0)
    return np.vstack([xyz, xyz[7] + (3.0, -2.5, rise)])


def test_twin_holes_are_both_met():
    xyz = with_twin(0.5)
    assert np.abs(fit_horizon(PointSet(xyz)).distance(xyz)).max() <= 0.1


@pytest.mark.parametrize("rise", [-40.0, 40.0])
def test_of_twin_holes_that_ask_for_a_cliff_the_one_that_the_others_do_not_support_is_let_go(rise):
    xyz = with_twin(rise)
    surface = fit_horizon(PointSet(xyz, hole=[f"H{k}" for k in range(41)]))
    off = np.abs(surface.distance(xyz))
    assert off[:40].max() <= 0.1
    assert off[40] > 1.0
    note = with_code(surface.accuracy.notes, "fitting.neighbours-contradict")
    assert (note.severity, note.params["count"]) == ("warning", 1)
    assert "point H40" in str(note)
    assert not surface.accuracy.passed
    strict = fit_horizon(PointSet(xyz), FitSettings(strict=True))
    assert np.abs(strict.distance(xyz)).max() < off[40]


def test_a_blunder_among_holes_that_scatter_is_let_go():
    xyz = rough(0, 4, relief=4.0, below=4.0, places=jittered(8, 4))
    wrong = xyz + (0.0, 0.0, 300.0) * (np.arange(len(xyz)) == 27)[:, None]
    surface = fit_horizon(PointSet(wrong))
    off = np.abs(surface.distance(wrong))
    assert np.flatnonzero(off > 0.1).tolist() == [27]
    assert with_code(surface.accuracy.notes, "fitting.neighbours-contradict").params["count"] == 1
    assert not surface.accuracy.passed


@pytest.mark.parametrize(("most", "epsilon", "met"), [(400, 0.3, True), (500, 0.3, True), (200, 2.0, False)])
def test_points_that_local_adjustment_has_met_are_not_said_to_stay_away(most, epsilon, met):
    settings = FitSettings(max_control_points=most, interior_tolerance=1.0, epsilon=epsilon)
    accuracy = fit_horizon(PointSet(rough(60, 60, relief=60.0, below=2.0)), settings).accuracy
    assert (np.abs(accuracy.residuals) <= 1.0).all() == met
    assert ("fitting.tolerance-not-met" not in {note.code for note in accuracy.notes}) == met


def test_only_the_check_counts_the_points_that_noise_puts_beyond_the_tolerance():
    """On a slope fewer lie so far away than so high: two counts of one thing would contradict each other."""
    rng = np.random.default_rng(3)
    xy = rng.uniform(0, SIDE, (3_000, 2))
    z = 0.5 * xy[:, 0] + 20 * np.sin(xy[:, 1] / 400) + 0.05 * rng.normal(size=len(xy))
    accuracy = fit_horizon(PointSet(np.column_stack([xy + CORNER, z])), FitSettings(core="none")).accuracy
    assert "count" not in with_code(accuracy.notes, "fitting.points-beyond-tolerance-as-noise").params
    (check,) = (one for one in accuracy.checks if one.name == "interior tolerance")
    assert check.passed
    assert check.text.params["count"] == (np.abs(accuracy.residuals) > 0.1).sum() > 0


def around_a_core(slope, seed=1):
    """Return the errors with either seam: nine sections, sparse points, and ground that turns by ``slope`` between."""
    rng = np.random.default_rng(seed)

    def ground(x, y):
        bent = slope * (np.maximum(0, x - 1320) + np.maximum(0, 680 - x))
        return 30 * np.sin(x / 180) + 20 * np.cos(y / 150) + 0.12 * x + bent

    plan = [np.column_stack([np.full(25, 685 + 78.75 * k), np.sort(rng.uniform(600, 1400, 25))]) for k in range(9)]
    around = rng.uniform(0, SIDE, (110, 2))
    around = around[(np.abs(around - 1000) > (320, 420)).any(axis=1)]
    plan = np.concatenate([*plan, around])
    section = np.append(np.repeat([f"S{k}" for k in range(9)], 25), np.full(len(around), ""))
    points = PointSet(np.column_stack([plan + CORNER, ground(*plan.T)]), section=section)
    core = np.array([[680, 580], [1320, 580], [1320, 1420], [680, 1420]]) + CORNER
    places = rng.uniform(150, SIDE - 150, (2000, 2))
    found = {}
    for seam in ("tangent", "position"):
        settings = FitSettings(seam=seam, core=tuple(map(tuple, core.tolist())))
        surface = fit_horizon(points, settings, np.array([[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]]) + CORNER)
        off = surface.elevation(*(places + CORNER).T) - ground(*places.T)
        found[seam] = float(np.sqrt(np.mean(off**2)))
    return found


def test_a_break_that_is_allowed_makes_a_smooth_horizon_no_worse():
    error = around_a_core(0.0)
    assert error["position"] < 1.1 * error["tangent"]


def test_the_surface_breaks_at_the_core_where_the_points_show_it():
    error = around_a_core(0.5)
    assert error["position"] < 0.7 * error["tangent"]
