"""The stereonet against what is known of it: areas, right angles, the rim, the mean of planes."""

import numpy as np
import pytest

from geofit.geometry.attitudes import attitudes, great_circle, mean_plane, plane_normals, poles, projected


def test_equal_areas_hold_equal_numbers():
    rng = np.random.default_rng(2)
    places = projected((lambda v: v / np.linalg.norm(v, axis=1)[:, None])(rng.normal(size=(40_000, 3))))
    radius = np.hypot(*places.T)
    assert radius.max() <= 1.0
    counts = np.histogram(radius**2, np.linspace(0, 1, 11))[0]
    assert np.abs(counts - 4000).max() < 5 * np.sqrt(4000)


@pytest.mark.parametrize(("azimuth", "dip"), [(90.0, 30.0), (213.0, 71.0), (0.0, 90.0), (5.0, 0.0)])
def test_a_trace_runs_from_rim_to_rim_and_is_a_right_angle_from_its_pole(azimuth, dip):
    trace = great_circle(azimuth, dip)
    assert np.hypot(*trace[[0, -1]].T) == pytest.approx(1.0)

    def unprojected(places):
        r2 = (places**2).sum(axis=1, keepdims=True)
        return np.column_stack([places * np.sqrt(2 - r2), r2 - 1])

    pole = unprojected(poles(np.array([azimuth]), np.array([dip])))[0]
    assert np.abs(unprojected(trace) @ pole).max() < 1e-9
    steepest = trace[45]
    assert np.degrees(np.arctan2(*steepest)) % 360 == pytest.approx(azimuth % 360) or dip in (0.0, 90.0)


def test_attitudes_undo_normals_of_either_sign():
    rng = np.random.default_rng(3)
    azimuth, dip = rng.uniform(0, 360, 50), rng.uniform(1, 89, 50)
    normals = plane_normals(azimuth, dip) * rng.choice([-1.0, 1.0], (50, 1))
    found = attitudes(normals)
    assert np.allclose(found[0], azimuth)
    assert np.allclose(found[1], dip)


def test_the_mean_plane_does_not_mind_that_steep_planes_dip_to_both_sides():
    azimuth, dip = np.array([90.0, 270.0, 90.0, 270.0]), np.array([85.0, 85.0, 80.0, 80.0])
    mean = mean_plane(azimuth, dip)
    assert mean[1] == pytest.approx(90.0)
    assert mean[0] % 180 == pytest.approx(90.0)
    assert mean[2] == pytest.approx(7.5)
