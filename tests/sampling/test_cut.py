"""Sections and contours against surfaces whose every elevation is known."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused
from surfaces import ORIGIN, fold, height_field, horizon, lifted, nine

from geofit.data.errors import SettingsError
from geofit.sampling.contours import contours, interval_for
from geofit.sampling.cut import cut_section
from geofit.sampling.isolines import level_lines, plane_lines

TOLERANCE = 0.05


def between(line, count=7):
    """Places along the straight pieces of a line."""
    t = np.linspace(0, 1, count)[:, None, None]
    return (line[:-1] + t * (line[1:] - line[:-1])).reshape(-1, line.shape[1])


def test_a_section_with_a_bend_through_nine_patches():
    surface = horizon(nine()[1])
    corners = np.array([[-50, 30], [420, 333.3], [990, 120]]) + ORIGIN[:2]
    (line,) = cut_section(surface, corners, tolerance=TOLERANCE)
    legs = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    # It enters at x = 0 and ends inside.
    assert line.distance[0] == pytest.approx(legs[0] * 50 / 470, abs=1e-6)
    assert line.distance[-1] == pytest.approx(legs.sum(), abs=1e-6)
    assert (np.diff(line.distance) > 0).all()
    x = np.interp(line.distance, np.append(0, np.cumsum(legs)), corners[:, 0])
    y = np.interp(line.distance, np.append(0, np.cumsum(legs)), corners[:, 1])
    assert np.abs(line.xyz[:, :2] - np.column_stack([x, y])).max() < 1e-6
    assert np.abs(line.xyz[:, 2] - surface.elevation(x, y)).max() < 1e-8
    chords = between(line.xyz)
    assert np.abs(surface.distance(chords)).max() <= TOLERANCE


def test_a_section_through_an_overturned_fold_is_one_line_that_turns_back():
    surface = horizon([fold()])
    corners = np.array([[-100, 140], [400, 160]]) + ORIGIN[:2]
    (line,) = cut_section(surface, corners, tolerance=TOLERANCE)
    assert (np.diff(line.distance) < 0).any()
    assert np.abs(surface.distance(line.xyz)).max() < 1e-8
    assert np.abs(surface.distance(between(line.xyz))).max() <= TOLERANCE
    # Truth: the control net is fine, so compare with the patch itself on the curtain.
    patch = surface.patches[0]
    u, v = np.meshgrid(np.linspace(0, 1, 401), np.linspace(0, 300, 601), indexing="ij")
    s = patch.evaluate(u, v)
    on = np.abs(s[..., 1] - (140 + 20 * (s[..., 0] + 100) / 500)).argmin(axis=1)
    truth = s[np.arange(401), on]
    chain = between(line.xyz - ORIGIN, 40)
    nearest = np.min(np.linalg.norm(truth[:, None, ::2] - chain[None, :, ::2], axis=2), axis=1)
    assert nearest.max() < 1.0


def test_a_section_that_ends_inside_a_fold_and_one_beside_it():
    surface = horizon([fold()])
    lines = cut_section(surface, np.array([[60, 150], [80, 150]]) + ORIGIN[:2], tolerance=TOLERANCE)
    assert len(lines) == 3  # three limbs over 20 m
    for line in lines:
        assert line.distance[[0, -1]] == pytest.approx((0, 20), abs=1e-6)
        assert np.abs(surface.distance(line.xyz)).max() < 1e-8
    assert cut_section(surface, np.array([[0, 1000], [100, 1000]]) + ORIGIN[:2]) == []


def test_a_section_respects_the_outline():
    surface = horizon([height_field()], outline=[[100, 100], [600, 100], [600, 300], [300, 200], [100, 300]])
    lines = cut_section(surface, np.array([[0, 250], [900, 250]]) + ORIGIN[:2], tolerance=TOLERANCE)
    # y = 250 leaves the notch of the outline: 100..200 and 450..600.
    ends = [tuple(line.distance[[0, -1]]) for line in lines]
    assert np.array(ends) == pytest.approx(np.array([(100, 200), (450, 600)]), abs=1e-4)


def test_a_steep_surface_is_cut():
    """A plane of 85 degrees: x = x0 + z / tan(85)."""
    slope = np.tan(np.radians(85))
    steep = height_field(nu=8, nv=8, size=(20.0, 700.0), z=lambda x, y: slope * x)
    surface = horizon([steep])
    (line,) = cut_section(surface, np.array([[-10, 300], [40, 350]]) + ORIGIN[:2])
    local = line.xyz - ORIGIN
    assert np.abs(local[:, 2] - slope * local[:, 0]).max() < 1e-6
    assert np.ptp(local[:, 0]) == pytest.approx(20, abs=1e-6)


def test_contours_of_a_dome_are_circles():
    """A paraboloid is in the spline space: its contours are circles of known radius."""
    dome = height_field(nu=12, nv=12, degree=2, size=(200.0, 200.0))
    x, y = dome.control[..., 0], dome.control[..., 1]

    # Control heights of z = -(x - 100)^2 / 100 from the blossom at consecutive knots.
    def squares(knots):
        a, b = knots[1:-2], knots[2:-1]
        return (a - 100) * (b - 100)

    dome = lifted(dome, -(squares(dome.knots_u)[:, None] + squares(dome.knots_v)[None, :]) / 100)
    surface = horizon([dome])
    assert surface.elevation(*(ORIGIN[:2] + 130)) == pytest.approx(ORIGIN[2] - 18)
    assert x.shape == y.shape
    lines = contours(surface, 20.0, tolerance=TOLERANCE)
    low = [line for line in lines if line.closed and ORIGIN[2] - line.elevation < 100]
    # At 0 the level only touches the top: no line, or one without length.
    assert {line.elevation for line in low} >= {ORIGIN[2] - 20 * k for k in (1, 2, 3, 4)}
    for line in low:
        radius = np.linalg.norm(line.line - ORIGIN[:2] - 100, axis=1)
        assert np.abs(radius - np.sqrt(100 * (ORIGIN[2] - line.elevation))).max() < 1e-6


def test_contours_of_nine_patches_run_through_the_seams():
    whole, parts = nine()
    one, many = contours(horizon([whole]), 10.0, tolerance=0.2), contours(horizon(parts), 10.0, tolerance=0.2)
    assert len(one) == len(many)
    surface = horizon(parts)
    for line in many:
        z = surface.elevation(*line.line.T)
        assert np.abs(z[np.isfinite(z)] - line.elevation).max() < 1e-6
    assert [line.elevation for line in many] == sorted(line.elevation for line in many)


@pytest.mark.parametrize(("span", "expected"), [(1.0, 0.1), (24.0, 1.0), (180.0, 10.0), (0.0, 1e-7)])
def test_interval(span, expected):
    assert interval_for(100.0, 100.0 + span) == pytest.approx(expected)


def test_refuses_what_makes_no_section_or_too_many_contours():
    surface = horizon([height_field()])
    with refused(SettingsError, "sampling.section-line-one-point"):
        cut_section(surface, [[0, 0], [0, 0]])
    with refused(SettingsError, "sampling.section-line-wrong-shape"):
        cut_section(surface, [0, 0, 1, 1])
    with refused(SettingsError, "data.contour-interval-not-positive"):
        contours(surface, -1)
    with refused(SettingsError, "sampling.too-many-contours"):
        contours(surface, 1e-4)


def test_planes_that_are_cut_together_give_the_lines_of_each_one_alone():
    surface = horizon(nine()[1])
    mesh, up = surface.triangulate(TOLERANCE), np.array([0.0, 0.0, 1.0])
    heights = [float(h) for h in np.linspace(mesh.points[:, 2].min() - 1, mesh.points[:, 2].max() + 1, 9)]
    together = level_lines(surface, mesh, up, heights)
    assert not together[0]
    assert not together[-1]
    for height, lines in zip(heights, together, strict=True):
        alone = plane_lines(surface, mesh, up, height)
        assert len(lines) == len(alone)
        for line, other in zip(lines, alone, strict=True):
            np.testing.assert_allclose(line, other, atol=1e-9)
