from __future__ import annotations

import numpy as np
import pytest

from geofit.fitting.assemble import carried, divide, multiply_knots, patches_of
from geofit.geometry.frame import Frame
from geofit.geometry.mesh import triangulate
from geofit.geometry.seams import seams
from geofit.splines import bspline
from geofit.splines.refined import RefinedSpace
from geofit.splines.tensor import TensorSpace

UNIT = 25.0
CORE = (3.0, 5.0, 2.0, 6.0)


def frame(degrees=0.0, kind="map", axes=None):
    a = np.radians(degrees)
    turned = np.array([[np.cos(a), np.sin(a), 0], [-np.sin(a), np.cos(a), 0], [0, 0, 1.0]])
    return Frame(np.zeros(3), turned if axes is None else axes, kind)


def space_of(degree=3):
    return TensorSpace(
        bspline.clamped_knots([0, 1, 2.2, 3, 4, 5, 6.5, 8], degree),
        bspline.clamped_knots(np.arange(9.0), degree),
        degree,
    )


def case(degree=3, columns=None, seed=0):
    space = space_of(degree)
    shape = (space.size,) if columns is None else (space.size, columns)
    return space, np.random.default_rng(seed).normal(0, 10, shape)


def unsplit(space, coefficients, where, turn):
    """What the whole surface says at (n, 2) places in units: coordinates in the map's axes."""
    values = space.matrix(where) @ coefficients
    local = values if values.ndim == 2 else np.column_stack([where * UNIT, values])
    return local @ turn.axes


@pytest.mark.parametrize("columns", [None, 3])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_patches_are_the_unsplit_surface(columns, degree):
    space, coefficients = case(degree, columns)
    turn = frame(20)
    patches = patches_of(space, coefficients, CORE, turn, UNIT)
    assert len(patches) == 9
    area = 0.0
    for patch in patches:
        u0, u1, v0, v1 = patch.domain
        area += (u1 - u0) * (v1 - v0)
        u, v = np.random.default_rng(1).uniform((u0, v0), (u1, v1), (200, 2)).T
        wanted = unsplit(space, coefficients, np.column_stack([u, v]) / UNIT, turn)
        np.testing.assert_allclose(patch.evaluate(u, v), wanted, atol=1e-12 * np.abs(wanted).max())
        assert patch.control.shape[:2] == (len(patch.knots_u) - degree - 1, len(patch.knots_v) - degree - 1)
    assert area == pytest.approx(64 * UNIT**2)


def test_nine_patches_are_named_by_the_winds_with_the_core_first():
    space, coefficients = case()
    names = [patch.name for patch in patches_of(space, coefficients, CORE, frame(), UNIT)]
    assert names[0] == "core"
    assert set(names) == {
        "core", "west", "east", "north", "south", "north-west", "north-east", "south-west", "south-east"
    }  # fmt: skip


def test_shared_rows_of_control_points_are_identical_bit_for_bit():
    space, coefficients = case()
    p = {patch.name: patch for patch in patches_of(space, coefficients, CORE, frame(33), UNIT)}
    for west, east in (("west", "core"), ("core", "east"), ("north-west", "north"), ("south", "south-east")):
        np.testing.assert_array_equal(p[west].control[-1], p[east].control[0])
        np.testing.assert_array_equal(p[west].knots_v, p[east].knots_v)
    for south, north in (("south", "core"), ("core", "north"), ("south-west", "west"), ("east", "north-east")):
        np.testing.assert_array_equal(p[south].control[:, -1], p[north].control[:, 0])
        np.testing.assert_array_equal(p[south].knots_u, p[north].knots_u)


@pytest.mark.parametrize(
    ("degrees", "names"),
    [
        (0, {"west", "east"}),
        (40, {"west", "east"}),
        (50, {"south", "north"}),
        (90, {"south", "north"}),
        (180, {"west", "east"}),
        (-60, {"south", "north"}),
    ],
)
def test_patches_left_and_right_are_named_by_where_they_lie(degrees, names):
    space, coefficients = case()
    patches = patches_of(space, coefficients, (3.0, 5.0, 0.0, 8.0), frame(degrees), UNIT)
    assert {patch.name for patch in patches[1:]} == names
    centre = {patch.name: patch.control.reshape(-1, 3).mean(axis=0) for patch in patches}
    for name, (axis, sign) in {"west": (0, -1), "east": (0, 1), "south": (1, -1), "north": (1, 1)}.items():
        if name in names:
            assert sign * (centre[name] - centre["core"])[axis] > 0


