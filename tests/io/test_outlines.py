"""Outlines of drawings and GeoJSON, and picked points of a body: what is used, what is listed, what is refused."""

from __future__ import annotations

import json

import ezdxf
import numpy as np
import pytest
from ezdxf.math import UCS

from geofit.data.errors import InputError
from geofit.io.body_points import read_body_points
from geofit.io.outlines import read_outlines

PLACE = np.array([500_000.0, 3_100_000.0, 800.0])
ANGLE = np.linspace(0, 2 * np.pi, 24, endpoint=False)


def ring(x, size=10.0):
    return PLACE + np.column_stack([np.full(24, x), size * np.cos(ANGLE), size * np.sin(ANGLE)])


def save(path, lines):
    document = ezdxf.new("R2010")
    for layer, xyz in lines:
        document.modelspace().add_polyline3d(xyz, close=True, dxfattribs={"layer": layer})
    document.saveas(path)
    return document


def test_outlines_are_grouped_by_their_planes(tmp_path):
    save(tmp_path / "a.dxf", [("ORE", ring(0)), ("ORE", ring(20)), ("HOLE", ring(20, 3.0)), ("S9", ring(40))])
    found = read_outlines(tmp_path / "a.dxf")
    assert found.layers == {"ORE": 2, "HOLE": 1, "S9": 1}
    assert [(one.section, float(one.xyz[0, 0] - PLACE[0])) for one in found.outlines] == [
        ("ORE 1", 0.0), ("ORE 2", 20.0), ("ORE 2", 20.0), ("S9", 40.0),
    ]  # fmt: skip
    some = read_outlines(tmp_path / "a.dxf", ["ORE"])
    assert [one.section for one in some.outlines] == ["ORE 1", "ORE 2"]
    with pytest.raises(InputError, match="NOPE"):
        read_outlines(tmp_path / "a.dxf", ["NOPE"])


def test_a_flat_polyline_in_a_coordinate_system_of_its_own_lies_at_its_true_place(tmp_path):
    document = ezdxf.new("R2010")
    for x in (0.0, 20.0):
        upright = UCS(origin=tuple(PLACE + np.array([x, 0.0, 0.0])), ux=(0, 1, 0), uz=(1, 0, 0))
        square = [upright.to_ocs((u, v, 0)) for u, v in ((-5, -5), (5, -5), (5, 5), (-5, 5))]
        attributes = {"extrusion": upright.uz, "elevation": square[0].z, "layer": f"S{x:g}"}
        document.modelspace().add_lwpolyline([(p.x, p.y) for p in square], close=True, dxfattribs=attributes)
    document.saveas(tmp_path / "a.dxf")
    first, second = read_outlines(tmp_path / "a.dxf").outlines
    assert first.xyz - PLACE == pytest.approx(np.array([[0, -5, -5], [0, 5, -5], [0, 5, 5], [0, -5, 5.0]]), abs=1e-6)
    assert second.xyz[:, 0] == pytest.approx(PLACE[0] + 20)


def test_what_is_no_outline_is_listed(tmp_path):
    document = save(tmp_path / "a.dxf", [("S1", ring(0)), ("S2", ring(20))])
    space = document.modelspace()
    space.add_text("A", dxfattribs={"layer": "TITLE"})
    space.add_polyline3d(ring(40), dxfattribs={"layer": "OPEN"})
    bent = ring(60)
    bent[::2, 0] += 4.0
    space.add_polyline3d(bent, close=True, dxfattribs={"layer": "BENT"})
    document.saveas(tmp_path / "a.dxf")
    found = read_outlines(tmp_path / "a.dxf")
    assert {one.section for one in found.outlines} == {"S1", "S2"}
    assert {(one.column, one.severity) for one in found.issues} == {
        ("TITLE", "note"),
        ("OPEN", "error"),
        ("BENT", "error"),
    }


@pytest.mark.parametrize(
    ("draw", "code", "remedy"),
    [
        ("open", "io.other-on-layer", "io.close-or-explode"),
        ("block", "io.other-on-layer", "io.close-or-explode"),
        ("nothing", "io.no-outline-layer", "io.draw-closed-polylines"),
    ],
)
def test_a_layer_without_a_closed_line_says_what_is_on_it(tmp_path, draw, code, remedy):
    document = ezdxf.new("R2010")
    corners = [(0, 0, 0), (9, 0, 0), (9, 9, 0)]
    if draw == "open":
        document.modelspace().add_polyline3d(corners, dxfattribs={"layer": "ORE"})
    if draw == "block":
        document.blocks.new("X").add_polyline3d(corners, close=True, dxfattribs={"layer": "ORE"})
        document.modelspace().add_blockref("X", (0, 0, 0))
    document.saveas(tmp_path / "ore.dxf")
    with pytest.raises(InputError) as wrong:
        read_outlines(tmp_path / "ore.dxf", ["ORE"])
    assert (wrong.value.code, wrong.value.remedy.code) == (code, remedy)
    assert len(wrong.value.issues) == (draw != "nothing")


