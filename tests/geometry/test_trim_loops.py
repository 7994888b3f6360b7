"""Distance to trimmed faces, against OpenCASCADE's own distance between shapes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from converged import converged_distances, ring
from surfaces import ORIGIN, height_field, horizon, nine

from geofit.cad.imported import surface_of
from geofit.cad.step import read_shapes, read_step, write_step
from geofit.geometry.trim_loops import nearest_on_trimmed
from geofit.io.export.write import untrimmed
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.surfaces.trimmed import TrimmedSurface


def faces_of_file(path, shape):
    """Write a shape as STEP in metres, and read it as geofit does."""
    import cadquery as cq

    cq.exporters.export(cq.Workplane(obj=cq.Shape.cast(shape)), str(path), "STEP")
    return next(iter(read_step(path).values()))


def truth(shape, target):
    """Distance of points from a shape by OpenCASCADE."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt

    return np.array(
        [
            BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(gp_Pnt(*p)).Vertex(), shape).Value()
            for p in target.tolist()
        ]
    )


def disc_with_a_hole():
    """A horizontal ring in the plane z = 0: radii 100 and 40."""
    import cadquery as cq

    return cq.Face.makeFromWires(
        cq.Wire.makeCircle(100, cq.Vector(0, 0, 0), cq.Vector(0, 0, 1)),
        [cq.Wire.makeCircle(40, cq.Vector(0, 0, 0), cq.Vector(0, 0, 1))],
    ).wrapped


def test_a_ring_is_no_square(tmp_path):
    # cadquery writes millimetres: the ring of the file has radii 0.1 and 0.04 m.
    surface = faces_of_file(tmp_path / "ring.step", disc_with_a_hole())
    assert isinstance(surface, TrimmedSurface)
    assert len(surface.loops[0]) == 2
    target = 1e-3 * np.array([[70, 0, 5], [0, 0, 30], [10, 0, -1], [98, 98, 0], [0, 130, 40]], float)
    found = nearest_on_trimmed(surface.patches, target - surface.origin, surface.loops)
    expected = [5, 50, np.hypot(30, 1), np.hypot(98, 98) - 100, 50]
    # A circle is sampled at 64 places: its polygon lies 100 (1 - cos(pi / 64)) = 0.12 mm inside at most.
    assert np.abs(np.abs(found.distance) * 1e3 - expected).max() < 0.13
    assert found.beyond.tolist() == [False, True, True, True, True]
    assert np.abs(surface.distance(target)) == pytest.approx(np.abs(found.distance))
    height = surface.elevation([0.07, 0.0, 0.098], [0.0, 0.01, 0.098])
    assert np.isnan(height).tolist() == [False, True, True]
    assert str(untrimmed({"ring": surface}, "step")[0]).startswith("ring: its faces end at holes")
    assert untrimmed({"ring": surface}, "obj") == []


def test_through_a_hole_to_the_face_below(tmp_path):
    import cadquery as cq

    below = cq.Face.makeFromWires(cq.Wire.makeCircle(100, cq.Vector(0, 0, -20), cq.Vector(0, 0, 1)))
    ring = faces_of_file(tmp_path / "ring.step", disc_with_a_hole())
    disc = faces_of_file(tmp_path / "disc.step", below.wrapped)
    found = nearest_on_trimmed((*ring.patches, *disc.patches), [[0, 0, 0.005]], (*ring.loops, *disc.loops))
    assert np.abs(found.distance) == pytest.approx([0.025])
    assert found.patch.tolist() == [1]
    assert not found.beyond.any()


@pytest.mark.parametrize("turned", [False, True])
def test_a_hole_off_the_middle_of_a_face_seen_from_either_side(turned, tmp_path):
    import cadquery as cq

    face = cq.Face.makeFromWires(
        cq.Wire.makeCircle(100, cq.Vector(0, 0, 0), cq.Vector(0, 0, 1)),
        [cq.Wire.makeCircle(20, cq.Vector(50, 30, 0), cq.Vector(0, 0, 1))],
    ).wrapped
    surface = faces_of_file(tmp_path / "disc.step", face.Reversed() if turned else face)
    target = 1e-3 * np.array([[50, 30, 1], [-50, 30, 1], [50, -30, 1], [-50, -30, 1]], float)
    found = nearest_on_trimmed(surface.patches, target - surface.origin, surface.loops)
    assert found.beyond.tolist() == [True, False, False, False]
    assert np.abs(found.distance) == pytest.approx([np.hypot(0.02, 0.001), 0.001, 0.001, 0.001], abs=3e-5)


