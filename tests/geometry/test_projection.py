from __future__ import annotations

import numpy as np
import pytest
from surfaces import ORIGIN, fold, height_field, horizon, nine, split

from geofit.geometry.elevation import plan_map
from geofit.geometry.projection import project
from geofit.splines.patch import Patch


def scattered(patch, n, spread, seed=0):
    rng = np.random.default_rng(seed)
    u0, u1, v0, v1 = patch.domain
    u, v = rng.uniform(u0, u1, n), rng.uniform(v0, v1, n)
    return patch.evaluate(u, v), patch.normal(u, v), rng.normal(0, spread, n)


def brute_force(patches, xyz, n=400):
    """Upper bound of the distance: the nearest of many places, refined by a shrinking grid."""
    best = np.full(len(xyz), np.inf)
    for patch in patches:
        u0, u1, v0, v1 = patch.domain
        grid_u, grid_v = np.meshgrid(np.linspace(u0, u1, n), np.linspace(v0, v1, n), indexing="ij")
        places = patch.evaluate(grid_u.ravel(), grid_v.ravel())
        for i, point in enumerate(xyz):
            k = np.argmin(((places - point) ** 2).sum(axis=1))
            u, v = grid_u.ravel()[k], grid_v.ravel()[k]
            half_u, half_v = (u1 - u0) / n, (v1 - v0) / n
            for _ in range(60):
                s, t = np.meshgrid(np.linspace(-1, 1, 5) * half_u, np.linspace(-1, 1, 5) * half_v)
                tries = np.clip(u + s.ravel(), u0, u1), np.clip(v + t.ravel(), v0, v1)
                d = np.linalg.norm(patch.evaluate(*tries) - point, axis=1)
                u, v = tries[0][d.argmin()], tries[1][d.argmin()]
                half_u, half_v = 0.7 * half_u, 0.7 * half_v
            best[i] = min(best[i], d.min())
    return best


@pytest.mark.parametrize("spread", [1e-6, 0.1, 10.0])
def test_points_put_along_the_normal_are_that_far_away(spread):
    patch = height_field()
    surface, normal, d = scattered(patch, 2000, spread)
    found = project([patch], surface + normal * d[:, None])
    assert found.converged.all()
    # 10 m is well inside the radius of curvature (some 60 m): no other foot is nearer.
    np.testing.assert_allclose(found.distance, d, atol=1e-9)
    np.testing.assert_allclose(found.foot, surface, atol=1e-6)
    np.testing.assert_allclose(patch.evaluate(found.u, found.v), found.foot, atol=1e-9)


def test_positive_is_above_whichever_way_the_patch_runs():
    patch = height_field()
    turned = Patch("core", (3, 3), patch.knots_u, patch.knots_v, patch.control[::-1])
    x = np.array([[500.0, 300.0, 400.0], [500.0, 300.0, -400.0]])
    for one in (patch, turned):
        assert np.sign(project([one], x).distance).tolist() == [1, -1]


def test_far_points_and_folds_find_the_nearest_of_many_feet():
    rng = np.random.default_rng(1)
    patch = fold()
    low, high = patch.control.min(axis=(0, 1)), patch.control.max(axis=(0, 1))
    xyz = rng.uniform(low - 30, high + 30, (60, 3))
    found = project([patch], xyz)
    np.testing.assert_allclose(np.abs(found.distance), brute_force([patch], xyz), atol=1e-7)


def test_equal_to_opencascade_near_and_far_and_on_folds():
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt

    from geofit.cad.faces import to_geom

    for patch, spread in ((height_field(), 0.2), (height_field(), 30.0), (fold(), 0.2), (fold(), 15.0)):
        surface, normal, d = scattered(patch, 150, spread)
        xyz = surface + normal * d[:, None]
        projector = GeomAPI_ProjectPointOnSurf()
        projector.Init(to_geom(patch), *patch.domain)
        occ = np.full(len(xyz), np.inf)
        for i, point in enumerate(xyz):
            projector.Perform(gp_Pnt(*point))
            if projector.NbPoints():
                occ[i] = projector.LowerDistance()
        ours = np.abs(project([patch], xyz).distance)
        assert (ours <= occ + 1e-9).all()
        # Nearer than OpenCASCADE only where its foot is not the nearest: on the patch's edge.
        inner = project([patch], xyz)
        at_edge = np.isin(inner.u, patch.domain[:2]) | np.isin(inner.v, patch.domain[2:])
        np.testing.assert_allclose(ours[~at_edge], occ[~at_edge], atol=1e-9)
        assert at_edge.mean() < 0.3


