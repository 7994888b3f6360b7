from __future__ import annotations

import os
import re
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused
from surfaces import ORIGIN, fold, height_field, horizon, nine, split

import geofit
from geofit.cad.faces import edges_with_faces, to_geom
from geofit.cad.read_back import read_back, self_intersects
from geofit.cad.step import read_shapes, read_step, step_surfaces, write_step
from geofit.cad.step_text import canonical
from geofit.checks.outside import BEYOND, outside
from geofit.data.errors import InputError, StitchError
from geofit.data.points import PointSet
from geofit.fitting.judge import judge
from geofit.splines.patch import Patch


def sampled(whole, n=120, off=0.05, seed=0):
    """Points, two thirds of them exactly on the surface: the core."""
    rng = np.random.default_rng(seed)
    u0, u1, v0, v1 = whole.domain
    u, v = rng.uniform(u0, u1, n), rng.uniform(v0, v1, n)
    core = np.arange(n) < 2 * n // 3
    d = np.where(core, 0.0, rng.normal(0, off, n))
    return whole.evaluate(u, v) + whole.normal(u, v) * d[:, None] + ORIGIN, core, d


def checks(found):
    return {check.name.removeprefix("read-back "): check for check in found.checks}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    whole, parts = nine()
    points, core, d = sampled(whole)
    surface = horizon(parts, points, core, "T1 顶板")
    path = tmp_path_factory.mktemp("step") / "T1.step"
    return surface, path, write_step({"T1 顶板": surface}, path)["T1 顶板"], d


def test_core_lies_on_the_surface_in_the_file_at_three_million_metres(written):
    _, _, found, d = written
    assert found.core_max_abs <= 1e-8
    assert found.sigma == pytest.approx(np.sqrt((d**2).sum() / (len(d) - 1)), rel=1e-6)
    assert found.max_abs == pytest.approx(np.abs(d).max(), abs=1e-7)


def test_seams_edges_and_validity_of_the_file(written):
    _, _, found, _ = written
    assert found.passed
    assert len(found.seams) == 12
    assert max(s.gap for s in found.seams) <= 1e-8
    assert max(s.angle for s in found.seams) <= 1e-3
    assert (found.faces, found.free_edges, found.outline_edges) == (9, 12, 12)
    assert found.brep_valid
    assert not found.self_intersects
    assert found.edge_tolerance <= 1e-6
    assert all(check.passed for name, check in checks(found).items() if name != "outline")


def test_read_gives_back_knots_control_points_names_and_origin(written):
    surface, path, _, _ = written
    (back,) = read_step(path).values()
    assert back.name == "T1 顶板"
    np.testing.assert_array_equal(back.origin, ORIGIN)
    assert back.outline is None
    for ours, theirs in zip(surface.patches, back.patches, strict=True):
        assert theirs.name == ours.name
        assert theirs.degree == ours.degree
        assert theirs.weights is None
        np.testing.assert_allclose(theirs.knots_u, ours.knots_u, atol=1e-9)
        np.testing.assert_allclose(theirs.control, ours.control, atol=1e-9)


@pytest.mark.usefixtures("read_here")
def test_a_file_in_millimetres_says_so_and_holds_the_same_surface(written, tmp_path):
    surface, path, found, _ = written
    back = write_step({"T1 顶板": surface}, tmp_path / "mm.step", unit="mm")["T1 顶板"]
    assert back.passed
    assert back.core_max_abs <= 1e-8
    assert back.sigma == pytest.approx(found.sigma, rel=1e-9)
    text = (tmp_path / "mm.step").read_text("ascii").replace("\n", "")
    assert "SI_UNIT(.MILLI.,.METRE.)" in str(text)
    assert "SI_UNIT($,.METRE.)" not in str(text)
    (ours,), (theirs,) = (read_step(file).values() for file in (path, tmp_path / "mm.step"))
    np.testing.assert_array_equal(theirs.origin, ORIGIN)
    for a, b in zip(ours.patches, theirs.patches, strict=True):
        np.testing.assert_allclose(a.control, b.control, atol=1e-9)
    # The unit is a setting of the whole of OpenCASCADE: the next file must be in metres again.
    assert write_step({"T1 顶板": surface}, tmp_path / "m.step")["T1 顶板"].sha256 == found.sha256


