from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from truth import EASTING, NORTHING

from geofit import PointSet
from geofit.geometry.frame import best_plane_frame, map_frame, section_azimuth

angles = st.floats(-np.pi, np.pi)


def cloud(n=50, seed=0):
    return np.random.default_rng(seed).uniform(-500, 500, (n, 3)) + np.array((EASTING, NORTHING, 800))


def dipping(dip, azimuth, n=60, seed=1):
    """Points of a plane that dips by ``dip`` towards ``azimuth`` (from north), with its upward normal."""
    a, d = np.radians(azimuth), np.radians(dip)
    down = np.array([np.sin(a) * np.cos(d), np.cos(a) * np.cos(d), -np.sin(d)])
    strike = np.array([np.cos(a), -np.sin(a), 0.0])
    s, t = np.random.default_rng(seed).uniform(-300, 300, (2, n))
    xyz = s[:, None] * strike + t[:, None] * down + (EASTING, NORTHING, 700)
    return PointSet(xyz), np.cross(strike, -down) * np.sign(np.cross(strike, -down)[2])


def sections(azimuth, k=5, n=12, wander=0.0, seed=2):
    """Parallel section lines along ``azimuth`` (radians from east), 80 m apart."""
    rng = np.random.default_rng(seed)
    along = np.array([np.cos(azimuth), np.sin(azimuth)])
    across = np.array([-along[1], along[0]])
    lines = [
        np.linspace(0, 600, n)[:, None] * along + (80.0 * i + rng.normal(0, wander, n)[:, None]) * across
        for i in range(k)
    ]
    plan = np.concatenate(lines) + np.array((EASTING, NORTHING))
    names = np.repeat([f"S{i}" for i in range(k)], n)
    return PointSet(np.column_stack([plan, np.full(len(plan), 900.0)]), section=names)


def azimuth_of(points):
    return section_azimuth(points.xyz[:, :2], points.section)


def apart(a, b):
    """The angle between two axes, radians."""
    return abs((a - b + np.pi / 2) % np.pi - np.pi / 2)


@settings(deadline=None, derandomize=True, max_examples=50)
@given(st.one_of(st.none(), angles))
def test_a_map_frame_is_right_handed_and_takes_points_there_and_back(along):
    points = PointSet(cloud())
    frame = map_frame(points, along)
    np.testing.assert_allclose(frame.axes @ frame.axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(frame.axes) == pytest.approx(1)
    np.testing.assert_array_equal(frame.axes[2], [0, 0, 1])
    local = frame.to_local(points.xyz)
    np.testing.assert_allclose(frame.turn_back(local) + frame.origin, points.xyz, atol=1e-9)
    np.testing.assert_allclose(frame.plan(points.xyz[:, :2]), local[:, :2], atol=1e-9)


@settings(deadline=None, derandomize=True, max_examples=50)
@given(angles)
def test_v_runs_along_the_direction_that_was_asked_for(along):
    axes = map_frame(PointSet(cloud()), along).axes
    assert apart(np.arctan2(axes[1, 1], axes[1, 0]), along) < 1e-9
    assert axes[1, 1] >= -1e-9


def test_without_a_direction_the_axes_are_east_and_north():
    np.testing.assert_array_equal(map_frame(PointSet(cloud())).axes, np.eye(3))


def test_the_origin_is_near_the_points_in_whole_metres():
    points = PointSet(cloud())
    for frame in (map_frame(points), best_plane_frame(points)):
        np.testing.assert_array_equal(frame.origin, np.round(frame.origin))
        assert np.abs(frame.to_local(points.xyz)).max() < 1000


@pytest.mark.parametrize("azimuth", [0, 12, 45, 89, 90, 91, 137, 179])
def test_the_sections_direction_is_found_however_the_site_is_turned(azimuth):
    found = azimuth_of(sections(np.radians(azimuth), wander=1.0))
    assert found is not None
    assert np.degrees(apart(found, np.radians(azimuth))) < 0.5


def test_a_section_counts_whichever_way_it_was_drawn():
    points = sections(np.radians(30))
    index = np.arange(len(points))
    index[12:24] = index[12:24][::-1]
    assert apart(azimuth_of(points[index]), np.radians(30)) < 1e-9


def test_most_sections_decide():
    most, one = sections(np.radians(90), k=6), sections(0.0, k=1).with_(section="cross")
    found = azimuth_of(PointSet.concatenate([most, one]))
    assert np.degrees(apart(found, np.pi / 2)) < 1


@pytest.mark.parametrize(
    "points",
    [
        PointSet(cloud()),
        sections(0.4)[np.arange(0, 60, 12)],
        PointSet(cloud(), section="a cloud, no line"),
        PointSet.concatenate([sections(a, k=1).with_(section=f"S{a}") for a in np.radians([0, 60, 120])]),
    ],
    ids=["no sections", "single points", "no lines", "every way"],
)
def test_no_common_direction_is_none(points):
    assert azimuth_of(points) is None


@pytest.mark.parametrize("dip", [0, 5, 35, 72, 89])
@pytest.mark.parametrize("azimuth", [0, 90, 215])
def test_the_best_plane_of_a_plane_is_that_plane(dip, azimuth):
    points, normal = dipping(dip, azimuth)
    frame = best_plane_frame(points)
    assert frame.kind == "best-plane"
    np.testing.assert_allclose(frame.axes @ frame.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame.axes) == pytest.approx(1)
    np.testing.assert_allclose(frame.axes[2], normal, atol=1e-9)
    local = frame.to_local(points.xyz)
    assert np.ptp(local[:, 2]) < 1e-8
    np.testing.assert_allclose(frame.turn_back(local) + frame.origin, points.xyz, atol=1e-8)
    assert frame.axes[0, 2] == pytest.approx(0, abs=1e-9)
    assert frame.axes[1, 2] >= -1e-9


def test_a_vertical_plane_has_a_frame_too():
    points, _ = dipping(90, 120)
    frame = best_plane_frame(points)
    assert np.ptp(frame.to_local(points.xyz)[:, 2]) < 1e-8
    assert np.isfinite(frame.axes).all()
    assert abs(frame.axes[1, 2]) == pytest.approx(1)


def test_three_points_have_a_best_plane_frame():
    frame = best_plane_frame(PointSet(cloud(3)))
    assert np.ptp(frame.to_local(cloud(3))[:, 2]) < 1e-8
    np.testing.assert_allclose(frame.axes @ frame.axes.T, np.eye(3), atol=1e-12)
