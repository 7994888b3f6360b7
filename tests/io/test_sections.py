"""Sections as DXF and CSV, with scale and origin."""

from __future__ import annotations

import ezdxf
import numpy as np
import pytest

from geofit.data.errors import InputError
from geofit.data.site import Section
from geofit.io import read_site
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.sections import Drawing, load_section
from geofit.io.source import Source

SECTION = Section("C1", np.array([[1000.0, 2000.0], [1300.0, 2400.0], [1300.0, 2900.0]]))


@pytest.fixture
def drawing(tmp_path):
    document = ezdxf.new("R2010")
    return document.modelspace(), lambda: (document.saveas(tmp_path / "C1.dxf"), tmp_path / "C1.dxf")[1]


def load(path, names=("A", "B"), *, stated=None, **how):
    journal = Journal()
    points = load_section(Source(path=path, **(stated or {})), SECTION, Drawing(**how), HorizonNames(names), journal)
    (count,) = journal.counts
    assert count.read == count.used + count.listed == sum(map(len, points.values())) + count.listed
    return points, journal


def test_entities_keep_their_order_and_place(drawing):
    space, save = drawing
    space.add_lwpolyline([(0, 80), (250, 81), (700, 82)], dxfattribs={"layer": "a"})
    space.add_polyline2d([(10, 50), (5, 51)], dxfattribs={"layer": "B"})
    space.add_line((5, 51), (0, 52), dxfattribs={"layer": "B"})
    space.add_point((1000, 60), dxfattribs={"layer": "A"})
    points, journal = load(save())
    np.testing.assert_allclose(
        points["A"].xyz, [[1000, 2000, 80], [1150, 2200, 81], [1300, 2600, 82], [1300, 2900, 60]]
    )
    np.testing.assert_allclose(points["B"].xyz[:, 2], [50, 51, 52])
    assert points["B"].row.tolist() == [4, 5, 7]
    assert points["A"].section.tolist() == ["C1"] * 4
    assert [issue.reason.code for issue in journal.issues] == ["io.point-repeated"]


def test_scale_and_origin(drawing, write):
    space, save = drawing
    space.add_lwpolyline([(100, 200), (250_100, 10_200)], dxfattribs={"layer": "A"})
    how = {"scale": 1000.0, "origin": (100.0, 200.0)}
    expected = [[1000, 2000, 0], [1150, 2200, 10]]
    np.testing.assert_allclose(load(save(), **how)[0]["A"].xyz, expected)
    table = write("horizon,distance,elevation\nA,100,200\nA,250100,10200\n")
    np.testing.assert_allclose(load(table, **how)[0]["A"].xyz, expected)


def test_the_origin_counts_in_drawing_units(drawing, make_site):
    feet = [(100.0, 200.0 + 80 / 0.3048), (100.0 + 250 / 0.3048, 200.0 + 81 / 0.3048)]
    space, save = drawing
    space.add_lwpolyline(feet, dxfattribs={"layer": "T2-T1"})
    for file in (save().name, "section.csv", "mixed.csv"):
        table = "horizon,distance,elevation\n" + "".join(f"T2-T1,{u},{v}\n" for u, v in feet)
        mixed = f"horizon,distance [ft],elevation\nT2-T1,{feet[0][0]},280\nT2-T1,{feet[1][0]},281\n"
        path = make_site(**{"section.csv": table, "mixed.csv": mixed})
        unit = "" if file == "mixed.csv" else 'unit = "ft"\n'
        path.write_text(
            '[[section]]\nname = "C1"\nline = [[500000, 3100000], [500300, 3100400]]\norigin = [100, 200]\n'
            f'file = "{file}"\n{unit}',
            encoding="utf-8",
        )
        found = read_site(path).horizons["T2-T1"].xyz
        np.testing.assert_allclose(found, [[500000, 3100000, 80], [500150, 3100200, 81]], atol=1e-6)


@pytest.mark.parametrize(("code", "unit"), [(3, "miles"), (7, "kilometres"), (10, "yards"), (21, "US survey feet")])
def test_rarer_units_of_a_drawing_are_warned_of(drawing, code, unit):
    space, save = drawing
    space.doc.header["$INSUNITS"] = code
    space.add_lwpolyline([(0, 80), (9, 81)], dxfattribs={"layer": "A"})
    _, journal = load(save())
    assert [str(issue.reason.params["unit"]) for issue in journal.issues if issue.severity == "warning"] == [unit]