def test_an_unknown_unit_is_refused(written, tmp_path):
    with refused(InputError, "cad.unit-unknown"):
        write_step({"T1": written[0]}, tmp_path / "ft.step", unit="ft")
    assert not list(tmp_path.iterdir())


def test_the_file_is_ascii_and_the_same_bytes_again(written, tmp_path):
    surface, path, found, _ = written
    twice = write_step({"T1 顶板": surface}, tmp_path / "other name.step")["T1 顶板"]
    assert twice.sha256 == found.sha256
    text = path.read_bytes().decode("ascii")
    assert "AP242" in str(text)
    assert "SI_UNIT($,.METRE.)" in str(text).replace("\n", "")
    assert str(text).count("COLOUR_RGB") == 1
    assert "'2000-01-01T00:00:00'" in text.partition("DATA;")[0]
    assert [p.name for p in tmp_path.iterdir()] == ["other name.step"]


def test_the_colour_is_read_by_opencascade(written):
    from OCP.Quantity import Quantity_Color
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDF import TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader = STEPCAFControl_Reader()
    reader.SetColorMode(True)
    reader.ReadFile(str(written[1]))
    reader.Transfer(document)
    shapes, colour = TDF_LabelSequence(), Quantity_Color()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetShapes(shapes)
    tool = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    assert any(tool.GetColor_s(label, XCAFDoc_ColorSurf, colour) for label in shapes)


@pytest.mark.usefixtures("read_here")
def test_several_horizons_in_one_assembly(tmp_path):
    whole, parts = nine()
    points, core, _ = sampled(whole, 30)
    lower = replace(height_field(z=lambda x, y: 0 * x - 50), name="only")
    both = {"upper": horizon(parts, points, core), "lower": horizon([lower])}
    found = write_step(both, tmp_path / "both.step")
    assert list(found) == ["upper", "lower"]
    assert found["upper"].core_max_abs <= 1e-8
    assert np.isnan(found["lower"].core_max_abs)
    assert found["lower"].passed
    back = read_step(tmp_path / "both.step")
    assert list(back) == ["upper", "lower"]
    assert [p.name for p in back["lower"].patches] == ["only"]


@pytest.mark.usefixtures("read_here")
def test_trimmed_horizon(tmp_path):
    whole, parts = nine()
    points, core, d = sampled(whole)
    outline = [(100, 80), (900, 60), (950, 500), (500, 690), (80, 600)]
    surface = horizon(parts, points, core, outline=outline)
    found = write_step({"T1": surface}, tmp_path / "t.step")["T1"]
    assert found.passed
    assert checks(found)["outline"].passed
    # Points beyond the outline are measured to the surface that the file carries under its trimmed faces.
    assert found.core_max_abs <= 1e-8
    assert found.max_abs == pytest.approx(np.abs(d).max(), abs=1e-7)
    back = read_step(tmp_path / "t.step")["T1"]
    import shapely

    assert back.outline is not None
    same = shapely.Polygon(back.outline - ORIGIN[:2]).symmetric_difference(shapely.Polygon(outline)).area
    assert same < 1e-3
    x, y = ORIGIN[0] + np.array([500, 30.0]), ORIGIN[1] + np.array([300, 30.0])
    z = back.elevation(x, y)
    assert z[0] == pytest.approx(surface.elevation(x[0], y[0]), abs=1e-8)
    assert np.isnan(z[1])


def without_patch(x, y):
    """A study area with a notch from (x, y) on."""
    return [(0, 0), (1000, 0), (1000, y), (x, y), (x, 700), (0, 700)]


