"""Files are whole or absent, and what the system refuses is told with the file's name and the remedy."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from refusals import refused

from geofit.data.errors import InputError
from geofit.data.files import is_file, replacing, spreadsheet_cell
from geofit.data.legible import legible, legible_keys
from geofit.data.messages import message
from geofit.data.points import PointSet

posix = pytest.mark.skipif(sys.platform == "win32", reason="limits of files are those of Linux and macOS")

#: Writes a surface in each format, and a project, on a disk that takes 600 bytes a file; prints what came of it.
FULL = """
import resource
from pathlib import Path
import numpy as np
from geofit import PointSet, fit_horizon
from geofit.data.errors import InputError
from geofit.io.export.write import FORMATS, write_surface
from geofit.io.project import Project, save_project
rng = np.random.default_rng(0)
plan = rng.uniform(0, 100, (30, 2))
surface = fit_horizon(PointSet(np.column_stack([plan + np.array([5e5, 3.1e6]), rng.uniform(0, 3, 30)])), name="a")
resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
tasks = {f"{name}{form.endings[0]}": (name, form.crs) for name, form in FORMATS.items()}
for file, (name, crs) in tasks.items():
    try:
        write_surface({"a": surface}, file, format=name, crs="EPSG:32648" if crs else "")
        print(file, "written")
    except InputError as error:
        print(file, "told", error)
try:
    save_project(Project(name="a"), "p.geofit", {"a": surface})
except InputError as error:
    print("p.geofit", "told", error)
"""


@posix
def test_a_full_disk_is_told_with_the_files_name_in_every_format(tmp_path):
    from geofit.io.export.write import FORMATS

    for name in ("h5py", "pyogrio", "rasterio", "ifcopenshell"):
        pytest.importorskip(name)
    done = subprocess.run(
        [sys.executable, "-c", FULL], cwd=tmp_path, capture_output=True, text=True, timeout=240, check=False
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == len(FORMATS) + 1
    for line in lines:
        name, outcome, text = line.split(" ", 2)
        assert outcome == "told", line
        assert name.split(".")[0] in text.split(":")[0]
        assert "Make room" in text or "disk" in text
        assert "draft" not in text
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [], "a part of a file is left"


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
@posix
def test_a_pipe_or_a_device_is_not_replaced(tmp_path):
    """As root, --out /dev/full had made a file of the device, for every program of the machine."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(tmp_path / "pipe")
    for name in ("pipe", "link"):
        with refused(InputError, "data.output-not-file"), replacing(tmp_path / name) as part:
            part.write_text("whole")
    assert (tmp_path / "pipe").is_fifo()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["link", "pipe"]


def test_names_in_gbk_are_legible():
    assert legible(os.fsdecode("强风化.csv".encode("gbk"))) == "强风化.csv"
    legible(os.fsdecode(b"\xff\xfe\x80")).encode()


@pytest.mark.parametrize("names", [("ZK\ud800", "ZK\ud801"), (os.fsdecode(b"ZK\xff"), os.fsdecode(b"ZK\xfe"))])
def test_names_that_differ_stay_different_when_they_are_made_legible(names):
    """Each half of a character had become the same mark, and two holes one."""
    assert len({legible(name) for name in names}) == 2
    holes = PointSet(np.zeros((2, 3)), hole=list(names)).hole.tolist()
    assert len(set(holes)) == 2
    "".join(holes).encode()


def test_a_legible_key_replaces_no_other():
    same = os.fsdecode("钻孔".encode("gbk"))
    assert legible_keys({same: 1, "钻孔": 2, "钻孔 (2)": 3}) == {"钻孔 (3)": 1, "钻孔": 2, "钻孔 (2)": 3}
    plain = {"钻孔": 1, "ZK1": 2}
    assert legible_keys(plain) is plain


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


@posix
def test_a_link_stays_a_link_to_what_was_replaced(tmp_path):
    real, link = tmp_path / "real.txt", tmp_path / "folder" / "link.txt"
    link.parent.mkdir()
    real.write_text("old")
    link.symlink_to(real)
    with replacing(link) as part:
        part.write_text("new")
    assert link.is_symlink()
    assert real.read_text() == "new"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "real.txt"]
