"""Bodies as STEP solids, read back."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import pyvista

import geofit
import geofit.implicit as implicit
from bodies.planted import ORIGIN, drilled, ellipsoid
from bodies.shapes import KINDS, horn
from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData
from geofit.bodies.dual import dual_quads
from geofit.bodies.fit import fit_body
from geofit.bodies.implicit_body import OwnField
from geofit.bodies.quads import PatchedSurface, patched_surface
from geofit.bodies.settings import BodySettings
from geofit.cad.faces import explore
from geofit.cad.solid_mesh import solid_triangles
from geofit.cad.solid_shapes import patch_solid, volume_of
from geofit.cad.step import read_shapes
from geofit.implicit.mesh import TriangleMesh
from geofit.io.boreholes import read_boreholes
from geofit.splines.patch import Patch

SAMPLE = Path(__file__).parents[2] / "sample_data" / "bodies"


def test_nurbs_solid_of_a_ring(ring: BodyFit, tmp_path: Path) -> None:
    found = ring.write_step(tmp_path / "ring.step")
    assert found.passed
    assert (found.grade, found.solids, found.free_edges, found.brep_valid) == ("nurbs", 1, 0, True)
    assert found.faces <= 500
    assert found.sigma < ring.settings.epsilon / 4
    assert found.volume == pytest.approx(ring.triangulate(1.5).volume, rel=1e-3)
    ring.write_step(tmp_path / "again.step")
    assert (tmp_path / "ring.step").read_bytes() == (tmp_path / "again.step").read_bytes()


def test_two_solids(two: BodyFit, tmp_path: Path) -> None:
    found = two.write_step(tmp_path / "two.step")
    assert found.passed
    assert found.solids == 2


def test_triangles_keep_the_volume(two: BodyFit, tmp_path: Path) -> None:
    found = two.write_step(tmp_path / "two.step", nurbs=False)
    assert found.passed
    assert found.grade == "triangles"
    assert found.volume == pytest.approx(two.overview.volume, rel=1e-9)
    # Contacts lie on the body; flat triangles cut its curves short by less than a cell's sagitta.
    (sigma,) = (check for check in found.checks if check.name == "sigma")
    mesh = pyvista.PolyData.from_regular_faces(two.overview.vertices, two.overview.triangles)
    places = two.contacts - two.origin
    gaps = np.linalg.norm(mesh.find_closest_cell(places, return_closest_point=True)[1] - places, axis=1)
    assert sigma.value == pytest.approx(np.sqrt((gaps**2).sum() / (len(gaps) - 1)), rel=1e-6)
    assert found.max_abs == pytest.approx(gaps.max(), rel=1e-6)


@dataclass(frozen=True)
class LargeCells(OwnField):
    """A thin ring whose overview has cells as large as the ring is thick."""

    field: implicit.Torus
    name: str = "thin ring"
    spacing: float = 1.0
    overview_spacing: float = 4.0

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """A box somewhat larger than the ring."""
        return np.array([-60.0, -60.0, -6.0]), np.array([60.0, 60.0, 6.0])


@pytest.mark.parametrize(("length", "lacking"), [(0.3, 2), (30.0, 0)])
def test_contacts_of_a_part_thinner_than_the_cells_are_counted(length: float, lacking: int, tmp_path: Path) -> None:
    """Sigma of a file was stated with "flat triangles cut curves short" where triangles were missing altogether."""
    known = drilled(ellipsoid((0.25, 0.25, 0.2), (-0.5, -0.5, 0.0))[0], 3, rows=9)
    hole = ORIGIN + np.array([70.0, 70.0, 0.0])
    depth = np.arange(-60.0, 60.0, 0.1)[:, None] * [0, 0, 1]
    inside = np.abs(depth[:, 2]) < length / 2
    data = BodyData(
        np.concatenate([known.contacts, hole + np.array([[0, 0, -length / 2], [0, 0, length / 2]])]),
        np.concatenate([known.inside, hole + depth[inside]]),
        np.concatenate([known.outside, hole + depth[~inside]]),
    )
    body = fit_body(data)
    assert body.accuracy is not None
    assert body.accuracy.sigma < 1e-6
    found = body.write_step(tmp_path / "body.step", nurbs=False)
    notes = [check for check in found.checks if check.name == "thin parts"]
    assert [check.value for check in notes] == [lacking] * (lacking > 0)
    assert all(f"{lacking} of {len(data.contacts)} contacts lie" in str(check.text) for check in notes)


def test_triangles_that_lose_a_part_of_the_volume_fail(tmp_path: Path) -> None:
    body = LargeCells(implicit.Torus((0, 0, 0), (0, 0, 1), 50.0, 4.0))
    found = body.write_step(tmp_path / "ring.step", nurbs=False)
    assert found.volume == pytest.approx(body.overview.volume, rel=1e-9)
    assert found.volume < 0.97 * body.size.volume
    assert [check.name for check in found.checks if check.passed is False] == ["volume"]


def test_the_contacts_of_a_cut_body_are_not_compared_and_no_check_says_nan(tmp_path: Path) -> None:
    box = (tuple(ORIGIN - 90), (ORIGIN[0], *(ORIGIN[1:] + 90)))
    body = fit_body(drilled(ellipsoid((0.6, 0.4, 0.3))[0], 0), BodySettings(box=box))
    for nurbs in (True, False):
        found = body.write_step(tmp_path / "cut.step", nurbs=nurbs)
        assert found.passed
        assert not any("nan" in str(check.text) for check in found.checks)


def test_seams_and_deviation(ring: BodyFit) -> None:
    patched = patched_surface(ring, tolerance=0.05)
    assert patched.deviation <= 0.05
    assert patched.seam_angle <= 1.0
    assert len(patched.patches) <= 500


def sample_body(name: str) -> BodyFit:
    """Return a body of the sample site, or one of the planted shapes."""
    if name == "horn":
        return fit_body(drilled(horn(), 1, rows=11), name=name)
    if name == "fork":
        return fit_body(drilled(KINDS["fork"](np.random.default_rng(3)), 1, rows=11), name=name)
    tables = [SAMPLE / f"{table}.csv" for table in ("collar", "survey", "lithology")]
    return fit_body(read_boreholes(*tables[:2], tables[2:], dip="down-positive"), codes=name, name=name)


@pytest.mark.parametrize("name", ["ORE", "VOID", "GABBRO", "horn", "fork"])
def test_planted_bodies_become_nurbs_solids(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    body, made = sample_body(name), []

    def kept(one: BodyFit) -> PatchedSurface:
        made.append(patched_surface(one))
        return made[-1]

    monkeypatch.setattr("geofit.bodies.creased.patched_surface", kept)
    found = body.write_step(tmp_path / "body.step")
    # The very patches of the file.
    (patched,) = made
    assert len(patched.patches) <= 500
    assert patched.deviation <= body.epsilon / 2
    assert patched.seam_angle <= 1.0
    assert found.passed
    assert (found.grade, found.faces, found.brep_valid) == ("nurbs", len(patched.patches), True)
    assert found.deviation <= body.epsilon
    assert found.edge_tolerance <= 1e-6
    (volume,) = (check for check in found.checks if check.name == "volume")
    assert volume.value <= volume.limit <= 0.03 * body.size.volume
    assert found.volume == pytest.approx(body.size.volume, rel=1e-3)


@pytest.mark.parametrize("name", ["ring", "two"])
def test_distances_from_the_solid_are_those_of_opencascade(name: str, request: pytest.FixtureRequest) -> None:
    """Places at planted offsets: sigma by the body's foot points, by OpenCASCADE from the solid, and as planted."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_SHELL

    body: BodyFit = request.getfixturevalue(name)
    solid = patch_solid(patched_surface(body, tolerance=5e-5).components)
    shells = list(explore(solid, TopAbs_SHELL))
    rng = np.random.default_rng(3)
    foot = body.overview.vertices[rng.choice(len(body.overview.vertices), 40, replace=False)]
    normal = body.field.gradient(foot)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    planted = rng.uniform(-1.0, 1.0, len(foot))
    places = foot + planted[:, None] * normal
    measured = body.distance(places + body.origin)
    found = np.empty(len(places))
    for k, place in enumerate(places.tolist()):
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*place)).Vertex()
        found[k] = min(BRepExtrema_DistShapeShape(vertex, shell).Value() for shell in shells)
    np.testing.assert_allclose(found, np.abs(measured), atol=1e-4)
    np.testing.assert_allclose(measured, planted, atol=1e-4)
    sigmas = [np.sqrt((d**2).sum() / (len(d) - 1)) for d in (found, measured, planted)]
    assert max(sigmas) - min(sigmas) < 1e-4