def test_points_on_a_patch_that_the_file_does_not_contain_are_left_out_and_counted(tmp_path):
    whole, parts = nine()
    points, core, d = sampled(whole)
    far = parts[-1].control.min(axis=(0, 1))[:2] - 20.0
    surface = horizon(parts, points, core, outline=without_patch(*far))
    absent = surface.project(points).patch == len(parts) - 1
    found = write_step({"T1": surface}, tmp_path / "l.step")["T1"]
    assert found.faces == len(parts) - 1
    assert found.passed
    # Points in the notch on the other patches are measured: the file carries those whole.
    assert found.core_max_abs <= 1e-8
    assert found.max_abs == pytest.approx(np.abs(d[~absent]).max(), abs=1e-7)
    assert found.sigma == pytest.approx(np.sqrt((d[~absent] ** 2).sum() / ((~absent).sum() - 1)), rel=1e-6)
    text = checks(found)["core"].text
    assert text.code == "cad.core-points-distance-left-out"
    figures = {key: text.params[key] for key in ("count", "left", "core")}
    assert figures == {"count": (core & ~absent).sum(), "left": absent.sum(), "core": (core & absent).sum()}
    assert figures["core"] > 0


@pytest.mark.parametrize(("unit", "origin"), [("m", "map"), ("mm", "local")])
@pytest.mark.parametrize("margin", [20.0, 0.0])
def test_a_file_gets_the_verdict_of_its_fit_with_a_whole_patch_outside_the_study_area(tmp_path, unit, origin, margin):
    """Points in the notch had been measured to the edge of the other patches: 49 m instead of 2e-5 m."""
    whole, parts = nine()
    points, core, d = sampled(whole)
    notch = parts[-1].control.min(axis=(0, 1))[:2] - margin
    surface = horizon(parts, points, core, outline=without_patch(*notch))
    write_step({"T0": horizon(parts), "T1": surface}, tmp_path / "l.step", unit=unit, origin=origin)
    assert [len(shape.face_names) for shape in read_shapes(tmp_path / "l.step")] == [9, 8]
    plain, back = read_step(tmp_path / "l.step").values()
    assert (len(plain.patches), len(back.patches)) == (9, 9)
    judged = judge(back, surface.points).accuracy
    assert judged.sigma == pytest.approx(np.sqrt((d**2).sum() / (len(d) - 1)), rel=1e-6)
    (beyond,) = [check for check in judged.checks if check.name == BEYOND]
    assert beyond.value == outside(surface.outline, points).sum() > 0
    write_step({"T1": back}, tmp_path / "again.step")
    assert judge(read_step(tmp_path / "again.step")["T1"], surface.points).accuracy.sigma == pytest.approx(judged.sigma)


@pytest.mark.parametrize(
    ("pattern", "by"),
    [
        ("'patches beyond the outline'", "''"),
        (r"REPRESENTATION\('patches beyond the outline',\(#", "REPRESENTATION('patches beyond the outline',(#9999"),
        (r"(REPRESENTATION\('patches beyond the outline',)", r"\1 "),
        (r"(B_SPLINE_SURFACE_WITH_KNOTS\('[^']*',3),", r"\1 ,"),
    ],
    ids=["unnamed", "another number", "another spacing", "surfaces spaced"],
)
def test_a_file_that_lost_the_patches_beyond_its_outline_is_measured_to_its_edge(tmp_path, pattern, by):
    whole, parts = nine()
    points, core, d = sampled(whole)
    surface = horizon(parts, points, core, outline=without_patch(*parts[-1].control.min(axis=(0, 1))[:2] - 20.0))
    write_step({"T1": surface}, tmp_path / "l.step")
    text = (tmp_path / "l.step").read_text("ascii")
    changed = re.sub(pattern, by, text)
    assert changed != text
    (tmp_path / "l.step").write_text(changed, "ascii")
    judged = judge(read_step(tmp_path / "l.step")["T1"], surface.points).accuracy
    assert judged.sigma > 100 * np.abs(d).max()
    (beyond,) = [check for check in judged.checks if check.name == BEYOND]
    assert beyond.text.params["within"] < np.abs(d).max()


