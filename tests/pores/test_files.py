"""Volumes read from every kind of file; networks written and read again."""

import gzip
import json
import zipfile

import numpy as np
import pytest
from refusals import refused
from shapes import pack

from geofit.data.errors import InputError
from geofit.data.languages import EN, sentence
from geofit.io.export.network import (
    openpnm_dictionary,
    read_statoil,
    write_network_csv,
    write_network_vtp,
    write_openpnm_csv,
    write_openpnm_json,
    write_statoil,
)
from geofit.io.meshes import read_stl
from geofit.io.volume_slices import open_volume
from geofit.io.volumes import read_volume
from geofit.pores import RockVolume, VolumeError, pore_network
from geofit.project.metaballs_run import run_metaballs
from geofit.project.pores_run import run_pores
from geofit.project.single_reports import write_pores_report

ARRAY = (np.random.default_rng(0).random((4, 5, 6)) < 0.3).astype(np.uint8)


def written(kind, folder):
    from PIL import Image

    path = folder / f"rock_4x5x6.{kind}"
    if kind == "raw":
        path.write_bytes(ARRAY.tobytes())
    elif kind == "raw.gz":
        path.write_bytes(gzip.compress(ARRAY.tobytes()))
    elif kind == "npy":
        np.save(path, ARRAY)
    elif kind == "npz":
        np.savez(path, im=ARRAY)
    elif kind in ("tif", "zip"):
        first, *others = [Image.fromarray(slice_) for slice_ in ARRAY]
        stack = folder / "stack.tif"
        first.save(stack, save_all=True, append_images=others)
        if kind == "tif":
            return stack
        with zipfile.ZipFile(path, "w") as archive:
            archive.write(stack, "stack.tif")
    elif kind == "mha":
        header = "NDims = 3\nDimSize = 6 5 4\nElementType = MET_UCHAR\nElementSpacing = 0.001 0.002 0.003\n"
        path.write_bytes((header + "ElementDataFile = LOCAL\n").encode() + ARRAY.tobytes())
    else:
        path = folder / "slices"
        path.mkdir()
        for number, slice_ in enumerate(ARRAY):
            Image.fromarray(slice_).save(path / f"s{number + 8}.tif")
    return path


@pytest.mark.parametrize("kind", ["raw", "raw.gz", "npy", "npz", "tif", "zip", "mha", "folder"])
def test_every_kind_gives_the_same_volume(kind, tmp_path):
    volume = read_volume(written(kind, tmp_path), pore=1, voxel=2e-6)
    np.testing.assert_array_equal(volume.pore, ARRAY == 1)
    assert volume.voxel == (2e-6,) * 3


def test_a_zarr_store_gives_the_same_volume(tmp_path):
    zarr = pytest.importorskip("zarr", reason="zarr stores need the extra volumes")
    group = zarr.open_group(tmp_path / "rock.zarr", mode="w")
    group.create_array("0", data=ARRAY)
    np.testing.assert_array_equal(read_volume(tmp_path / "rock.zarr", pore=1, voxel=2e-6).pore, ARRAY == 1)
    group.create_array("1", data=ARRAY[::2])
    with pytest.raises(InputError, match=r"2 arrays.*name="):
        read_volume(tmp_path / "rock.zarr", pore=1, voxel=2e-6)
    assert read_volume(tmp_path / "rock.zarr", pore=1, voxel=2e-6, name="1").shape == (2, 5, 6)


def test_a_header_may_state_the_voxel(tmp_path):
    assert read_volume(written("mha", tmp_path), pore=1).voxel == pytest.approx((3e-6, 2e-6, 1e-6))