@pytest.mark.parametrize("degrees", range(0, 360, 15))
def test_no_two_patches_have_one_name(degrees):
    space, coefficients = case()
    names = [patch.name for patch in patches_of(space, coefficients, CORE, frame(degrees), UNIT)]
    assert len(set(names)) == 9


@pytest.mark.parametrize("strike", range(0, 360, 45))
def test_patches_over_a_best_plane_are_named_by_the_dip(strike):
    space, coefficients = case()
    s, d = np.radians(strike), np.radians(70)
    u = np.array([np.cos(s), np.sin(s), 0])
    v = np.array([-np.sin(s) * np.cos(d), np.cos(s) * np.cos(d), np.sin(d)])
    turned = frame(kind="best-plane", axes=np.array([u, v, np.cross(u, v)]))
    patches = patches_of(space, 0 * coefficients, CORE, turned, UNIT)
    names = [patch.name for patch in patches]
    assert len(set(names)) == 9
    height = {patch.name: patch.control[..., 2].mean() for patch in patches}
    assert height["up-dip"] > height["core"] > height["down-dip"]


@pytest.mark.parametrize(("interpolated", "name"), [(True, "core"), (False, "periphery")])
def test_a_surface_without_seams_is_one_patch(interpolated, name):
    space, coefficients = case()
    (patch,) = patches_of(space, coefficients, None, frame(), UNIT, interpolated=interpolated)
    assert patch.name == name
    np.testing.assert_allclose(patch.control[..., 2].ravel(), coefficients)


def test_map_coordinates_are_reproduced_exactly_by_a_height_field():
    space, coefficients = case()
    for patch in patches_of(space, coefficients, CORE, frame(), UNIT):
        u, v = np.random.default_rng(2).uniform(patch.domain[::2], patch.domain[1::2], (50, 2)).T
        np.testing.assert_allclose(patch.evaluate(u, v)[:, :2], np.column_stack([u, v]), atol=1e-11)


def test_a_core_ruled_across_has_degree_one_there():
    p, lines = 3, np.array([3.0, 4.0, 5.0])
    space, _ = case()
    space, _ = multiply_knots(space, np.zeros(space.size), {3.0: 3, 4.0: 3, 5.0: 3}, {})
    rng = np.random.default_rng(3)
    net = rng.normal(size=space.shape)
    u = bspline.greville(space.knots_u, p)
    first, last = np.flatnonzero(np.isclose(u, 3.0))[0], np.flatnonzero(np.isclose(u, 5.0))[0]
    curves = rng.normal(size=(3, space.shape[1]))
    net[first : last + 1] = np.stack([[np.interp(x, lines, c) for c in curves.T] for x in u[first : last + 1]])
    core, *_ = patches_of(space, net.ravel(), CORE, frame(), UNIT, ruled_lines=lines)
    assert core.degree == (1, p)
    np.testing.assert_allclose(np.unique(core.knots_u), lines * UNIT)
    where = rng.uniform((3, 2), (5, 6), (100, 2))
    wanted = unsplit(space, net.ravel(), where, frame())
    np.testing.assert_allclose(core.evaluate(*(where * UNIT).T), wanted, atol=1e-10)


def test_raising_knots_keeps_the_surface():
    space, coefficients = case(columns=2)
    finer, more = multiply_knots(space, coefficients, {3.0: 3, 1.7: 2}, {4.0: 2})
    assert (finer.knots_u == 3.0).sum() == 3
    assert (finer.knots_u == 1.7).sum() == 2
    assert (finer.knots_v == 4.0).sum() == 2
    where = np.random.default_rng(4).uniform(0, 8, (100, 2))
    np.testing.assert_allclose(finer.matrix(where) @ more, space.matrix(where) @ coefficients, atol=1e-11)
    same, unchanged = multiply_knots(space, coefficients, {3.0: 1}, {})
    np.testing.assert_array_equal(same.knots_u, space.knots_u)
    np.testing.assert_array_equal(unchanged, coefficients)


