"""What a fit calls exact is exact."""

from __future__ import annotations

import numpy as np
import pytest
from truth import EASTING, NORTHING, fold_at, folded, paper_arrangement

from geofit import FitSettings, PointSet, fit_horizon
from geofit.checks.check import CORE_LIMIT
from geofit.data.errors import ExactnessError, FitError, InputError, PointsError


def overturned(between: int, offset: float, seed: int) -> PointSet:
    """Five sections through an overturned fold, and points between them that are ``offset`` metres off it."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, 30)
    line = np.column_stack([200 * t + 120 * np.sin(2 * np.pi * t), np.zeros(30), 200 * t])
    rows = [line + np.array([0, y, 0]) for y in np.arange(0, 500, 100.0)]
    t, y = rng.uniform(0.1, 0.9, between), rng.uniform(20, 380, between)
    off = offset * rng.choice([-1, 1], between)
    rows.append(np.column_stack([200 * t + 120 * np.sin(2 * np.pi * t), y, 200 * t + off]))
    names = [f"S{k}" for k in range(5) for _ in range(30)] + [""] * between
    return PointSet(np.concatenate(rows) + np.array([500000, 3100000, 0]), section=names)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("between", "offset"), [(0, 0.0), (5, 0.1), (10, 0.02)])
def test_points_of_a_fold_that_count_as_exact_are_met(between, offset, seed):
    try:
        surface = fit_horizon(overturned(between, offset, seed), FitSettings(frame="sections"))
    except ExactnessError:
        return
    residuals = np.abs(surface.accuracy.residuals)
    assert residuals[surface.core].max() <= CORE_LIMIT
    assert surface.partition.core == surface.core.sum()
    missed = int((residuals > CORE_LIMIT).sum())
    assert surface.partition.periphery == missed
    assert ("points that it misses" in str(surface.partition.reason)) == (missed > 0)


def test_points_that_a_fold_misses_count_as_approximated(monkeypatch):
    # No fold is known that misses a point: a limit below rounding plants some.
    monkeypatch.setattr("geofit.fitting.exactness.CORE_LIMIT", 1e-16)
    surface = fit_horizon(overturned(5, 0.02, 1), FitSettings(frame="sections"))
    missed = int((np.abs(surface.accuracy.residuals) > 1e-16).sum())
    assert missed > 0
    assert surface.partition.periphery == missed
    assert surface.core.sum() == len(surface.points) - missed
    assert "points that it misses" in str(surface.partition.reason)


def drilled_between(seed: int, share: float) -> PointSet:
    """A fold of which a share of the points was moved along it to places between its sections."""
    rng = np.random.default_rng(seed)
    lines = int(rng.integers(4, 9))
    drawn = folded(lines, int(rng.integers(25, 50)), seed=seed)
    count = int(share * len(drawn))
    moved = rng.choice(len(drawn), count, replace=False)
    xyz, section = drawn.xyz.copy(), drawn.section.astype("U8")
    xyz[moved] = fold_at(rng.random(count), rng.uniform(0, 60 * (lines - 1), count)) + np.array(
        (EASTING, NORTHING, 500)
    )
    section[moved] = ""
    return PointSet(xyz + rng.normal(0, 0.05, xyz.shape), section=section, kind="section")


@pytest.mark.parametrize("share", [0.1, 0.35, 0.6])
@pytest.mark.parametrize("seed", range(3))
def test_a_fold_with_many_points_between_its_sections_is_fitted(seed, share):
    points = drilled_between(seed, share)
    surface = fit_horizon(points)
    residuals = np.abs(surface.accuracy.residuals)
    assert surface.frame == "sections"
    assert residuals[points.section != ""].max() <= CORE_LIMIT
    assert residuals[surface.core].max() <= CORE_LIMIT
    assert surface.core.sum() == (residuals <= CORE_LIMIT).sum()


def stacked() -> PointSet:
    """A fold with points between two sections that stand one above the other across it."""
    normal = np.array([220.0, 0.0, 667.0]) / np.hypot(220.0, 667.0)
    place = fold_at(np.full(1, 0.5), np.full(1, 90.0)) + np.array((EASTING, NORTHING, 500))
    drawn = folded(4, 30, seed=1)
    xyz = np.concatenate([drawn.xyz, place + np.linspace(-5, 5, 12)[:, None] * normal])
    return PointSet(xyz, section=[*drawn.section, *[""] * 12], kind="section")


@pytest.mark.parametrize(
    ("cliff", "code"),
    [(0.5, "fitting.core-points-contradict"), (np.inf, "fitting.points-between-sections-released")],
)
def test_section_curves_outrank_points_between_them_that_contradict_each_other(cliff, code, monkeypatch):
    # Where no two points ask for a cliff, none is let go alone: all between the sections are.
    monkeypatch.setattr("geofit.fitting.core.CLIFF", cliff)
    points = stacked()
    surface = fit_horizon(points, FitSettings(max_control_points=1500))
    residuals = np.abs(surface.accuracy.residuals)
    drawn = points.section != ""
    assert residuals[drawn].max() <= CORE_LIMIT
    assert surface.core[drawn].all()
    assert not surface.core.all()
    assert surface.core.sum() == (residuals <= CORE_LIMIT).sum()
    assert code in [note.code for note in surface.accuracy.notes]


def cloud(shift=0.0):
    rng = np.random.default_rng(3)
    return PointSet(rng.uniform(0, 100, (20, 3)) + np.array([500000, 3100000, 0]) + shift)


BOX = np.array([[500000.0, 3100000.0], [500100.0, 3100000.0], [500100.0, 3100100.0], [500000.0, 3100100.0]])


@pytest.mark.parametrize(
    ("boundary", "words"),
    [
        (BOX[[0, 2, 1, 3]], "crosses or touches itself"),
        (BOX[[0, 0, 0]], "at least three are needed"),
        (BOX[0] + np.arange(4)[:, None] * np.array([10.0, 20.0]), "no area"),
        ([[1, 2], [3, 4, 5], [6, 7]], "not a list of corners"),
        (["a", "b", "c"], "not a list of corners"),
        (BOX + 50_000.0, "All points lie outside the study area; the nearest is"),
    ],
    ids=["crossing", "one corner", "flat", "ragged", "words", "far off"],
)
def test_a_boundary_from_a_program_is_checked_as_that_of_a_file(boundary, words):
    with pytest.raises(PointsError, match=words):
        fit_horizon(cloud(), None, boundary)


def test_coordinates_beyond_the_digits_of_a_double_are_refused():
    with pytest.raises(PointsError, match="at most 1000000000 m"):
        fit_horizon(cloud(shift=1e10))


@pytest.mark.parametrize("dz", [1e300, float("nan"), float("inf")])
def test_a_change_by_hand_that_no_surface_survives_is_refused(dz):
    surface = fit_horizon(cloud())
    with pytest.raises(FitError, match="finite number up to"):
        surface.adjust(surface.patches[0].name, 2, 2, dz=dz)


def test_a_surface_beyond_the_digits_of_a_double_is_not_written(tmp_path):
    surface = fit_horizon(cloud())
    with pytest.raises(InputError, match="at most 1e"):
        surface.with_(origin=surface.origin + 1e10).write_step(tmp_path / "far.step")
    assert list(tmp_path.iterdir()) == []


def test_of_two_points_of_a_core_that_contradict_each_other_one_is_let_go():
    """The core is kept: all its other points are met, and the one that is not is named."""
    truth = paper_arrangement(4)
    points = truth.points
    first = int(np.flatnonzero(points.section == "S06")[20])
    beside = points.xyz[[first]] + [0.02, 0.0, 0.4]
    both = PointSet(np.concatenate([points.xyz, beside]), section=[*points.section, "X01"], hole=[*points.hole, ""])
    surface = fit_horizon(both, FitSettings(), truth.boundary)
    torn = [note for note in surface.accuracy.notes if note.code == "fitting.core-points-contradict"]
    assert len(torn) == 1
    assert torn[0].severity == "warning"
    assert surface.core.sum() == 440
    assert np.abs(surface.accuracy.residuals[surface.core]).max() < CORE_LIMIT
    assert not surface.core[[first, len(points)]].all()


def test_relief_below_the_spans_of_the_field_is_no_reason_to_lose_a_core_of_sections():
    """Drawn sections over rough ground: what the field leaves is relief, not noise."""
    truth = paper_arrangement(2)
    x, y = truth.points.xyz[:, :2].T
    rough = 1.5 * np.sin(x / 11) * np.sin(y / 17)
    points = PointSet(
        truth.points.xyz + np.column_stack([0 * x, 0 * x, rough]), section=truth.points.section, hole=truth.points.hole
    )
    surface = fit_horizon(points, FitSettings(), truth.boundary)
    assert surface.diagnostics["noise"] > 0.5
    assert surface.core.sum() == 440
    assert np.abs(surface.accuracy.residuals[surface.core]).max() < CORE_LIMIT