def test_unclear_files_are_errors_with_a_remedy(tmp_path):
    path = written("npy", tmp_path)
    with pytest.raises(VolumeError, match=r"rock_4x5x6.npy.*pore="):
        read_volume(path, voxel=1e-6)
    with pytest.raises(VolumeError, match="metres"):
        read_volume(path, pore=1)
    (tmp_path / "a.raw").write_bytes(bytes(7))
    with pytest.raises(InputError, match=r"--shape 200,200,100, in Python shape"):
        read_volume(tmp_path / "a.raw", pore=1, voxel=1e-6)
    with pytest.raises(InputError, match="bytes"):
        read_volume(tmp_path / "a.raw", pore=1, voxel=1e-6, shape=(2, 2, 2))
    with pytest.raises(InputError, match="the file or folder does not exist"):
        read_volume(tmp_path / "b.raw", pore=1, voxel=1e-6)
    (tmp_path / "broken.npz").write_bytes(b"PK")
    with pytest.raises(InputError, match="damaged"):
        read_volume(tmp_path / "broken.npz", pore=1, voxel=1e-6)


@pytest.fixture(scope="module")
def network():
    return pore_network(RockVolume(pack("sc", 20, 2), pore=True, voxel=5e-6))


def test_statoil_files_read_back(network, tmp_path):
    write_statoil(network, tmp_path, "rock", axis=2)
    read = read_statoil(tmp_path, "rock")
    np.testing.assert_allclose(read.pore_radius, network.pores.inscribed * 5e-6, rtol=1e-6)
    np.testing.assert_allclose(read.centre, network.centre[:, [2, 0, 1]], rtol=1e-6)
    assert len(read.pores) == len(network.throats) + 8
    np.testing.assert_allclose(read.total_length, read.pore_length.sum(axis=1) + read.throat_length, rtol=1e-5)


def test_the_published_network_of_berea(pore_data):
    read = read_statoil(pore_data / "icl_berea", "Berea")
    assert (len(read.centre), len(read.pores)) == (6298, 12545)
    assert read.pore_radius.mean() == pytest.approx(15.36e-6, rel=1e-3)


