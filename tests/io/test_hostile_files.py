"""Files from strangers: numbers without end, names that are none, unreadable corners, files that name others."""

from __future__ import annotations

import gzip
import json
import os
import struct
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from refusals import refused
from surfaces import horizon, nine

from geofit.data.errors import GeofitError, InputError
from geofit.io import Source, read_points, read_site, read_surfaces, read_volume
from geofit.io.boundary import load_boundary
from geofit.io.grid import read_ground
from geofit.io.journal import Journal
from geofit.io.mapping import load_mappings
from geofit.io.project import Project, open_project, save_project
from geofit.io.survex import read_survex

ZEROS = "0" * 400
LONG = "1" + ZEROS
PICKS = "x,y,z,horizon\n500000,3100000,1,T\n500100,3100000,2,T\n500000,3100100,3,T\n500100,3100100,4,T\n"
PROJECT = {"format": "geofit project", "version": 1, "name": "a"}


def boundary(path: Path):
    return load_boundary(Source(path=path), Journal())


@pytest.mark.parametrize(
    ("cell", "used"),
    [("1" + ZEROS, 4), ("-1" + ZEROS, 4), ("1e400", 4), ("1" + ZEROS + ".5", 4), ("0." + ZEROS + "1", 5),
     (ZEROS + "5", 5), ("1." + ZEROS, 5)],
)  # fmt: skip
def test_cells_with_400_zeros_are_numbers_or_listed(cell, used, tmp_path):
    (tmp_path / "a.csv").write_text(PICKS + f"500050,3100050,{cell},T\n")
    found = read_points(tmp_path / "a.csv")
    (count,) = found.counts
    assert (count.read, count.used, count.listed) == (5, used, 5 - used)
    assert all(len(str(issue)) < 2_000 for issue in found.issues)


@pytest.mark.parametrize("epsilon", ["1" + ZEROS, "0." + ZEROS + "1", "1" + "0" * 5000, "0x1" + "0" * 5000, "1e400"])
def test_settings_of_a_site_file_with_400_zeros(epsilon, tmp_path):
    (tmp_path / "picks.csv").write_text(PICKS)
    text = f'[site]\nname="s"\n[picks]\nfile="picks.csv"\n[[horizon]]\nname="T"\nepsilon={epsilon}\n'
    (tmp_path / "site.toml").write_text(text)
    with pytest.raises(InputError, match=r"site\.toml") as told:
        read_site(tmp_path / "site.toml")
    assert len(str(told.value)) < 2_000


@pytest.mark.parametrize(
    "more",
    [
        '"settings": {"T": {"epsilon": ' + LONG + "}}",
        '"settings": {"T": {"core": [[' + LONG + ", 0], [0, 1], [1, 1]]}}",
        '"settings": {"T": 3}',
        '"settings": []',
        '"sources": 3',
        '"sources": [[]]',
        '"sources": [{"path": 3}]',
        '"sources": [{"path": "a\\u0000b"}]',
        '"edits": [{"kind": true}]',
        '"edits": [{"kind": "exclude", "values": []}]',
        '"results": [{"horizon": "T", "surface": "a_surfaces/T-1f00c3a2.step", "sha256": "", "n": ' + LONG + "}]",
        '"results": [{"horizon": "T", "surface": "a_surfaces/T-1f00c3a2.step", "sha256": "", "sigma": NaN}]',
        '"results": [{"horizon": "T", "surface": "a_surfaces/T-1f00c3a2.step", "sha256": "", "passed": "yes"}]',
        '"name": null',
    ],
)
def test_projects_with_values_of_the_wrong_type(more, tmp_path):
    text = json.dumps(PROJECT)[:-1] + ", " + more + "}"
    (tmp_path / "a.geofit").write_text(text)
    with refused(InputError, "io.project-incomplete"):
        open_project(tmp_path / "a.geofit")


@pytest.mark.parametrize("read", [open_project, read_site, read_points, load_mappings, read_volume, read_survex])
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have names on Linux and macOS only")
def test_pipes_and_devices_are_refused_at_once(read, tmp_path):
    os.mkfifo(tmp_path / "pipe.npy")
    for name in (tmp_path / "pipe.npy", "/dev/zero"):
        with refused(InputError, "io.not-a-file"):
            read(name)


@pytest.mark.parametrize("read", [open_project, read_site, read_points, load_mappings, read_survex])
@pytest.mark.parametrize("name", ["a\0b.csv", "a\ud800b.csv"])
def test_names_that_no_file_has(read, name):
    with pytest.raises(InputError) as told:
        read(name)
    str(told.value).encode()


def test_surfaces_and_volumes_of_names_that_no_file_has():
    for read, name in ((read_surfaces, "a\0b.step"), (read_volume, "a\0b.npy"), (read_surfaces, "a\ud800b.step")):
        with pytest.raises(InputError) as told:
            read(name)
        str(told.value).encode()


@pytest.mark.parametrize(
    "text",
    ["a = " + "[" * 3000 + "]" * 3000, "a = " + "{a=" * 3000 + "1" + "}" * 3000, ".".join("a" * 3000) + " = 1",
     "[" + ".".join("a" * 3000) + "]\nb = 1"],
    ids=["arrays", "tables", "dotted", "headings"],
)  # fmt: skip
def test_toml_nested_3000_deep(text, tmp_path):
    (tmp_path / "a.toml").write_text(text)
    for read in (read_site, load_mappings):
        with pytest.raises(InputError):
            read(tmp_path / "a.toml")