@pytest.mark.parametrize(
    ("unit", "metres", "issues"),
    [
        (None, 0.3048, [("warning", "io.drawing-unit-converted")]),
        ("ft", 0.3048, [("note", "io.stated-unit-converted")]),
        ("m", 1.0, []),
    ],
)
def test_a_drawing_is_read_in_the_unit_that_it_states_or_that_is_given(tmp_path, unit, metres, issues):
    document = ezdxf.new("R2010", units=ezdxf.units.FT)
    for x in (0.0, 10.0):
        document.modelspace().add_polyline3d(ring(x).tolist(), close=True, dxfattribs={"layer": "ORE"})
    document.saveas(tmp_path / "ore.dxf")
    read = read_outlines(tmp_path / "ore.dxf", unit=unit)
    assert [(issue.severity, issue.reason.code) for issue in read.issues] == issues
    np.testing.assert_allclose(read.outlines[1].xyz, metres * ring(10.0))


def test_the_unit_of_geojson_and_points_is_given_and_that_of_a_site_file_is_its_own(tmp_path):
    (tmp_path / "ore.geojson").write_text(features(*(({}, "LineString", closed(ring(x))) for x in (0, 10))), "utf-8")
    metres, feet = (read_outlines(tmp_path / "ore.geojson", unit=unit) for unit in (None, "ft"))
    np.testing.assert_allclose(feet.outlines[0].xyz, 0.3048 * metres.outlines[0].xyz)
    (tmp_path / "p.csv").write_text("x,y,z\n1,2,3\n4,5,6\n", "utf-8")
    np.testing.assert_allclose(read_body_points(tmp_path / "p.csv", unit="km").data.contacts[0], [1000, 2000, 3000])
    (tmp_path / "site.toml").write_text("[site]\n", "utf-8")
    with pytest.raises(InputError) as wrong:
        read_outlines(tmp_path / "site.toml", ["ORE"], unit="ft")
    assert wrong.value.code == "io.site-states-units"


def test_one_plane_is_not_a_body(tmp_path):
    save(tmp_path / "a.dxf", [("S1", ring(0)), ("S2", ring(0, 3.0))])
    with pytest.raises(InputError, match="1 plane;"):
        read_outlines(tmp_path / "a.dxf")


def features(*shapes, **top):
    made = [{"type": "Feature", "properties": p, "geometry": {"type": k, "coordinates": c}} for p, k, c in shapes]
    return json.dumps({"type": "FeatureCollection", "features": made, **top})


def closed(xyz):
    return [*xyz.tolist(), xyz[0].tolist()]


def test_polygons_and_closed_lines_of_geojson(tmp_path):
    file = tmp_path / "a.geojson"
    file.write_text(features(
        ({"section": "S1"}, "Polygon", [closed(ring(0)), closed(ring(0, 3.0))]),
        ({"section": "S2"}, "LineString", closed(ring(20))),
        ({"section": "S3"}, "LineString", ring(40).tolist()),
    ))  # fmt: skip
    found = read_outlines(file)
    assert [(one.section, len(one.xyz)) for one in found.outlines] == [("S1", 24), ("S1", 24), ("S2", 24)]
    assert [(one.row, one.severity) for one in found.issues] == [(3, "error")]


@pytest.mark.parametrize("text", ["", "{", "[]", '{"type": "FeatureCollection"}', '{"type": "Feature", "geometry": 3}'])
def test_geojson_that_cannot_be_read(tmp_path, text):
    (tmp_path / "a.geojson").write_text(text)
    with pytest.raises(InputError):
        read_outlines(tmp_path / "a.geojson")


def test_longitudes_and_latitudes_are_refused(tmp_path):
    small = [(({}, "Polygon", [closed((ring(x) - PLACE) * 1e-4 + [110.0, 30.0, 500.0])])) for x in (0, 20)]
    (tmp_path / "a.geojson").write_text(features(*small))
    with pytest.raises(InputError, match="longitude"):
        read_outlines(tmp_path / "a.geojson")


def test_points_with_normals_sides_and_holes(tmp_path):
    (tmp_path / "p.csv").write_text(
        "X;Y;Z;OrientX;OrientY;OrientZ;side;hole\n1;2;3;0;0;1;;A\n1;2;9;-99999;-99999;-99999;contact;A\n"
        "1;2;5;;;;inside;B\n1;2;99;;;;体外;\n1;2;7;;;;beside;\n1;2;x;;;;;\n",
        encoding="utf-8",
    )
    found = read_body_points(tmp_path / "p.csv")
    data = found.data
    assert (len(data.contacts), len(data.inside), len(data.outside)) == (2, 1, 1)
    assert data.normals[0].tolist() == [0, 0, 1]
    assert np.isnan(data.normals[1]).all()
    assert (data.hole.tolist(), data.inside_hole.tolist()) == (["A", "A"], ["B"])
    assert sorted(one.row for one in found.issues if one.severity == "error") == [6, 7]


