"""Files are whole or absent, and what the system refuses is told with the file's name and the remedy."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from geofit.data.errors import InputError
from geofit.data.files import is_file, replacing, spreadsheet_cell
from geofit.data.legible import legible
from geofit.data.messages import message

posix = pytest.mark.skipif(sys.platform == "win32", reason="limits of files are those of Linux and macOS")

#: Writes each format on a disk that takes 2,000 bytes a file; prints what came of it.
FULL = """
import resource, sys
from pathlib import Path
sys.path.insert(0, {tests!r})
import numpy as np
from surfaces import horizon, nine
from geofit.data.errors import InputError
from geofit.sampling.contours import Contour
from geofit.io.export import geoh5, geopackage, grids
from geofit.cad.export import write_brep, write_iges
from geofit.cad.step import write_step
from geofit.data.site import Ground
surface = horizon(nine()[1], name="a")
mesh = surface.triangulate(0.5)
axis = np.arange(60.0)
ground = Ground(axis, axis, np.random.default_rng(0).uniform(size=(60, 60)))
line = np.random.default_rng(0).uniform(size=(900, 3))
tasks = {{
    "a.geoh5": lambda path: geoh5.write_geoh5({{"a": mesh}}, path),
    "a.gpkg": lambda path: geopackage.write_contours_gpkg({{"a": [Contour(1.0, line, False)]}}, path),
    "a.tif": lambda path: grids.write_geotiff(ground, path),
    "a.brep": lambda path: write_brep({{"a": surface}}, path),
    "a.igs": lambda path: write_iges({{"a": surface}}, path),
    "a.step": lambda path: write_step({{"a": surface}}, path),
}}
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
for name, task in tasks.items():
    try:
        task(Path(name))
        print(name, "written")
    except InputError as error:
        print(name, "told", error)
"""


@posix
def test_a_full_disk_is_told_with_the_files_name(tmp_path):
    pytest.importorskip("h5py")
    pytest.importorskip("pyogrio")
    pytest.importorskip("rasterio")
    code = FULL.format(tests=str(Path(__file__).parents[1]))
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 6
    for line in lines:
        name, outcome, *words = line.split()
        assert outcome == "told", line
        text = " ".join(words)
        assert name in text
        assert "Make room" in text or "disk" in text
    assert list(tmp_path.iterdir()) == [], "a part of a file is left"


def test_a_folder_that_is_not_there_is_told(tmp_path):
    with (
        pytest.raises(InputError, match=r"none.a\.txt.*Make the folder"),
        replacing(tmp_path / "none" / "a.txt") as part,
    ):
        part.write_text("x")


def test_an_error_of_another_file_passes(tmp_path):
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "a.txt"):
        (tmp_path / "other.txt").read_text()
    assert list(tmp_path.iterdir()) == []


def test_names_that_are_no_files(tmp_path):
    assert not is_file("a\0b")
    assert not is_file(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        assert not is_file(tmp_path / "pipe")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names are bytes on Linux only")
def test_names_in_gbk_are_legible():
    assert legible(os.fsdecode("强风化.csv".encode("gbk"))) == "强风化.csv"
    legible(os.fsdecode(b"\xff\xfe\x80")).encode()


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r"])
def test_cells_are_no_formulas(start):
    cell = spreadsheet_cell(f'{start}HYPERLINK("x")')
    assert cell.startswith("'")
    assert spreadsheet_cell("-12.5") == "-12.5"


def test_tables_that_are_written_hold_no_formulas(tmp_path):
    from geofit.data.site import ImportIssue
    from geofit.report.tables import write_issues

    write_issues([ImportIssue("=cmd", 3, "@c", "-2+3", "error", message("test.text", "+r"))], tmp_path / "i.csv")
    row = (tmp_path / "i.csv").read_text("utf-8-sig").splitlines()[1]
    assert row == "error,'=cmd,3,'@c,'-2+3,'+r,"


@pytest.mark.parametrize("name", ["site.toml", "map.toml"])
def test_toml_that_is_nested_deep_is_refused(tmp_path, name):
    from geofit.io import read_site
    from geofit.io.mapping import load_mappings

    (tmp_path / name).write_text("a = " + "[" * 30_000 + "]" * 30_000)
    with pytest.raises(InputError, match="nested too deeply"):
        (read_site if name == "site.toml" else load_mappings)(tmp_path / name)
