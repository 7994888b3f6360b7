"""Exports and sections as the command line asks for them."""

from __future__ import annotations

import csv
import json
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from refusals import refused
from surfaces import ORIGIN, fold, height_field, horizon, nine

from geofit.cad.step import write_step
from geofit.data.errors import InputError, SettingsError
from geofit.data.files import spreadsheet_cell
from geofit.data.points import PointSet
from geofit.io.export.section_csv import write_section_csv
from geofit.io.export.write import FORMATS, write_surface
from geofit.io.grid import read_ground
from geofit.io.surface_files import read_surfaces
from geofit.project.section import read_line, section
from geofit.sampling.cut import CutLine
from geofit.sampling.grids import deviation_grid, elevation_grid, thickness_grid


@pytest.fixture(scope="module")
def upper():
    return horizon(nine()[1], name="T2/T1")


@pytest.fixture(scope="module")
def lower():
    return horizon([height_field(z=lambda x, y: 0.2 * x - 60)], name="强风化")


@pytest.fixture(scope="module")
def both(upper, lower):
    return {"T2/T1": upper, "强风化": lower}


@pytest.mark.parametrize("to", FORMATS)
def test_every_format_writes_what_it_says(to, both, tmp_path):
    """Each file that is named exists, nothing else is left, and an empty file is none."""
    pytest.importorskip({"tif": "rasterio", "gpkg": "pyogrio", "ifc": "ifcopenshell", "geoh5": "h5py"}.get(to, "numpy"))
    files = write_surface(both, tmp_path / "new" / f"site.{to}", format=to, tolerance=2.0, cell=50.0, interval=20.0)
    assert files
    assert all(file.stat().st_size > 100 for file in files)
    left = {p for p in (tmp_path / "new").iterdir() if p.is_file()}
    assert left == set(files)


def test_one_horizon_a_file_where_the_format_asks_for_it(both, tmp_path):
    files = write_surface(both, tmp_path / "site.asc", format="asc", cell=50.0)
    assert [file.name for file in files] == ["site_T2_T1.asc", "site_强风化.asc"]
    alone = write_surface({"T2/T1": both["T2/T1"]}, tmp_path / "one.asc", format="asc", cell=50.0)
    assert alone == [tmp_path / "one.asc"]


def test_thickness_grid_is_the_difference(both, tmp_path):
    (file,) = write_surface(both, tmp_path / "t.asc", format="asc", cell=50.0, value="thickness")
    grid = read_ground(file)
    x, y = np.meshgrid(grid.x, grid.y)
    truth = both["T2/T1"].elevation(x, y) - both["强风化"].elevation(x, y)
    assert grid.z.shape == (15, 21)
    assert np.abs(grid.z - truth).max() < 6e-5
    with pytest.raises(InputError, match="between two horizons; given: 1"):
        write_surface({"T2/T1": both["T2/T1"]}, tmp_path / "t.asc", format="asc", value="thickness")


def test_deviation_grid_holds_the_largest_of_each_cell(upper):
    x, y = ORIGIN[0] + np.array([100.0, 104.0, 333.0]), ORIGIN[1] + np.array([200.0, 199.0, 410.0])
    z = upper.elevation(x, y) + np.array([0.1, -0.4, 0.2])
    points = PointSet(np.column_stack([x, y, z]))
    grid = deviation_grid(upper, points, 50.0)
    held = np.argwhere(np.isfinite(grid.z))
    assert held.tolist() == [[4, 2], [8, 7]]
    off = upper.distance(points.xyz)
    assert [grid.z[4, 2], grid.z[8, 7]] == pytest.approx([off[1], off[2]])
    assert off[1] < -0.3


def test_grids_stand_at_multiples_of_the_cell(upper):
    grid = elevation_grid(upper, 30.0)
    assert np.abs(grid.x % 30).max() < 1e-6
    assert np.isfinite(grid.z).all()
    assert len(elevation_grid(upper).x) in range(100, 401)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"cell": 0.0}, "above 0"),
        ({"cell": 5000.0}, "are too large"),
        ({"cell": 1e-4}, "cells"),
        ({"value": "dip"}, "unknown"),
    ],
)
def test_grid_settings_are_checked(options, match, both, tmp_path):
    with pytest.raises(SettingsError, match=match):
        write_surface(both, tmp_path / "a.asc", **options)


def test_horizons_apart_have_no_thickness(upper, lower):
    with refused(SettingsError, "sampling.horizons-not-overlapping"):
        thickness_grid(upper, lower.with_(origin=lower.origin + np.array([5000.0, 0, 0])))


