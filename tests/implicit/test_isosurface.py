"""T1-T3, T11, T12: volumes and areas, closed manifold meshes, blocks equal to the whole, vertices on the surface."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import geofit.implicit as implicit
from geofit.data.errors import FitError
from geofit.implicit.isosurface import isosurface, isosurface_of_samples
from geofit.implicit.mesh import TriangleMesh

BOX = ([-1.0] * 3, [1.0] * 3)
EVERYTHING = (np.full(3, -np.inf), np.full(3, np.inf))


def whole(field: implicit.Field) -> implicit.FunctionField:
    """The same field without a bound: every block is evaluated."""
    return implicit.FunctionField(field.value, field.gradient, EVERYTHING, np.inf)


DIAMOND = implicit.FunctionField(lambda x: np.abs(x).sum(axis=1) - 0.5, np.sign, lipschitz=3**0.5)
CUBE = implicit.FunctionField(lambda x: np.abs(x).max(axis=1) - 0.5, np.sign, lipschitz=1.0)


def check(mesh: implicit.TriangleMesh, spacing: float) -> None:
    assert not len(mesh.boundary_edges)
    assert not len(mesh.nonmanifold_edges)
    assert not len(mesh.nonmanifold_vertices)
    assert mesh.areas.min() > 1e-7 * spacing**2
    assert mesh.volume > 0


#: Field, box of the lattice, volume, area, Euler number; the flat faces of the last three are those of the box.
SOLIDS = {
    "sphere": (implicit.Sphere([0, 0, 0], 0.6), None, 4 / 3 * math.pi * 0.6**3, 4 * math.pi * 0.36, 2),
    "ellipsoid": (implicit.ellipsoid([0, 0, 0], [3, 2, 1]), None, 25.132741228718, 48.882146303, 2),
    "torus": (implicit.Torus([0, 0, 0], [1, 2, 3], 1.0, 0.4), None, 2 * math.pi**2 * 0.16, 4 * math.pi**2 * 0.4, 0),
    "cylinder": (
        implicit.Cylinder([0, 0, 0], [0, 0, 1], 0.5), ([-0.6, -0.6, -0.7], [0.6, 0.6, 0.7]),
        math.pi * 0.25 * 1.4, math.pi * 1.4 + math.pi * 0.5, 2,
    ),
    "cone": (
        implicit.quadric_from_coefficients([1, 0, 0, 0, 1, 0, 0, -0.25, 0, 0]), ([-0.6, -0.6, 0], [0.6, 0.6, 1]),
        math.pi / 12, math.pi / 4 + math.pi * 0.5 * 1.25**0.5, 2,
    ),
    "paraboloid": (
        implicit.quadric_from_coefficients([1, 0, 0, 0, 1, 0, 0, 0, -0.5, 0]), ([-1.1, -1.1, -0.1], [1.1, 1.1, 1]),
        math.pi / 2, math.pi + math.pi / 6 * (5 * 5**0.5 - 1), 2,
    ),
}  # fmt: skip
SMOOTH = ("sphere", "ellipsoid", "torus")


def box_of(name: str) -> tuple[np.ndarray, np.ndarray]:
    field, box = SOLIDS[name][:2]
    if box is not None:
        return np.array(box[0]), np.array(box[1])
    low, high = field.bounds
    return low - 0.01 * (high - low).max(), high + 0.01 * (high - low).max()


def lattice_of(name: str, cells: int) -> implicit.Lattice:
    """Cells along the longest side; the upper side of the box is a layer of nodes."""
    low, high = box_of(name)
    spacing = float((high - low).max()) / cells
    counts = np.ceil((high - low) / spacing - 1e-9).astype(int)
    return implicit.Lattice(high - counts * spacing, spacing, tuple(counts + 1))


@pytest.mark.parametrize("name", SOLIDS)
def test_volume_and_area_of_solids_by_mesh_and_by_field(name: str) -> None:
    field, _, volume, area, euler = SOLIDS[name]
    lattice = lattice_of(name, 96)
    mesh = isosurface(field, lattice, capped=True)
    check(mesh, lattice.spacing)
    assert mesh.euler == euler
    assert mesh.volume == pytest.approx(volume, rel=1e-3)
    assert mesh.area == pytest.approx(area, rel=1e-3)
    by_field = implicit.extent_of_samples(implicit.sample(field, lattice), lattice)
    assert by_field.volume == pytest.approx(mesh.volume, rel=1e-3)


@pytest.mark.parametrize("name", SMOOTH)
def test_extrapolated_and_curved_extents_of_smooth_bodies(name: str) -> None:
    field, _, volume, area, _ = SOLIDS[name]
    lattice = lattice_of(name, 96)
    curved = implicit.curved_extent(field, isosurface(field, lattice))
    assert curved.volume == pytest.approx(volume, rel=1e-6)
    assert curved.area == pytest.approx(area, rel=1e-6)
    low, high = box_of(name)
    counts = np.ceil((high - low) / lattice.spacing / 2).astype(int) * 2 + 1
    better = implicit.extrapolated_extent(field, implicit.Lattice(low, lattice.spacing, tuple(counts)))
    # 15 cells across the thinnest place; the sphere has 96.
    limit = 2e-5 if name == "sphere" else 5e-5
    assert better.volume == pytest.approx(volume, rel=limit)
    assert better.area == pytest.approx(area, rel=limit)
    assert better.volume_error < 2e-3 * volume


def test_a_body_without_triangles_has_no_extent() -> None:
    empty = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.intp))
    assert implicit.curved_extent(SOLIDS["sphere"][0], empty) == implicit.Extent(0.0, 0.0)


def test_order_of_volume_and_area_is_two_and_that_of_curved_triangles_four() -> None:
    field, _, volume, area, _ = SOLIDS["sphere"]
    flat, curved = [], []
    for n in (24, 48, 96):
        mesh = isosurface(field, implicit.Lattice.around(*BOX, cells=n))
        extent = implicit.curved_extent(field, mesh)
        flat.append((mesh.volume / volume - 1, mesh.area / area - 1))
        curved.append((extent.volume / volume - 1, extent.area / area - 1))
    np.testing.assert_allclose(np.log2(np.divide(flat[:-1], flat[1:])), 2.0, atol=0.1)
    np.testing.assert_allclose(np.log2(np.divide(curved[:-1], curved[1:])), 4.0, atol=0.5)


@pytest.mark.parametrize("name", ["sphere", "torus", "cone"])
def test_blocks_equal_the_whole_vertex_for_vertex(name: str) -> None:
    field = SOLIDS[name][0]
    lattice = implicit.Lattice([-1.45, -1.45, -1.45], 0.053, (55, 57, 60))
    some, everything = isosurface(field, lattice), isosurface(whole(field), lattice)
    assert some.vertices.tobytes() == everything.vertices.tobytes()
    assert some.triangles.tobytes() == everything.triangles.tobytes()


def test_blocks_equal_flying_edges_of_the_whole_lattice() -> None:
    field = implicit.Sphere([0.01, 0.02, 0.03], 0.9)
    lattice = implicit.Lattice([-1.45, -1.45, -1.45], 0.053, (55, 57, 60))
    stored = isosurface_of_samples(implicit.sample(field, lattice), lattice)
    blocks = isosurface(field, lattice)
    np.testing.assert_array_equal(stored.triangles, blocks.triangles)
    # Each vertex is on the same edge of the lattice; the stored samples are linear there, the field is not.
    assert np.abs(stored.vertices - blocks.vertices).max() < lattice.spacing
    assert np.count_nonzero(np.abs(stored.vertices - blocks.vertices) > 1e-12, axis=1).max() == 1


@pytest.mark.parametrize("capped", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_a_surface_that_is_followed_is_the_whole_vertex_for_vertex_and_costs_less(seed: int, capped: bool) -> None:
    noise = gaussian_filter(np.random.default_rng(seed).normal(size=(40, 44, 48)), 5.0).astype(np.float32)
    smooth = implicit.spline_grid(noise - 1.5 * noise.std(), implicit.Lattice([0, 0, 0], 1.0, noise.shape))
    asked: list[int] = []

    def value(xyz: np.ndarray) -> np.ndarray:
        asked.append(len(xyz))
        return -smooth.value(xyz)

    field = implicit.FunctionField(value, lambda xyz: -smooth.gradient(xyz), EVERYTHING, np.inf)
    coarse = isosurface(field, implicit.Lattice([0, 0, 0], 1.0, noise.shape), capped=capped)
    lattice = implicit.Lattice([0.2, 0.2, 0.2], 0.21, (188, 207, 225))
    asked.clear()
    everything = isosurface(field, lattice, capped=capped)
    whole_cost = sum(asked)
    asked.clear()
    followed = isosurface(field, lattice, capped=capped, near=coarse.vertices)
    assert sum(asked) < 0.6 * whole_cost
    assert followed.vertices.tobytes() == everything.vertices.tobytes()
    assert followed.triangles.tobytes() == everything.triangles.tobytes()


def test_a_surface_is_looked_for_only_where_known_places_lead() -> None:
    balls = implicit.union(implicit.Sphere([-0.5, 0, 0], 0.2), implicit.Sphere([0.5, 0, 0], 0.2))
    lattice = implicit.Lattice.around(*BOX, cells=64)
    one = isosurface(whole(balls), lattice, near=np.array([[-0.5, 0.2, 0.0]]))
    check(one, lattice.spacing)
    assert one.components == 1
    assert one.volume == pytest.approx(isosurface(balls, lattice).volume / 2, rel=1e-9)
    assert not len(isosurface(whole(balls), lattice, near=np.array([[0.0, 0.9, 0.9]])).triangles)
    assert not len(isosurface(whole(balls), lattice, near=np.zeros((0, 3))).triangles)


@pytest.mark.parametrize(("sigma", "n"), [(1.2, 64), (0.7, 40), (2.5, 64)])
def test_noise_is_closed_and_manifold(sigma: float, n: int) -> None:
    noise = gaussian_filter(np.random.default_rng(5).normal(size=(n, n, n)), sigma).astype(np.float32)
    lattice = implicit.Lattice([0, 0, 0], 1.0, noise.shape)
    check(isosurface_of_samples(noise, lattice, capped=True), 1.0)
    check(isosurface(implicit.spline_grid(noise, lattice), lattice, capped=True), 1.0)


@pytest.mark.parametrize("field", [DIAMOND, CUBE])
@pytest.mark.parametrize("cells", [31, 32])
def test_nodes_that_are_exactly_zero_leave_no_slivers(field: implicit.FunctionField, cells: int) -> None:
    lattice = implicit.Lattice.around(*BOX, cells=cells)
    check(isosurface(field, lattice), lattice.spacing)
    check(isosurface_of_samples(implicit.sample(field, lattice), lattice), lattice.spacing)
    assert isosurface(field, lattice).euler == 2


def test_a_body_that_leaves_its_box_is_capped_on_the_box_or_named_open() -> None:
    ball = implicit.Sphere([0.4, 0, 0], 0.8)
    lattice = implicit.Lattice.around(*BOX, cells=48)
    mesh = isosurface(ball, lattice, capped=True)
    check(mesh, lattice.spacing)
    cap = 0.2**2 * math.pi * (3 * 0.8 - 0.2) / 3
    assert mesh.volume == pytest.approx(4 / 3 * math.pi * 0.8**3 - cap, rel=2e-3)
    assert mesh.vertices[:, 0].max() == 1.0
    opened = isosurface(ball, lattice)
    assert implicit.open_sides(opened, lattice) == ("+x",)
    assert opened.euler == 1
    assert implicit.open_sides(mesh, lattice) == ()


def test_a_body_that_fills_the_box_is_the_box() -> None:
    lattice = implicit.Lattice.around(*BOX, cells=10)
    mesh = isosurface(implicit.Sphere([0, 0, 0], 9.0), lattice, capped=True)
    check(mesh, lattice.spacing)
    assert mesh.volume == pytest.approx(8.0, abs=1e-12)
    assert not len(isosurface(implicit.Sphere([0, 0, 0], 9.0), lattice).triangles)


def test_vertices_are_on_the_surface_and_normals_are_those_of_the_body() -> None:
    field, n = implicit.ellipsoid([0.03, 0.02, 0.01], [0.9, 0.6, 0.4]), 96
    lattice = implicit.Lattice.around(*BOX, cells=n)
    mesh = isosurface(field, lattice)
    distance = np.abs(field.value(mesh.vertices)) / np.linalg.norm(field.gradient(mesh.vertices), axis=1)
    assert distance.max() <= 1e-9 * lattice.spacing
    spline = implicit.spline_of_field(implicit.Sphere([0, 0, 0], 0.6), lattice)
    vertices = isosurface(spline, lattice).vertices
    analytic = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    angle = np.linalg.norm(np.cross(implicit.normals(spline, vertices), analytic), axis=1)
    assert angle.max() < 1e-3


def test_a_field_that_is_not_a_number_is_refused() -> None:
    broken = implicit.FunctionField(lambda x: np.where(x[:, 0] > 0.5, np.nan, x[:, 1]), np.sign)
    with pytest.raises(FitError, match="not a number"):
        isosurface(broken, implicit.Lattice.around(*BOX, cells=8))
