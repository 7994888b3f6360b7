"""Texts in several encodings or with damaged characters: every row is read, and what is lost is listed."""

from __future__ import annotations

import json
from importlib import import_module

import ezdxf
import numpy as np
import pytest

import geofit
from geofit.io import read_points
from geofit.io.export.write import FORMATS
from geofit.io.sniff import decode

ROWS = [f"钻孔{i},强风化砂岩,{500_000 + 7 * i % 300},{3_100_000 + 13 * i % 290},{100 + i % 9}.5" for i in range(300)]
TEXT = ["孔号,层位,X坐标,Y坐标,高程", *ROWS]
UTF8, GBK = ("\r\n".join(TEXT).encode(codec) for codec in ("utf-8", "gb18030"))
HALVES = {
    "utf-8 first": "\r\n".join(TEXT[:200]).encode() + b"\r\n" + "\r\n".join(TEXT[200:]).encode("gbk"),
    "gbk first": "\r\n".join(TEXT[:100]).encode("gbk") + b"\r\n" + "\r\n".join(TEXT[100:]).encode(),
}


def codes(issues):
    return [issue.reason.code for issue in issues if issue.severity == "warning"]


@pytest.mark.parametrize("name", HALVES)
def test_lines_in_two_encodings_are_each_read_in_their_own(name, tmp_path):
    """Such a file was refused, or read as Windows-1252 without one legible name."""
    (tmp_path / "a.csv").write_bytes(HALVES[name])
    picks = read_points(tmp_path / "a.csv")
    assert {key: len(points) for key, points in picks.horizons.items()} == {"强风化砂岩": 300}
    assert picks.horizons["强风化砂岩"].hole[-1] == "钻孔299"
    assert "io.encodings-mixed" in codes(picks.issues)


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("codec", ["utf-8", "gb18030", "utf-16"])
def test_a_damaged_character_loses_itself_alone(codec, big, tmp_path, monkeypatch):
    """One byte that was lost in a file of UTF-8 had the whole file refused."""
    if big:
        monkeypatch.setattr("geofit.io.tables.BIG", 1)
    whole = "\r\n".join(TEXT)
    at = len(whole[: whole.index("砂", 3000)].encode(codec))
    data = whole.encode(codec)
    # The first half of a pair of UTF-16, a byte of the others that follows none.
    damaged = data[:at] + (b"\x00\xd8" if codec == "utf-16" else b"\xff") + data[at + (2 if codec == "utf-16" else 1) :]
    (tmp_path / "a.csv").write_bytes(damaged)
    picks = read_points(tmp_path / "a.csv")
    assert sum(map(len, picks.horizons.values())) == 300
    assert len(picks.horizons["强风化砂岩"]) == 299
    (issue,) = [one for one in picks.issues if one.reason.code == "io.characters-lost"]
    assert issue.row == whole[: whole.index("砂", 3000)].count("\n") + 1
    assert issue.reason.params["count"] == 1


def test_a_line_end_of_one_byte_after_utf16_is_no_damage(tmp_path):
    (tmp_path / "a.csv").write_bytes("\r\n".join(TEXT).encode("utf-16") + b"\n")
    picks = read_points(tmp_path / "a.csv")
    assert len(picks.horizons["强风化砂岩"]) == 300
    assert "io.characters-lost" not in codes(picks.issues)


@pytest.mark.parametrize(
    ("letters", "codec"),
    [("钻孔层位强风化砂岩灰岩泥高程模茅冒断面地表第四系", "gb18030"), ("éèàçùÉîïâüöäßñÃÂ°²³µ§", "cp1252")],
)
def test_texts_in_one_encoding_are_read_as_ever(letters, codec):
    rng = np.random.default_rng(4)
    for _ in range(300):
        words = ["".join(rng.choice(list(letters), rng.integers(2, 6))) for _ in range(rng.integers(2, 9))]
        if codec == "cp1252":  # in words: letters with accents are between others
            words = ["a" + "n".join(word) for word in words]
        data = "\n".join(f"B{i},1.5,{word}" for i, word in enumerate(words)).encode(codec)
        assert decode(data, "a")[0] == data.decode(codec)