def test_rational_cylinder():
    """A quarter cylinder of radius 100 m: distances are known in closed form."""
    w = np.sqrt(0.5)
    arc = np.array([[100, 0], [100, 100], [0, 100]])
    control = np.stack([np.column_stack([arc[:, 0], np.full(3, y), arc[:, 1]]) for y in (0.0, 50.0)], axis=1)
    weights = np.tile(np.array([[1], [w], [1]]), (1, 2))
    ku, kv = np.array([0, 0, 0, 1, 1, 1.0]), np.array([0, 0, 1, 1.0])
    patch = Patch("cylinder", (2, 1), ku, kv, control.astype(float), weights)
    rng = np.random.default_rng(2)
    angle, r, y = rng.uniform(0, np.pi / 2, 500), rng.uniform(20, 300, 500), rng.uniform(0, 50, 500)
    xyz = np.column_stack([r * np.cos(angle), y, r * np.sin(angle)])
    np.testing.assert_allclose(project([patch], xyz).distance, r - 100, atol=1e-9)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_foot_on_a_crease(degree):
    """A roof: the points above its ridge have their foot on the ridge, a knot of full multiplicity."""
    patch = height_field(13, 13, degree, (120.0, 120.0), multiplicity=degree)
    breaks = np.unique(patch.knots_u)
    ridge = breaks[len(breaks) // 2]
    roof = height_field(13, 13, degree, (120.0, 120.0), degree, lambda x, y: -np.abs(x - ridge) + 0.1 * y)
    y = np.linspace(10, 100, 91)
    xyz = np.column_stack([np.full(91, ridge) + np.linspace(-3, 3, 91), y, 0.1 * y + 20.0])
    found = project([roof], xyz)
    # Nearest place of the ridge line (0, 1, 0.1) / |.|; the normal cone of the ridge holds all these points.
    along = np.array([0, 1, 0.1]) / np.hypot(1, 0.1)
    rel = xyz - [ridge, 0, 0]
    expected = np.linalg.norm(rel - (rel @ along)[:, None] * along, axis=1)
    np.testing.assert_allclose(found.distance, expected, atol=1e-9)
    np.testing.assert_allclose(found.foot[:, 0], ridge, atol=1e-9)
    assert found.converged.all()


def test_valley_crease_does_not_stall_the_walk():
    roof = height_field(13, 13, 3, (120.0, 120.0), 3, lambda x, y: np.abs(x - 60.0) + np.abs(y - 60.0))
    rng = np.random.default_rng(3)
    xyz = np.column_stack([rng.uniform(20, 100, (40, 2)), rng.uniform(-40, 90, 40)])
    np.testing.assert_allclose(np.abs(project([roof], xyz).distance), brute_force([roof], xyz, 200), atol=1e-7)


def test_beside_the_surface_the_foot_is_on_the_edge():
    flat = height_field(z=lambda x, y: 0 * x)
    xyz = np.array([[-30.0, 350.0, 40.0], [1030.0, 740.0, 0.0], [-3.0, -4.0, 12.0]])
    found = project([flat], xyz)
    np.testing.assert_allclose(np.abs(found.distance), [50, 50, 13], atol=1e-9)
    np.testing.assert_allclose(found.foot, [[0, 350, 0], [1000, 700, 0], [0, 0, 0]], atol=1e-9)


def test_patches_together_are_the_whole():
    whole, parts = nine()
    surface, normal, d = scattered(whole, 3000, 15.0)
    xyz = surface + normal * d[:, None]
    np.testing.assert_allclose(project(parts, xyz).distance, project([whole], xyz).distance, atol=1e-9)


def test_one_surface_of_one_cell_and_no_points():
    knots = np.array([0, 0, 1, 1.0])
    control = np.array([[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1.0]]])
    patch = Patch("core", (1, 1), knots, knots, control)
    assert project([patch], np.empty((0, 3))).distance.shape == (0,)
    assert project([patch], [[0.5, 0.5, 0.25]]).distance[0] == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_elevation_of_height_fields(turn):
    patch = height_field(turn=turn)
    assert plan_map(patch) is not None
    surface, _, _ = scattered(patch, 5000, 1.0)
    z = horizon([patch]).elevation(surface[:, 0] + ORIGIN[0], surface[:, 1] + ORIGIN[1])
    # Map coordinates of 3e6 m hold 5e-10 m; the slopes are below 1.
    np.testing.assert_allclose(z - ORIGIN[2], surface[:, 2], atol=1e-9)
    local = horizon([patch]).with_(origin=np.zeros(3)).elevation(surface[:, 0], surface[:, 1])
    np.testing.assert_allclose(local, surface[:, 2], atol=2e-12)


