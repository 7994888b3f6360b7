"""Labels and voxel sizes are stated, never guessed; what is unclear is an error with its remedy."""

import numpy as np
import pytest

from geofit.data.errors import ArgumentError, GeofitError
from geofit.pores import RockVolume, VolumeError, maximal_balls, pore_network
from geofit.pores.sliced import SlicedVolume


def test_the_label_is_never_guessed_and_the_error_lists_shares():
    array = np.zeros((4, 4, 5), np.uint8)
    array[:3] = 255
    with pytest.raises(VolumeError, match=r"255 \(75 %\), 0 \(25 %\).*pore="):
        RockVolume(array, voxel=1e-6)


def test_the_voxel_size_is_never_guessed():
    with pytest.raises(VolumeError, match=r"voxel.*metres"):
        RockVolume(np.zeros((2, 2, 2)), pore=0)


@pytest.mark.parametrize("voxel", [0, -1e-6, np.nan, (1e-6, 1e-6), "x"])
def test_a_voxel_size_must_be_a_length(voxel):
    with pytest.raises((VolumeError, ArgumentError)):
        RockVolume(np.zeros((2, 2, 2)), pore=0, voxel=voxel)


def test_three_labels_need_a_list_of_pore_labels():
    array = np.arange(27).reshape(3, 3, 3) % 3
    with pytest.raises(VolumeError, match=r"3 different values.*pore=\[0\]"):
        RockVolume(array, pore=0, voxel=1e-6)
    assert RockVolume(array, pore=[0], voxel=1e-6).porosity == pytest.approx(1 / 3)
    assert RockVolume(array, pore=range(2), voxel=1e-6).porosity == pytest.approx(2 / 3)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.ones((3, 3, 3)), "No voxel has the pore value"),
        (np.zeros((3, 3)), "2 axes"),
        (np.zeros((0, 3, 3)), "no voxel"),
        (np.full((2, 2, 2), np.nan), "NaN"),
        (np.full((2, 2, 2), "a"), "numbers"),
    ],
)
def test_unusable_arrays_are_errors(array, words):
    with pytest.raises(GeofitError, match=words):
        RockVolume(array, pore=0, voxel=1e-6)


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 8, 8), (5, 1, 1), (3, 4, 5)])
def test_all_pore_and_thin_volumes_have_trivial_results(shape):
    volume = RockVolume(np.zeros(shape, bool), pore=False, voxel=1e-6)
    assert maximal_balls(volume).union().all()
    network = pore_network(volume)
    assert len(network.pores) == 1
    assert network.percolates == (True, True, True)
    assert network.pores.volume.sum() == np.prod(shape)


def test_the_mask_is_a_copy_that_cannot_be_written():
    array = np.zeros((2, 2, 2), bool)
    volume = RockVolume(array, pore=False, voxel=1)
    array[:] = True
    assert volume.pore.all()
    with pytest.raises(ValueError, match="read-only"):
        volume.pore[0] = False


@pytest.mark.parametrize("pore", [0.1, [0.1], np.float64(0.1), np.array(0.1), [0.1, 1e300]])
@pytest.mark.parametrize("kind", [RockVolume, SlicedVolume])
def test_a_pore_value_is_that_of_the_voxels_type(kind, pore):
    """0.1 in four bytes is not 0.1 in eight."""
    array = np.zeros((4, 4, 4), np.float32)
    array[1:3] = 0.1
    volume = kind(array, pore=pore, voxel=1e-6)
    assert volume.porosity == 0.5
    assert volume.slab(0, 4).sum(axis=(1, 2)).tolist() == [0, 16, 16, 0]
