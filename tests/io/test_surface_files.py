"""Surfaces to be checked from IGES, BREP and GOCAD TSurf: what was written is what is measured."""

from __future__ import annotations

import csv
import json
import re

import numpy as np
import pytest
from numpy.testing import assert_allclose
from surfaces import ORIGIN, fold, height_field, horizon, nine

from geofit.cad.export import write_brep, write_iges
from geofit.cad.step import write_step
from geofit.data.errors import InputError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.judge import judge
from geofit.io.export.tsurf import write_tsurf
from geofit.io.export.write import write_surface
from geofit.io.surface_files import read_surface, read_surfaces
from geofit.surfaces.mesh_surface import MeshSurface
from geofit.surfaces.trimmed import TrimmedSurface

OUTLINE = [[100, 80], [500, 20], [900, 100], [950, 600], [80, 650]]
LONG = "T1, top of the weathered zone"


@pytest.fixture(scope="module")
def surfaces():
    return {LONG: horizon(nine()[1], outline=OUTLINE), "fold": horizon([fold()])}


@pytest.fixture(scope="module")
def files(surfaces, tmp_path_factory):
    folder = tmp_path_factory.mktemp("surfaces")
    write_iges(surfaces, folder / "a.igs")
    write_brep(surfaces, folder / "a.brep")
    write_tsurf({name: surface.triangulate(0.5) for name, surface in surfaces.items()}, folder / "a.ts")
    return folder


def points_near(surface, n=200, seed=0):
    """Places on a surface moved up by a known distance along its normal."""
    rng = np.random.default_rng(seed)
    patch = surface.patches[4 % len(surface.patches)]
    u0, u1, v0, v1 = patch.domain
    u, v = rng.uniform(u0, u1, n), rng.uniform(v0, v1, n)
    moved = rng.normal(0, 0.5, n)
    xyz = patch.evaluate(u, v) + moved[:, None] * patch.normal(u, v) + surface.origin
    return xyz, moved


@pytest.mark.parametrize(
    ("file", "names", "within"),
    [("a.igs", [LONG, "fold"], 2e-8), ("a.brep", ["a", "a 2"], 1e-9), ("a.ts", [LONG, "fold"], 0.5)],
)
def test_what_was_written_is_measured(file, names, within, files, surfaces):
    found = read_surfaces(files / file)
    assert list(found) == names
    for one, known in zip(found.values(), surfaces.values(), strict=True):
        xyz, moved = points_near(known)
        assert np.abs(np.abs(one.distance(xyz)) - np.abs(known.distance(xyz))).max() < within
        assert np.abs(np.abs(known.distance(xyz)) - np.abs(moved)).max() < 1e-6


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize("file", ["a.igs", "a.brep", "a.ts"])
def test_the_surface_ends_at_its_outline(file, files, surfaces):
    one = next(iter(read_surfaces(files / file).values()))
    x, y = ORIGIN[0] + np.array([50.0, 500, 500, 980]), ORIGIN[1] + np.array([300.0, 300, 690, 20])
    known = surfaces[LONG].elevation(x, y)
    assert np.isnan(known).tolist() == [True, False, True, True]
    assert np.isnan(one.elevation(x, y)).tolist() == [True, False, True, True]
    assert one.elevation(x[1], y[1]) == pytest.approx(known[1], abs=0.5)
    # 40 m beyond the outline is 40 m and more from the surface, not the centimetres to a patch that reaches on.
    whole = surfaces[LONG].with_(outline=None)
    place = np.column_stack([x, y, whole.elevation(x, y)])
    assert np.abs(whole.distance(place)).max() < 1e-6
    assert (np.abs(one.distance(place))[[0, 2, 3]] > 30).all()
    judged = judge(one, PointSet(place, file="p.csv", row=np.arange(4)), FitSettings(), "T1")
    (check,) = [check for check in judged.accuracy.checks if check.name == "beyond the surface"]
    assert check.value == 3
    assert sum("p.csv" in str(note) for note in judged.accuracy.notes) == 3


@pytest.mark.usefixtures("read_here")
def test_sigma_of_a_given_surface_is_eq_3(files, surfaces):
    one = read_surfaces(files / "a.igs")[LONG]
    xyz, moved = points_near(surfaces[LONG], 50)
    kinds = np.array(["borehole", "section"] * 25)
    judged = judge(one, PointSet(xyz, kind=kinds), FitSettings(epsilon=0.1), "T1")
    accuracy = judged.accuracy
    assert accuracy.sigma == pytest.approx(np.sqrt((moved**2).sum() / 49), abs=1e-6)
    assert not accuracy.passed
    assert accuracy.by_kind["section"].n == 25
    assert accuracy.by_kind["section"].max_abs == pytest.approx(np.abs(moved[1::2]).max(), abs=1e-6)
    assert accuracy.over["interior_tolerance"].count == (np.abs(moved) > 0.1).sum()