def test_a_core_outside_the_study_area_is_not_measured_in_the_file(tmp_path):
    whole, parts = nine()
    points, core, _ = sampled(whole)
    on_last = horizon(parts, points).project(points).patch == len(parts) - 1
    far = parts[-1].control.min(axis=(0, 1))[:2] - 1.0
    surface = horizon(parts, points[on_last], core[on_last], outline=without_patch(*far))
    found = write_step({"T1": surface}, tmp_path / "l.step")["T1"]
    assert checks(found)["core"].passed is None
    assert np.isnan([found.core_max_abs, found.sigma, found.max_abs]).all()
    assert found.passed


def test_overturned_fold(tmp_path):
    patch = fold()
    u = np.unique(patch.knots_u)
    points, core, _ = sampled(patch)
    surface = horizon(split(patch, [u[12], u[25]], []), points, core)
    found = write_step({"fold": surface}, tmp_path / "fold.step")["fold"]
    assert found.passed
    assert found.core_max_abs <= 1e-8
    assert checks(found)["normals"].passed is not False


def test_a_gap_hidden_in_the_edge_tolerance_is_found(tmp_path):
    """Sewing at 0.02 m closes a 0.01 m gap and BRepCheck calls it valid."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopLoc import TopLoc_Location

    from geofit.cad.imported import FileShape

    whole, _ = nine()
    v = np.unique(whole.knots_v)
    one, two = split(whole, [], [v[7]])
    two = replace(two, control=two.control + np.array([0, 0, 0.01]))
    sewing = BRepBuilderAPI_Sewing(0.02)
    for patch in (one, two):
        sewing.Add(BRepBuilderAPI_MakeFace(to_geom(patch), 1e-7).Face())
    sewing.Perform()
    shape = sewing.SewedShape()
    assert BRepCheck_Analyzer(shape).IsValid()
    assert sorted(len(faces) for _, faces in edges_with_faces(shape)) == [1] * 6 + [2]
    surface = horizon([one, two])
    path = tmp_path / "hidden.step"
    path.write_text("")
    found = checks(
        read_back(surface, FileShape("hidden", shape, TopLoc_Location(), ("one", "two")), surface, shape, path)
    )
    assert found["validity"].passed
    assert found["seam gap"].passed is False
    assert 0.008 < found["seam gap"].value < 0.0101
    assert found["seam tolerance"].passed is False


def test_a_gap_is_not_written(tmp_path):
    _, parts = nine()
    apart = (*parts[:4], replace(parts[4], control=parts[4].control + np.array([0, 0, 0.01])), *parts[5:])
    with refused(StitchError, "cad.edges-not-shared"):
        write_step({"T1": horizon(apart)}, tmp_path / "gap.step")
    assert not list(tmp_path.iterdir())


def test_a_break_in_slope_fails_where_tangent_was_asked(tmp_path):
    kinked = height_field(25, 19, 3, multiplicity=3, z=lambda x, y: 0.1 * np.abs(x - 500))
    parts = split(kinked, [500.0], [])
    for seam, verdict in (("tangent", False), ("position", None)):
        found = checks(write_step({"k": horizon(parts, seam=seam)}, tmp_path / "k.step")["k"])
        assert found["seam angle"].passed is verdict
        assert found["seam angle"].value == pytest.approx(2 * np.degrees(np.arctan(0.1)), abs=1e-3)
        assert found["seam gap"].passed


def crossing():
    """A sheet rolled through itself: x goes forth and back while z crosses."""
    t = np.array([[0, 0], [200, 0], [200, 100], [100, 150], [0, 100], [60, -100]], float)
    knots_u = np.array([0, 0, 0, 0, 1, 2, 3, 3, 3, 3.0])
    knots_v = np.array([0, 0, 1, 1.0])
    control = np.stack([np.column_stack([t[:, 0], np.full(6, y), t[:, 1]]) for y in (0.0, 100.0)], axis=1)
    return Patch("core", (3, 1), knots_u, knots_v, control)


def test_a_self_crossing_face_is_found_where_brepcheck_passes(tmp_path):
    found = write_step({"x": horizon([crossing()])}, tmp_path / "x.step")["x"]
    assert found.brep_valid
    assert found.self_intersects
    assert checks(found)["self-intersection"].passed is False
    assert not found.passed


def test_two_patches_that_pierce_each_other_are_found():
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.TopoDS import TopoDS_Shell

    shape, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shape)
    for patch in (height_field(z=lambda x, y: 0.1 * x - 50), height_field(z=lambda x, y: 50 - 0.1 * x)):
        builder.Add(shape, BRepBuilderAPI_MakeFace(to_geom(patch), 1e-7).Face())
    assert self_intersects(shape)


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize("unit", ["MM", "M"])
def test_foreign_files_in_any_unit_with_planes_cylinders_and_trimmed_faces(tmp_path, unit):
    import cadquery
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Controller, STEPControl_Writer

    metre = 1000.0
    plane = cadquery.Workplane("XY").workplane(offset=20 * metre).rect(100 * metre, 60 * metre).extrude(metre)
    top = plane.faces(">Z").val().wrapped
    tube = cadquery.Workplane("YZ").circle(30 * metre).extrude(80 * metre).faces("%CYLINDER").val().wrapped
    patch = height_field(size=(100.0, 70.0), z=lambda x, y: 0.1 * x)
    large = to_geom(replace(patch, control=patch.control * metre))
    part = BRepBuilderAPI_MakeFace(large, 20.0, 60.0, 10.0, 50.0, 1e-7).Face()
    STEPControl_Controller.Init_s()
    before = Interface_Static.CVal_s("write.step.unit")
    Interface_Static.SetCVal_s("write.step.unit", unit)
    for name, face in (("plane", top), ("tube", tube), ("part", part)):
        writer = STEPControl_Writer()
        writer.Transfer(face, STEPControl_AsIs)
        writer.Write(str(tmp_path / f"{name}.step"))
    Interface_Static.SetCVal_s("write.step.unit", before)

    (flat,) = read_step(tmp_path / "plane.step").values()
    assert flat.elevation(10.0, 5.0) == pytest.approx(21, abs=1e-9)
    np.testing.assert_allclose(flat.distance([[10, 5, 23.5], [53, 0, 25]]), [2.5, 5], atol=1e-9)
    (round_,) = read_step(tmp_path / "tube.step").values()
    np.testing.assert_allclose(np.abs(round_.distance([[40, 0, 50], [40, 10, 0]])), [20, 20], atol=1e-6)
    (cut,) = read_step(tmp_path / "part.step").values()
    assert cut.patches[0].control[..., 0].min() == pytest.approx(20, abs=1e-6)
    assert cut.elevation(40.0, 30.0) == pytest.approx(4, abs=1e-6)
    assert np.isnan(cut.elevation(70.0, 30.0))


def test_opencascade_settings_are_put_back(written):
    from OCP.Interface import Interface_Static

    before = [Interface_Static.CVal_s(name) for name in ("xstep.cascade.unit", "write.step.schema")]
    read_shapes(written[1])
    assert [Interface_Static.CVal_s(name) for name in ("xstep.cascade.unit", "write.step.schema")] == before


def test_what_cannot_be_read_says_so(tmp_path, capfd):
    with refused(InputError, "data.file-missing"):
        read_step(tmp_path / "none.step")
    (tmp_path / "text.step").write_text("x, y, z\n1, 2, 3\n")
    with refused(InputError, "cad.not-step"):
        read_step(tmp_path / "text.step")
    (tmp_path / "empty.step").write_text("")
    with refused(InputError, "cad.not-step"):
        read_step(tmp_path / "empty.step")
    with refused(InputError, "data.file-not-written"):
        write_step({"x": horizon([height_field()])}, tmp_path / "nowhere" / "x.step")
    with refused(InputError, "data.no-surface"):
        write_step({}, tmp_path / "x.step")


def test_canonical_text():
    text = (
        "#1 = MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#2,#3),#4);\n#3 = SHELL_BASED_SURFACE_MODEL('',());\n"
        "#5 = NEXT_ASSEMBLY_USAGE_OCCURRENCE('17','层𠀀','',#1,#2,$);\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    out = canonical(text)
    assert "OCCURRENCE('1','\\X4\\00005C4200020000\\X0\\'" in out
    assert "#7 = STYLED_ITEM('color',(#8),#3);" in out
    assert out.endswith("ENDSEC;\nEND-ISO-10303-21;\n")


class Stuck:
    """OpenCASCADE's projection where it stops in a local minimum, 834 m off."""

    def Init(self, *_):  # noqa: N802
        pass

    def Perform(self, _):  # noqa: N802
        pass

    def NbPoints(self):  # noqa: N802
        return 1

    def LowerDistance(self):  # noqa: N802
        return 834.0


