from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from truth import EASTING, NORTHING, hills, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.errors import FitError, InputError, SettingsError
from geofit.site import Site
from geofit.stack.faults import fit_blocks, fit_faulted
from geofit.steps.stitch import shell
from geofit.words import Said

ORIGIN = np.array([EASTING, NORTHING])
BOUNDARY = np.array([[0, 0], [1200, 0], [1200, 1000], [0, 1000]]) + ORIGIN
HEIGHT = hills(7, size=1200.0, shortest=400.0, relief=4.0)
#: The fault's trace at the elevation 1500 m in plan, local; the part on its left is thrown down.
START, WAY = np.array([520.0, 0.0]), np.array([0.12, 1.0]) / np.hypot(0.12, 1.0)
ACROSS = np.array([-WAY[1], WAY[0]])
DIP = np.radians(75.0)


def throw(along):
    """5 m, growing by 2 m a kilometre along the fault."""
    return 5.0 + 0.002 * along


def off(x, y, z):
    """Distance in plan from the fault at its elevation, positive on the left, the hanging wall."""
    return (np.column_stack([x, y]) - ORIGIN - START) @ ACROSS + (z - 1500.0) / np.tan(DIP)


def truth(x, y):
    """The faulted horizon: the left block, which lies over the fault, is down."""
    along = (np.column_stack([x, y]) - ORIGIN - START) @ WAY
    z = HEIGHT(x, y)
    down = z - throw(along)
    return np.where(off(x, y, (z + down) / 2) > 0, down, z)


def fault_points():
    """Points of the fault's plane: it dips to the left."""
    along, depth = np.meshgrid(np.linspace(-100, 1200, 14), np.linspace(-70, 70, 6))
    plan = START + along.ravel()[:, None] * WAY - (depth.ravel() / np.tan(DIP))[:, None] * ACROSS
    return PointSet(np.column_stack([plan + ORIGIN, 1500.0 + depth.ravel()]))


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(11)
    wide = rng.uniform(BOUNDARY[0], BOUNDARY[2], (360, 2))
    # Holes beside the fault, as one drills them where one looks for it.
    beside = (
        np.sort(rng.uniform(10, 990, 60))[:, None] * WAY
        + (rng.uniform(4, 15, 60) * np.tile([1, -1], 30))[:, None] * ACROSS
    )
    plan = np.concatenate([wide, beside + START + ORIGIN])
    # In the heave there is no horizon at all.
    plan = plan[np.abs(off(*plan.T, truth(*plan.T))) > 2.0]
    return PointSet(np.column_stack([plan, truth(*plan.T)]), file="holes.csv", row=np.arange(len(plan)) + 2)


@pytest.fixture(scope="module")
def fault():
    return fit_horizon(fault_points(), FitSettings(frame="best-plane"), name="F1")


@pytest.fixture(scope="module")
def blocks(points, fault):
    return fit_blocks(points, [fault], None, BOUNDARY, name="T2")


def test_the_throw_along_an_inclined_fault_is_recovered(blocks):
    (cut,) = blocks.cuts
    assert (cut.fault, cut.horizon) == ("F1", "T2")
    along = (cut.trace[:, :2] - ORIGIN - START) @ WAY
    assert np.abs(cut.throw - throw(along)).mean() < 0.3
    assert cut.throw.mean() == pytest.approx(throw(along).mean(), abs=0.25)
    np.testing.assert_allclose(off(*cut.trace.T), 0, atol=0.05)
    assert cut.distance[0] == 0
    assert cut.distance[-1] == pytest.approx(np.hypot(120, 1000), rel=0.02)
    # A normal fault opens by throw / tan(dip).
    assert np.isfinite(cut.heave[2:-2]).all()
    assert np.nanmean(cut.heave) == pytest.approx(cut.throw.mean() / np.tan(DIP), rel=0.2)
    assert isinstance(cut.text, Said)
    assert "F1 throws T2 down by" in cut.text


def test_the_higher_block_is_named(blocks):
    (cut,) = blocks.cuts
    up = next(one for one in blocks.blocks if one.name == cut.up)
    assert (
        up.points.xyz[:, 0].mean() > next(one for one in blocks.blocks if one.name == cut.down).points.xyz[:, 0].mean()
    )


def test_every_point_is_in_the_block_of_its_side(blocks, points):
    left = off(*points.xyz.T) > 0
    for number, surface in enumerate(blocks.blocks):
        assert len(surface.points) == (blocks.block == number).sum()
        assert len(set(left[blocks.block == number])) == 1
    assert sum(len(one.points) for one in blocks.blocks) == len(points)


