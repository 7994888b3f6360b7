"""Maps and adit plans in DXF, several sections in one table, grids as horizons, collars on the ground."""

from __future__ import annotations

import ezdxf
import numpy as np
import pytest
from refusals import with_code

from geofit.data.errors import InputError
from geofit.io import read_site
from geofit.io.mapping import ColumnMapping
from geofit.project.importing import import_files

GROUND = "ncols 3\nnrows 3\nxllcenter 500000\nyllcenter 3100000\ncellsize 500\n700 750 800\n600 650 700\n500 550 600\n"


def ground_at(x, y):
    """The plane of GROUND."""
    return 500 + (x - 500000) * 0.1 + (y - 3100000) * 0.2


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "ground.asc").write_text(GROUND)
    return tmp_path


def site(folder, text):
    (folder / "site.toml").write_text('[ground]\nfile = "ground.asc"\n' + text, encoding="utf-8")
    read = read_site(folder / "site.toml")
    for count in read.counts:
        assert count.read == count.used + count.listed
    return read, {count.file: (count.read, count.used, count.listed) for count in read.counts}


def plan(folder):
    document = ezdxf.new("R2010")
    space = document.modelspace()
    space.add_lwpolyline([(500100, 3100100), (500200, 3100150), (500300, 3100200)], dxfattribs={"layer": "t2-t1"})
    space.add_lwpolyline([(500500, 3100500), (500600, 3100500), (500600, 3100600)], close=True,
                         dxfattribs={"layer": "T2-T1"})  # fmt: skip
    space.add_polyline3d([(500400, 3100400, 612.5), (500410, 3100400, 613.5)], dxfattribs={"layer": "F1"})
    space.add_point((509000, 3100100), dxfattribs={"layer": "T2-T1"})
    space.add_text("T2-T1", dxfattribs={"layer": "T2-T1", "insert": (500100, 3100100)})
    space.add_lwpolyline([(0, 0), (10, 0), (10, 10)], dxfattribs={"layer": "FRAME"})
    space.add_polyline3d([(500000, 3100500, 490), (500100, 3100500, 491), (500100, 3100500, 491),
                          (500100, 3100600, 492)], dxfattribs={"layer": "PD1"})  # fmt: skip
    space.add_polyline3d([(500200, 3100500, 480), (500260, 3100500, 480)], dxfattribs={"layer": "PD2"})
    space.add_line((500200, 3100510, 480), (500200, 3100560, 481), dxfattribs={"layer": "PD2"})
    space.add_lwpolyline([(500200, 3100500), (500260, 3100500)], dxfattribs={"layer": "PD2"})
    space.add_text("T2-T1", dxfattribs={"layer": "PD1", "insert": (500050, 3100502)})
    space.add_text("PD1", dxfattribs={"layer": "PD1", "insert": (500000, 3100500)})
    space.add_mtext("F1", dxfattribs={"layer": "PD1", "insert": (500103, 3100550, 0)})
    space.add_text("F1", dxfattribs={"layer": "PD1", "insert": (500150, 3100550)})
    block = document.blocks.new("CONTACT")
    block.add_attdef("NAME", (0, 0))
    insert = space.add_blockref("CONTACT", (500230, 3100499, 480), dxfattribs={"layer": "PD2"})
    insert.add_attrib("NAME", "t2-t1")
    document.saveas(folder / "plan.dxf")


HORIZONS = '[[horizon]]\nname = "T2-T1"\n[[horizon]]\nname = "F1"\n'


def test_map_traces_are_draped_where_they_have_no_elevation(folder):
    plan(folder)
    read, counts = site(folder, HORIZONS + '[traces]\nfile = "plan.dxf"\n')
    points = read.horizons["T2-T1"]
    assert set(points.kind) == {"outcrop"}
    np.testing.assert_allclose(points.xyz[0], [500100, 3100100, 530])
    np.testing.assert_allclose(points.xyz[:, 2], ground_at(*points.xyz[:, :2].T), atol=1e-9)
    np.testing.assert_allclose(read.horizons["F1"].xyz[:, 2], [612.5, 613.5])
    assert points.row.tolist() == [1, 2, 3, 4, 5, 6]
    # 28 points in all: three lines, the stray point, the text, the frame, four adit paths, four words, one block.
    assert counts["plan.dxf"] == (28, 8, 20)
    reasons = [issue.reason for issue in read.issues if issue.file == "plan.dxf"]
    assert any("off the ground's grid" in str(reason) for reason in reasons)
    assert any("Layer 'FRAME' is not a horizon" in str(reason) for reason in reasons)
    assert any("draped on the ground: 7" in str(reason) for reason in reasons)


