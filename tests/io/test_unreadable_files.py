"""What no library can read is refused in words for the reader of the file, never in those of the library."""

from __future__ import annotations

import gzip
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from refusals import refused
from surfaces import height_field, horizon

from geofit.data.errors import GeofitError, InputError
from geofit.io import (
    open_volume,
    preview_file,
    read_body,
    read_ground,
    read_points,
    read_surfaces,
    read_volume,
    write_surface,
)
from geofit.io.boundary import read_boundary
from geofit.io.clouds import open_cloud
from geofit.io.project import open_project

#: Words of Python, numpy, zipfile, openpyxl, ezdxf, json, sqlite, laspy and rasterio.
FOREIGN = re.compile(
    r"pickle|numpy\.|<_io|0x[0-9a-f]{6}|object has no|codec|Error\b|StopIteration|zip file|EOF|magic|buffer|sqlite"
    r"|Expecting|delimiter|previous exception|b'|mmap|setting an array|driver|identify image|utf-8-sig|No data left"
)
NOISE = np.random.default_rng(0).integers(0, 256, 4000, dtype=np.uint8).tobytes()
CONTENTS = {"empty": b"", "noise": NOISE, "zeros": bytes(500), "text": b"a letter, nothing else\n", "head": b"x,y,z\n"}


def volume(path: Path) -> object:
    return read_volume(path, pore=0, voxel=1e-6)


def slabs(path: Path) -> object:
    return open_volume(path, pore=0, voxel=1e-6)


READERS = [
    *((volume, ending) for ending in ("npz", "npy", "tif", "zip", "npy.gz", "npz.gz", "tif.gz", "raw", "mha")),
    *((slabs, ending) for ending in ("npy", "tif", "raw", "mha")),
    *((read_points, ending) for ending in ("xlsx", "las", "ags", "ts", "shp", "gpkg", "geojson")),
    *((read_body, ending) for ending in ("stl", "obj", "ply", "ts")),
    *((read_ground, ending) for ending in ("asc", "grd", "tif")),
    (preview_file, "dxf"),
    (read_boundary, "geojson"),
    (open_project, "geofit"),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("content", CONTENTS)
@pytest.mark.parametrize(("read", "ending"), READERS, ids=[f"{read.__name__}-{e}" for read, e in READERS])
def test_a_file_without_its_format_is_refused_in_plain_words(read, ending, content, tmp_path):
    path = tmp_path / f"rock.{ending}"
    path.write_bytes(CONTENTS[content])
    with pytest.raises(GeofitError) as told:
        read(path)
    assert not FOREIGN.search(str(told.value)), str(told.value)
    assert getattr(told.value, "remedy", True), "nothing states what to do"


def written(path: Path, ending: str) -> bytes:
    """A whole file of a format."""
    voxels = np.zeros((8, 8, 8), np.uint8)
    voxels[2:5] = 1
    match ending:
        case "npy" | "npy.gz":
            np.save(path / "v.npy", voxels)
            data = (path / "v.npy").read_bytes()
            return data if ending == "npy" else gzip.compress(data)
        case "npz":
            np.savez_compressed(path / "v.npz", volume=voxels)
            return (path / "v.npz").read_bytes()
        case "tif":
            from PIL import Image

            first, *others = (Image.fromarray(one) for one in voxels)
            first.save(path / "v.tif", save_all=True, append_images=others)
            return (path / "v.tif").read_bytes()
    form = {"ts": "tsurf"}.get(ending, ending)
    write_surface(horizon([height_field()]).surface, path / f"whole.{ending}", format=form)
    return (path / f"whole.{ending}").read_bytes()


@pytest.mark.filterwarnings("ignore:Corrupt EXIF:UserWarning", "ignore:Truncated:UserWarning")
@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.98])
@pytest.mark.parametrize(
    ("read", "ending"),
    [(volume, "npy"), (volume, "npz"), (volume, "npy.gz"), (volume, "tif"), (slabs, "npy"), (slabs, "tif"),
     (read_body, "ply"), (read_body, "ts"), (read_surfaces, "ts"), (preview_file, "dxf"), (read_ground, "grd")],
    ids=lambda value: getattr(value, "__name__", value),
)  # fmt: skip
def test_a_file_that_was_cut_off_is_refused(read, ending, share, tmp_path):
    """Of a TSurf the last triangles would be missing without a word."""
    data = written(tmp_path, ending)
    path = tmp_path / f"cut.{ending}"
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(GeofitError) as told:
        read(path)
    assert not FOREIGN.search(str(told.value)), str(told.value)