@pytest.mark.usefixtures("read_here")
def test_loose_faces_are_one_surface_and_units_are_converted(tmp_path):
    import cadquery as cq

    boxes = [cq.Face.makePlane(500, 1000, (500 + 1000 * k, 250, 0)) for k in range(3)]
    from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer

    IGESControl_Controller.Init_s()
    writer = IGESControl_Writer("MM", 0)
    for box in boxes:
        writer.AddShape(box.wrapped)
    writer.ComputeModel()
    assert writer.Write(str(tmp_path / "loose.igs"))
    (one,) = read_surfaces(tmp_path / "loose.igs").values()
    assert one.name == "loose"
    assert len(one.patches) == 3
    # OpenCASCADE's own unit is the millimetre: 3,000 by 500 of them.
    assert one.distance([[1.5, 0.25, 2.0], [4.0, 0.25, 0.0]]) == pytest.approx([2.0, 1.0], abs=1e-9)


def test_a_tsurf_of_several_parts_in_feet_and_depth(tmp_path):
    text = """GOCAD TSurf 1
HEADER {
name:base
}
AXIS_UNIT "ft" "ft" "ft"
ZPOSITIVE Depth
TFACE
VRTX 1 0 0 100
PVRTX 2 1000 0 100 7.5
VRTX 3 0 1000 100
TRGL 1 2 3
TFACE
ATOM 4 2
VRTX 5 1000 1000 100
TRGL 4 5 3
END
GOCAD VSet 1
VRTX 1 0 0 0
END
"""
    (tmp_path / "b.ts").write_text(text)
    (one,) = read_surfaces(tmp_path / "b.ts").values()
    assert isinstance(one, MeshSurface)
    assert one.name == "base"
    foot = 0.3048
    assert one.distance([[500 * foot, 700 * foot, 0.0]]) == pytest.approx([100 * foot])
    assert one.elevation(900 * foot, 900 * foot) == pytest.approx(-100 * foot)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("VRTX 1 0 0 0\nVRTX 2 1 0 0\nTRGL 1 2 3\n", "row 4.*TRGL"),
        ("VRTX 1 0 0 x\n", "row 2.*VRTX"),
        ("VRTX 1 0 0 nan\n", "row 2"),
        ('AXIS_UNIT "yd" "yd" "yd"\n', "unit 'yd'"),
        ("VRTX 1 0 0 0\n", "no triangle"),
    ],
)
def test_a_damaged_tsurf_is_named(text, words, tmp_path):
    (tmp_path / "b.ts").write_text("GOCAD TSurf 1\n" + text)
    with pytest.raises(InputError, match=words):
        read_surfaces(tmp_path / "b.ts")