@pytest.fixture
def flat_map(folder):
    """Lines of a map at 0, as a GIS writes a layer without elevations, and one with elevations of its own."""
    pyogrio, shapely = pytest.importorskip("pyogrio"), pytest.importorskip("shapely")
    lines = [[(500100, 3100100 + 300 * k, 0), (500900, 3100200 + 300 * k, 0)] for k in range(2)]
    lines.append([(500100, 3100900, 0), (500900, 3100900, 12)])
    shapes = np.array([shapely.LineString(line) for line in lines], dtype=object)
    for name, count in (("mixed.gpkg", 3), ("flat.gpkg", 2)):
        pyogrio.raw.write(
            folder / name, shapely.to_wkb(shapes[:count], output_dimension=3), [np.array(["T2"] * count, dtype=object)],
            ["horizon"], geometry_type="LineString Z", crs="EPSG:32650",
        )  # fmt: skip
    return np.array(lines, float)


def test_traces_of_a_map_at_0_are_draped(folder, flat_map):
    read, _ = site(folder, '[traces]\nfile = "mixed.gpkg"\n')
    xyz = read.horizons["T2"].xyz
    np.testing.assert_allclose(xyz[:4, 2], ground_at(*xyz[:4, :2].T))
    np.testing.assert_allclose(xyz[4:], flat_map[2])
    assert any("draped on the ground: 4" in str(issue.reason) for issue in read.issues)
    (folder / "flat.csv").write_text("horizon,x,y,z\nT2,500100,3100100,0\nT2,500200,3100100,0\n")
    read, _ = site(folder, '[traces]\nfile = "flat.csv"\n')
    np.testing.assert_allclose(read.horizons["T2"].xyz[:, 2], [530, 540])
    (folder / "flat.csv").write_text("horizon,x,y,z\nT2,500100,3100100,0\nT2,500200,3100100,\n")
    read, _ = site(folder, '[traces]\nfile = "flat.csv"\n')
    np.testing.assert_allclose(read.horizons["T2"].xyz[:, 2], [530, 540])
    (folder / "flat.csv").write_text("horizon,x,y,z\nT2,500100,3100100,0\nT2,500200,3100100,5\n")
    read, _ = site(folder, '[traces]\nfile = "flat.csv"\n')
    np.testing.assert_allclose(read.horizons["T2"].xyz[:, 2], [0, 5])


def test_a_map_at_0_is_imported_as_traces(folder, flat_map):
    found = import_files([folder / "flat.gpkg", folder / "ground.asc"], folder / "new.toml")
    xyz = found.site.horizons["T2"].xyz
    np.testing.assert_allclose(xyz[:, 2], ground_at(*xyz[:, :2].T))


@pytest.mark.parametrize("kind", ["LWPOLYLINE", "POLYLINE"])
def test_flat_polylines_lie_at_their_true_place(folder, kind):
    drawing = ezdxf.new()
    corners = [(500100, 3100100), (500200, 3100150)]
    # Mirrored in CAD: x and z count the other way.
    for side in (1, -1):
        flat, own = [(side * x, y) for x, y in corners], {"layer": "F1", "extrusion": (0, 0, side)}
        if kind == "LWPOLYLINE":
            drawing.modelspace().add_lwpolyline(flat, dxfattribs={**own, "elevation": side * 610.0})
        else:
            drawing.modelspace().add_polyline2d(flat, dxfattribs={**own, "elevation": (0, 0, side * 610.0)})
    drawing.saveas(folder / "map.dxf")
    read, _ = site(folder, '[traces]\nfile = "map.dxf"\n')
    np.testing.assert_allclose(read.horizons["F1"].xyz, [(x, y, 610.0) for x, y in corners] * 2)


def test_a_mirrored_text_names_the_contact_of_an_adit(folder):
    drawing = ezdxf.new()
    space = drawing.modelspace()
    space.add_polyline3d([(500000, 3100500, 490), (500100, 3100500, 490)], dxfattribs={"layer": "PD1"})
    space.add_text("F1", dxfattribs={"layer": "PD1", "insert": (-500050, 3100501), "extrusion": (0, 0, -1)})
    drawing.saveas(folder / "plan.dxf")
    read, _ = site(folder, '[[horizon]]\nname = "F1"\n[adits]\npath = "plan.dxf"\ncontacts = "plan.dxf"\n')
    np.testing.assert_allclose(read.horizons["F1"].xyz, [[500050, 3100500, 490]])


