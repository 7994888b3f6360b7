"""What a program may hand over by mistake: study areas, places and changes that mean nothing."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from refusals import refused

from geofit import (
    BodyData,
    FitSettings,
    PointSet,
    band,
    contours,
    cut_section,
    examine,
    fit_body,
    fit_horizon,
    prediction_sd,
)
from geofit.data.columns import LARGEST
from geofit.data.errors import FitError, PointsError, SettingsError
from geofit.fitting.horizon_fit import HorizonFit
from geofit.surfaces.mesh_surface import MeshSurface

CORNER = np.array([500_000.0, 3_100_000.0])
SQUARE = CORNER + 100 * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
LONG = 10**400


def cloud(size: float = 100.0) -> PointSet:
    plan = np.random.default_rng(0).uniform(0, 1, (40, 2))
    z = 0.1 * np.sin(4 * plan[:, 0]) + 0.05 * plan[:, 1]
    return PointSet(np.column_stack([plan, z]) * size + [*CORNER, 100.0])


@cache
def fitted() -> HorizonFit:
    return fit_horizon(cloud(), FitSettings(core="none"))


@pytest.mark.parametrize(
    ("boundary", "code"),
    [
        (SQUARE[[0, 1, 3, 2]], "fitting.study-area-invalid"),
        (CORNER + np.array([[0, 0], [50, 0], [100, 0]]), "fitting.study-area-invalid"),
        (SQUARE[[0, 0, 2, 2]], "fitting.study-area-invalid"),
        ([[0, 0], [1], [2, 3]], "fitting.boundary-without-corners"),
        ([["a", "b"]] * 3, "fitting.boundary-without-corners"),
        ([[0, 0], [LONG, 0], [1, 1]], "fitting.boundary-without-corners"),
        ([], "fitting.boundary-wrong-shape"),
        ([[0, 0], [1, np.nan], [2, 2]], "fitting.boundary-wrong-shape"),
        (SQUARE * 1e300, "data.coordinate-too-large"),
        (SQUARE + 1e4, "fitting.points-off-study-area"),
        (SQUARE + np.array([1e4, 0]), "fitting.points-off-study-area"),
        (SQUARE[:, ::-1], "fitting.points-off-study-area"),
    ],
    ids=["crossing", "flat", "two corners", "ragged", "words", "400 zeros", "none", "nan", "1e300 m", "10 km off",
         "10 km east", "exchanged"],
)  # fmt: skip
def test_a_study_area_of_a_program_is_checked_as_that_of_a_file(boundary, code):
    with refused(PointsError, code):
        fit_horizon(cloud(), None, boundary)


def test_a_study_area_beside_the_points_is_fitted():
    assert np.isfinite(fit_horizon(cloud(), FitSettings(core="none"), SQUARE + np.array([120.0, 0])).accuracy.sigma)


@pytest.mark.parametrize("axis", [0, 2])
def test_coordinates_beyond_a_billion_metres_are_refused(axis):
    xyz = cloud().xyz.copy()
    xyz[7, axis] = 2 * LARGEST
    with refused(PointsError, "data.coordinate-too-large", farthest=2 * LARGEST):
        fit_horizon(PointSet(xyz))


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
@pytest.mark.parametrize("of", ["patches", "triangles"])
def test_no_distance_to_places_that_are_none(bad, of):
    surface = fitted() if of == "patches" else MeshSurface(fitted().triangulate(1.0))
    assert np.isnan(surface.elevation(bad, CORNER[1]))
    place = [[*CORNER, 100.0], [bad, CORNER[1], 100.0]]
    code = "data.points-not-finite" if not np.isfinite(bad) else "data.coordinate-too-large"
    for measure in (surface.distance, surface.project):
        with refused(PointsError, code):
            measure(place)
    assert surface.distance([*CORNER, 100.0]).shape == (1,)


def test_no_standard_deviation_at_places_that_are_none():
    known = examine(fitted()).uncertainty
    places = fitted().points.xyz[:3]
    np.testing.assert_array_equal(prediction_sd(fitted(), known, places[:, :2]), prediction_sd(fitted(), known, places))
    for place in ([[np.nan, CORNER[1]]], [[np.nan, CORNER[1], 0.0]]):
        with refused(PointsError, "data.points-not-finite"):
            prediction_sd(fitted(), known, place)


@pytest.mark.parametrize("dz", [1e300, -1e300, np.nan, np.inf, LONG, "a", None, True])
def test_a_control_point_is_moved_by_a_number_of_metres_only(dz):
    with refused(FitError, "fitting.value-not-finite"):
        fitted().adjust(fitted().patches[0].name, 2, 2, dz=dz)


@pytest.mark.parametrize("weight", [np.nan, LONG, "a", 0.0, -1.0, 1e300])
def test_a_weight_is_a_number(weight):
    with refused(FitError, "fitting.weight-out-of-range"):
        fitted().weigh(fitted().patches[0].name, 4, 4, weight=weight)


@pytest.mark.parametrize("index", [(2.5, 2), (-1, 2), (2, LONG), ("a", 0)])
def test_control_points_are_named_by_whole_numbers(index):
    with refused(FitError, "fitting.control-point-unknown"):
        fitted().adjust(fitted().patches[0].name, *index, dz=1.0)


@pytest.mark.parametrize("point", [[np.nan, 0, 0], [*CORNER, 1e300], "abc", [1, 2], [LONG, 0, 0], None])
def test_the_surface_is_pulled_to_places_only(point):
    with refused(FitError, "fitting.target-not-finite"):
        fitted().move_to(point)


@pytest.mark.parametrize("core", ["auto", "all", "none"])
def test_a_site_of_two_millimetres_is_that_of_two_metres_in_small(core):
    small, large = (
        fit_horizon(cloud(size), FitSettings(core=core, coincidence_distance=1e-6 * size)) for size in (2e-3, 2.0)
    )
    assert small.accuracy.passed
    assert np.isfinite(small.accuracy.residuals).all()
    # No farther beyond the points than the large one, in relation: a strip of a fixed width was ten times the site.
    for near, far in zip(small.bounds, large.bounds, strict=True):
        np.testing.assert_allclose((near - [*CORNER, 100.0]) / 2e-3, (far - [*CORNER, 100.0]) / 2.0, atol=0.2)


def test_a_site_of_two_millimetres_goes_to_step_and_back(tmp_path):
    back = fit_horizon(cloud(2e-3), FitSettings(coincidence_distance=1e-8)).write_step(tmp_path / "small.step")
    assert back.brep_valid
    assert back.max_abs < 1e-3


def test_sigma_below_epsilon_is_never_shown_as_above_it():
    surface = fitted()
    failed = surface.with_(accuracy=surface.accuracy.__class__(**{**vars(surface.accuracy), "passed": False}))
    assert failed.accuracy.sigma < failed.accuracy.epsilon
    assert ">=" not in repr(failed)
    assert ">=" not in repr(failed.accuracy)


@pytest.mark.parametrize("value", [np.nan, np.inf, 0, -1, LONG, "a", True])
def test_lengths_and_shares_are_numbers_above_zero(value):
    surface, known = fitted(), examine(fitted())
    with refused(SettingsError, "geometry.chordal-tolerance-not-positive"):
        surface.triangulate(value)
    with refused(SettingsError, "data.contour-interval-not-positive"):
        contours(surface, value)
    with refused(SettingsError, "prediction.share-out-of-range"):
        band(surface, known, share=value)


def test_a_tolerance_too_fine_for_memory_is_refused_at_once():
    with refused(SettingsError, "geometry.too-many-triangles"):
        fitted().triangulate(1e-300)


@pytest.mark.parametrize(
    "line", ["ab", [[0, 0], [LONG, 0]], [[1], [2, 3]], [[0, 0], [1e300, 0]], [[0, 0], [np.nan, 0]]]
)
def test_a_section_line_is_one(line):
    with refused(SettingsError, "sampling.section-line-wrong-shape"):
        cut_section(fitted(), line)


def test_bodies_refuse_what_horizons_refuse():
    rng = np.random.default_rng(0)
    ball = rng.normal(size=(60, 3))
    ball *= 50 / np.linalg.norm(ball, axis=1)[:, None]
    body = fit_body(BodyData(contacts=ball, inside=0.5 * ball, outside=1.5 * ball))
    for places in ([[np.nan, 0, 0]], [[1e300, 0, 0]], [[LONG, 0, 0]], "a", [[1, 2]], [[1], [2, 3]]):
        for measure in (body.distance, body.value, body.gradient):
            with pytest.raises(PointsError):
                measure(places)
    assert body.distance([0, 0, 100.0]) == pytest.approx(50, abs=5)
    with refused(PointsError, "data.coordinate-too-large"):
        BodyData(contacts=1e300 * ball)
    for spacing in (np.nan, 0, -1, LONG, "a", 1e-12):
        with refused(SettingsError, "bodies.spacing-unusable"):
            body.triangulate(spacing)