def test_halves_of_characters_are_replaced_where_they_come_in(tmp_path):
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [500_000 + 7 * i % 90, 3_100_000 + 13 * i % 80, 5.0 + i % 3]},
            "properties": {"hole": f"B{i}\ud83d", "horizon": "T\udcd6 top"},
        }
        for i in range(30)
    ]
    (tmp_path / "a.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}), "utf-8")
    pytest.importorskip("pyogrio")
    picks = read_points(tmp_path / "a.geojson")
    ((name, points),) = picks.horizons.items()
    assert len(points) == 30
    assert len(set(points.hole.tolist())) == 30
    "".join([name, *points.hole.tolist()]).encode()


@pytest.fixture(scope="module")
def broken():
    """A surface and its points under names with half a character, of UTF-16 and of a file name."""
    rng = np.random.default_rng(0)
    xy = rng.uniform(0, 200, (60, 2))
    xyz = np.c_[xy, 100 + 0.05 * xy[:, 0]]
    points = geofit.PointSet(xyz, kind="borehole", hole=[f"B\ud800{i % 7}" for i in range(60)], file="a\udcd6.csv")
    return geofit.fit_horizon(points, name="T\udcd6\ud800"), points


def test_points_keep_holes_apart_under_broken_names(broken):
    _, points = broken
    assert len(set(points.hole.tolist())) == 7
    "".join([*points.hole.tolist(), *points.file.tolist()]).encode()


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_can_be_written_under_broken_names(form, broken, tmp_path):
    """Nine of them ended in a UnicodeEncodeError."""
    fit, points = broken
    names = ("A\ud800", "A\ud801") if FORMATS[form].takes != "measured" else ("A\ud800",)
    path = tmp_path / f"a{FORMATS[form].endings[0]}"
    written = geofit.write_surface(
        dict.fromkeys(names, fit), path, format=form, cell=20.0, points={names[0]: points}, site="S\ud800"
    )
    assert all(one.is_file() for one in written)
    assert written


def test_a_report_can_be_written_under_broken_names(broken, tmp_path):
    written = geofit.write_report(broken[0], tmp_path, forms=("html", "json"))
    assert set(written) == {"html", "json"}


@pytest.mark.parametrize(
    ("module", "function", "takes", "ending"),
    [
        ("io.export.triangles", "write_obj", "mesh", "obj"),
        ("io.export.triangles", "write_ply", "mesh", "ply"),
        ("io.export.triangles", "write_glb", "mesh", "glb"),
        ("io.export.dxf", "write_mesh_dxf", "mesh", "dxf"),
        ("io.export.dxf", "write_section_dxf", "cut", "dxf"),
        ("io.export.section_csv", "write_section_csv", "cut", "csv"),
        ("io.export.geopackage", "write_contours_gpkg", "contours", "gpkg"),
        ("io.export.landxml", "write_landxml", "mesh", "xml"),
        ("io.export.tsurf", "write_tsurf", "mesh", "ts"),
        ("io.export.geoh5", "write_geoh5", "mesh", "geoh5"),
        ("io.export.omf", "write_omf", "mesh", "omf"),
        ("io.export.vtk", "write_vtm", "mesh", "vtm"),
        ("io.export.ifc", "write_ifc", "fit", "ifc"),
        ("cad.step", "write_step", "fit", "step"),
    ],
)
def test_a_writer_called_by_itself_writes_broken_names(module, function, takes, ending, broken, tmp_path):
    """Nine of them ended in a UnicodeEncodeError: only write_surface knew of such names."""
    fit, _ = broken
    given = {
        "fit": lambda: fit,
        "mesh": lambda: fit.triangulate(0.1),
        "cut": lambda: geofit.cut_section(fit, [[10.0, 10.0], [190.0, 180.0]]),
        "contours": lambda: geofit.contours(fit, 2.0),
    }[takes]()
    if ending in ("gpkg", "geoh5", "ifc"):
        pytest.importorskip({"gpkg": "pyogrio", "geoh5": "h5py", "ifc": "ifcopenshell"}[ending])
    write = getattr(import_module(f"geofit.{module}"), function)
    write(dict.fromkeys(("A\ud800", "A\ud801"), given), tmp_path / f"a.{ending}")
    assert (tmp_path / f"a.{ending}").stat().st_size > 100


def test_layers_in_gbk_of_a_drawing_that_states_utf8_stay_apart(tmp_path):
    """Each byte of them had become a question mark, and two horizons one."""
    drawing = ezdxf.new("R2010")
    for k, name in enumerate(("AAAA", "BBBB")):
        drawing.layers.add(name)
        line = [(x, 100.0 - 20.0 * k) for x in range(0, 400, 20)]
        drawing.modelspace().add_lwpolyline(line, dxfattribs={"layer": name})
    drawing.saveas(tmp_path / "C1.dxf")
    data = (tmp_path / "C1.dxf").read_bytes()
    for ascii_name, name in ((b"AAAA", "灰岩"), (b"BBBB", "泥岩")):
        data = data.replace(ascii_name, name.encode("gbk"))
    (tmp_path / "C1.dxf").write_bytes(data)
    line = "[[500000.0, 3100000.0], [500400.0, 3100000.0]]"
    (tmp_path / "site.toml").write_text(f'[site]\n[[section]]\nname = "C1"\nline = {line}\nfile = "C1.dxf"\n')
    horizons = geofit.read_site(tmp_path / "site.toml").horizons
    assert {name: len(points) for name, points in horizons.items()} == {"灰岩": 20, "泥岩": 20}