@pytest.mark.parametrize("name", ["a.igs", "a.brep", "a.ts", "a.step"])
def test_what_is_no_surface_is_said(name, tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_surfaces(tmp_path / name)
    (tmp_path / name).write_text("no surface\n")
    with pytest.raises(InputError, match=re.escape(name)):
        read_surfaces(tmp_path / name)
    with pytest.raises(InputError, match=r"'\.dwg'.*\.brep"):
        read_surfaces(tmp_path / "a.dwg")


def test_a_mesh_goes_to_triangle_formats_and_grids_not_to_nurbs(files, tmp_path):
    found = {LONG: read_surfaces([files / "a.ts"])[LONG]}
    for to in ("obj", "landxml", "tsurf", "asc", "dxf", "ply"):
        assert write_surface(found, tmp_path / f"a.{to}", format=to, cell=50.0)
    again = next(iter(read_surfaces((tmp_path / "a.tsurf").rename(tmp_path / "b.ts")).values()))
    assert np.abs(again.mesh.xyz - found[LONG].mesh.xyz).max() < 1e-6
    for to in ("step", "iges", "brep", "ifc"):
        with pytest.raises(InputError, match=r"triangle mesh.*landxml"):
            write_surface(found, tmp_path / "x", format=to)


def run(monkeypatch, capsys, *arguments):
    from geofit.cli.main import main

    monkeypatch.setattr("sys.argv", ["geofit", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    captured = capsys.readouterr()
    return int(stop.value.code or 0), captured.out, captured.err


@pytest.mark.usefixtures("read_here")
def test_the_commands_take_every_format(files, surfaces, tmp_path, monkeypatch, capsys):
    xyz, moved = points_near(surfaces[LONG], 40)
    with (tmp_path / "p.csv").open("w", newline="") as stream:
        csv.writer(stream).writerows([("x", "y", "z"), *(map(repr, map(float, row)) for row in xyz)])
    for file, more in (("a.igs", LONG), ("a.ts", LONG)):
        arguments = ["check", files / file, tmp_path / "p.csv", "--epsilon", "1", "--json", "--out", tmp_path]
        code, _, err = run(monkeypatch, capsys, *arguments)
        assert (code, "2 surfaces" in err) == (2, True)
        code, out, _ = run(monkeypatch, capsys, "info", files / file, "--json")
        assert [row["surface"] for row in json.loads(out)] == [more, "fold"]
    write_surface({"T1": surfaces[LONG].with_(outline=None)}, tmp_path / "one.igs", format="iges")
    code, out, _ = run(
        monkeypatch, capsys, "check", tmp_path / "one.igs", tmp_path / "p.csv", "--epsilon", "1", "--json"
    )
    assert code == 0
    assert json.loads(out)["sigma"] == pytest.approx(np.sqrt((moved**2).sum() / 39), abs=1e-6)
    line = f"{ORIGIN[0] + 200},{ORIGIN[1] + 200},{ORIGIN[0] + 800},{ORIGIN[1] + 500}"
    code, out, _ = run(monkeypatch, capsys, "section", files / "a.ts", "--line", line, "--out", tmp_path / "s")
    assert code == 0
    assert LONG in out


@pytest.mark.usefixtures("read_here")
def test_a_foreign_step_is_a_trimmed_surface(tmp_path):
    import cadquery as cq

    cq.exporters.export(cq.Workplane(obj=cq.Face.makeFromWires(cq.Wire.makeCircle(5000, (0, 0, 0), (0, 0, 1)))),
                        str(tmp_path / "disc.step"))  # fmt: skip
    (one,) = read_surfaces(tmp_path / "disc.step").values()
    assert isinstance(one, TrimmedSurface)
    judged = judge(one, PointSet([[4.5, 4.5, 0], [0, 0, 0.1]]), FitSettings(), "disc")
    # The corner of the square around the disc lies 1.36 m from it: 4.5 sqrt(2) - 5.
    assert np.abs(judged.accuracy.residuals) == pytest.approx([4.5 * np.sqrt(2) - 5, 0.1], abs=0.007)
    assert not judged.accuracy.passed
    (check,) = [check for check in judged.accuracy.checks if check.name == "interior tolerance"]
    assert check.value == judged.accuracy.max_abs
    assert not check.passed


def test_five_thousand_triangles_are_measured_exactly():
    surface = horizon([height_field(nu=40, nv=40, degree=1, size=(1000, 1000))])
    mesh = surface.triangulate(1.0)
    assert len(mesh.triangles) > 3000
    one = MeshSurface(mesh)
    rng = np.random.default_rng(3)
    share = rng.dirichlet([1, 1, 1], len(mesh.triangles))
    places = np.einsum("nk,nkd->nd", share, mesh.points[mesh.triangles])
    assert np.abs(one.distance(places + ORIGIN)).max() < 1e-8


@pytest.fixture(scope="module", params=["step", "igs", "brep"])
def foreign_surface(request, tmp_path_factory):
    """A surface as it is read from a file of a CAD format."""
    path = tmp_path_factory.mktemp("foreign") / f"a.{request.param}"
    write_surface(horizon([nine()[0]]), path)
    return read_surface(path)


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize("target", ["step", "igs", "brep", "ifc", "stl"])
def test_a_surface_that_was_read_is_written_again(foreign_surface, target, tmp_path):
    """A file of one CAD format becomes one of another: no points and no settings are needed for that."""
    whole, second = nine()[0], tmp_path / f"b.{target}"
    write_surface(foreign_surface, second)
    if target in ("step", "igs", "brep"):
        x, y = (ORIGIN[:2] + np.random.default_rng(3).uniform((20, 20), (980, 680), (50, 2))).T
        assert_allclose(read_surface(second).elevation(x, y), horizon([whole]).surface.elevation(x, y), atol=1e-6)


@pytest.mark.usefixtures("read_here")
def test_the_read_back_of_an_unfitted_surface_has_no_points(tmp_path):
    write_surface(horizon(nine()[1]), tmp_path / "a.igs")
    found = read_surface(tmp_path / "a.igs")
    (back,) = write_step({"a": found}, tmp_path / "a.step").values()
    checks = {check.name: check for check in back.checks}
    assert checks["read-back core"].passed is None
    assert checks["read-back seam angle"].passed is None
    assert checks["read-back validity"].passed


HEAD = "GOCAD TSurf 1\nHEADER {\nname:T1\n}\n"
TRIANGLE = "TFACE\nVRTX 1 0 0 10\nVRTX 2 100 0 20\nVRTX 3 0 100 30\nTRGL 1 2 3\nEND\n"


def test_a_brep_of_surfaces_of_one_face_keeps_them_apart(tmp_path):
    """Three horizons came back as one surface, whose elevations were those of the first."""
    upper, lower = horizon([height_field()]), horizon([height_field()])
    lower = lower.with_(origin=lower.origin - np.array([0.0, 0.0, 50.0]))
    write_brep({"upper": upper, "lower": lower}, tmp_path / "a.brep")
    one, two = read_surfaces(tmp_path / "a.brep").values()
    assert_allclose(two.origin - one.origin, [0, 0, -50], atol=1e-9)
    assert [len(one.patches), len(two.patches)] == [1, 1]


@pytest.mark.parametrize("name", ["a.step", "a.igs", "a.brep", "a.ts"])
def test_a_folder_is_not_called_a_missing_file(name, tmp_path):
    (tmp_path / name).mkdir()
    with pytest.raises(InputError) as told:
        read_surfaces(tmp_path / name)
    assert told.value.code in ("cad.path-is-folder", "io.file-not-opened")


@pytest.mark.parametrize(
    ("units", "factors"),
    [
        ('"m" "m" "m"', (1, 1, 1)),
        ('" m " " m " " ft "', (1, 1, 0.3048)),
        ("ft ft ft", (0.3048,) * 3),
        ('"none" "None" "ft"', (1, 1, 0.3048)),
        ('"" "unitless" "unknown"', (1, 1, 1)),
    ],
)
def test_units_of_a_tsurf_may_have_blanks_or_be_none(units, factors, tmp_path):
    """As points, such a file had counted its elevations by the unit of another axis, or none."""
    from geofit.io import read_points

    (tmp_path / "a.ts").write_text(HEAD + f"AXIS_UNIT {units}\n" + TRIANGLE)
    (surface,) = read_surfaces(tmp_path / "a.ts").values()
    places = np.array([[0, 0, 10], [100, 0, 20], [0, 100, 30]]) * factors
    assert_allclose(surface.mesh.xyz, places)
    found = read_points(tmp_path / "a.ts")
    (points,) = found.horizons.values()
    assert_allclose(points.xyz, places)
    assert "io.unit-of-column-unknown" not in [issue.reason.code for issue in found.issues]


@pytest.mark.parametrize(
    "head", ["HEADER {name:Top T1}\n", "HEADER {\nname: Top T1 \n}\n", 'HEADER{\n*name:x\nname:"Top T1"\n}\n']
)
def test_a_tsurf_has_its_name_in_each_form_of_the_header(head, tmp_path):
    from geofit.io import read_points

    (tmp_path / "a.ts").write_text("GOCAD TSurf 1\n" + head + TRIANGLE)
    assert list(read_surfaces(tmp_path / "a.ts")) == list(read_points(tmp_path / "a.ts").horizons) == ["Top T1"]


def test_control_characters_in_a_name_leave_a_tsurf_readable(tmp_path):
    """A NUL in the name of a horizon had made the whole file "not text"."""
    mesh = horizon([height_field()], name="T").triangulate(5.0)
    write_tsurf({"a\0b\x07\nc": mesh}, tmp_path / "a.ts")
    assert list(read_surfaces(tmp_path / "a.ts")) == ["a b c"]


def test_a_mark_for_no_data_is_no_elevation(tmp_path):
    """Of depths, -99999 became an elevation of +99,999 m; of a surface, a vertex at -99,999 m."""
    from geofit.io import read_points

    rows = "VRTX 1 0 0 10\nVRTX 2 100 0 20\nVRTX 3 0 100 30\nVRTX 4 100 100 -99999\nVRTX 5 9 9 1e30\n"
    (tmp_path / "a.vs").write_text(f"GOCAD VSet 1\nHEADER {{\nname:T1\n}}\nZPOSITIVE Depth\n{rows}END\n")
    (points,) = read_points(tmp_path / "a.vs").horizons.values()
    assert sorted(points.xyz[:, 2]) == [-30, -20, -10]
    (tmp_path / "a.ts").write_text(f"{HEAD}TFACE\n{rows}TRGL 1 2 3\nTRGL 2 3 4\nEND\n")
    with pytest.raises(InputError) as told:
        read_surfaces(tmp_path / "a.ts")
    assert (told.value.code, told.value.row) == ("io.vertex-without-elevation", 9)


def test_a_tsurf_without_its_end_is_refused(tmp_path):
    (tmp_path / "a.ts").write_text(HEAD + TRIANGLE.replace("END\n", ""))
    with pytest.raises(InputError) as told:
        read_surfaces(tmp_path / "a.ts")
    assert told.value.code == "io.tsurf-without-end"
