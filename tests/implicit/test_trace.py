"""T10: rays and holes against analytic roots; contours of known curves."""

from __future__ import annotations

import math

import numpy as np
import pytest

import geofit.implicit as implicit
from geofit.data.errors import SettingsError


def rays(n: int, seed: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    start = rng.normal(size=(n, 3))
    start *= (3 * size / np.linalg.norm(start, axis=1))[:, None]
    aim = rng.uniform(-size, size, (n, 3)) - start
    return start, aim / np.linalg.norm(aim, axis=1)[:, None]


def test_rays_meet_an_ellipsoid_where_the_quadratic_says() -> None:
    axes = np.array([3.0, 2, 1])
    start, along = rays(100_000, 1, 3.0)
    hits = implicit.first_hits(implicit.ellipsoid([0, 0, 0], axes), start, along, length=20.0)
    p, d = start / axes, along / axes
    a, b, c = (d * d).sum(axis=1), (p * d).sum(axis=1), (p * p).sum(axis=1) - 1
    disc = b * b - a * c
    depth = (-b - np.sqrt(np.maximum(disc, 0))) / a
    # Depth of the chord below the surface, in lengths of the axes.
    deep = disc / a > 2e-6
    assert not np.isnan(hits.depth[deep]).any()
    assert np.abs(hits.depth - depth)[deep].max() < 1e-6
    assert np.isnan(hits.depth[disc < 0]).all()
    assert hits.entering[deep].all()
    np.testing.assert_allclose(np.linalg.norm(hits.normal[deep], axis=1), 1.0)


def test_rays_meet_a_torus_where_the_quartic_says() -> None:
    ring, radius = 1.0, 0.35
    start, along = rays(100_000, 2, 1.4)
    torus = implicit.Torus([0, 0, 0], [0, 0, 1], ring, radius)
    hits = implicit.first_hits(torus, start, along, length=20.0)
    m, n = (start * along).sum(axis=1), (start**2).sum(axis=1) + ring**2 - radius**2
    flat = [(along[:, :2] ** 2).sum(axis=1), (start * along)[:, :2].sum(axis=1), (start[:, :2] ** 2).sum(axis=1)]
    # (t^2 + 2 m t + n)^2 = 4 R^2 (a t^2 + 2 b t + c)
    k = 4 * ring**2
    poly = [4 * m, 4 * m**2 + 2 * n - k * flat[0], 4 * m * n - 2 * k * flat[1], n**2 - k * flat[2]]
    companion = np.zeros((len(m), 4, 4))
    companion[:, [1, 2, 3], [0, 1, 2]] = 1
    companion[:, 0] = -np.stack(poly, axis=1)
    roots = np.linalg.eigvals(companion)
    real = np.abs(roots.imag) < 1e-5
    depth = np.where(real, roots.real, np.inf).min(axis=1)
    # Rays well inside the tube at some point; the others are tangents.
    middle = np.sort(np.where(real, roots.real, np.nan), axis=1)[:, :2].mean(axis=1)
    spot = start + np.nan_to_num(middle)[:, None] * along
    deep = np.isfinite(middle) & (torus.value(spot) < -1e-6)
    assert deep.sum() > 20_000
    assert not np.isnan(hits.depth[deep]).any()
    assert np.abs(hits.depth - depth)[deep].max() < 1e-6
    assert np.isnan(hits.depth[~real.any(axis=1)]).all()


def test_a_planned_hole_enters_and_leaves_a_body_as_often_as_it_does() -> None:
    torus = implicit.Torus([0, 0, -50], [0, 0, 1], 20.0, 5.0)
    through, beside, inside = implicit.hole_crossings(
        torus, [[-40, 0, -50], [40, 0, 0], [20, 0, -50]], [[1, 0, 0], [0, 0, -2], [0, 0, -1]], length=100.0
    )
    assert [c.depth for c in through] == pytest.approx([15, 25, 55, 65], abs=1e-6)
    assert [c.entering for c in through] == [True, False, True, False]
    assert beside == ()
    assert [(c.entering, round(c.depth, 6)) for c in inside] == [(False, 5.0)]


def test_a_hole_through_a_spline_grid_agrees_with_the_body() -> None:
    ball = implicit.Sphere([0, 0, 0], 0.6)
    grid = implicit.spline_of_field(ball, implicit.Lattice.around([-1] * 3, [1] * 3, cells=64))
    start, along = rays(300, 3, 0.4)
    pairs = zip(*(implicit.hole_crossings(f, start, along, length=5.0) for f in (ball, grid)), strict=True)
    for truth, found in pairs:
        assert [c.depth for c in found] == pytest.approx([c.depth for c in truth], abs=1e-5)


def test_unbounded_slopes_and_zero_directions_are_refused() -> None:
    cone = implicit.quadric_from_coefficients([1, 0, 0, 0, 1, 0, 0, -1, 0, 0])
    with pytest.raises(SettingsError, match="Lipschitz"):
        implicit.first_hits(cone, np.zeros((1, 3)), np.ones((1, 3)), length=1.0)
    with pytest.raises(SettingsError, match="direction 0 is zero"):
        implicit.first_hits(implicit.Sphere([0, 0, 0], 1), np.zeros((1, 3)), np.zeros((1, 3)), length=1.0)


def test_contour_of_a_torus_on_an_inclined_plane_is_on_both() -> None:
    torus = implicit.Torus([0, 0, 0], [0, 0, 1], 1.0, 0.3)
    along, up = np.array([1.0, 0, 0.2]), np.array([-0.2, 0, 1.0])
    lines = implicit.field_contours(torus, [-1.5, 0.01, -1.0], along, up, size=(3.2, 2.2), spacing=0.05)
    assert len(lines) == 2
    for line in lines:
        assert line.closed
        assert np.abs(torus.value(line.xyz)).max() < 1e-10
        assert np.abs(line.xyz[:, 1] - 0.01).max() < 1e-12


def test_level_contours_have_the_lengths_of_their_circles_and_open_lines_end_at_the_side() -> None:
    torus = implicit.Torus([0, 0, 0], [0, 0, 1], 1.0, 0.3)
    lines = implicit.field_contours(torus, [-1.5, -1.5, 0], [1, 0, 0], [0, 1, 0], size=(3, 3), spacing=0.02)
    rings = [np.append(line.xyz, line.xyz[:1], axis=0) for line in lines]
    lengths = sorted(float(np.linalg.norm(np.diff(ring, axis=0), axis=1).sum()) for ring in rings)
    assert lengths == pytest.approx([2 * math.pi * 0.7, 2 * math.pi * 1.3], rel=1e-4)
    half = implicit.field_contours(torus, [0, -1.5, 0], [1, 0, 0], [0, 1, 0], size=(3, 3), spacing=0.02)
    assert [line.closed for line in half] == [False, False]
    assert all(np.allclose(line.xyz[[0, -1], 0], 0) for line in half)


def test_saddles_are_joined_through_the_sign_of_their_middle() -> None:
    saddle = implicit.FunctionField(lambda x: x[:, 0] * x[:, 1] - 0.001, lambda x: x[:, [1, 0, 2]])
    lines = implicit.field_contours(saddle, [-1, -1, 0], [1, 0, 0], [0, 1, 0], size=(2, 2), spacing=2 / 7)
    assert len(lines) == 2
    assert all((line.xyz[:, 0] > 0).all() or (line.xyz[:, 0] < 0).all() for line in lines)