def test_a_trimmed_horizon_with_a_notch(tmp_path):
    """Points over the notch are measured to its rim, whichever of the nine patches is nearest."""
    outline = [[80, 60], [940, 60], [940, 640], [620, 640], [500, 300], [380, 640], [80, 640]]
    surface = horizon(nine()[1], outline=outline)
    write_step({"T1": surface}, tmp_path / "a.step")
    # As a face of a program that does not state how the surface goes on beneath the loops.
    back = surface_of(read_shapes(tmp_path / "a.step")[0])
    assert isinstance(back, TrimmedSurface)
    rng = np.random.default_rng(4)
    assert untrimmed({"T1": back}, "step") == []
    target = rng.uniform([0, 0, -80], [1000, 700, 80], (120, 3))
    target[:30] = rng.uniform([460, 420, -5], [540, 640, 5], (30, 3))
    target[:30, 2] += horizon(nine()[1]).elevation(*(target[:30, :2] + ORIGIN[:2]).T) - ORIGIN[2]
    found = nearest_on_trimmed(back.patches, target + ORIGIN - back.origin, back.loops)
    # Truth about the local origin: distances at 3e6 m lose digits in OpenCASCADE.
    from OCP.TopLoc import TopLoc_Location

    from geofit.cad.sewing import shell

    expected = truth(shell(surface).Located(TopLoc_Location()), target)
    assert np.abs(np.abs(found.distance) - expected).max() < 1e-5
    assert found.beyond.sum() > 20
    # A check that measures to whole patches would be wrong for some of them by metres.
    whole = nearest_on_trimmed(back.patches, target + ORIGIN - back.origin)
    assert (np.abs(found.distance) - np.abs(whole.distance) > 1.0).sum() > 10


def test_a_curved_face_cut_by_a_curve(tmp_path):
    """Part of a cylinder, cut by another one: the loop is curved in the parameters."""
    import cadquery as cq

    outer = cq.Solid.makeCylinder(1000, 3000, cq.Vector(0, 0, -1500))
    hole = cq.Solid.makeCylinder(400, 3000, cq.Vector(0, 0, 0), cq.Vector(1, 0, 0))
    (side,) = [face for face in outer.cut(hole).Faces() if face.geomType() == "CYLINDER" and face.Area() > 1e7]
    surface = faces_of_file(tmp_path / "side.step", side.wrapped)
    rng = np.random.default_rng(5)
    target = rng.uniform(-1500, 1500, (60, 3))
    target[:20] = rng.uniform([700, -250, -250], [1400, 250, 250], (20, 3))
    found = nearest_on_trimmed(surface.patches, 1e-3 * target - surface.origin, surface.loops)
    assert np.abs(np.abs(found.distance) * 1e3 - truth(side.wrapped, target)).max() < 1.0
    assert found.beyond[:20].all()


def test_beside_whole_patches_but_not_over_their_seams():
    surface = horizon(nine()[1])
    middle = surface.patches[0].evaluate(*surface.patches[0].domain[1::2])
    target = np.array([[-50, 300, 0], [500, 350, 90], [1030, 730, 0], middle + np.array([0, 0, 20])])
    assert nearest_on_trimmed(surface.patches, target).beyond.tolist() == [True, False, True, False]


def test_no_triangle_turns_over_where_parameters_run_unevenly():
    """Slivers along a loop, on a patch whose parameters bend by metres from triangle to triangle."""
    patch = height_field()
    x, y = patch.control[..., 0], patch.control[..., 1]
    patch = replace(patch, control=patch.control + np.stack([8 * np.sin(y / 90), 8 * np.cos(x / 80), 0 * x], axis=-1))
    least = []
    for seed in range(20, 25):
        rng = np.random.default_rng(seed)
        loops = [star(rng, 340, rng.integers(8, 60)), star(rng, 100, rng.integers(5, 40))]
        mesh = TrimmedSurface((patch,), ORIGIN, trim_loops=(tuple(loops),)).triangulate(0.5)
        a, b, c = np.moveaxis(mesh.points[mesh.triangles], 1, 0)
        least.append(np.cross(b - a, c - a)[:, 2].min())
    assert min(least) > 0


def star(rng, radius, count):
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    far = rng.uniform(0.4, 1, count) * radius
    return np.array([500, 350]) + far[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("turns", [0.0, 180.0])
@pytest.mark.parametrize("off", [0.2, 60.0])
def test_distances_to_a_trimmed_fold_are_those_of_a_dense_search(turns, off):
    u_knots, v_knots = (
        bspline.clamped_knots(np.linspace(0, 1, 20), 3),
        bspline.clamped_knots(np.linspace(0, 500, 12), 3),
    )
    u, y = np.meshgrid(bspline.greville(u_knots, 3), bspline.greville(v_knots, 3), indexing="ij")
    x, z = 150 * u + turns * np.sin(2 * np.pi * u) + 0.1 * y, 300 * u + 10 * np.sin(y / 90)
    patch = Patch("limb", (3, 3), u_knots, v_knots, np.stack([x, y, z], axis=-1))
    loops = (ring(patch, (0.5, 0.5), 0.4, 100), ring(patch, (0.45, 0.55), 0.1, 25))
    rng = np.random.default_rng(4)
    u, v = rng.uniform(0, 1, 60), rng.uniform(0, 500, 60)
    xyz = patch.evaluate(u, v) + patch.normal(u, v) * rng.normal(0, off, 60)[:, None]
    found = nearest_on_trimmed([patch], xyz, (loops,))
    assert 0.2 < found.beyond.mean() < 0.8
    np.testing.assert_allclose(np.abs(found.distance), converged_distances(patch, loops, xyz), atol=1e-9)