def test_a_flat_map_without_a_ground_says_so(folder):
    plan(folder)
    (folder / "site.toml").write_text(HORIZONS + '[traces]\nfile = "plan.dxf"\n')
    with pytest.raises(InputError, match="no ground on which to place the points without an elevation \\(7\\)"):
        read_site(folder / "site.toml")


def test_a_section_taken_for_a_map_is_refused(folder):
    drawing = ezdxf.new()
    drawing.modelspace().add_line((0, 80), (100, 81), dxfattribs={"layer": "F1"})
    drawing.saveas(folder / "C1.dxf")
    with pytest.raises(InputError, match="far outside the study area"):
        site(folder, HORIZONS + '[traces]\nfile = "C1.dxf"\n')


def test_adits_and_their_contacts_from_a_plan(folder):
    plan(folder)
    text = (
        HORIZONS
        + '[adits]\npath = { file = "plan.dxf", table = "PD*" }\ncontacts = { file = "plan.dxf", table = "PD*" }\n'
    )
    read, _ = site(folder, text)
    assert [hole.name for hole in read.holes] == ["PD1", "PD2", "PD2 2"]
    np.testing.assert_allclose(read.holes[0].depth[-1], np.hypot(100, 1) + np.hypot(100, 1))
    points = read.horizons["T2-T1"]
    np.testing.assert_allclose(points.xyz, [[500050, 3100500, 490.5], [500230, 3100500, 480]])
    assert points.hole.tolist() == ["PD1", "PD2"]
    assert points.kind.tolist() == ["adit", "adit"]
    np.testing.assert_allclose(read.horizons["F1"].xyz, [[500100, 3100550, 491.5]])
    paths, contacts = (count for count in read.counts if count.file == "plan.dxf [PD*]")
    assert (paths.read, paths.used) == (28, 7)
    assert (contacts.read, contacts.used) == (28, 3)
    reasons = [(issue.severity, issue.reason) for issue in read.issues]
    assert ("error", "io.polyline-no-elevation") in [(severity, reason.code) for severity, reason in reasons]
    assert any(
        severity == "error" and "50.0 m from the nearest adit, PD1" in str(reason) for severity, reason in reasons
    )
    assert any("repeats the one before" in str(reason) for _, reason in reasons)


def test_feet_of_a_map(folder):
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 2
    place = np.array([500100.0, 3100100.0, 520.0]) / 0.3048
    drawing.modelspace().add_polyline3d([place, place + 10], dxfattribs={"layer": "F1"})
    drawing.saveas(folder / "map.dxf")
    read, _ = site(folder, '[traces]\nfile = "map.dxf"\nunit = "ft"\n')
    np.testing.assert_allclose(read.horizons["F1"].xyz[0], [500100, 3100100, 520])
    (folder / "site.toml").write_text('[traces]\nfile = "map.dxf"\n')
    read = read_site(folder / "site.toml")
    np.testing.assert_allclose(read.horizons["F1"].xyz[0], [500100, 3100100, 520])
    assert with_code([issue.reason for issue in read.issues], "io.drawing-unit-converted").params["unit"] == "feet"


def test_a_plan_is_imported_as_the_mapping_says(folder):
    plan(folder)
    kinds = [
        ColumnMapping(file="plan.dxf", kind="traces", table="T2*"),
        ColumnMapping(file="plan.dxf", kind="adit path", table="PD*"),
        ColumnMapping(file="plan.dxf", kind="adit contacts", table="PD*"),
    ]
    found = import_files([folder / "plan.dxf", folder / "ground.asc"], folder / "s.toml", mappings=kinds)
    assert set(found.site.horizons) >= {"T2-T1", "F1"}
    assert (
        sorted(set(found.site.horizons["T2-T1"].kind.tolist() + found.site.horizons["F1"].kind.tolist()))
        == [
            "adit",
            "outcrop",
        ]
        or "t2-t1" in found.site.horizons
    )
    assert all(count.read == count.used + count.listed for count in found.counts)
    assert read_site(folder / "s.toml").holes[0].name == "PD1"


