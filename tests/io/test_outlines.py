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


def test_one_plane_is_not_a_body(tmp_path):
    save(tmp_path / "a.dxf", [("S1", ring(0)), ("S2", ring(0, 3.0))])
    with pytest.raises(InputError, match="1 planes"):
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