def test_points_give_deviations_to_vtp(upper, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    x, y = ORIGIN[:1] + 100.0, ORIGIN[1:2] + 200.0
    points = PointSet(np.column_stack([x, y, upper.elevation(x, y) + 0.5]))
    (file,) = write_surface({"T1": upper}, tmp_path / "a.vtp", format="vtp", tolerance=2.0, points={"any": points})
    assert pyvista.read(file)["deviation"][-1] == pytest.approx(upper.distance(points.xyz)[0])


def test_unknown_format_and_no_surface(both, tmp_path):
    with pytest.raises(InputError, match=r"no format 'dwg'.*landxml"):
        write_surface(both, tmp_path / "a.dwg", format="dwg")
    with pytest.raises(InputError, match="No surface"):
        write_surface({}, tmp_path / "a.obj", format="obj")


@pytest.mark.usefixtures("read_here")
def test_surfaces_of_several_files_keep_apart(both, tmp_path):
    write_step({"T1": both["T2/T1"]}, tmp_path / "old.step")
    write_step({"T1": both["强风化"]}, tmp_path / "new.step")
    found = read_surfaces([tmp_path / "old.step", tmp_path / "new.step"])
    assert list(found) == ["T1", "new T1"]
    with pytest.raises(InputError, match="twice"):
        read_surfaces([tmp_path / "old.step", tmp_path / "new.step", tmp_path / "new.step"])


def test_section_writes_drawing_table_and_picture(both, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    surfaces = both | {"fold": horizon([fold()], name="fold")}
    line = np.array([[-50, 100], [300, 150], [1050, 600]]) + ORIGIN[:2]
    cuts, files = section(surfaces, line, tmp_path / "s", tolerance=0.2)
    assert [file.name for file in files] == ["section.dxf", "section_3d.dxf", "section.csv", "section.png"]
    assert sorted(p.name for p in (tmp_path / "s").iterdir()) == sorted(file.name for file in files)
    with files[2].open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["horizon"] for row in rows} == set(surfaces)
    for row in rows[::7]:
        place = [[float(row[name]) for name in ("x", "y", "elevation")]]
        assert np.abs(surfaces[row["horizon"]].distance(place)).max() < 1e-6
    assert len(rows) == sum(len(one.distance) for lines in cuts.values() for one in lines)
    assert len(ezdxf.readfile(files[0]).modelspace().query("LWPOLYLINE")) == sum(map(len, cuts.values()))
    first = files[3].read_bytes()
    assert first.startswith(b"\x89PNG")
    section(surfaces, line, tmp_path / "s", tolerance=0.2)
    assert files[3].read_bytes() == first


def test_a_section_beside_the_site_says_so(both, tmp_path):
    with pytest.raises(InputError, match="meets no horizon"):
        section(both, np.array([[0.0, 0.0], [100.0, 0.0]]), tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_section_lines_from_text_and_file(tmp_path):
    assert read_line("1,2,3.5,4e2").tolist() == [[1, 2], [3.5, 400]]
    assert read_line("1, 2, 3, 4, 5, 6").shape == (3, 2)
    (tmp_path / "line.csv").write_text("x,y\n500000,3100000\n500100,3100050\n500200,3100400\n")
    assert read_line(str(tmp_path / "line.csv"))[1].tolist() == [500100, 3100050]
    with pytest.raises(InputError, match="line: 3"):
        read_line("1,2,3")
    with pytest.raises(InputError, match="no such file"):
        read_line("line.csv")
    (tmp_path / "bad.csv").write_text("x,y\n500000,3100000\n500100,here\n")
    with pytest.raises(InputError, match="row 3"):
        read_line(str(tmp_path / "bad.csv"))


metres = st.floats(-1e7, 1e7, allow_nan=False)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    lines=st.lists(st.lists(st.tuples(*[metres] * 4), min_size=1, max_size=6), min_size=1, max_size=4),
    name=st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=10),
)
def test_any_section_table_comes_back(lines, name, tmp_path):
    cuts = [CutLine(np.array(line)[:, 0], np.array(line)[:, 1:]) for line in lines]
    write_section_csv({name: cuts}, tmp_path / "any.csv")
    with (tmp_path / "any.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["horizon"] for row in rows} == {spreadsheet_cell(name)}
    for number, line in enumerate(cuts, 1):
        own = [row for row in rows if row["line"] == str(number)]
        back = np.array([[float(row[key]) for key in ("distance", "x", "y", "elevation")] for row in own])
        assert np.abs(back - np.column_stack([line.distance, line.xyz])).max() <= 5.1e-7


def run(monkeypatch, capsys, *arguments):
    from geofit.cli.main import main

    monkeypatch.setattr("sys.argv", ["geofit", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    captured = capsys.readouterr()
    return int(stop.value.code or 0), captured.out, captured.err


def test_the_commands(both, tmp_path, monkeypatch, capsys):
    write_step(both, tmp_path / "site.step")
    code, out, _ = run(
        monkeypatch, capsys, "export", tmp_path / "site.step", "--to", "obj", "--out", tmp_path / "a.obj", "--json"
    )
    assert code == 0
    assert json.loads(out) == {"files": [str(tmp_path / "a.obj")]}
    line = f"{ORIGIN[0] + 10},{ORIGIN[1] + 10},{ORIGIN[0] + 900},{ORIGIN[1] + 600}"
    folder = tmp_path / "s"
    code, out, _ = run(monkeypatch, capsys, "section", tmp_path / "site.step", "--line", line, "--out", folder)
    assert code == 0
    assert "强风化" in out
    assert (folder / "section.png").is_file()
    x, y = ORIGIN[0] + 100.0, ORIGIN[1] + 200.0
    z = float(both["T2/T1"].elevation(x, y)) + 0.5
    (tmp_path / "p.csv").write_text(f"x,y,z,surface\n{x},{y},{z},T2/T1\n{x},{y + 9},{z},强风化\n", encoding="utf-8")
    code, _, _ = run(
        monkeypatch, capsys, "export", tmp_path / "site.step", "--to", "asc", "--out", tmp_path / "d.asc",
        "--value", "deviation", "--points", tmp_path / "p.csv", "--cell", "50",
    )  # fmt: skip
    assert code == 0
    assert np.nansum(np.isfinite(read_ground(tmp_path / "d_T2_T1.asc").z)) == 1
    code, _, err = run(monkeypatch, capsys, "export", tmp_path / "site.step", "--to", "dwg", "--out", tmp_path / "a")
    assert code == 2
    assert "no format 'dwg'" in err


def test_help_names_every_format():
    from geofit.cli.options import FORMATS as NAMED

    words = {word.strip() for word in re.sub(r"\(.*?\)", "", NAMED).split(",")}
    assert words == set(FORMATS)
