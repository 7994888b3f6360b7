"""Volumes worked through in slabs: the same balls and the same network as in one piece."""

from __future__ import annotations

import numpy as np
import pytest
from brute import blobs
from shapes import capsules

from geofit.data.errors import InputError
from geofit.io.volume_slices import open_volume
from geofit.pores import RockVolume, maximal_balls, pore_network, slabs
from geofit.pores.distance import squared_distance
from geofit.pores.packed import PackedSpace, pack_slab, pore_voxels, slots, unpacked
from geofit.pores.sliced import SlicedVolume
from geofit.pores.volume import VolumeError


def tables(network):
    return {
        f"{part}.{name}": column
        for part in ("pores", "throats", "face_throats", "dropped")
        for name, column in vars(getattr(network, part)).items()
    }


def assert_same(one, two):
    for name, column in tables(one).items():
        np.testing.assert_array_equal(column, tables(two)[name], err_msg=name)
    assert one.percolates == two.percolates


@pytest.fixture
def thin(monkeypatch):
    """Function that sets how many voxels a slab may have."""
    return lambda voxels, halo=2: (
        monkeypatch.setattr(slabs, "VOXELS", voxels),
        monkeypatch.setattr(slabs, "HALO", halo),
    )


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("border", ["open", "closed", ("closed", "open", "open")])
def test_distances_of_slabs_are_those_of_the_whole(seed, border, thin):
    shape = tuple(np.random.default_rng(seed).integers(5, 34, 3))
    pore = blobs(seed, shape)
    edges = (1.0, 1.0, 1.0) if seed % 3 else (1.0, 1.3, 2.1)
    volume = RockVolume(pore, pore=True, voxel=[1e-6 * edge for edge in edges])
    whole = squared_distance(pore, border, volume.edges)
    thin(300)
    for reach in (0, 3):
        for first, end, before, found in slabs.distance_slabs(volume, border, reach):
            low = first - before
            np.testing.assert_array_equal(found, whole[low : low + len(found)])
            assert before == min(first, reach)
            assert low + len(found) == min(end + reach, shape[0])


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("border", ["open", "closed"])
def test_balls_and_network_of_slabs_are_those_of_the_whole(seed, border, thin):
    volume = RockVolume(blobs(seed, (40, 21, 17)), pore=True, voxel=1e-6)
    balls, network = maximal_balls(volume, border=border), pore_network(volume, border=border)
    thin(int(np.random.default_rng(seed).integers(400, 4000)))
    sliced = SlicedVolume(volume.pore, pore=True, voxel=1e-6)
    for part in (volume, sliced):
        again = maximal_balls(part, border=border)
        np.testing.assert_array_equal(again.centre, balls.centre)
        np.testing.assert_array_equal(again.radius2, balls.radius2)
        np.testing.assert_array_equal(again.reach2, balls.reach2)
        assert_same(pore_network(part, border=border), network)
    assert pore_network(sliced, border=border).pore_of is None


def test_a_tube_through_all_slabs_is_one_pore_of_each(thin):
    """Nothing along the tube is narrower: a slab cannot know where its widest place is."""
    pore = capsules((120, 24, 24), [((-20, 11.5, 11.5), (140, 11.5, 11.5), 7.3)])
    volume = RockVolume(pore, pore=True, voxel=1e-6)
    whole = pore_network(volume)
    thin(24 * 24 * 12)
    assert_same(pore_network(volume), whole)
    assert len(whole.pores) == 1


def test_berea_200_in_slabs_of_40_slices(rock, thin):
    volume = rock("berea_200")
    balls, network = maximal_balls(volume), pore_network(volume)
    thin(200 * 200 * (40 + 2 * 16), 16)
    assert_same(pore_network(volume), network)
    again = maximal_balls(volume)
    np.testing.assert_array_equal(again.centre, balls.centre)


def test_long_voxels_and_a_full_volume_in_slabs(thin):
    long = RockVolume(blobs(3, (30, 14, 12)), pore=True, voxel=(2e-6, 1e-6, 1e-6))
    full = RockVolume(np.ones((30, 9, 9)), pore=1, voxel=1e-6)
    networks = [pore_network(volume) for volume in (long, full)]
    thin(14 * 12 * 6)
    for volume, network in zip((long, full), networks, strict=True):
        assert_same(pore_network(volume), network)
    with pytest.raises(VolumeError, match="read_volume"):
        maximal_balls(SlicedVolume(long.pore, pore=True, voxel=long.voxel))


@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 5, 7), (4, 8, 16), (9, 13, 64)])
def test_packed_voxels_come_back(shape):
    rng = np.random.default_rng(0)
    pore = rng.random(shape) < 0.4
    space = PackedSpace.empty(shape)
    filled = 0
    for first in range(0, shape[0], 2):
        filled = pack_slab(space, pore[first : first + 2], first, filled)
    flat = np.flatnonzero(pore)
    assert filled == len(flat)
    out = np.empty(len(flat), space.address_type)
    pore_voxels(space, out)
    np.testing.assert_array_equal(out, flat)
    where = np.full(pore.size, -1)
    where[flat] = np.arange(len(flat))
    np.testing.assert_array_equal(slots(space, np.arange(pore.size)), where)
    values = rng.integers(1, 99, len(flat)).astype(np.int32)
    np.testing.assert_array_equal(unpacked(space, values)[pore], values)


@pytest.mark.parametrize("kind", ["raw", "npy", "tif", "mha", "folder"])
def test_files_that_stay_on_the_disk_give_the_same_volume(kind, tmp_path):
    from test_files import ARRAY, written

    volume = open_volume(written(kind, tmp_path), pore=1, voxel=2e-6)
    assert volume.shape == ARRAY.shape
    assert volume.porosity == (ARRAY == 1).mean()
    for first in range(len(ARRAY)):
        np.testing.assert_array_equal(volume.slab(first, len(ARRAY)), ARRAY[first:] == 1)
    assert volume.size == pytest.approx(tuple(2e-6 * n for n in ARRAY.shape))


def test_packed_files_and_unclear_labels_are_errors(tmp_path):
    from test_files import written

    with pytest.raises(InputError, match="Unpack"):
        open_volume(written("npz", tmp_path), pore=1, voxel=1e-6)
    with pytest.raises(InputError, match="the file or folder does not exist"):
        open_volume(tmp_path / "none.raw", pore=1, voxel=1e-6)
    values = np.arange(3, dtype=np.uint8).repeat(20).reshape(6, 2, 5)
    with pytest.raises(VolumeError, match="3 different values"):
        SlicedVolume(values, pore=1, voxel=1e-6)
    with pytest.raises(VolumeError, match=r"No voxel.*0 \(33.33 %\)"):
        SlicedVolume(values, pore=[7], voxel=1e-6)
    with pytest.raises(VolumeError, match="pore="):
        SlicedVolume(values, voxel=1e-6)
    with pytest.raises(VolumeError, match="metres"):
        SlicedVolume(values, pore=[1])
    with pytest.raises(VolumeError, match="axes"):
        SlicedVolume(values[0], pore=[1], voxel=1e-6)
    holes = values.astype(float)
    holes[4] = np.nan
    with pytest.raises(VolumeError, match="Slices 0 to 5"):
        SlicedVolume(holes, pore=[1], voxel=1e-6)
    assert SlicedVolume(values, pore=[0, 2], voxel=1e-6).porosity == pytest.approx(2 / 3)
