from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused
from truth import EASTING, NORTHING, hills

from geofit import FitSettings, PointSet, fit_horizon
from geofit.cad.sewing import shell
from geofit.data.errors import Cancelled, SettingsError
from geofit.data.messages import Message
from geofit.site.order import compare_horizons, orders
from geofit.site.separate import separate_horizons

BOUNDARY = np.array([[0, 0], [1000, 0], [1000, 900], [0, 900]]) + np.array([EASTING, NORTHING])
HEIGHT = hills(3, size=1000.0, shortest=300.0, relief=4.0)


def arrangement(seed, lift):
    """Points of a horizon: a dense core of seven sections, boreholes left and right of it."""
    rng = np.random.default_rng(seed)
    x = np.repeat(np.arange(380.0, 621.0, 40.0), 24)
    y = np.concatenate([np.sort(rng.uniform(0, 900, 24)) for _ in range(7)])
    wide = rng.uniform((0, 0), (360, 900), (50, 2))
    wide[25:, 0] += 640.0
    plan = np.concatenate([np.column_stack([x, y]), wide]) + np.array([EASTING, NORTHING])
    return PointSet(
        np.column_stack([plan, HEIGHT(*plan.T) + lift]),
        kind=["section"] * 168 + ["borehole"] * 50,
        section=[f"S{i}" for i in range(7) for _ in range(24)] + [""] * 50,
        file=f"points_{seed}.csv",
        row=np.arange(218) + 2,
    )


def fit(seed, lift, name):
    return fit_horizon(arrangement(seed, lift), boundary=BOUNDARY, name=name)


@pytest.fixture(scope="module")
def crossing():
    """A thin stratum whose contacts were seen at different places: between these the fits cross."""
    return {"top": fit(1, 0.5, "top"), "base": fit(2, 0.0, "base")}


@pytest.fixture(scope="module")
def repaired(crossing):
    return separate_horizons(crossing, ["top", "base"])


def test_the_crossing_goes_and_exact_points_stay_exact(crossing, repaired):
    before = compare_horizons(crossing["top"], crossing["base"])
    assert before.crossed_volume > 100
    assert len(before.crossings) >= 3
    assert repaired.contradictions == ()
    after = compare_horizons(repaired.surfaces["top"], repaired.surfaces["base"])
    assert after.crossed_volume == 0
    assert after.check().passed
    for name, surface in repaired.surfaces.items():
        assert surface is not crossing[name]
        assert surface.core.sum() > 150
        np.testing.assert_allclose(surface.accuracy.residuals[surface.core], 0, atol=1e-8)
        assert surface.accuracy.passed


def test_approximated_points_hardly_move_and_the_change_is_told(crossing, repaired):
    for name, surface in repaired.surfaces.items():
        moved = np.abs(surface.accuracy.residuals - crossing[name].accuracy.residuals)
        assert moved.max() < 0.2 * repaired.moved[name]
        note = surface.accuracy.notes[-1]
        assert isinstance(note, Message)
        assert str(note) == f"moved by up to {repaired.moved[name]:.3f} m to keep the order of strata"


def test_nothing_moves_outside_the_supports_of_the_crossing(crossing, repaired):
    order = compare_horizons(crossing["top"], crossing["base"])
    assert order.crossed_area < 0.2 * order.area
    places = np.concatenate([line[:, :2] for one in order.crossings for line in one.lines])
    for name, surface in repaired.surfaces.items():
        old, new = crossing[name].model.net, surface.model.net
        moved = old.coefficients != new.coefficients
        assert moved.any()
        assert not moved.all()
        # Supports of cubic control points reach two spans either way from where they stand.
        kept = np.flatnonzero(~moved)
        np.testing.assert_array_equal(old.coefficients[kept], new.coefficients[kept])
        rng = np.random.default_rng(5)
        xy = rng.uniform(BOUNDARY[0], BOUNDARY[2], (4000, 2))
        frame = surface.model.problem.parametrization.frame
        spans = max(np.diff(np.unique(k)).max() for k in (old.space.knots_u, old.space.knots_v)) * old.unit
        far = np.linalg.norm(xy[:, None] - places[None, ::5], axis=2).min(axis=1) > 5 * spans
        matrix = old.space.matrix(frame.plan(xy[far]) / old.unit)
        np.testing.assert_array_equal(matrix @ old.coefficients, matrix @ new.coefficients)


