"""Quadrics, distance surfaces and CSG against closed forms and brute force (T4, T5)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import geofit.implicit as implicit
from geofit.data.errors import FitError, SettingsError

KINDS = {
    "ellipsoid": [1, 0, 0, 0, 2, 0, 0, 3, 0, -1],
    "imaginary ellipsoid": [1, 0, 0, 0, 2, 0, 0, 3, 0, 1],
    "hyperboloid of one sheet": [1, 0, 0, 0, 2, 0, 0, -3, 0, -1],
    "hyperboloid of two sheets": [1, 0, 0, 0, 2, 0, 0, -3, 0, 1],
    "cone": [1, 0, 0, 0, 2, 0, 0, -3, 0, 0],
    "imaginary cone": [1, 0, 0, 0, 2, 0, 0, 3, 0, 0],
    "elliptic paraboloid": [1, 0, 0, 0, 2, 0, 0, 0, -0.5, 0],
    "hyperbolic paraboloid": [1, 0, 0, 0, -2, 0, 0, 0, -0.5, 0],
    "elliptic cylinder": [1, 0, 0, 0, 2, 0, 0, 0, 0, -1],
    "imaginary elliptic cylinder": [1, 0, 0, 0, 2, 0, 0, 0, 0, 1],
    "hyperbolic cylinder": [1, 0, 0, 0, -2, 0, 0, 0, 0, -1],
    "intersecting planes": [1, 0, 0, 0, -2, 0, 0, 0, 0, 0],
    "imaginary intersecting planes": [1, 0, 0, 0, 2, 0, 0, 0, 0, 0],
    "parabolic cylinder": [1, 0, 0, 0, 0, 0, -0.5, 0, 0, 0],
    "parallel planes": [1, 0, 0, 0, 0, 0, 0, 0, 0, -1],
    "imaginary parallel planes": [1, 0, 0, 0, 0, 0, 0, 0, 0, 1],
    "coincident planes": [1, 0, 0, 0, 0, 0, 0, 0, 0, 0],
}


def rotation(rng: np.random.Generator) -> np.ndarray:
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_the_17_types_in_any_position_scale_and_sign(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    move = np.eye(4)
    move[:3, :3] = rotation(rng) * rng.uniform(0.2, 5)
    move[:3, 3] = rng.uniform(-3, 3, 3)
    sign = rng.choice([-1, 1]) * rng.uniform(0.1, 50)
    assert implicit.Quadric(sign * move.T @ implicit.quadric_from_coefficients(KINDS[kind]).matrix @ move).kind == kind


def test_ellipsoid_is_fitted_to_points_on_it_and_to_noisy_ones() -> None:
    rng = np.random.default_rng(3)
    axes, turn, centre = np.array([3.0, 2, 1]), rotation(rng), np.array([10.0, -4, 2])
    u = rng.normal(size=(400, 3))
    xyz = (u / np.linalg.norm(u, axis=1)[:, None] * axes) @ turn.T + centre
    found, truth = implicit.fit_quadric(xyz), implicit.ellipsoid(centre, axes, turn)
    assert found.kind == "ellipsoid"
    np.testing.assert_allclose(
        found.matrix / found.matrix[0, 0], truth.matrix / truth.matrix[0, 0], rtol=1e-8, atol=1e-8
    )
    noisy = implicit.fit_quadric(xyz + rng.normal(0, 0.01, xyz.shape))
    np.testing.assert_allclose(noisy.bounds, truth.bounds, atol=0.02)


def test_points_that_do_not_fix_a_quadric_are_refused() -> None:
    rng = np.random.default_rng(4)
    with pytest.raises(FitError, match="9 or more"):
        implicit.fit_quadric(rng.normal(size=(8, 3)))
    with pytest.raises(FitError, match="more than one quadric"):
        implicit.fit_quadric(np.append(rng.normal(size=(50, 2)), np.zeros((50, 1)), axis=1))
    with pytest.raises(SettingsError, match="half lengths"):
        implicit.ellipsoid([0, 0, 0], [1, 1, 0])


def test_round_cone_is_the_distance_to_the_balls_between_its_ends() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        a, b = rng.uniform(-1, 1, (2, 3))
        r0, r1 = rng.uniform(0.1, 1.0, 2)
        t = np.linspace(0, 1, 20001)
        xyz = rng.uniform(-3, 3, (20, 3))
        balls = a + t[:, None] * (b - a)
        brute = (np.linalg.norm(xyz[:, None] - balls, axis=2) - (r0 + t * (r1 - r0))).min(axis=1)
        np.testing.assert_allclose(implicit.RoundCones([a, b], [r0, r1]).value(xyz), brute, atol=2e-7)


def test_a_chain_of_cones_is_the_nearest_of_them() -> None:
    rng = np.random.default_rng(6)
    line, radii = rng.uniform(-2, 2, (9, 3)), rng.uniform(0.1, 0.5, 9)
    xyz = rng.uniform(-3, 3, (500, 3))
    single = [implicit.RoundCones(line[i : i + 2], radii[i : i + 2]).value(xyz) for i in range(8)]
    np.testing.assert_array_equal(implicit.RoundCones(line, radii).value(xyz), np.min(single, axis=0))


def test_curve_tube_is_the_distance_to_a_dense_curve() -> None:
    s = np.linspace(0, 6, 13)
    helix = np.stack([np.cos(s), np.sin(s), 0.4 * s], axis=1)
    tube = implicit.CurveTube(helix, 0.2)
    dense = tube.curve(np.linspace(0, tube.curve.x[-1], 40001))
    xyz = np.random.default_rng(7).uniform(-2, 3, (300, 3))
    brute = np.array([np.linalg.norm(dense - p, axis=1).min() for p in xyz]) - 0.2
    np.testing.assert_allclose(tube.value(xyz), brute, atol=1e-6)


def test_lens_steinmetz_and_difference_have_their_volumes() -> None:
    a, b = implicit.Sphere([-0.6, 0, 0], 1.0), implicit.Sphere([0.6, 0, 0], 1.0)
    lattice = implicit.Lattice.around([-1.7, -1.1, -1.1], [1.7, 1.1, 1.1], cells=96)
    values = {
        name: implicit.extent_of_samples(implicit.sample(body, lattice), lattice).volume
        for name, body in {
            "a": a, "b": b, "or": implicit.union(a, b), "and": implicit.intersection(a, b),
            "minus": implicit.difference(a, b),
        }.items()
    }  # fmt: skip
    # Samples that are linear in a cell cut the crease off: of both sides of the sum alike, to second order.
    assert values["a"] + values["b"] == pytest.approx(values["or"] + values["and"], rel=2e-4)
    lens = implicit.isosurface(
        implicit.intersection(a, b), implicit.Lattice.around([-0.5, -1, -1], [0.5, 1, 1], cells=96)
    )
    assert lens.volume == pytest.approx(0.871268363, rel=1e-3)
    whole = implicit.isosurface(implicit.difference(a, b), lattice)
    assert whole.volume == pytest.approx(4 / 3 * math.pi - 0.871268363, rel=1e-3)
    assert whole.is_closed
    tube = implicit.intersection(
        implicit.Cylinder([0, 0, 0], [1, 0, 0], 1.0), implicit.Cylinder([0, 0, 0], [0, 1, 0], 1.0)
    )
    steinmetz = implicit.isosurface(tube, implicit.Lattice.around([-1.05] * 3, [1.05] * 3, cells=96))
    assert steinmetz.volume == pytest.approx(16 / 3, rel=1e-3)
    assert steinmetz.area == pytest.approx(16.0, rel=3e-3)
    assert steinmetz.is_closed


def test_inside_and_outside_add_up_by_count_of_cells() -> None:
    a, b = implicit.Sphere([-0.6, 0, 0], 1.0), implicit.Sphere([0.6, 0, 0], 1.0)
    xyz = implicit.Lattice.around([-1.7, -1.1, -1.1], [1.7, 1.1, 1.1], cells=60).nodes()
    inside = [(f.value(xyz) < 0).sum() for f in (a, b, implicit.union(a, b), implicit.intersection(a, b))]
    assert inside[0] + inside[1] == inside[2] + inside[3]
    assert ((implicit.complement(a).value(xyz) < 0) == (a.value(xyz) > 0)).all()


@settings(max_examples=40, deadline=None)
@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.05, 0.8))
def test_blends_only_add_to_unions_and_only_take_from_intersections(x: float, y: float, radius: float) -> None:
    a, b = implicit.Sphere([0, 0, 0], 0.7), implicit.Sphere([x, y, 0.3], 0.5)
    xyz = np.random.default_rng(8).uniform(-1.5, 1.5, (200, 3))
    assert (implicit.smooth_union(a, b, radius).value(xyz) <= implicit.union(a, b).value(xyz)).all()
    assert (implicit.smooth_intersection(a, b, radius).value(xyz) >= implicit.intersection(a, b).value(xyz)).all()
    same_sign = np.sign(implicit.r_union(a, b).value(xyz)) == np.sign(implicit.union(a, b).value(xyz))
    assert same_sign.all()


def test_smooth_union_is_c2_where_sharp_ones_break() -> None:
    a, b = implicit.Plane([0, 0, 0], [1, 0, 0]), implicit.Plane([0, 0, 0], [0, 1, 0])
    blend = implicit.smooth_union(a, b, 0.4)
    t = np.linspace(-1, 1, 2001)
    value = blend.value(np.stack([t, -t, 0 * t], axis=1))
    second = np.diff(value, 2) / (t[1] - t[0]) ** 2
    # f - g = 2t: a jump of the second derivative would not shrink with the step.
    assert np.abs(np.diff(second)).max() < 0.1
    sharp = implicit.union(a, b).value(np.stack([t, -t, 0 * t], axis=1))
    assert np.abs(np.diff(np.diff(sharp, 2) / (t[1] - t[0]) ** 2)).max() > 100


def test_reinitialized_union_has_unit_slope_in_the_band_off_creases() -> None:
    a, b = implicit.Sphere([-0.3, 0, 0], 0.5), implicit.Sphere([0.3, 0, 0], 0.5)
    body = implicit.r_union(a, b)
    lattice = implicit.Lattice.around([-1] * 3, [1] * 3, cells=64)
    distance = implicit.distance_field(body, lattice)
    xyz = np.random.default_rng(9).uniform(-0.9, 0.9, (20000, 3))
    near = (np.abs(distance.value(xyz)) < 2 * lattice.spacing) & (np.abs(xyz[:, 0]) > 5 * lattice.spacing)
    slope = np.linalg.norm(distance.gradient(xyz[near]), axis=1)
    assert np.abs(slope - 1).max() < 0.02
    before = np.linalg.norm(body.gradient(xyz[near]), axis=1)
    assert np.abs(before - 1).max() > 0.1
