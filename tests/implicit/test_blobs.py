"""Potentials, metaballs and convolution (T6-T9, T15)."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

import geofit.implicit as implicit
from geofit.data.errors import SettingsError
from geofit.implicit.convolution import WIDTH, kernel_integral


@pytest.mark.parametrize("name", implicit.POTENTIALS)
def test_integral_of_a_potential_is_that_of_the_table(name: str) -> None:
    kernel = implicit.potential(name)
    ends = (0, 1 / 3, 1.0) if name != "blinn" else (0, 1.0, 2.0, 4.0, 8.0)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    total = 0.0
    for a, b in pairwise(ends):
        r = (a + b) / 2 + (b - a) / 2 * nodes
        total += (b - a) / 2 * float((weights * 4 * math.pi * r**2 * kernel.value(r**2)).sum())
    assert total == pytest.approx(kernel.integral, rel=1e-12)


def test_slopes_at_the_rim_and_where_pieces_meet() -> None:
    rim = np.array([1 - 1e-12])

    def radial(kernel: implicit.Potential, q: float) -> float:
        """Second derivative along r for R = 1."""
        return float(2 * kernel.slope(q) + 4 * q * kernel.bend(q))

    for name in ("smooth", "wyvill", "murakami", "nishimura"):
        kernel = implicit.potential(name)
        assert float(kernel.value(0.0)) == 1.0
        assert abs(float(kernel.value(rim)[0])) < 1e-11
        assert abs(float(kernel.slope(rim)[0])) < 1e-11
    assert radial(implicit.potential("murakami"), 1.0) == pytest.approx(8.0, abs=1e-12)
    assert radial(implicit.potential("wyvill"), 1.0 - 1e-13) == pytest.approx(40 / 9, abs=1e-11)
    assert radial(implicit.potential("smooth"), 1.0 - 1e-13) == pytest.approx(0.0, abs=1e-11)
    # The third derivative of (1 - r^2)^3 at r = 1 is -48.
    h = 1e-5
    assert radial(implicit.potential("smooth"), (1 - h) ** 2) / h == pytest.approx(48, rel=1e-3)
    assert float(implicit.potential("wyvill").value(0.25)) == pytest.approx(0.5, abs=1e-15)
    nishimura = implicit.potential("nishimura")
    for f in (nishimura.value, nishimura.slope):
        assert float(f(1 / 9 - 1e-14)) == pytest.approx(float(f(1 / 9 + 1e-14)), abs=1e-12)


@pytest.mark.parametrize("name", implicit.POTENTIALS)
@pytest.mark.parametrize("ratio", [0.05, 0.42, 0.7, 0.99])
def test_lone_iso_radius_and_steepest_slope(name: str, ratio: float) -> None:
    kernel = implicit.potential(name)
    assert float(kernel.value(kernel.iso_radius(ratio) ** 2)) == pytest.approx(ratio, abs=1e-13)
    r = np.linspace(0, 3, 30001)
    assert np.abs(2 * r * kernel.slope(r**2)).max() == pytest.approx(kernel.steepest, rel=1e-4)


def test_bezier_ordinates_of_wyvill_along_a_ray_are_those_of_nishita() -> None:
    # f(r) for r in 0..1 as polynomial of degree 6: power to Bernstein basis.
    power = np.array([1, 0, -22 / 9, 0, 17 / 9, 0, -4 / 9])
    bezier = [sum(math.comb(i, j) / math.comb(6, j) * power[j] for j in range(i + 1)) for i in range(7)]
    np.testing.assert_allclose(bezier, [1, 1, 113 / 135, 23 / 45, 4 / 27, 0, 0], atol=1e-12)
    r = np.linspace(0, 1, 50)[:-1]
    bernstein = sum(b * math.comb(6, i) * r**i * (1 - r) ** (6 - i) for i, b in enumerate(bezier))
    np.testing.assert_allclose(implicit.potential("wyvill").value(r**2), bernstein, atol=1e-12)


def test_rays_through_a_ball_lose_no_root() -> None:
    rng = np.random.default_rng(1)
    ball = implicit.spherical_metaballs([[0, 0, 0]], 1.0, kernel="wyvill")
    n, radius = 100_000, ball.kernel.iso_radius(0.5)
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    start = 3 * rng.normal(size=(n, 3)) / 2
    start *= (3 / np.linalg.norm(start, axis=1))[:, None]
    aim = rng.uniform(-0.9, 0.9, (n, 3))
    direction = (aim - start) / np.linalg.norm(aim - start, axis=1)[:, None]
    b, c = (start * direction).sum(axis=1), 9 - radius**2
    disc = b * b - c
    hit = implicit.first_hits(ball, start, direction, length=9.0)
    depth = radius - np.sqrt(np.maximum(radius**2 - disc, 0))
    deep = disc > 1e-6
    np.testing.assert_allclose(hit.depth[deep], (-b - np.sqrt(np.maximum(disc, 0)))[deep], atol=1e-6)
    assert np.isnan(hit.depth[disc < -1e-9]).all()
    assert depth.shape == (n,)


def brute(body: implicit.Metaballs, xyz: np.ndarray) -> np.ndarray:
    total = np.zeros(len(xyz))
    for centre, shape, density in zip(body.centres, body.shapes, body.densities, strict=True):
        q = (((xyz - centre) @ shape.T) ** 2).sum(axis=1)
        total += density * body.kernel.value(q)
    return (body.threshold - total) / body.slope_scale


@pytest.mark.parametrize("name", implicit.POTENTIALS)
def test_compiled_sums_are_those_of_numpy(name: str) -> None:
    rng = np.random.default_rng(2)
    n = 60
    shapes = np.eye(3) / rng.uniform(0.3, 1, n)[:, None, None] + rng.uniform(-0.3, 0.3, (n, 3, 3))
    body = implicit.Metaballs(
        rng.uniform(-3, 3, (n, 3)), shapes, rng.uniform(-0.5, 2, n), implicit.potential(name), threshold=0.4
    )
    xyz = rng.uniform(-5, 5, (20000, 3))
    cut = 1e-5 if name == "blinn" else 1e-12
    np.testing.assert_allclose(body.value(xyz), brute(body, xyz), atol=cut)


@pytest.mark.parametrize(
    ("kernel", "threshold", "density", "distance"),
    [("blinn", 1.0, math.e, 2.602420), ("smooth", 0.5, 1.0, 1.216617)],
)
def test_two_balls_fuse_at_their_distance(kernel: str, threshold: float, density: float, distance: float) -> None:
    def components(d: float) -> int:
        body = implicit.spherical_metaballs(
            [[-d / 2, 0, 0], [d / 2, 0, 0]], 1.0, density, kernel=kernel, threshold=threshold
        )
        # A node at the middle, where they touch first.
        lattice = implicit.Lattice([-2.6, -1.2, -1.2], 0.1, (53, 25, 25))
        return implicit.isosurface(body, lattice).components

    low, high = 0.9 * distance, 1.1 * distance
    assert (components(low), components(high)) == (1, 2)
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (middle, high) if components(middle) == 1 else (low, middle)
    assert (low + high) / 2 == pytest.approx(distance, abs=1.5e-3)


def test_a_negative_ball_makes_a_hollow() -> None:
    body = implicit.spherical_metaballs([[0, 0, 0], [0, 0, 0]], [2.0, 1.0], [2.0, -2.5])
    mesh = implicit.isosurface(body, implicit.Lattice.around([-2] * 3, [2] * 3, cells=48))
    assert mesh.components == 2
    assert mesh.euler == 4
    assert body.value(np.zeros((1, 3)))[0] > 0


def test_balls_without_a_surface_are_refused() -> None:
    with pytest.raises(SettingsError, match="empty"):
        implicit.spherical_metaballs([[0, 0, 0]], 1.0, 0.3)
    with pytest.raises(SettingsError, match="choose one of"):
        implicit.spherical_metaballs([[0, 0, 0]], 1.0, kernel="gauss")


RADIAL = {
    "compact": lambda r2, w: np.maximum(1 - r2 / w**2, 0.0) ** 3,
    "gauss": lambda r2, w: np.exp(-r2 / w**2),
    "cauchy": lambda r2, w: (1 + r2 / w**2) ** -2,
}


@pytest.mark.parametrize("kernel", RADIAL)
def test_closed_integrals_are_those_of_quadrature(kernel: str) -> None:
    rng = np.random.default_rng(3)
    n = 1000
    length, width = rng.uniform(0.1, 3, n), rng.uniform(0.4, 1.5, n)
    x, rho = rng.uniform(-1, 4, n), rng.uniform(0, 2, n)
    value, by_x, by_rho2 = kernel_integral(kernel, x, length, rho**2, width)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    half = np.sqrt(np.maximum(width**2 - rho**2, 0)) if kernel == "compact" else np.full(n, np.inf)
    low, high = np.maximum(0, x - half), np.minimum(length, x + half)
    high = np.maximum(low, high)
    pieces = 8
    truth = np.zeros(n)
    for p in range(pieces):
        a, b = low + (high - low) * p / pieces, low + (high - low) * (p + 1) / pieces
        t = (a + b) / 2 + (b - a) / 2 * nodes[:, None]
        r2 = rho**2 + (t - x) ** 2
        f = {
            "compact": lambda q: np.maximum(1 - q, 0) ** 3,
            "gauss": lambda q: np.exp(-q),
            "cauchy": lambda q: (1 + q) ** -2.0,
        }
        truth += (b - a) / 2 * (weights[:, None] * f[kernel](r2 / width**2)).sum(axis=0)
    some = truth > 1e-12
    assert np.abs(value[some] / truth[some] - 1).max() < 1e-12
    i = int(np.argmax(truth))
    assert quad(lambda t: RADIAL[kernel](rho[i] ** 2 + (t - x[i]) ** 2, width[i]), 0, length[i])[0] == pytest.approx(
        truth[i]
    )
    eps = 1e-5
    for step, slope in (((eps, 0), by_x), ((0, eps), by_rho2)):
        ahead = kernel_integral(kernel, x + step[0], length, rho**2 + step[1] + eps, width)[0]
        back = kernel_integral(kernel, x - step[0], length, rho**2 - step[1] + eps, width)[0]
        centre = kernel_integral(kernel, x, length, rho**2 + eps, width)[1 if step[0] else 2]
        # The compact kernel of a line has a third derivative that jumps at its rim.
        assert np.abs((ahead - back) / (2 * eps) - centre).max() < 1e-7
        assert np.isfinite(slope).all()


@pytest.mark.parametrize("kernel", WIDTH)
def test_a_segment_cut_in_two_is_the_whole(kernel: str) -> None:
    rng = np.random.default_rng(4)
    a, b = np.array([0.1, 0.2, -0.3]), np.array([2.0, 1.0, 0.5])
    middle = a + 0.37 * (b - a)
    whole = implicit.Convolution([[a, b]], 0.4, kernel)
    halves = implicit.Convolution([[a, middle], [middle, b]], 0.4, kernel)
    xyz = rng.uniform(-1, 3, (1000, 3))
    np.testing.assert_allclose(halves.value(xyz), whole.value(xyz), atol=1e-13)


@pytest.mark.parametrize("kernel", WIDTH)
def test_a_long_segment_has_its_radius_also_at_a_joint(kernel: str) -> None:
    radius, half = 0.3, 600.0 if kernel == "cauchy" else 6.0
    line = implicit.Convolution([[[-half, 0, 0], [0, 0, 0]], [[0, 0, 0], [half, 0, 0]]], radius, kernel)
    x = np.linspace(-1, 1, 41)
    xyz = np.stack([x, np.full(41, radius), 0 * x], axis=1)
    # A Cauchy line of finite length is a little thinner than an infinite one, everywhere alike.
    value = line.value(xyz)
    assert np.ptp(value) <= 1e-9 * radius
    assert np.abs(value).max() < (1e-6 if kernel == "cauchy" else 1e-9)


def test_bulge_at_a_joint_is_smaller_than_that_of_a_distance_surface() -> None:
    def bulge(field: implicit.Field, reach: float) -> float:
        """How much farther out the surface is over the outer corner of the blended joint than along a branch."""
        t = np.linspace(0, reach, 4001)[:, None]
        outward = np.array([[-1.0, 0, 0]])
        inside = t[field.value(t * outward) < 0]
        return float(inside.max())

    angle, r = math.radians(30), 0.2
    arms = [[math.cos(a), math.sin(a), 0] for a in (angle, -angle)]
    segments = [[[0, 0, 0], [3 * v for v in arm]] for arm in arms]
    blended = implicit.smooth_union(implicit.RoundCones(segments[0], r), implicit.RoundCones(segments[1], r), 0.5)
    convolved = implicit.Convolution(segments, r)
    assert max(bulge(convolved, 1.0) - r, 0) * 5 <= bulge(blended, 1.0) - r