def test_seams_stay_closed_and_tangent(repaired):
    for surface in repaired.surfaces.values():
        assert len(surface.patches) > 1
        checks = {check.name: check for check in surface.accuracy.checks}
        assert checks["seam gap"].passed
        assert checks["seam angle"].passed
        assert not shell(surface).IsNull()


def test_a_least_thickness_is_kept(crossing):
    # Between the points only: at them the stratum is 0.8 m thick.
    found = separate_horizons(crossing, ["top", "base"], minimum=0.1)
    assert found.contradictions == ()
    assert compare_horizons(found.surfaces["top"], found.surfaces["base"]).min >= 0.1 - 1e-6


def test_three_horizons_are_pushed_apart_together(crossing):
    three = {**crossing, "middle": fit(4, 0.4, "middle")}
    sequence = ["top", "middle", "base"]
    assert sum(order.crossed_volume for order in orders(three, sequence)) > 200
    found = separate_horizons(three, sequence)
    left = {(one.upper, one.lower) for one in found.contradictions}
    for order in orders(found.surfaces, sequence):
        assert order.crossed_volume == 0 or (order.upper, order.lower) in left
    for surface in found.surfaces.values():
        np.testing.assert_allclose(surface.accuracy.residuals[surface.core], 0, atol=1e-8)


def test_progress_is_told_at_each_step_and_stops_the_separation(crossing):
    heard = []
    separate_horizons(crossing, ["top", "base"], progress=lambda stage, share: heard.append((stage, share)))
    stages, shares = zip(*heard, strict=True)
    assert set(stages) == {"separate horizons"}
    assert len(shares) > 10
    assert list(shares) == sorted(shares)
    assert 0 <= shares[0] < shares[-1] <= 1
    few = iter(range(5))
    with pytest.raises(Cancelled):
        separate_horizons(crossing, ["top", "base"], progress=lambda *_: next(few) < 4)
    assert next(few, None) is None


def test_a_step_that_moves_nothing_is_not_made_again(crossing):
    three = {**crossing, "middle": fit(4, 0.4, "middle")}
    heard = []
    separate_horizons(three, ["top", "middle", "base"], progress=lambda *_: heard.append(1))
    # 485 where those that move nothing were made until the last that is allowed.
    assert len(heard) < 350


def test_surfaces_in_order_are_handed_on_as_they_are(crossing):
    apart = {"top": crossing["top"], "base": fit(2, -60.0, "base"), "other": crossing["base"]}
    found = separate_horizons(apart, ["top", "base"])
    assert found.moved == {}
    assert all(found.surfaces[name] is apart[name] for name in apart)


def test_exact_points_that_contradict_are_named_with_their_rows(crossing):
    points = crossing["top"].points
    row = 80
    xyz = points.xyz[[row]] + np.array([0.5, 0.5, 3.0])
    more = PointSet(xyz, kind="section", section="S3", file="wrong.csv", row=77)
    # Drawn, since an automatic core asks its points to agree: so is a person's wrong section made exact.
    core = tuple((x + EASTING, y + NORTHING) for x, y in ((375, 0), (625, 0), (625, 900), (375, 900)))
    every = PointSet.concatenate([arrangement(2, 0.0), more])
    wrong = fit_horizon(every, FitSettings(core=core), BOUNDARY, name="base")
    found = separate_horizons({"top": crossing["top"], "base": wrong}, ["top", "base"])
    assert found.contradictions
    worst = max(found.contradictions, key=lambda one: one.lack)
    assert np.hypot(worst.x - xyz[0, 0], worst.y - xyz[0, 1]) < 10
    assert 2.0 < worst.lack < 10.0
    assert str(worst.below) == "section S3, wrong.csv row 77"
    assert (worst.above.params["file"], worst.above.params["row"]) == ("points_1.csv", points.row[row])
    assert (worst.text.code, worst.text.severity) == ("site.horizons-not-separable", "warning")
    for surface in found.surfaces.values():
        np.testing.assert_allclose(surface.accuracy.residuals[surface.core], 0, atol=1e-8)
    # Nothing swings for what cannot be.
    assert max(found.moved.values()) < 40


def test_what_cannot_be_repaired_is_refused(crossing):
    imported = {**crossing, "base": replace(crossing["base"], model=None)}
    with refused(SettingsError, "site.no-control-net", name="base"):
        separate_horizons(imported, ["top", "base"])
    with refused(SettingsError, "site.least-thickness-negative", value=-1):
        separate_horizons(crossing, ["top", "base"], minimum=-1)
    with refused(SettingsError, "site.least-thickness-negative", value=1e300):
        separate_horizons(crossing, ["top", "base"], minimum=1e300)
