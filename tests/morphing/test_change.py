"""Gain, loss and net of surveys whose change has a formula, and notes where the lattice cannot measure it."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import with_code

import geofit
import geofit.implicit as implicit
from geofit.morphing.leg import Mode

MODES: tuple[Mode, ...] = ("arrival", "blend")


def ball(radius: float, x: float = 0.0) -> implicit.Field:
    return implicit.Sphere([x, 0, 0], radius)


def volume_of(radius: float) -> float:
    return 4 / 3 * np.pi * radius**3


def lens(a: float, b: float, d: float) -> float:
    """Volume that two balls with middles d apart share."""
    return np.pi * (a + b - d) ** 2 * (d**2 + 2 * d * (a + b) - 3 * (a - b) ** 2) / (12 * d)


def cube(edge: float) -> implicit.TriangleMesh:
    corners = (np.array(list(np.ndindex(2, 2, 2)), float) - 0.5) * edge
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return implicit.TriangleMesh(corners, [[f[0], f[k], f[k + 1]] for f in faces for k in (1, 2)])


def ball_mesh(radius: float, x: float = 0.0) -> implicit.TriangleMesh:
    field = ball(radius, x)
    return implicit.isosurface(field, implicit.Lattice.around(*field.bounds, cells=32), capped=True)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("cells", [32, 64, 96])
def test_a_body_within_another_gains_nothing(mode: Mode, cells: int) -> None:
    large = ball(10.0)
    for small, volume in ((ball(5.0), volume_of(5.0)), (cube(5.0), 125.0)):
        (shrunk,) = geofit.morph(large, small, mode=mode, cells=cells).changes
        (grown,) = geofit.morph(small, large, mode=mode, cells=cells).changes
        assert shrunk.gain == grown.loss == 0
        for lost in (shrunk.loss, grown.gain):
            assert lost == pytest.approx(volume_of(10.0) - volume, rel=0.003)
        assert {part.kind for part in shrunk.parts} == {"loss"}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("cells", [48, 96])
def test_gain_and_loss_of_balls_that_overlap(mode: Mode, cells: int) -> None:
    (moved,) = geofit.morph(ball(10.0), ball(8.0, 7.0), mode=mode, cells=cells).changes
    shared = lens(10.0, 8.0, 7.0)
    assert moved.gain == pytest.approx(volume_of(8.0) - shared, rel=0.005)
    assert moved.loss == pytest.approx(volume_of(10.0) - shared, rel=0.005)
    assert moved.net == pytest.approx(volume_of(8.0) - volume_of(10.0), rel=0.005)


@pytest.mark.parametrize("mode", MODES)
def test_the_frames_on_the_way_gain_nothing_either(mode: Mode) -> None:
    m = geofit.morph(ball(10.0), ball(5.0), mode=mode, cells=96)
    for row in m.table(4):
        assert row.gain == pytest.approx(0, abs=1e-3 * volume_of(10.0))
        assert row.net == pytest.approx(row.volume - volume_of(10.0), abs=0.003 * volume_of(10.0))
    assert not m.notes


@pytest.mark.parametrize("mode", MODES)
def test_the_table_ends_with_the_change_of_its_leg(mode: Mode) -> None:
    m = geofit.morph(ball(10.0), implicit.union(ball(8.0), ball(6.0, 30.0)), mode=mode, cells=96)
    last, (change,) = m.table(2)[-1], m.changes
    assert (last.gain, last.loss, last.net) == (change.gain, change.loss, change.net)
    assert last.gain == pytest.approx(volume_of(6.0), rel=0.02)


def test_a_mesh_with_normals_inwards_is_turned_and_named() -> None:
    a, b = ball_mesh(10.0), ball_mesh(8.0)
    m = geofit.morph(a, implicit.TriangleMesh(b.vertices, b.triangles[:, ::-1]), cells=32, names=["a.stl", "b.stl"])
    assert with_code(m.notes, "morphing.mesh-turned").params == {"name": "b.stl"}
    assert m(1).volume == m(1).mesh.volume == pytest.approx(b.volume)
    assert m.changes[0].net == pytest.approx(b.volume - a.volume, rel=0.02)


def test_cells_too_coarse_for_a_part_are_named_with_the_spacing_it_needs() -> None:
    a, b = ball_mesh(10.0), ball_mesh(10.0, 1000.0)
    two = implicit.TriangleMesh(
        np.concatenate([a.vertices, b.vertices]), np.concatenate([a.triangles, b.triangles + len(a.vertices)])
    )
    m = geofit.morph(a, two, cells=128, names=["a", "two"])
    (first, second) = [note for note in m.notes if note.code == "morphing.cells-too-coarse"]
    assert (first.params["name"], second.params["name"]) == ("a", "two")
    assert second.params["across"] == pytest.approx(20.0, rel=0.02)
    assert second.params["least"] == pytest.approx(20.0 / 6, rel=0.02)
    assert with_code(m.notes, "morphing.volumes-disagree").params["wanted"] == pytest.approx(volume_of(10.0), rel=0.02)
    fine = geofit.morph(ball(10.0), ball(9.0), spacing=2.5)
    assert not [note for note in fine.notes if note.code == "morphing.cells-too-coarse" and note.params["name"] == "A"]


@pytest.mark.parametrize("thick", [2.0, 3.5, 5.0])
def test_a_plate_is_as_thick_as_it_is(thick: float) -> None:
    def plate(height: float) -> implicit.TriangleMesh:
        slab = cube(1.0)
        return implicit.TriangleMesh(slab.vertices * [40.0, 40.0, height], slab.triangles)

    m = geofit.morph(plate(7.0), plate(thick), spacing=1.0, names=["thick", "thin"])
    (note,) = [note for note in m.notes if note.code == "morphing.cells-too-coarse"]
    assert note.params["name"] == "thin"
    assert note.params["across"] == pytest.approx(thick, rel=0.03)


def test_a_small_ball_far_from_the_others_is_as_thick_as_it_is():
    def body(radius):
        return implicit.union(implicit.Sphere([0, 0, 0], 30.0), implicit.Sphere([480, 0, 0], radius))

    way = geofit.morph(body(9.0), body(10.0))
    thick = [note.params["across"] for note in way.notes if note.code == "morphing.cells-too-coarse"]
    assert thick == pytest.approx([18.0, 20.0], rel=0.15)