@pytest.mark.parametrize(
    ("stated", "metres", "code"),
    [
        ({}, 0.3048, "io.drawing-unit-converted"),
        ({"usual_unit": "m"}, 0.3048, "io.drawing-unit-converted"),
        ({"usual_unit": "ft"}, 0.3048, "io.stated-unit-converted"),
        ({"unit": "m"}, 1.0, ""),
        ({"unit": "ft-us"}, 1200 / 3937, "io.stated-unit-converted"),
    ],
)
def test_a_drawing_in_feet_is_converted_unless_the_user_states_its_unit(drawing, stated, metres, code):
    space, save = drawing
    space.doc.header["$INSUNITS"] = 2
    space.add_lwpolyline([(0, 80), (1000, 81)], dxfattribs={"layer": "A"})
    points, journal = load(save(), stated=stated)
    np.testing.assert_allclose(points["A"].xyz[:, 2], np.array([80, 81]) * metres)
    assert [issue.reason.code for issue in journal.issues] == [code] * bool(code)


@pytest.mark.parametrize(("drawing_unit", "scale", "z"), [(2, 3.28084, 80 / 3.28084), (4, 1.0, 80.0), (1, 1.0, 80.0)])
def test_a_scale_counts_before_the_unit_and_that_of_a_template_does_not(drawing, drawing_unit, scale, z):
    space, save = drawing
    space.doc.header["$INSUNITS"] = drawing_unit
    space.add_lwpolyline([(0, 80), (100, 80)], dxfattribs={"layer": "A"})
    points, journal = load(save(), scale=scale)
    np.testing.assert_allclose(points["A"].xyz[:, 2], z)
    assert [issue.reason.code for issue in journal.issues] == ["io.drawing-unit-ignored"] * (scale == 1.0)


def test_what_is_not_used_is_listed(drawing):
    space, save = drawing
    space.add_lwpolyline([(0, 80), (1000.5, 81), (1001, 82), (-1, 83)], dxfattribs={"layer": "A"})
    space.add_spline([(0, 0), (1, 1), (2, 0)], dxfattribs={"layer": "A"})
    space.add_lwpolyline([(0, 0), (1, 1), (2, 0)], close=True, dxfattribs={"layer": "A"})
    space.add_text("C1", dxfattribs={"layer": "TEXT"})
    points, journal = load(save())
    assert len(points["A"]) == 1
    assert journal.counts[0].listed == 3 + 1 + 3 + 1
    severities = [issue.severity for issue in journal.issues]
    assert severities.count("error") == 5
    assert severities.count("note") == 1


def test_a_block_with_lines_of_a_horizon_is_an_error(drawing):
    """Whatever the layer of the insert; lines on layer 0 are on that of the insert."""
    space, save = drawing
    space.add_lwpolyline([(0, 80), (1000, 81)], dxfattribs={"layer": "A"})
    for name, layer in (("X", "A"), ("Y", "0")):
        space.doc.blocks.new(name).add_lwpolyline([(0, 70), (1000, 71)], dxfattribs={"layer": layer})
    space.doc.blocks.new("SYMBOL").add_circle((0, 0), 1, dxfattribs={"layer": "FRAME"})
    space.add_blockref("X", (0, 0))
    space.add_blockref("Y", (0, 0), dxfattribs={"layer": "B"})
    space.add_blockref("SYMBOL", (0, 0))
    _, journal = load(save())
    found = [(issue.severity, issue.reason.params["reason"].code) for issue in journal.issues]
    assert found == [
        ("error", "io.block-not-read"), ("error", "io.block-not-read"), ("note", "io.layer-not-a-horizon"),
    ]  # fmt: skip


def test_lines_on_a_sheet_are_warned_of(drawing):
    space, save = drawing
    space.add_lwpolyline([(0, 80), (1000, 81)], dxfattribs={"layer": "A"})
    space.doc.layout("Layout1").add_lwpolyline([(0, 80), (1000, 81)], dxfattribs={"layer": "B"})
    _, journal = load(save())
    (issue,) = journal.issues
    assert (issue.severity, issue.reason.code) == ("warning", "io.paper-space-not-read")
    assert issue.reason.params["layers"] == "B"