def test_a_drawing_that_is_set_aside_counts_its_points(folder):
    plan(folder)
    found = import_files([folder / "plan.dxf"], folder / "s.toml")
    assert [(count.file, count.read, count.used, count.listed) for count in found.counts] == [("plan.dxf", 28, 0, 28)]
    assert any('kind = "traces"' in str(issue.remedy) for issue in found.issues)
    (folder / "plan.dxf").write_text("no drawing")
    found = import_files([folder / "plan.dxf"], folder / "s.toml")
    assert found.exit_code == 2


SECTIONS = """section,horizon,distance,elevation,x0,y0,x1,y1
C1,F1,0,510,500000,3100000,500300,3100400
C1,F1,250,520,500000,3100000,500300,3100400
C1,F1,501,520,500000,3100000,500300,3100400
C1,F1,100,520,500000,3100000,500300,3100500
C2,F1,10,530,,,,
C3,F1,100,540,500500,3100500,500500,3100900
"""


def test_one_table_of_several_sections_with_their_lines(folder):
    (folder / "sections.csv").write_text(SECTIONS)
    read, counts = site(folder, '[sections]\nfile = "sections.csv"\n')
    points = read.horizons["F1"]
    np.testing.assert_allclose(
        points.xyz, [[500000, 3100000, 510], [500150, 3100200, 520], [500500, 3100600, 540]], atol=1e-6
    )
    assert points.section.tolist() == ["C1", "C1", "C3"]
    assert points.kind.tolist() == ["section"] * 3
    assert [section.name for section in read.sections] == ["C1", "C3"]
    assert counts["sections.csv"] == (6, 3, 3)
    reasons = {issue.row: issue.reason for issue in read.issues if issue.severity == "error"}
    assert reasons[4].code == "io.distance-off-section"
    assert (reasons[5].code, reasons[5].params["row"]) == ("io.section-line-contradicts", 2)
    assert (reasons[6].code, reasons[6].params["section"]) == ("io.named-section-without-line", "C2")


def test_one_table_of_several_sections_with_a_table_of_lines(folder):
    (folder / "profiles.csv").write_text(
        "剖面号,界面,距离,高程\nC1,F1,250,520\nC2,F1,10,530\nC9,F1,1,2\n", encoding="utf-8"
    )
    lines = (
        "section,x,y\nC1,500000,3100000\nC1,500150,3100200\nC1,500150,3100300\nC2,500500,3100500\nC2,500500,3100900\n"
    )
    (folder / "lines.csv").write_text(lines)
    found = import_files([folder / name for name in ("profiles.csv", "lines.csv", "ground.asc")], folder / "s.toml")
    np.testing.assert_allclose(found.site.horizons["F1"].xyz, [[500150, 3100200, 520], [500500, 3100510, 530]])
    assert {count.file: (count.used, count.listed) for count in found.counts}["profiles.csv"] == (2, 1)
    (folder / "lines.csv").write_text("section,x,y\nC7,1,2\nC7,3,4\n")
    found = import_files([folder / "profiles.csv", folder / "lines.csv"], folder / "t.toml")
    assert {count.file: (count.used, count.listed) for count in found.counts}["profiles.csv"] == (0, 3)


def test_a_section_stands_once(folder):
    (folder / "sections.csv").write_text(SECTIONS)
    (folder / "C1.csv").write_text("horizon,distance,elevation\nF1,0,1\n")
    text = '[[section]]\nname = "C1"\nline = [[500000, 3100000], [500100, 3100100]]\nfile = "C1.csv"\n'
    with pytest.raises(InputError, match="Two sections have the name 'C1'"):
        site(folder, text + '[sections]\nfile = "sections.csv"\n')