def test_an_obj_without_faces_or_with_half_a_vertex_is_refused(tmp_path):
    for text in ("v 1 2 3\nv 2 3 4\nv 4", "v 1 2 3\nv 2 3 4\n"):
        (tmp_path / "a.obj").write_text(text)
        with refused(InputError, "io.mesh-damaged"):
            read_body(tmp_path / "a.obj")


def test_an_array_is_read_by_its_content_and_an_archive_names_its_arrays(tmp_path):
    voxels = np.zeros((3, 3, 3), np.uint8)
    voxels[1] = 1
    with (tmp_path / "one.npz").open("wb") as stream:
        np.save(stream, voxels)
    assert volume(tmp_path / "one.npz").porosity == pytest.approx(2 / 3)
    np.savez(tmp_path / "two.npz", before=voxels, after=voxels)
    with refused(InputError, "io.several-volumes", count=2) as told:
        volume(tmp_path / "two.npz")
    assert "--name after" in str(told.value)
    assert read_volume(tmp_path / "two.npz", pore=0, voxel=1.0, name="before").porosity == pytest.approx(2 / 3)
    with zipfile.ZipFile(tmp_path / "book.npz", "w") as archive:
        archive.writestr("[Content_Types].xml", "<a/>")
    with refused(InputError, "io.volume-unreadable"):
        volume(tmp_path / "book.npz")
    np.savez(tmp_path / "objects.npz", volume=np.array([{}], dtype=object))
    with refused(InputError, "io.file-damaged-incomplete"):
        volume(tmp_path / "objects.npz")


def test_an_old_workbook_is_named(tmp_path):
    (tmp_path / "a.xlsx").write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + NOISE)
    with refused(InputError, "io.workbook-old"):
        read_points(tmp_path / "a.xlsx")


def test_a_layer_that_a_map_does_not_have_is_named_with_the_others(tmp_path):
    pytest.importorskip("pyogrio", reason="maps need the extra gis")
    from geofit.io import Source
    from geofit.io.formats import read_any_table
    from geofit.io.journal import Journal

    write_surface(horizon([height_field()]).surface, tmp_path / "a.gpkg", format="gpkg")
    with refused(InputError, "io.layer-missing", name="none"):
        read_any_table(Source(path=tmp_path / "a.gpkg", table="none"), Journal())


def test_a_cloud_that_is_damaged_is_refused_in_plain_words(tmp_path):
    pytest.importorskip("laspy", reason="clouds need the extra scale")
    (tmp_path / "a.las").write_bytes(b"LASF" + NOISE)
    (tmp_path / "a.parquet").write_bytes(b"PAR1" + NOISE)
    for name in ("a.las", "a.parquet"):
        with refused(InputError, "io.cloud-damaged") as told:
            list(open_cloud(tmp_path / name).chunks())
        assert not FOREIGN.search(str(told.value))


def test_a_project_or_boundary_that_is_not_json_names_the_place(tmp_path):
    (tmp_path / "a.geofit").write_text('{"format": }')
    with refused(InputError, "io.project-invalid") as told:
        open_project(tmp_path / "a.geofit")
    assert "character 12" in str(told.value)
    (tmp_path / "a.geojson").write_text('{"type": "Polygon"}')
    with refused(InputError, "io.geojson-invalid") as told:
        read_boundary(tmp_path / "a.geojson")
    assert not FOREIGN.search(str(told.value))