def test_arcs_and_units_are_warned_of(drawing):
    space, save = drawing
    space.doc.header["$INSUNITS"] = 4
    space.add_lwpolyline([(0, 80, 0, 0, 0.5), (9, 81, 0, 0, 0)], dxfattribs={"layer": "A"})
    _, journal = load(save())
    assert sum("arcs" in str(issue.reason) or "millimetres" in str(issue.reason) for issue in journal.issues) == 2


@pytest.mark.parametrize("content", [b"", b"no drawing", b"0\nSECTION\n2\nENTITIES\n0\nLINE\n"])
def test_broken_drawing_is_a_clear_error(tmp_path, content):
    path = tmp_path / "C1.dxf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"C1\.dxf"):
        load(path)


def test_empty_drawing_is_a_clear_error(drawing):
    with pytest.raises(InputError, match="empty"):
        load(drawing[1]())


def test_lines_of_sections_from_a_table_and_levels(make_site, files):
    site = make_site(**{
        "lines.csv": "section,x,y\nC1,500000,3100000\n"
        + 2 * "C1,500300,3100400\n"
        + "C1,500300,3100900\nC2,1,2\n",
        "plan.csv": "horizon,x,y\nT2-T1,500400,3100450\nnone,1,2\n",
    })  # fmt: skip
    text = site.read_text(encoding="utf-8")
    expected = read_site(site).horizons["T2-T1"].xyz
    start, end = text.index("line = "), text.index('file = "sections')
    text = (
        text[:start]
        + text[end:]
        + "[section_lines]\nfile = 'lines.csv'\n[[level]]\nelevation = 88\nfile = 'plan.csv'\n"
    )
    site.write_text(text, encoding="utf-8")
    read = read_site(site)
    np.testing.assert_array_equal(read.sections[0].line, [[500000, 3100000], [500300, 3100400], [500300, 3100900]])
    points = read.horizons["T2-T1"]
    level = points.section == "level 88"
    np.testing.assert_array_equal(points.xyz[level], [[500400, 3100450, 88]])
    np.testing.assert_array_equal(points.xyz[~level], expected)
    counts = {count.file: (count.read, count.used, count.listed) for count in read.counts}
    assert counts["lines.csv"] == (5, 3, 2)
    assert counts["plan.csv"] == (2, 1, 1)


def test_orientations_are_kept(make_site):
    site = make_site(**{
        "dips.csv": "x,y,z,azimuth,dip,horizon\n500100,3100100,80,350,20,T2-T1\n500100,3100200,80,0,95,\n",
        "normals.csv": "X;Y;Z;OrientX;OrientY;OrientZ\n500100;3100100;80;0;-1;-1\n500100;3100100;80;0;0;0\n",
        "strikes.csv": "x,y,z,strike,dip\n500100,3100100,80,300,20\n",
    })  # fmt: skip
    text = site.read_text(encoding="utf-8")
    for name in ("dips", "normals", "strikes"):
        text += f"[[orientations]]\nfile = '{name}.csv'\n"
    site.write_text(text, encoding="utf-8")
    read = read_site(site)
    found = read.orientations
    np.testing.assert_allclose(found.azimuth, [350, 0, 30])
    np.testing.assert_allclose(found.dip, [20, 45, 20])
    assert found.horizon.tolist() == ["T2-T1", "", ""]
    assert found.row.tolist() == [2, 2, 2]
    counts = {count.file: (count.read, count.used, count.listed) for count in read.counts}
    assert counts["dips.csv"] == counts["normals.csv"] == (2, 1, 1)


def test_a_section_line_far_off_the_study_area_is_warned_of(make_site):
    """In a site in feet its corners were given in feet, too; its points lay thousands of kilometres away."""
    site_file = make_site()
    assert not [one for one in read_site(site_file).issues if one.reason.code == "io.line-far-outside"]
    feet = "line = [[1640420, 10170604], [1641404, 10171916], [1641404, 10173556]]"
    metres = "line = [[500000, 3100000], [500300, 3100400], [500300, 3100900]]"
    text = site_file.read_text(encoding="utf-8")
    site_file.write_text(text.replace(metres, feet), encoding="utf-8")
    (issue,) = [one for one in read_site(site_file).issues if one.reason.code == "io.line-far-outside"]
    assert (issue.severity, issue.file, issue.value) == ("warning", "site.toml", "C1")