@pytest.mark.parametrize("form", ["asc", "surfer", "tif"])
def test_a_grid_is_a_horizon(form, folder):
    z = np.array([[10.0, 11, 12, 13], [20, np.nan, 22, 23], [30, 31, 32, 33]])  # north to south
    if form == "tif":
        rasterio = pytest.importorskip("rasterio")
        with rasterio.open(
            folder / "base.tif", "w", driver="GTiff", width=4, height=3, count=1, dtype="float64", nodata=-9.0,
            transform=rasterio.Affine(10, 0, 500095, 0, -10, 3100125), crs="EPSG:32648",
        ) as raster:  # fmt: skip
            raster.write(np.nan_to_num(z, nan=-9.0), 1)
        name = "base.tif"
    elif form == "asc":
        name = "base.asc"
        rows = "\n".join(" ".join("-9" if np.isnan(c) else f"{c:g}" for c in row) for row in z)
        head = "ncols 4\nnrows 3\nxllcenter 500100\nyllcenter 3100100\ncellsize 10\nnodata_value -9\n"
        (folder / name).write_text(head + rows + "\n")
    else:
        name = "base.grd"
        rows = "\n".join(" ".join("1.70141e+38" if np.isnan(c) else f"{c:g}" for c in row) for row in z[::-1])
        (folder / name).write_text(f"DSAA\n4 3\n500100 500130\n3100100 3100120\n10 33\n{rows}\n")
    read, counts = site(folder, f'[[grids]]\nfile = "{name}"\nhorizon = "base of Q"\n')
    points = read.horizons["base of Q"]
    assert set(points.kind) == {"grid"}
    assert counts[name] == (12, 11, 1)
    np.testing.assert_allclose(points.xyz[0], [500100, 3100120, 10])
    np.testing.assert_allclose(points.xyz[-1], [500130, 3100100, 33])
    assert points.row.tolist() == [1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12]
    notes = [
        issue.reason for issue in read.issues if issue.file == name and issue.reason.code == "io.nodes-without-data"
    ]
    assert [dict(note.params) for note in notes] == [{"count": 1, "total": 12}]
    found = import_files([folder / name, folder / "ground.asc"], folder / "s.toml",
                         mappings=[ColumnMapping(file="base.*", kind="grid")])  # fmt: skip
    assert {key: len(value) for key, value in found.site.horizons.items()} == {"base": 11}
    assert found.site.ground is not None


def test_of_two_grids_the_one_that_is_named_so_is_the_ground(folder):
    (folder / "base.asc").write_text(GROUND)
    found = import_files([folder / "base.asc", folder / "ground.asc"], folder / "s.toml")
    (issue,) = [issue for issue in found.issues if issue.file == "base.asc" and issue.severity == "error"]
    assert "taken from ground.asc already" in str(issue.reason)
    assert 'kind = "grid"' in str(issue.remedy)
    assert {count.file: (count.read, count.listed) for count in found.counts}["base.asc"] == (3, 3)


def test_a_grid_of_no_horizon_is_an_error(folder):
    with pytest.raises(InputError, match="'ground', which is not a horizon"):
        site(folder, HORIZONS + '[[grids]]\nfile = "ground.asc"\n')


COLLAR = "hole,x,y,depth\n" + "".join(f"B{k},{500100 + 100 * k},{3100100 + 50 * k},60\n" for k in range(4))
LOG = "hole,from,to,code\n" + "".join(f"B{k},0,{10 + k},Q\nB{k},{10 + k},60,T\n" for k in range(4))


def test_collars_without_an_elevation_stand_on_the_ground(folder):
    (folder / "collar.csv").write_text(COLLAR + "B9,600000,3100000,60\n")
    (folder / "log.csv").write_text(LOG)
    files = [folder / name for name in ("log.csv", "collar.csv", "ground.asc")]
    found = import_files(files, folder / "s.toml")
    points = found.site.horizons["base of Q"]
    expected = ground_at(*points.xyz[:, :2].T) - [10, 11, 12, 13]
    np.testing.assert_allclose(points.xyz[:, 2], expected, atol=1e-9)
    notes = [issue for issue in found.issues if "the ground's" in str(issue.reason) and issue.severity == "note"]
    assert [issue.row for issue in notes] == [2, 3, 4, 5]
    assert f"{ground_at(500100, 3100100):.2f} m" in str(notes[0].reason)
    assert {count.file: (count.used, count.listed) for count in found.counts}["collar.csv"] == (4, 1)
    assert any("lies outside the ground's grid" in str(issue.reason) for issue in found.issues)


def test_collars_without_an_elevation_and_without_a_ground_are_an_error(folder):
    (folder / "collar.csv").write_text(COLLAR)
    (folder / "log.csv").write_text(LOG)
    found = import_files([folder / "log.csv", folder / "collar.csv"], folder / "s.toml")
    (issue,) = [i for i in found.issues if i.file == "collar.csv" and i.severity == "error"]
    assert "No column for 'z'" in str(issue.reason)
    assert {count.file: (count.used, count.listed) for count in found.counts} == {
        "collar.csv": (0, 4),
        "log.csv": (0, 8),
    }
