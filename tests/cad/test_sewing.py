from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused
from surfaces import ORIGIN, fold, height_field, horizon, nine, split

from geofit.cad import faces as occ
from geofit.cad.sewing import shell, to_shape
from geofit.data.errors import StitchError
from geofit.geometry.seams import seams
from geofit.splines import bspline
from geofit.splines.patch import Patch


def moved(patches, name, shift):
    return tuple(replace(p, control=p.control + shift) if p.name == name else p for p in patches)


def edge_counts(shape):
    return [len(faces) for _, faces in occ.edges_with_faces(shape)]


def test_nine_patches_make_one_shell_with_shared_edges():
    _, parts = nine()
    shape = to_shape(horizon(parts))
    assert shape.isValid()
    assert len(shape.Faces()) == 9
    counts = edge_counts(shape.wrapped)
    assert (counts.count(2), counts.count(1)) == (12, 12)
    assert occ.free_loops(shape.wrapped) == 1


def test_the_offset_is_the_placement_and_the_geometry_stays_local():
    _, parts = nine()
    shape = to_shape(horizon(parts))
    move = shape.wrapped.Location().Transformation().TranslationPart()
    assert (move.X(), move.Y(), move.Z()) == tuple(ORIGIN)
    box = shape.BoundingBox()
    assert box.xmin == pytest.approx(ORIGIN[0], abs=1)
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    local = shape.wrapped.Located(TopLoc_Location())
    pole = BRep_Tool.Surface_s(occ.faces_of(local)[0]).Pole(2, 3)
    assert (pole.X(), pole.Y(), pole.Z()) == tuple(parts[0].control[1, 2])


@pytest.mark.parametrize(
    ("outline", "seams_left"),
    [
        ([(100, 80), (900, 60), (950, 500), (500, 690), (80, 600)], 12),
        ([(0, 0), (1000, 0), (1000, 400), (600, 700), (0, 700)], 12),
        ([(0, 0), (1000, 0), (1000, 200), (300, 200), (300, 700), (0, 700)], 10),
    ],
)
def test_trimmed_shell_keeps_its_seams_and_follows_the_outline(outline, seams_left):
    import shapely

    whole, parts = nine()
    shape = shell(horizon(parts, outline=outline))
    counts = edge_counts(shape)
    assert counts.count(2) == seams_left
    assert set(counts) == {1, 2}
    assert occ.free_loops(shape) == 1
    ring = shapely.LinearRing(outline)
    for edge in occ.free_edges(shape):
        line = occ.edge_places(edge, 50)
        assert shapely.distance(ring, shapely.points(line[:, :2])).max() < 1e-6
        np.testing.assert_allclose(line[:, 2], whole.evaluate(line[:, 0], line[:, 1])[:, 2], atol=1e-6)
    import cadquery

    dense = np.stack(np.meshgrid(np.linspace(0, 1000, 801), np.linspace(0, 700, 561), indexing="ij"), -1)
    cross = np.cross(whole.evaluate(*np.moveaxis(dense, 2, 0), 1, 0), whole.evaluate(*np.moveaxis(dense, 2, 0), 0, 1))
    inside = shapely.contains_xy(shapely.Polygon(outline), dense[..., 0], dense[..., 1])
    expected = np.linalg.norm(cross, axis=2)[inside].mean() * shapely.Polygon(outline).area
    assert cadquery.Shell(shape).Area() == pytest.approx(expected, rel=2e-3)


def test_an_outline_of_the_rectangle_itself_does_not_trim():
    _, parts = nine()
    shape = shell(horizon(parts, outline=[(0, 0), (1000, 0), (1000, 700), (0, 700)]))
    assert len(occ.free_edges(shape)) == 12


def test_a_fold_is_cut_by_a_prism():
    patch = fold()
    u = np.unique(patch.knots_u)
    parts = split(patch, [u[18]], [])
    shape = shell(horizon(parts, outline=[(-500, 40), (1000, 40), (1000, 250), (-500, 250)]))
    assert occ.free_loops(shape) == 1
    y = np.concatenate([occ.edge_places(edge, 20)[:, 1] for edge in occ.free_edges(shape)])
    assert 40 - 0.01 <= y.min() <= y.max() <= 250 + 0.01


def test_a_gap_is_named_with_its_width():
    _, parts = nine()
    apart = moved(parts, "p11", [0, 0, 0.01])
    with refused(StitchError, "cad.edges-not-shared") as caught:
        shell(horizon(apart))
    gap = caught.value.message.params["places"][0].params
    assert (gap["first"], gap["second"], gap["gap"]) == ("p01", "p11", pytest.approx(0.01, rel=1e-6))