@pytest.fixture
def shapefile(tmp_path):
    pyogrio = pytest.importorskip("pyogrio", reason="shapefiles need the extra gis")
    import shapely

    square = shapely.Polygon([(5e5, 3e6), (5.001e5, 3e6), (5.001e5, 3.0001e6), (5e5, 3.0001e6)])
    pyogrio.raw.write(
        tmp_path / "area.shp", shapely.to_wkb([square]), [np.arange(1)], ["id"], geometry_type="Polygon", crs=None
    )
    return tmp_path / "area.shp"


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::RuntimeWarning")
def test_shapefiles_with_unreadable_corners(shapefile):
    data = shapefile.read_bytes()
    assert len(boundary(shapefile)) == 4
    corner = struct.pack("<d", 5.001e5)
    for value in (np.nan, np.inf, -np.inf, 1e300):
        shapefile.write_bytes(data.replace(corner, struct.pack("<d", value)))
        with pytest.raises(InputError, match=r"area\.shp"):
            boundary(shapefile)
    for end in range(0, len(data), 7):
        shapefile.write_bytes(data[:end])
        with pytest.raises(InputError, match=r"area\.shp"):
            boundary(shapefile)
    for place in range(100, 152, 4):
        shapefile.write_bytes(data[:place] + b"\xff\xff\xff\x7f" + data[place + 4 :])
        with suppress(InputError):
            boundary(shapefile)


@pytest.mark.parametrize("name", ["a.shp", "a.gpkg", "a.geojson", "a.tif"])
def test_maps_that_name_other_files_are_refused(name, tmp_path):
    pytest.importorskip("pyogrio", reason="maps need the extra gis")
    secret = tmp_path / "secret.csv"
    secret.write_text("x,y,z\n1,2,3\n")
    (tmp_path / name).write_text(
        f'<OGRVRTDataSource><OGRVRTLayer name="secret"><SrcDataSource>{secret}</SrcDataSource>'
        '<GeometryType>wkbPoint</GeometryType><GeometryField encoding="PointFromColumns" x="x" y="y"/>'
        "</OGRVRTLayer></OGRVRTDataSource>"
    )
    with pytest.raises(InputError):
        (read_ground if name.endswith("tif") else read_points)(tmp_path / name)


@pytest.mark.parametrize("name", ["../secret.raw", "/etc/hostname", "sub/x.raw", "C:x.raw", "none.raw"])
def test_a_header_reads_no_file_outside_its_folder(name, tmp_path):
    (tmp_path / "secret.raw").write_bytes(bytes(8))
    (tmp_path / "in").mkdir()
    header = f"NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\nElementDataFile = {name}\n"
    (tmp_path / "in" / "a.mhd").write_text(header)
    with refused(InputError, "io.volume-header-names-file"):
        read_volume(tmp_path / "in" / "a.mhd", pore=0)
    (tmp_path / "in" / "x.raw").write_bytes(bytes(7) + b"\1")
    (tmp_path / "in" / "a.mhd").write_text(header.replace(name, "x.raw"))
    assert read_volume(tmp_path / "in" / "a.mhd", pore=0).porosity == 7 / 8


def test_a_survey_includes_no_file_outside_its_folder(tmp_path):
    (tmp_path / "secret.svx").write_text("a b 1 2 3\n")
    (tmp_path / "in" / "sub").mkdir(parents=True)
    (tmp_path / "in" / "sub" / "part.svx").write_text("*data normal from to tape compass clino\na b 5 90 0\n")
    (tmp_path / "in" / "a.svx").write_text("*include sub/part\n")
    assert len(read_survex(tmp_path / "in" / "a.svx").stations) == 2
    for name in ("../secret", str(tmp_path / "secret.svx")):
        (tmp_path / "in" / "a.svx").write_text(f"*include {name}\n")
        with refused(InputError, "io.include-unreadable"):
            read_survex(tmp_path / "in" / "a.svx")


def test_volumes_that_unpack_to_more_than_memory(tmp_path, monkeypatch):
    monkeypatch.setattr("geofit.pores.memory.available_memory", lambda: 50_000_000)
    with gzip.open(tmp_path / "a_1000.raw.gz", "wb", compresslevel=1) as stream:
        for _ in range(10):
            stream.write(bytes(100_000_000))
    with pytest.raises(GeofitError, match="memory"):
        read_volume(tmp_path / "a_1000.raw.gz", pore=0, voxel=1.0)
    header = "NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\nCompressedData = True\n"
    bomb = zlib.compress(bytes(100_000_000))
    (tmp_path / "a.mha").write_bytes((header + "ElementDataFile = LOCAL\n").encode() + bomb)
    with pytest.raises(InputError, match="65 bytes"):
        read_volume(tmp_path / "a.mha", pore=0)


def test_volumes_that_state_more_than_memory(tmp_path):
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999, 99999, 9), }".ljust(117) + b"\n"
    (tmp_path / "a.npy").write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header)
    with pytest.raises(GeofitError):
        read_volume(tmp_path / "a.npy", pore=0, voxel=1.0)


def test_two_windows_save_one_project_at_once(tmp_path, monkeypatch):
    """While one window writes a surface, another writes the same horizon: neither takes the other's draft away."""
    from geofit.cad import step

    once, known = [], step.store_step

    def store(surfaces, path, **settings):
        result = known(surfaces, path, **settings)
        if not once:
            once.append(path)
            save_project(Project(name="theirs"), tmp_path / "p.geofit", {"T": horizon(nine()[1], name="T")})
        return result

    monkeypatch.setattr(step, "store_step", store)
    ours = save_project(Project(name="ours"), tmp_path / "p.geofit", {"T": horizon(nine()[1][:1], name="T")})
    assert open_project(tmp_path / "p.geofit") == ours
    assert ours.changed(tmp_path) == {}
    assert not list(tmp_path.rglob("*draft*"))
