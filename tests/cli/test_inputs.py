"""No command overwrites a file that it reads; an import overwrites a site file only with ``--force``."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from geofit import PointSet, fit_horizon
from geofit.cad.step import write_step
from geofit.cli.main import main
from geofit.data.errors import InputError
from geofit.data.files import inputs_kept, note_input, replacing


def run(monkeypatch, capsys, *arguments) -> tuple[int, str]:
    """Run the command in this process; return exit code and stderr."""
    monkeypatch.setattr(sys, "argv", ["geofit", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    return int(stop.value.code or 0), capsys.readouterr().err


def points() -> np.ndarray:
    plan = np.random.default_rng(1).uniform(0, 100, (20, 2))
    return np.column_stack([plan + np.array([500_000.0, 3_100_000.0]), 0.1 * plan[:, 0] + np.sin(plan[:, 1] / 20)])


def table(path: Path) -> Path:
    path.parent.mkdir(exist_ok=True)
    rows = [f"B{k},{x:.2f},{y:.2f},{z:.3f},T2" for k, (x, y, z) in enumerate(points())]
    path.write_text("\n".join(["hole,x,y,z,horizon", *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["T2_residuals.csv", "import_issues.csv"])
def test_a_fit_refuses_to_replace_its_points(name, tmp_path, monkeypatch, capsys):
    source = table(tmp_path / name)
    before = source.read_bytes()
    code, err = run(monkeypatch, capsys, "fit", source, "--out", tmp_path)
    assert (code, source.read_bytes()) == (2, before)
    assert "input of this run" in err
    assert "Name another file or folder" in err
    assert "PASS at the data" not in err, "it is refused before anything is fitted"


def test_a_file_that_a_site_names_is_an_input_as_well(tmp_path, monkeypatch, capsys):
    source = table(tmp_path / "out" / "T2_residuals.csv")
    before = source.read_bytes()
    (tmp_path / "site.toml").write_text('[site]\nname = "s"\n[[picks]]\nfile = "out/T2_residuals.csv"\n')
    code, err = run(monkeypatch, capsys, "fit", tmp_path / "site.toml", "--out", tmp_path / "out")
    assert (code, source.read_bytes()) == (2, before)
    assert "T2_residuals.csv: The file is an input of this run" in err


@pytest.mark.parametrize("way", ["itself", "link", "hard link"])
def test_an_export_refuses_to_replace_its_surface(way, tmp_path, monkeypatch, capsys):
    source, out = tmp_path / "x.step", tmp_path / ("x.step" if way == "itself" else "y.step")
    write_step({"a": fit_horizon(PointSet(points()), name="a")}, source)
    if way != "itself":
        try:
            (os.link if way == "hard link" else os.symlink)(source, out)
        except OSError:
            pytest.skip("no links here")
    before = source.read_bytes()
    code, err = run(monkeypatch, capsys, "export", source, "--to", "step", "--out", out)
    assert (code, source.read_bytes()) == (2, before)
    assert "input of this run" in err


def test_an_import_refuses_its_tables_and_a_site_file_that_is_there(tmp_path, monkeypatch, capsys):
    source = table(tmp_path / "picks.csv")
    before = source.read_bytes()
    for force in ((), ("--force",)):
        code, err = run(monkeypatch, capsys, "import", source, "--site", source, *force)
        assert (code, source.read_bytes()) == (2, before)
        assert "input of this run" in err
    site = tmp_path / "site.toml"
    site.write_text("# by hand\n")
    code, err = run(monkeypatch, capsys, "import", source, "--site", site)
    assert (code, site.read_text()) == (2, "# by hand\n")
    assert "--force" in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["picks.csv", "site.toml"]
    code, err = run(monkeypatch, capsys, "import", source, "--site", site, "--force")
    assert code == 0, err
    assert "by hand" not in site.read_text("utf-8")
    # The mapping is to be corrected by hand: it is kept like the site file, and is an input where it is read.
    site.unlink()
    assert run(monkeypatch, capsys, "import", source, "--site", site)[0] == 2
    mapping = tmp_path / "site_mapping.toml"
    before = mapping.read_bytes()
    assert run(monkeypatch, capsys, "import", source, "--site", site, "--force", "--mapping", mapping)[0] == 2
    assert mapping.read_bytes() == before
    shutil.copy(mapping, tmp_path / "saved.toml")
    code, err = run(monkeypatch, capsys, "import", source, "--site", site, "--force", "--mapping", "saved.toml")
    assert code == 2, "the file does not exist here"
    saved = tmp_path / "saved.toml"
    code, err = run(monkeypatch, capsys, "import", source, "--site", site, "--force", "--mapping", saved)
    assert code == 0, err


def test_outside_a_run_a_file_that_was_read_may_be_saved(tmp_path):
    file, other = table(tmp_path / "a.csv"), table(tmp_path / "b.csv")
    note_input(file)
    with replacing(file) as part:
        part.write_text("saved")
    with inputs_kept([file]):
        note_input(other)
        for one in (file, other):
            with pytest.raises(InputError) as caught, replacing(one) as part:
                part.write_text("lost")
            assert caught.value.code == "data.output-is-input"
    assert file.read_text() == "saved"


@pytest.mark.parametrize("name", ["out", "out/", "site.txt"])
def test_an_import_writes_a_site_file_that_fit_reads_as_one(name, tmp_path, monkeypatch, capsys):
    source = table(tmp_path / "picks.csv")
    code, err = run(monkeypatch, capsys, "import", source, "--site", f"{tmp_path}/{name}")
    assert (code, [path.name for path in tmp_path.iterdir()]) == (2, ["picks.csv"])
    assert "must end in .toml" in err
    assert "site.toml" in err


@pytest.fixture
def feet(tmp_path):
    """Return the STEP file of a surface, and its points in feet in a table whose headers are not known."""
    surface, points_file = tmp_path / "T2.step", tmp_path / "own.csv"
    write_step({"T2": fit_horizon(PointSet(points()), name="T2")}, surface)
    rows = [";".join(f"{value / 0.3048:.4f}".replace(".", ",") for value in row) for row in points()]
    points_file.write_text("\n".join(["C1;C2;C3", *rows]) + "\n", encoding="utf-8")
    return surface, points_file


COLUMNS = ("--x", "C1", "--y", "C2", "--z", "C3", "--sep", ";", "--decimal", ",", "--unit", "ft")


def test_an_export_measures_points_whose_columns_are_named(feet, tmp_path, monkeypatch, capsys):
    surface, table = feet
    out = tmp_path / "out.step"
    code, err = run(monkeypatch, capsys, "export", surface, "--to", "step", "--out", out, "--points", table, *COLUMNS)
    assert code == 0, err
    sigma = re.search(r"ITEM\('sigma_m','([^']+)'", out.read_text(encoding="utf-8"))
    assert sigma is not None
    assert float(sigma[1]) < 0.5


def test_a_check_reads_a_table_in_feet(feet, monkeypatch, capsys):
    surface, table = feet
    code, err = run(monkeypatch, capsys, "check", surface, table, *COLUMNS)
    assert code == 0, err


def test_columns_without_points_are_refused(feet, tmp_path, monkeypatch, capsys):
    code, err = run(monkeypatch, capsys, "export", feet[0], "--to", "obj", "--out", tmp_path / "o.obj", "--x", "C1")
    assert code == 2
    assert "--points" in err


def test_an_export_names_surfaces_that_have_no_points(tmp_path, monkeypatch, capsys):
    source, surface, out = table(tmp_path / "picks.csv"), tmp_path / "two.step", tmp_path / "out.step"
    fit = fit_horizon(PointSet(points()), name="T2")
    write_step({"T2": fit, "T2 (B)": fit_horizon(PointSet(points() + np.array([0, 0, 50])), name="T2 (B)")}, surface)
    code, err = run(monkeypatch, capsys, "export", surface, "--to", "step", "--out", out, "--points", source)
    assert code == 0, err
    assert [line[:6] for line in err.splitlines() if "--points" in line] == ["T2 (B)"]


@pytest.mark.parametrize("to", ["gpkg", "tif"])
def test_a_label_of_a_site_is_no_coordinate_system(to, tmp_path, monkeypatch, capsys):
    """The label that a site file may give ended the export of a map."""
    pytest.importorskip("pyogrio" if to == "gpkg" else "rasterio")
    table(tmp_path / "picks.csv")
    site, surface, out = tmp_path / "site.toml", tmp_path / "T2.step", tmp_path / f"a.{to}"
    site.write_text('[site]\nname = "s"\ncrs = "local grid"\n[[picks]]\nfile = "picks.csv"\n', encoding="utf-8")
    write_step({"T2": fit_horizon(PointSet(points()), name="T2")}, surface)
    code, err = run(monkeypatch, capsys, "export", surface, "--to", to, "--out", out, "--points", site)
    assert code == 0, err
    assert "local grid" in err
    assert out.stat().st_size > 1000