def test_other_files(network, tmp_path):
    import pyvista

    write_openpnm_json(network, tmp_path / "a.json")
    content = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert np.array(content["throat"]["conns"]).shape == (12, 2)
    assert set(openpnm_dictionary(network)) == {f"{e}.{p}" for e, part in content.items() for p in part}
    write_openpnm_csv(network, tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text(encoding="utf-8").startswith("pore.coords[0],pore.coords[1]")
    assert len(write_network_csv(network, tmp_path)) == 4
    write_network_vtp(network, tmp_path / "a.vtp")
    read = pyvista.read(tmp_path / "a.vtp")
    assert (read.n_points, read.n_lines) == (8, 12)
    assert not list(tmp_path.glob("*.part*"))


def test_a_volume_of_pore_only_is_refused_before_any_computation(tmp_path, recwarn):
    volume = RockVolume(np.zeros((6, 7, 8), np.uint8), pore=0, voxel=1.0)
    with refused(VolumeError, "pores.no-rock", shape=(6, 7, 8)):
        run_pores(volume, tmp_path / "out", "all")
    assert not (tmp_path / "out").exists()
    assert not recwarn.list


def test_figures_of_the_surface_are_those_of_its_file(tmp_path):
    """Voxels whose middle lies within the surface are fewer than its volume: both are stated, each as what it is."""
    volume = RockVolume(np.random.default_rng(3).random((12, 10, 8)) < 0.6, pore=True, voxel=(2e-6, 3e-6, 4e-6))
    run = run_pores(volume, tmp_path, "sand")
    written = read_stl(tmp_path / "sand_surface.stl").volume / np.prod(volume.size)
    figures = json.loads((tmp_path / "sand.json").read_text(encoding="utf-8"))
    assert figures["triangles"] == pytest.approx(written, rel=1e-4)
    assert figures["after"]["connectivity"]["porosity"] == pytest.approx(run.surface.voxels().mean())
    page, _ = write_pores_report(run, "sand", tmp_path)
    text = page.read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ").replace("&nbsp;", " ")
    assert f"{100 * written:.1f} %" in text
    assert "voxels whose middle lies within the smooth surface" in text
    assert f"{100 * run.table.smoothing:+.1f}".replace("-", "−") + " percentage points" in text
    words = (tmp_path / "sand_surface.stl.origin.txt").read_text(encoding="utf-8")
    assert "along the axes of the array" in words
    assert "x axis 0, y axis 1, z axis 2" in words
    assert not any(word in words for word in ("map", "east", "north", "elevation"))


def test_metaballs_state_the_volume_of_their_file(tmp_path):
    run = run_metaballs(RockVolume(ARRAY, pore=1, voxel=1e-6), tmp_path, "balls", max_balls=3)
    figures = json.loads((tmp_path / "balls_metaballs.json").read_text(encoding="utf-8"))
    written = read_stl(tmp_path / "balls_metaballs.stl")
    assert figures["volume_of_triangles"] == pytest.approx(written.volume, rel=1e-4)
    assert figures["volume"] == pytest.approx(np.count_nonzero(run.body.covered()) * 1e-18)
    # The origin along the axes of the array is added where the file is read.
    low, high = run.body.bounds
    assert (written.vertices.min(axis=0) > low).all()
    assert (written.vertices.max(axis=0) < high).all()
    assert "east" not in (tmp_path / "balls_metaballs.stl.origin.txt").read_text(encoding="utf-8")


def test_a_surface_without_the_volume_of_the_voxels_is_reported(monkeypatch, tmp_path):
    line = np.zeros((18, 15, 15), bool)
    line[:, 7, 7] = True
    run = run_pores(RockVolume(line, pore=True, voxel=1e-6), tmp_path / "line", "line")
    assert (tmp_path / "line" / "line_surface.stl").exists()
    assert run.surface_note is None
    # Where smaller cells are too many, cells of a voxel see only where the channels widen.
    monkeypatch.setattr("geofit.pores.surface.MOST_CELLS", 0)
    widened = line.copy()
    widened[:, 3, 7] = widened[9:14, 6:9, 6:9] = True
    run = run_pores(RockVolume(widened, pore=True, voxel=1e-6), tmp_path / "widened", "widened")
    assert run.surface_note.code == "pores.surface-volume-off"
    change = run.surface.triangulate().volume / (np.count_nonzero(widened) * 1e-18) - 1
    assert run.surface_note.params["change"] == pytest.approx(change)
    figures = json.loads((tmp_path / "widened" / "widened.json").read_text(encoding="utf-8"))
    assert [entry["code"] for entry in figures["messages"]][-1] == "pores.surface-volume-off"
    page, _ = write_pores_report(run, "widened", tmp_path / "widened")
    assert sentence(run.surface_note, EN) in page.read_text(encoding="utf-8")
    run = run_pores(RockVolume(line, pore=True, voxel=1e-6), tmp_path / "missed", "missed")
    assert not list((tmp_path / "missed").glob("*.stl"))
    assert run.surface_note.code == "pores.no-surface"


@pytest.mark.parametrize(
    ("numbers", "missing"),
    [
        ((1, 2, 4, 5), ": 1, the first after s2.tif"),
        ((10, 20, 30, 60, 70, 90), ": 3, the first after s30.tif"),
        ((0, 2, 4, 6), None),
        ((3, 17, 20, 41), None),
    ],
)
def test_a_folder_with_a_gap_between_its_slices_is_refused(tmp_path, numbers, missing):
    from PIL import Image

    for number in numbers:
        Image.fromarray(np.full((3, 4), number % 2, np.uint8)).save(tmp_path / f"s{number}.tif")
    for read in (read_volume, open_volume):
        if missing is None:
            assert read(tmp_path, pore=0, voxel=1e-6).shape == (len(numbers), 3, 4)
            continue
        with pytest.raises(InputError, match=missing):
            read(tmp_path, pore=0, voxel=1e-6)