def test_apart_the_blocks_are_nearer_to_the_rock_than_one_surface_across_the_step(blocks, points):
    whole = fit_horizon(points, None, BOUNDARY)
    plan = np.random.default_rng(4).uniform(BOUNDARY[0], BOUNDARY[2], (6000, 2))
    z = truth(*plan.T)
    near = np.abs(off(*plan.T, z)) < 40
    parts = np.stack([one.elevation(*plan.T) for one in blocks.blocks])
    known = np.isfinite(parts).sum(axis=0) == 1
    assert known.mean() > 0.99
    faulted = np.nanmax(np.where(known, parts, -np.inf), axis=0)
    use = near & known
    assert rms(faulted[use] - z[use]) < 0.4 * rms(whole.elevation(*plan[use].T) - z[use])
    assert all(one.accuracy.passed for one in blocks.blocks)


def test_the_blocks_end_at_the_fault_and_make_valid_shells(blocks):
    for one in blocks.blocks:
        inner = one.outline[np.abs(one.outline - BOUNDARY.mean(axis=0)).max(axis=1) < 400]
        assert len(inner) > 5
        np.testing.assert_allclose(off(*inner.T, one.elevation(*inner.T)), 0, atol=0.05)
        shape = shell(one)
        assert not shape.IsNull()


def test_a_trace_in_plan_cuts_upright(points):
    line = np.array([START, START + 1100 * WAY]) + ORIGIN
    upright = PointSet(np.column_stack([points.xyz[:, :2], HEIGHT(*points.xyz[:, :2].T)]))
    side = (points.xyz[:, :2] - line[0]) @ ACROSS > 0
    upright = upright.with_(xyz=upright.xyz - np.array([0, 0, 8.0]) * side[:, None])
    found = fit_blocks(upright, [line], None, BOUNDARY, name="T2")
    (cut,) = found.cuts
    assert cut.throw.mean() == pytest.approx(8.0, abs=0.3)
    np.testing.assert_allclose(cut.heave[2:-2], 0, atol=1e-4)
    np.testing.assert_allclose((cut.trace[:, :2] - line[0]) @ ACROSS, 0, atol=1e-6)


def test_two_faults_make_three_blocks(points):
    lines = [np.array([[x, -10.0], [x + 1, 1010.0]]) + ORIGIN for x in (400.0, 800.0)]
    step = np.where(points.xyz[:, 0] - EASTING > 800, -6.0, np.where(points.xyz[:, 0] - EASTING > 400, 4.0, 0.0))
    moved = points.with_(xyz=np.column_stack([points.xyz[:, :2], HEIGHT(*points.xyz[:, :2].T) + step]))
    found = fit_blocks(moved, lines, None, BOUNDARY, name="T2")
    assert len(found.blocks) == 3
    assert sorted(cut.throw.mean() for cut in found.cuts) == pytest.approx([4.0, 10.0], abs=0.5)


def test_a_fault_beside_the_points_does_not_cut_and_a_note_says_so(points):
    line = np.array([[5000.0, 0.0], [5000.0, 1000.0]]) + ORIGIN
    found = fit_blocks(points[:200], [line], None, BOUNDARY, name="T2")
    assert found.cuts == ()
    assert len(found.blocks) == 1
    assert found.blocks[0].name == "T2"
    assert found.notes == ("all points of T2 lie on one side of fault 1",)


def test_a_block_of_too_few_points_is_refused_with_its_rows(points):
    x = np.sort(points.xyz[:, 0])
    line = np.array([[x[1] + 1e-3, NORTHING], [x[1] + 1e-3, NORTHING + 1000]])
    with pytest.raises(FitError, match=r"of T2: 2 \(.*holes.csv row"):
        fit_blocks(points, [line], None, BOUNDARY, name="T2")
    line[:, 0] = (x[4] + x[5]) / 2
    assert any("rests on" in note for note in fit_blocks(points, [line], None, BOUNDARY).notes)


def test_what_is_no_fault_is_refused(points):
    with pytest.raises(SettingsError, match="Fault 1 has shape"):
        fit_blocks(points, [[1.0, 2.0]], None, BOUNDARY)


def test_a_site_states_which_fault_cuts_which_horizon(points):
    site = Site(
        "site",
        {"T2": points, "F1": fault_points()},
        settings={"F1": FitSettings(frame="best-plane")},
        boundary=BOUNDARY,
        faults={"F1": ("T2",)},
    )
    found = fit_faulted(site, "T2")
    assert found.cuts[0].fault == "F1"
    with pytest.raises(InputError, match="No fault of the site cuts 'F1'"):
        fit_faulted(site, "F1")
    with pytest.raises(InputError, match="no horizon 'X'"):
        fit_faulted(replace(site, faults={}), "X")
