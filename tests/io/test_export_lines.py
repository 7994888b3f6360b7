"""Contours and section drawings read back by ezdxf and pyogrio."""

from __future__ import annotations

import numpy as np
import pytest
from surfaces import ORIGIN, height_field, horizon, nine

from geofit.data.errors import InputError, MissingDependencyError
from geofit.io.export.dxf import write_contours_dxf, write_section_dxf
from geofit.io.export.geopackage import write_contours_gpkg
from geofit.sampling.contours import contours
from geofit.sampling.cut import cut_section


@pytest.fixture(scope="module")
def lines():
    upper, lower = horizon(nine()[1]), horizon([height_field(z=lambda x, y: 0.1 * x - 30)])
    return {"T2/T1": contours(upper, 20.0, tolerance=0.5), "强风化": contours(lower, 20.0, tolerance=0.5)}


def test_dxf_contours_are_polylines_at_their_elevation(lines, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_contours_dxf(lines, tmp_path / "a.dxf")
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert not document.audit().errors
    assert document.units == 6
    for layer, name in (("T2_T1", "T2/T1"), ("强风化", "强风化")):
        found = list(document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]'))
        assert [p.dxf.elevation for p in found] == [c.elevation for c in lines[name]]
        assert [p.closed for p in found] == [c.closed for c in lines[name]]
        for polyline, contour in zip(found, lines[name], strict=True):
            corners = contour.line[:-1] if contour.closed else contour.line
            assert np.abs(np.array(polyline.get_points("xy")) - corners).max() < 1e-9


def test_geopackage_contours(lines, tmp_path):
    pyogrio = pytest.importorskip("pyogrio")
    import shapely

    write_contours_gpkg(lines, tmp_path / "a.gpkg", "EPSG:32648")
    meta, _, geometry, fields = pyogrio.raw.read(tmp_path / "a.gpkg", layer="contours")
    rows = [(name, contour) for name, found in lines.items() for contour in found]
    assert meta["crs"] == "EPSG:32648"
    assert list(meta["fields"]) == ["horizon", "elevation"]
    assert fields[0].tolist() == [name for name, _ in rows]
    assert fields[1].tolist() == [contour.elevation for _, contour in rows]
    for wkb, (_, contour) in zip(geometry, rows, strict=True):
        assert np.array_equal(shapely.get_coordinates(shapely.from_wkb(wkb)), contour.line)


def test_geopackage_twice_is_the_same_file_and_no_crs_is_none(lines, tmp_path):
    pyogrio = pytest.importorskip("pyogrio")
    for name in ("a.gpkg", "b.gpkg"):
        write_contours_gpkg(lines, tmp_path / name)
    assert (tmp_path / "a.gpkg").read_bytes() == (tmp_path / "b.gpkg").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.gpkg", "b.gpkg"]
    assert (
        not pyogrio.read_info(tmp_path / "a.gpkg")["crs"] or "ndefined" in pyogrio.read_info(tmp_path / "a.gpkg")["crs"]
    )


def test_geopackage_refusals(lines, tmp_path, monkeypatch):
    pytest.importorskip("pyogrio")
    with pytest.raises(InputError, match="no contour"):
        write_contours_gpkg({"T1": []}, tmp_path / "a.gpkg")
    with pytest.raises(InputError, match="cannot be written"):
        write_contours_gpkg(lines, tmp_path / "a.gpkg", "no such system")
    assert list(tmp_path.iterdir()) == []
    monkeypatch.setitem(__import__("sys").modules, "pyogrio", None)
    with pytest.raises(MissingDependencyError, match="gis"):
        write_contours_gpkg(lines, tmp_path / "a.gpkg")


def test_section_drawing_and_section_in_space(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    surface = horizon(nine()[1])
    found = {"T1": cut_section(surface, np.array([[-50, 30], [420, 333], [990, 120]]) + ORIGIN[:2], tolerance=0.5)}
    write_section_dxf(found, tmp_path / "flat.dxf")
    write_section_dxf(found, tmp_path / "space.dxf", drawn=False)
    (line,) = found["T1"]
    flat, space = ezdxf.readfile(tmp_path / "flat.dxf"), ezdxf.readfile(tmp_path / "space.dxf")
    assert not flat.audit().errors
    assert not space.audit().errors
    (drawn,) = flat.modelspace().query("LWPOLYLINE")
    assert np.abs(np.array(drawn.get_points("xy")) - np.column_stack([line.distance, line.xyz[:, 2]])).max() < 1e-9
    (curve,) = space.modelspace().query("POLYLINE")
    assert np.abs(np.array([list(p) for p in curve.points()]) - line.xyz).max() < 1e-9
