"""Triangles against known surfaces: distance, seams, outline, orientation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused
from surfaces import ORIGIN, fold, height_field, horizon, nine, wave

from geofit.data.errors import SettingsError
from geofit.geometry.clip import inside
from geofit.geometry.mesh import cell_boxes, triangle_count

#: Concave, with corners between the mesh's vertices and one (500, -20) outside the surface.
OUTLINE = np.array([[100, 80], [500, -20], [900, 100], [950, 600], [500, 400], [80, 650]], float)
FOLD_OUTLINE = np.array([[-20, 20], [100, 10], [180, 250], [60, 120], [-20, 280]], float)


def edges(mesh):
    """Return each edge once, and how many triangles it has."""
    t = mesh.triangles
    every = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    return np.unique(every, axis=0, return_counts=True)


def normals(mesh):
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def samples(mesh, seed=0):
    """Random places on every triangle, and its middle."""
    share = np.random.default_rng(seed).dirichlet([1, 1, 1], (3, len(mesh.triangles)))
    share = np.concatenate([share, np.full((1, len(mesh.triangles), 3), 1 / 3)])
    return np.einsum("smi,mik->smk", share, mesh.points[mesh.triangles]).reshape(-1, 3) + mesh.origin


def boundary_length(mesh):
    pairs, count = edges(mesh)
    a, b = (mesh.points[pairs[count == 1][:, k], :2] for k in (0, 1))
    return np.linalg.norm(b - a, axis=1).sum()


SURFACES = {
    "one patch": lambda: horizon([height_field(turn=0.4)]),
    "nine patches": lambda: horizon(nine()[1]),
    "nine patches, outline": lambda: horizon(nine()[1], outline=OUTLINE),
    "overturned fold": lambda: horizon([fold()]),
    "overturned fold, outline": lambda: horizon([fold()], outline=FOLD_OUTLINE),
}


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("tolerance", [1.0, 0.05])
def test_triangles_stay_within_the_tolerance(name, tolerance):
    surface = SURFACES[name]()
    mesh = surface.triangulate(tolerance)
    distance = np.abs(surface.distance(samples(mesh)))
    assert distance.max() <= tolerance
    # Not by being far too dense: half the tolerance is used somewhere.
    assert distance.max() > 0.3 * tolerance


@pytest.mark.parametrize("name", SURFACES)
def test_seams_are_closed(name):
    mesh = SURFACES[name]().triangulate(0.2)
    _, count = edges(mesh)
    assert count.max() == 2
    # Open edges are the rim alone: its length in plan is that of the outline or the rectangle.
    expected = {"one patch": 3400.0, "nine patches": 3400.0}.get(name)
    if expected is not None:
        assert boundary_length(mesh) == pytest.approx(expected, abs=1e-6)
    assert np.linalg.norm(normals(mesh), axis=1).min() > 0


@pytest.mark.parametrize("name", ["one patch", "nine patches", "nine patches, outline"])
def test_a_height_field_faces_up_and_its_vertices_are_on_the_surface(name):
    surface = SURFACES[name]()
    mesh = surface.triangulate(0.2)
    assert normals(mesh)[:, 2].min() > 0
    assert np.abs(surface.distance(mesh.xyz)).max() < 1e-9


def test_area_and_edge_of_the_outline():
    import shapely

    mesh = horizon(nine()[1], outline=OUTLINE).triangulate(0.2)
    part = shapely.Polygon(OUTLINE) & shapely.box(0, 0, 1000, 700)
    assert normals(mesh)[:, 2].sum() / 2 == pytest.approx(part.area, abs=1e-6)
    assert boundary_length(mesh) == pytest.approx(part.length, abs=1e-6)


def test_every_limb_of_a_fold_is_trimmed():
    surface = horizon([fold()], outline=FOLD_OUTLINE)
    whole, part = surface.with_(outline=None).triangulate(0.2), surface.triangulate(0.2)
    middles = part.points[part.triangles, :2].mean(axis=1)
    assert inside(FOLD_OUTLINE, middles).all()
    # The area in space is the area of what a fine sampling finds inside.
    fine = surface.with_(outline=None).triangulate(0.002)
    area = np.linalg.norm(normals(fine), axis=1) / 2
    held = inside(FOLD_OUTLINE, fine.points[fine.triangles, :2].mean(axis=1))
    assert np.linalg.norm(normals(part), axis=1).sum() / 2 == pytest.approx(area[held].sum(), rel=5e-3)
    assert len(whole.triangles) > 0


def test_a_vertical_surface_is_trimmed():
    """A wall over the line y = 100: the plan of its triangles has no area."""
    wall = height_field(z=lambda x, y: wave(x, y))
    control = wall.control[..., [0, 2, 1]]
    control[..., 1] = 100.0
    wall = replace(wall, control=control)
    mesh = horizon([wall], outline=[[100, 0], [400, 0], [400, 200], [100, 200]]).triangulate(0.5)
    x, z = mesh.points[:, 0], mesh.points[:, 2]
    assert (x.min(), x.max()) == pytest.approx((100, 400), abs=1e-6)
    assert np.linalg.norm(normals(mesh), axis=1).sum() / 2 == pytest.approx(300 * 700, abs=1e-3)
    assert np.ptp(z) == pytest.approx(700)


def test_an_outline_outside_leaves_all_and_a_plane_is_two_pieces_a_span():
    surface = horizon([height_field(nu=5, nv=4, z=lambda x, y: 0.1 * x - 0.2 * y)])
    mesh = surface.triangulate(0.05)
    around = surface.with_(outline=np.array([[-1, -1], [1001, -1], [1001, 701], [-1, 701]]) + ORIGIN[:2])
    same = around.triangulate(0.05)
    assert len(mesh.triangles) == len(same.triangles) == 8


@pytest.mark.parametrize("name", SURFACES)
def test_a_tolerance_that_changes_over_the_map_is_kept_everywhere(name):
    surface = SURFACES[name]()
    middle = surface.triangulate(5.0).xyz.mean(axis=0)

    def allowed(xyz):
        return 0.02 + 0.002 * np.linalg.norm(xyz[..., :2] - middle[:2], axis=-1)

    def tolerance(low, high):
        nearest = np.clip(middle, low, high)
        return allowed(nearest)

    mesh = surface.triangulate(tolerance)
    places = samples(mesh)
    share = np.abs(surface.distance(places)) / allowed(places)
    assert 0.2 < share.max() <= 1.0
    finest = surface.triangulate(0.02)
    assert len(mesh.triangles) < 0.7 * len(finest.triangles)
    _, count = edges(mesh)
    assert count.max() == 2


def test_boxes_of_cells_hold_the_surface():
    for patch in (fold(), *nine()[1]):
        low, high = cell_boxes(patch, ORIGIN)
        u, v = (np.unique(knots) for knots in (patch.knots_u, patch.knots_v))
        rng = np.random.default_rng(0)
        i, j = rng.integers(len(u) - 1, size=500), rng.integers(len(v) - 1, size=500)
        places = patch.evaluate(rng.uniform(u[i], u[i + 1]), rng.uniform(v[j], v[j + 1])) + ORIGIN
        assert (places >= low[i, j] - 1e-9).all()
        assert (places <= high[i, j] + 1e-9).all()
        assert low.shape == (len(u) - 1, len(v) - 1, 3)


@pytest.mark.parametrize("tolerance", [2.0, 0.1])
def test_the_count_is_told_before_triangles_are_made(tolerance):
    patches = nine()[1]
    count = triangle_count(patches, ORIGIN, tolerance)
    # The strips along the seams have more: both neighbours' lines.
    assert count <= len(horizon(patches).triangulate(tolerance).triangles) <= 1.3 * count


def test_refuses_a_tolerance_of_zero():
    with refused(SettingsError, "geometry.chordal-tolerance-not-positive"):
        horizon([height_field()]).triangulate(0.0)


@pytest.mark.parametrize("seed", range(12))
def test_any_outline_is_followed_without_cracks(seed):
    """Star-shaped polygons of 3 to 24 corners, some with corners on the mesh's own lines."""
    import shapely

    rng = np.random.default_rng(seed)
    count = rng.integers(3, 25)
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    radius = rng.uniform(0.2, 1, count) * rng.uniform(50, 600)
    middle = rng.uniform([200, 150], [800, 550])
    outline = middle + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    if seed % 2 == 0:
        outline = np.round(outline, -1)
    polygon = shapely.Polygon(outline)
    if not polygon.is_valid:
        pytest.skip("rounding made the polygon cross itself")
    part = polygon & shapely.box(0, 0, 1000, 700)
    mesh = horizon(nine()[1], outline=outline).triangulate(2.0)
    assert edges(mesh)[1].max() == 2
    assert normals(mesh)[:, 2].sum() / 2 == pytest.approx(part.area, abs=1e-4)
    assert boundary_length(mesh) == pytest.approx(part.length, abs=1e-3)