def test_elevation_outside_is_nan_and_the_boundary_is_inside():
    _, parts = nine()
    flat = horizon(parts)
    x, y = np.array([0, 1000, 1000, 500, -1e-3, 500.0]), np.array([0, 0, 700, 700, 300, 700.001])
    assert np.isnan(flat.elevation(x + ORIGIN[0], y + ORIGIN[1])).tolist() == [False] * 4 + [True] * 2
    cut = horizon(parts, outline=[(100, 100), (900, 100), (900, 600)])
    x, y = np.array([100, 500, 899.0, 500, 200]), np.array([100, 350.0, 599, 351, 300])
    assert np.isnan(cut.elevation(x + ORIGIN[0], y + ORIGIN[1])).tolist() == [False, False, False, True, True]
    assert cut.elevation(ORIGIN[0] + np.zeros((2, 1)) + 500, ORIGIN[1] + np.full(3, 200.0)).shape == (2, 3)
    assert np.ndim(cut.elevation(ORIGIN[0] + 500, ORIGIN[1] + 200)) == 0


def test_elevation_of_a_fold_is_the_highest_sheet():
    patch = fold()
    assert plan_map(patch) is None
    rng = np.random.default_rng(4)
    u, v = rng.uniform(0, 1, 80), rng.uniform(0, 300, 80)
    place = patch.evaluate(u, v)
    z = horizon([patch]).with_(origin=np.zeros(3)).elevation(place[:, 0], place[:, 1])
    # Dense section at the same y: every crossing of x, highest first.
    dense = np.linspace(0, 1, 20001)
    for k in range(80):
        line = patch.evaluate(dense, v[k])
        before, after = line[:-1], line[1:]
        crosses = (before[:, 0] - place[k, 0]) * (after[:, 0] - place[k, 0]) <= 0
        assert z[k] == pytest.approx(after[crosses, 2].max(), abs=0.05)
    assert (z > place[:, 2] + 1).any()
    sheet = z < place[:, 2] + 1e-6
    np.testing.assert_allclose(z[sheet], place[sheet, 2], atol=1e-8)


def test_elevation_of_split_fold_and_outside():
    patch = fold()
    u = np.unique(patch.knots_u)
    parts = split(patch, [u[12], u[25]], [])
    west = patch.control[..., 0].min()
    x = np.linspace(west - 50, west + 300, 50)
    whole = horizon([patch]).with_(origin=np.zeros(3)).elevation(x, 150.0)
    pieces = horizon(parts).with_(origin=np.zeros(3)).elevation(x, 150.0)
    np.testing.assert_allclose(whole, pieces, atol=1e-8)
    assert np.isnan(whole[0])
    assert np.isfinite(whole).any()


def test_cells_reproduce_the_patch():
    from geofit.geometry.cells import tabulate

    rng = np.random.default_rng(5)
    patch = fold()
    weights = rng.uniform(0.5, 2, patch.control.shape[:2])
    for one in (patch, Patch("w", (3, 3), patch.knots_u, patch.knots_v, patch.control, weights)):
        cells = tabulate([one])
        u, v = rng.uniform(0, 1, 300), rng.uniform(0, 300, 300)
        place = cells.locate(0, u, v)
        half = cells.half[:, place.cell]
        for jet, (a, b) in zip(cells.jets(place), [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)], strict=True):
            expected = one.evaluate(u, v, a, b).T * half[0] ** a * half[1] ** b
            np.testing.assert_allclose(jet, expected, atol=1e-9)
