"""Minimum curvature against the package wellpathpy and against circles."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.io.desurvey import METHODS, desurvey, minimum_curvature, tangential


def random_survey(seed, stations=30):
    rng = np.random.default_rng(seed)
    depth = np.r_[0.0, np.cumsum(rng.uniform(1, 40, stations - 1))]
    dip = np.clip(70 + np.cumsum(rng.normal(0, 3, stations)), -85, 89.9)
    azimuth = (rng.uniform(0, 360) + np.cumsum(rng.normal(0, 8, stations))) % 360
    return depth, azimuth, dip


@pytest.mark.parametrize("seed", range(8))
def test_stations_agree_with_wellpathpy(seed):
    wellpathpy = pytest.importorskip("wellpathpy")
    depth, azimuth, dip = random_survey(seed)
    position = wellpathpy.deviation(md=depth, inc=90 - dip, azi=azimuth).minimum_curvature()
    collar = np.array([500000.0, 3100000.0, 1200.0])
    path = minimum_curvature(collar, depth, azimuth, dip)
    expected = collar + np.column_stack([position.easting, position.northing, -position.depth])
    np.testing.assert_allclose(path.xyz, expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_places_between_stations_agree_with_wellpathpy(seed):
    wellpathpy = pytest.importorskip("wellpathpy")
    depth, azimuth, dip = random_survey(seed)
    places = np.linspace(0, depth[-1], 101)
    position = wellpathpy.deviation(md=depth, inc=90 - dip, azi=azimuth).minimum_curvature().resample(places)
    expected = np.column_stack([position.easting, position.northing, -position.depth])
    np.testing.assert_allclose(minimum_curvature((0, 0, 0), depth, azimuth, dip).at(places), expected, atol=1e-6)


def test_places_between_stations_lie_on_the_circle():
    # From straight down to horizontal east over a quarter circle of 100 m radius.
    length = 50 * np.pi
    path = minimum_curvature((0, 0, 0), [0, length], [90, 90], [90, 0])
    angle = np.linspace(0, np.pi / 2, 21)
    expected = 100 * np.column_stack([1 - np.cos(angle), 0 * angle, -np.sin(angle)])
    np.testing.assert_allclose(path.at(100 * angle), expected, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_a_station_put_on_the_path_does_not_move_it(seed):
    depth, azimuth, dip = random_survey(seed)
    path = minimum_curvature((0, 0, 0), depth, azimuth, dip)
    new = 0.3 * depth[4] + 0.7 * depth[5]
    step = 1e-4
    tangent = (path.at(new + step) - path.at(new - step))[0] / (2 * step)
    inserted = minimum_curvature(
        (0, 0, 0),
        np.insert(depth, 5, new),
        np.insert(azimuth, 5, np.degrees(np.arctan2(tangent[0], tangent[1]))),
        np.insert(dip, 5, np.degrees(np.arcsin(-tangent[2]))),
    )
    np.testing.assert_allclose(inserted.at(depth), path.xyz, atol=1e-5)


def test_straight_before_the_first_station_and_beyond_the_last():
    path = minimum_curvature((10, 20, 30), [40], [0], [30])
    c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
    np.testing.assert_allclose(path.at([0, 20, 100]), [[10, 20 + d * c, 30 - d * s] for d in (0, 20, 100)])


def test_tiny_doglegs_keep_their_digits():
    path = minimum_curvature((0, 0, 0), [0, 100], [0, 1e-7], [60, 60])
    np.testing.assert_allclose(np.linalg.norm(path.xyz[1]), 100, rtol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_tangential_agrees_with_wellpathpy(seed):
    wellpathpy = pytest.importorskip("wellpathpy")
    depth, azimuth, dip = random_survey(seed)
    position = wellpathpy.deviation(md=depth, inc=90 - dip, azi=azimuth).tan_method(choice="low")
    expected = np.column_stack([position.easting, position.northing, -position.depth])
    path = tangential((0, 0, 0), depth, azimuth, dip)
    np.testing.assert_allclose(path.xyz, expected, atol=1e-6)
    np.testing.assert_allclose(path.at(0.5 * (depth[3] + depth[4]))[0], 0.5 * (path.xyz[3] + path.xyz[4]), atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_depth_of_an_elevation(method):
    depth, azimuth, dip = random_survey(3)
    path = desurvey(method, (0, 0, 100), depth, azimuth, dip)
    wanted = np.linspace(0, depth[-1] + 30, 57)
    np.testing.assert_allclose(path.depth_of(path.at(wanted)[:, 2]), wanted, atol=1e-5)
    assert np.isnan(path.depth_of([101.0]))[0]