def test_points_outside_alone_bound_nothing(tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z,side\n1,2,3,outside\n4,5,6,outside\n", encoding="utf-8")
    with pytest.raises(InputError, match="only points outside"):
        read_body_points(tmp_path / "p.csv")


START, AZIMUTH = np.array([500_000.0, 3_100_000.0]), np.radians(30.0)
ALONG = np.array([np.sin(AZIMUTH), np.cos(AZIMUTH)])
ACROSS = np.array([ALONG[1], -ALONG[0]])


def flat_site(folder, sections=5, scale=1000.0, origin=(250.0, -75.0), length=100.0):
    """Write a site whose sections cross a lens, each drawn flat in drawing units of its own; return the site file."""
    tables = []
    for k in range(sections):
        across = 15.0 * (k - (sections - 1) / 2)
        width = 30.0 * np.sqrt(1 - (across / 60) ** 2)
        uv = np.column_stack([50.0 + width * np.cos(ANGLE), 700.0 + 0.4 * width * np.sin(ANGLE)]) * scale + origin
        document = ezdxf.new("R2010")
        space = document.modelspace()
        space.add_lwpolyline(uv.tolist(), close=True, dxfattribs={"layer": "ORE"})
        space.add_lwpolyline((np.array([[0, 720], [100, 725.0]]) * scale + origin).tolist(), dxfattribs={"layer": "T2"})
        document.saveas(folder / f"S{k}.dxf")
        ends = [(START + across * ACROSS + t * ALONG).tolist() for t in (0.0, length)]
        tables.append(
            f'[[section]]\nname = "S{k}"\nline = {ends}\nfile = "S{k}.dxf"\nscale = {scale}\norigin = {list(origin)}\n'
        )
    (folder / "site.toml").write_text("\n".join(tables), encoding="utf-8")
    return folder / "site.toml"


@pytest.mark.parametrize(("scale", "origin"), [(1.0, (0.0, 0.0)), (1000.0, (250.0, -75.0)), (3.28084, (0.0, -300.0))])
def test_flat_sections_of_a_site_file_lie_at_their_true_places(tmp_path, scale, origin):
    found = read_outlines(flat_site(tmp_path, scale=scale, origin=origin), ["ORE"])
    assert found.layers == {"ORE": 5}
    by_section = {one.section: one.xyz for one in found.outlines}
    assert sorted(by_section) == [f"S{k}" for k in range(5)]
    for k in range(5):
        across = 15.0 * (k - 2)
        width = 30.0 * np.sqrt(1 - (across / 60) ** 2)
        plan = START + across * ACROSS + np.outer(50.0 + width * np.cos(ANGLE), ALONG)
        true = np.column_stack([plan, 700.0 + 0.4 * width * np.sin(ANGLE)])
        np.testing.assert_allclose(by_section[f"S{k}"], true, atol=1e-6)
    # Open lines belong to horizons: they are notes, and no errors.
    assert {(one.severity, one.column) for one in found.issues} == {("note", "T2")}
    assert set(found.inputs) == {"site.toml", *(f"S{k}.dxf" for k in range(5))}


def test_a_flat_outline_beyond_its_section_line_is_listed(tmp_path):
    site = flat_site(tmp_path, length=78.0)
    found = read_outlines(site)
    errors = [one for one in found.issues if one.severity == "error"]
    # The three middle sections are wider than 28 m from the middle of their lines.
    widths = [30.0 * np.sqrt(1 - (15.0 * (k - 2) / 60) ** 2) for k in range(5)]
    assert [one.file for one in errors] == [f"S{k}.dxf" for k in range(5) if widths[k] > 28.01]
    assert len(found.outlines) == 5 - len(errors)


def test_plans_at_levels_give_outlines(tmp_path):
    tables = []
    for level in (680.0, 700.0):
        document = ezdxf.new("R2010")
        document.modelspace().add_circle((20.0, 30.0), 8.0, dxfattribs={"layer": "VOID"})
        document.saveas(tmp_path / f"L{level:g}.dxf")
        tables.append(f'[[level]]\nelevation = {level}\nfile = "L{level:g}.dxf"\nscale = 0.5\norigin = [10, 10]\n')
    (tmp_path / "site.toml").write_text("\n".join(tables), encoding="utf-8")
    found = read_outlines(tmp_path / "site.toml")
    assert [one.section for one in found.outlines] == ["level 680", "level 700"]
    for one, level in zip(found.outlines, (680.0, 700.0), strict=True):
        assert (one.xyz[:, 2] == level).all()
        np.testing.assert_allclose(np.hypot(one.xyz[:, 0] - 20, one.xyz[:, 1] - 40), 16.0, rtol=1e-3)


def test_a_site_file_without_drawings_is_refused(tmp_path):
    (tmp_path / "site.toml").write_text('[site]\nname = "none"\n', encoding="utf-8")
    with pytest.raises(InputError, match="drawing"):
        read_outlines(tmp_path / "site.toml")