def test_quadrilaterals_of_noise_are_closed() -> None:
    value = np.random.default_rng(2).normal(size=(12, 12, 12))
    value[[0, -1]] = value[:, [0, -1]] = value[:, :, [0, -1]] = 1.0
    found = dual_quads(value)
    assert found is not None
    corners, quads = found
    # Two edges with the same ends are one to a mesh: such a layout is refused, all others are closed.
    _, count = np.unique(np.sort(quads[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2), axis=1), axis=0,
                         return_counts=True)  # fmt: skip
    assert set(count.tolist()) <= {2, 4}
    mesh = TriangleMesh(corners, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    assert mesh.volume > 0
    value[5, 5, 0] = -1.0
    assert dual_quads(value) is None


BALL, LENS = implicit.Sphere([0, 0, 0], 1.0), implicit.ellipsoid([0.9, 0.2, 0.1], [0.8, 0.6, 0.7])
CREASED = {
    "union": implicit.union(BALL, LENS),
    "difference": implicit.difference(BALL, LENS),
    "intersection": implicit.intersection(BALL, LENS),
    "flat top": implicit.intersection(implicit.union(BALL, LENS), implicit.Plane([0, 0, 0.3], [0.1, 0, 1])),
    "hollow with a flat floor": implicit.difference(
        BALL, implicit.intersection(LENS, implicit.Plane([0, 0, -0.1], [0, 0, -1]))
    ),
}


@pytest.mark.parametrize("name", CREASED)
def test_sharp_bodies_keep_their_creases(name: str, tmp_path: Path) -> None:
    body = geofit.morph(CREASED[name], implicit.Sphere([0, 0, 0], 1.2), cells=64)(0)
    found = body.write_step(tmp_path / "body.step")
    assert found.passed, [check.text for check in found.checks if check.passed is False]
    assert (found.grade, found.solids, found.free_edges, found.brep_valid) == ("nurbs", 1, 0, True)
    assert found.deviation <= body.epsilon / 2
    assert found.edge_tolerance <= 1e-3
    lower, upper = body.extent
    fine, coarse = (
        implicit.isosurface(body.field, implicit.Lattice.around(lower, upper, cells=n)).volume for n in (96, 48)
    )
    assert found.volume == pytest.approx((4 * fine - coarse) / 3, rel=2e-3)
    # The two bodies of a crease meet at its true angle there: its places are on both, and triangles cut it off.
    mesh = solid_triangles(read_shapes(tmp_path / "body.step")[0].shape)
    assert np.abs(body.field.value(mesh.vertices)).max() <= body.epsilon / 2


def test_parts_that_touch_along_an_edge_are_triangles(tmp_path: Path) -> None:
    """The patches went past a neck of a few centimetres, 7 m from its contacts, and the file failed."""

    def truth(x: np.ndarray) -> np.ndarray:
        return np.minimum(*(np.abs(x - side * np.array([0.3, 0, 0.3])).max(axis=1) - 0.3 for side in (-1, 1)))

    body = fit_body(drilled(truth, 1, rows=9, named=True))
    found = body.write_step(tmp_path / "body.step")
    assert found.passed, [check.text for check in found.checks if check.passed is False]
    assert found.grade == "triangles"
    assert "contacts" in str(next(check.text for check in found.checks if check.name == "grade"))


def cube(low: float, high: float, *, outward: bool) -> list[Patch]:
    """Return the faces of a cube as patches of degree 1."""
    faces, knots = [], np.array([0.0, 0.0, 1.0, 1.0])
    for axis in range(3):
        for side in (low, high):
            u, v = np.meshgrid([low, high], [low, high], indexing="ij")
            control = np.empty((2, 2, 3))
            control[..., axis], control[..., (axis + 1) % 3], control[..., (axis + 2) % 3] = side, u, v
            # u x v looks along the axis, which is outwards on its upper side.
            if (side == high) != outward:
                control = control.transpose(1, 0, 2)
            faces.append(Patch(f"{axis}{side}", (1, 1), knots, knots, control))
    return faces


@pytest.mark.parametrize("first", [0, 1])
def test_patches_that_look_inwards_are_a_cavity_of_the_solid_around_them(first: int) -> None:
    parts = [cube(0.0, 10.0, outward=True), cube(2.0, 5.0, outward=False)]
    assert volume_of(patch_solid([parts[first], parts[1 - first]])) == pytest.approx(1000 - 27)
    assert volume_of(patch_solid([cube(0.0, 10.0, outward=True), cube(20.0, 23.0, outward=True)])) == pytest.approx(
        1027
    )