@pytest.mark.parametrize("columns", [None, 3])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_knots_that_contain_the_surface_s_own_carry_it_unchanged(columns, degree):
    space, coefficients = case(degree, columns)
    knots = [np.sort(np.append(each, [0.4, 5.5])) for each in (space.knots_u, space.knots_v)]
    fine, net = carried(space, coefficients, *knots)
    at = np.random.default_rng(3).uniform(0, 8, (300, 2))
    np.testing.assert_allclose(fine.matrix(at) @ net, space.matrix(at) @ coefficients, atol=1e-11)


def test_other_knots_carry_a_surface_the_better_the_finer_they_are():
    space, coefficients = case()
    at, off = np.random.default_rng(3).uniform(0, 8, (2000, 2)), []
    for count in (40, 80):
        knots = bspline.clamped_knots(np.linspace(0, 8, count + 1) ** 1.02 / 8**0.02, 3)
        fine, net = carried(space, coefficients, knots, knots)
        off.append(float(np.abs(fine.matrix(at) @ net - space.matrix(at) @ coefficients).max()))
    assert off[1] < 0.2 * off[0]


def finer_core(seed=0, columns=None):
    """A surface whose core has three times as many spans."""
    outer, fine = space_of(), []
    for knots, low, high in ((outer.knots_u, *CORE[:2]), (outer.knots_v, *CORE[2:])):
        own = np.unique(knots[(knots >= low) & (knots <= high)])
        fine.append(bspline.clamped_knots(np.unique(own[:-1, None] + np.diff(own)[:, None] * (0, 1 / 3, 2 / 3, 1)), 3))
    space = RefinedSpace(outer, TensorSpace(fine[0], fine[1], 3))
    shape = (space.size,) if columns is None else (space.size, columns)
    return space, np.random.default_rng(seed).normal(0, 3, shape)


@pytest.mark.parametrize("columns", [None, 3])
def test_a_finer_core_is_a_patch_with_knots_of_its_own(columns):
    space, coefficients = finer_core(columns=columns)
    turn = frame(20)
    patches = patches_of(space, coefficients, CORE, turn, UNIT)
    coarse = patches_of(space.outer, coefficients[: space.outer.size], CORE, turn, UNIT)
    assert [p.name for p in patches] == [p.name for p in coarse]
    for patch, plain in zip(patches, coarse, strict=True):
        u0, u1, v0, v1 = patch.domain
        u, v = np.random.default_rng(1).uniform((u0, v0), (u1, v1), (200, 2)).T
        wanted = unsplit(space, coefficients, np.column_stack([u, v]) / UNIT, turn)
        np.testing.assert_allclose(patch.evaluate(u, v), wanted, atol=1e-11)
        if patch.name != "core":
            np.testing.assert_array_equal(patch.control, plain.control)
    assert patches[0].control.size > 3 * coarse[0].control.size


def test_a_finer_core_has_closed_and_tangent_seams_and_triangles_without_cracks():
    space, coefficients = finer_core()
    patches = patches_of(space, coefficients, CORE, frame(), UNIT)
    found = seams(patches)
    assert len(found) == 12
    assert max(seam.gap for seam in found) < 1e-9
    assert max(seam.angle for seam in found) < 1e-6
    mesh = triangulate(patches, np.zeros(3), 0.05)
    edges = np.sort(np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]]))
    single, counts = np.unique(edges, axis=0, return_counts=True)
    assert counts.max() == 2
    # Free edges lie on the border of the whole surface.
    rim = mesh.points[single[counts == 1]]
    on_border = np.isclose(rim[..., :2] % (8 * UNIT), 0, atol=1e-9) | np.isclose(rim[..., :2], 8 * UNIT)
    assert on_border.any(axis=2).all()


def test_a_coefficient_moves_the_control_point_of_a_part_by_the_share_that_is_stated():
    space, _ = finer_core()
    division = divide(space, CORE, frame())
    for part in division.parts:
        for i, j in ((0, 0), (1, part.shape[1] - 1), (part.shape[0] // 2, part.shape[1] // 2), (3, 3)):
            index, share = division.acting_most(part, i, j)
            moved = division.coefficients(part, np.eye(space.size)[index]).reshape(part.shape)
            assert moved[i, j] == pytest.approx(share)
            assert share > 0