def test_patches_far_apart_are_named():
    _, parts = nine()
    with refused(StitchError, "cad.patches-not-connected", shells=2):
        shell(horizon([parts[0], parts[8]]))


def test_an_outline_beside_the_surface():
    _, parts = nine()
    with refused(StitchError, "cad.outline-not-reached-at-all"):
        shell(horizon(parts, outline=[(2000, 0), (3000, 0), (3000, 500)]))


def test_no_patch():
    with refused(StitchError, "cad.no-patch"):
        shell(horizon([]))


def test_seams_of_one_tensor_surface_are_closed_and_smooth():
    _, parts = nine()
    found = seams(parts)
    assert len(found) == 12
    assert max(s.gap for s in found) < 1e-12
    assert max(s.angle for s in found) < 1e-6


def test_seams_find_a_gap_and_an_angle():
    _, parts = nine()
    by_pair = {(s.first, s.second): s for s in seams(moved(parts, "p11", [0, 0, 0.01]))}
    # The orthogonal gap is the shift times the cosine of the edge's slope.
    assert 0.008 < by_pair["p01", "p11"].gap <= 0.01 + 1e-12
    assert by_pair["p00", "p01"].gap < 1e-12

    def roof(x, y):
        return 0.1 * np.abs(x - 500)

    kinked = height_field(25, 19, 3, multiplicity=3, z=roof)
    breaks = np.unique(kinked.knots_u)
    middle = breaks[len(breaks) // 2]
    assert middle == 500
    (seam,) = seams(split(kinked, [middle], []))
    assert seam.angle == pytest.approx(2 * np.degrees(np.arctan(0.1)), abs=1e-6)


def test_seams_of_turned_and_mirrored_neighbours():
    _, parts = nine()
    turned = replace(
        parts[4],
        control=parts[4].control[::-1, ::-1],
        knots_u=parts[4].knots_u[0] + parts[4].knots_u[-1] - parts[4].knots_u[::-1],
        knots_v=parts[4].knots_v[0] + parts[4].knots_v[-1] - parts[4].knots_v[::-1],
    )
    found = seams((*parts[:4], turned, *parts[5:]))
    assert len(found) == 12
    assert max(s.gap for s in found) < 1e-9
    assert max(s.angle for s in found) < 1e-6


def test_seams_along_parts_of_edges():
    """Faces of a file end where they are trimmed: a short edge runs along a part of a long one."""
    whole = height_field(25, 19)
    left, right = split(whole, [400.0], [])
    low, high = split(right, [], [300.0])
    parts = replace(left, name="left"), replace(low, name="low"), replace(high, name="high")
    found = {(s.first, s.second): s for s in seams(parts)}
    assert set(found) == {("left", "low"), ("left", "high"), ("low", "high")}
    assert max(s.gap for s in found.values()) < 1e-9
    assert max(s.angle for s in found.values()) < 1e-4
    found = {(s.first, s.second): s.gap for s in seams(moved(parts, "high", [0, 0, 0.05]))}
    assert found["left", "high"] == pytest.approx(0.05, rel=0.2)
    assert found["low", "high"] == pytest.approx(0.05, rel=0.2)
    assert found["left", "low"] < 1e-9


def test_surface_modules_do_not_load_opencascade():
    import subprocess
    import sys

    rooms = "geofit.geometry.seams, geofit.cad.sewing, geofit.geometry.projection, geofit.cad.step"
    code = f"import {rooms}, sys; print('OCP' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == "False"


def test_a_patch_that_is_finer_than_its_neighbours_is_sewn_all_the_same():
    _, parts = nine()
    finer = []
    for part in parts:
        knots = [np.sort(np.concatenate([k, np.convolve(np.unique(k), [0.5, 0.5], "valid")])) for k in knots_of(part)]
        to_u, to_v = (bspline.insertion_matrix(old, new, 3) for old, new in zip(knots_of(part), knots, strict=True))
        control = np.einsum("ai,bj,ijk->abk", to_u, to_v, part.control)
        finer.append(Patch(part.name, (3, 3), knots[0], knots[1], control) if part.name == "p11" else part)
    assert all(seam.gap < 1e-9 for seam in seams(finer))
    shape = shell(horizon(finer))
    assert len(occ.faces_of(shape)) == 9
    assert edge_counts(shape).count(2) == 12


def knots_of(patch):
    return patch.knots_u, patch.knots_v
