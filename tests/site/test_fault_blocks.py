from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from faulted import (
    ACROSS,
    ARMS,
    BOUNDARY,
    DIP,
    HEIGHT,
    ORIGIN,
    START,
    WAY,
    armed_points,
    fault_points,
    faulted_site,
    horizon_points,
    off,
    throw,
    truth,
)  # fmt: skip
from refusals import refused, with_code
from shapely import Polygon, contains_xy
from truth import EASTING, NORTHING, rms

from geofit import FitSettings, PointSet, fit_horizon
from geofit.cad.sewing import shell
from geofit.data.errors import FitError, InputError, SettingsError
from geofit.data.messages import Message
from geofit.site.fault_blocks import fit_blocks, fit_faulted


@pytest.fixture(scope="module")
def points():
    return horizon_points()


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
    assert isinstance(cut.text, Message)
    assert (cut.text.code, cut.text.params["fault"], cut.text.params["horizon"]) == ("site.fault-throw", "F1", "T2")


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


def test_a_block_is_checked_as_far_as_it_reaches(blocks):
    for block in blocks.blocks:
        area = next(check for check in block.accuracy.checks if check.name == "area")
        assert area.passed
        size = Polygon(block.outline).area
        assert area.text.params["covered"] == pytest.approx(size, abs=0.5)
        # Of the whole area it is the part on one side.
        assert size < 0.7 * Polygon(BOUNDARY).area


def test_a_block_that_is_changed_by_hand_still_ends_at_its_fault(blocks):
    block = blocks.blocks[0]
    assert block.accuracy.max_abs > 0
    pulled = block.move_to(block.accuracy.worst[0])
    assert pulled.accuracy.max_abs < block.accuracy.max_abs
    np.testing.assert_array_equal(pulled.outline, block.outline)


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
    (note,) = found.notes
    assert (note.code, note.severity) == ("site.points-on-one-side", "warning")
    assert note.params == {"horizon": "T2", "fault": "fault 1"}


def test_a_block_of_too_few_points_is_refused_with_its_rows(points):
    x = np.sort(points.xyz[:, 0])
    line = np.array([[x[1] + 1e-3, NORTHING], [x[1] + 1e-3, NORTHING + 1000]])
    with refused(FitError, "site.block-too-few-points", horizon="T2", count=2) as caught:
        fit_blocks(points, [line], None, BOUNDARY, name="T2")
    assert all(point.params["row"] for point in caught.value.message.params["points"])
    line[:, 0] = (x[4] + x[5]) / 2
    assert (
        with_code(fit_blocks(points, [line], None, BOUNDARY).notes, "site.block-rests-on-points").severity == "warning"
    )


def test_what_is_no_fault_is_refused(points):
    with refused(SettingsError, "site.fault-wrong-shape", number=1):
        fit_blocks(points, [[1.0, 2.0]], None, BOUNDARY)


def test_a_site_states_which_fault_cuts_which_horizon():
    site = faulted_site()
    found = fit_faulted(site, "T2")
    assert found.cuts[0].fault == "F1"
    with refused(InputError, "site.horizon-not-faulted", name="F1"):
        fit_faulted(site, "F1")
    with refused(InputError, "data.horizon-unknown", name="X"):
        fit_faulted(replace(site, faults={}), "X")


def test_each_arm_of_a_concave_area_has_a_surface_and_its_throw():
    blocks = fit_blocks(armed_points(), [np.array([[450.0, 0], [550, 1000]])], None, ARMS, name="T2")
    outlines = [Polygon(block.outline) for block in blocks.blocks]
    assert [block.name for block in blocks.blocks] == ["T2 (A)", "T2 (B)", "T2 (C)"]
    assert sum(one.area for one in outlines) == pytest.approx(Polygon(ARMS).area, rel=1e-3)
    for number, (outline, block) in enumerate(zip(outlines, blocks.blocks, strict=True)):
        assert contains_xy(outline.buffer(0.1), *block.points.xyz[:, :2].T).all()
        assert len(block.points) == np.count_nonzero(blocks.block == number)
    assert [(cut.up, cut.down) for cut in blocks.cuts] == [("T2 (A)", "T2 (B)"), ("T2 (A)", "T2 (C)")]
    for cut in blocks.cuts:
        assert cut.throw == pytest.approx(20, abs=0.2)
        assert cut.distance[-1] == pytest.approx(402, rel=0.03)
    assert not blocks.notes


def test_an_arm_with_too_few_points_is_named():
    points = armed_points(lambda x, y: (x < 450 + 0.1 * y) | (y < 500))
    blocks = fit_blocks(points, [np.array([[450.0, 0], [550, 1000]])], None, ARMS, name="T2")
    assert len(blocks.blocks) == 2
    note = with_code(blocks.notes, "site.piece-without-surface")
    assert note.severity == "warning"
    assert (note.params["count"], note.params["least"]) == (0, 3)
    assert note.params["area"] == pytest.approx(188_000, rel=1e-3)