class StuckShapes:
    def __init__(self, *_):
        pass

    def Value(self):  # noqa: N802
        return 834.0


def on_it(surface):
    """The surface with points that it meets, all of them its core."""
    places = [
        patch.evaluate(*(np.quantile(knots, [0.2, 0.5, 0.9]) for knots in (patch.knots_u, patch.knots_v)))
        for patch in surface.patches
    ]
    points = PointSet(np.concatenate(places) + surface.origin)
    return surface.with_(points=points, core=np.ones(len(points), bool))


def test_a_projection_that_stops_in_a_local_minimum_is_no_fault_of_the_file(tmp_path, monkeypatch):
    monkeypatch.setattr("OCP.GeomAPI.GeomAPI_ProjectPointOnSurf", Stuck)
    monkeypatch.setattr("OCP.BRepExtrema.BRepExtrema_DistShapeShape", StuckShapes)
    back = write_step({"a": on_it(horizon(nine()[1], name="a"))}, tmp_path / "a.step")["a"]
    assert back.core_max_abs < 1e-6


def test_the_witness_hides_no_point_that_is_missed(tmp_path):
    surface = on_it(horizon(nine()[1], name="a"))
    off = surface.points.with_(xyz=surface.points.xyz + np.array([0, 0, 1e-3]))
    back = write_step({"a": surface.with_(points=off)}, tmp_path / "a.step")["a"]
    assert back.core_max_abs > 1e-4
    assert {check.name: check for check in back.checks}["read-back core"].passed is False


@pytest.mark.parametrize("name", ["强风化下限" * 20, "强a'𠀀" * 30, "a'" * 60, "ab cd" * 60])
def test_a_name_across_lines_is_whole(name, tmp_path):
    """OpenCASCADE breaks a string after 72 bytes, in the middle of a character or of a doubled quotation mark."""
    surface = geofit.fit_horizon(geofit.PointSet([[0, 0, 1.0], [9, 0, 2.0], [0, 9, 3.0], [9, 9, 4.0]]), name="a")
    write_step({name: surface}, tmp_path / "a.step")
    assert list(step_surfaces(tmp_path / "a.step")) == [name]


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="names of 255 bytes")
def test_the_reason_of_the_system_is_told_not_a_full_disk(tmp_path):
    surface = geofit.fit_horizon(geofit.PointSet([[0, 0, 1.0], [9, 0, 2.0], [0, 9, 3.0], [9, 9, 4.0]]), name="a")
    with pytest.raises(InputError, match=r"name too long.*Choose another name"):
        write_step({"a": surface}, tmp_path / f"{'a' * 260}.step")
    # As long as the system takes: names of temporary files are not longer.
    write_step({"a": surface}, tmp_path / f"{'a' * 250}.step")
