"""The rebuilt body: closed, with the volume of its voxels, smooth, bounded."""

import numpy as np
import pytest
from brute import blobs
from shapes import pack

from geofit.implicit.field import Field
from geofit.pores import RockVolume, VolumeError, pore_network, pore_surface


@pytest.fixture(scope="module")
def berea(request):
    volume = request.getfixturevalue("rock")("berea_110")
    part = RockVolume(volume.pore[:64, :64, :64], pore=True, voxel=volume.voxel)
    return part, pore_network(part)


@pytest.mark.parametrize(("construction", "within"), [("contact", 0.01), ("blend", 0.1)])
def test_the_mesh_is_closed_and_keeps_the_volume(berea, construction, within):
    volume, network = berea
    body = pore_surface(volume, network, construction=construction)
    assert isinstance(body, Field)
    mesh = body.triangulate()
    assert mesh.is_closed
    assert mesh.is_manifold
    assert body.porosity == pytest.approx(network.porosity, rel=within)


@pytest.mark.parametrize("construction", ["contact", "blend"])
def test_gradients_are_those_of_the_values(berea, construction):
    body = pore_surface(*berea, construction=construction)
    unit = berea[0].unit
    rng = np.random.default_rng(0)
    places = rng.uniform(5, 59, (200, 3)) * unit
    step = 1e-5 * unit
    differences = np.stack(
        [(body.value(places + step * e) - body.value(places - step * e)) / (2 * step) for e in np.eye(3)], 1
    )
    error = np.abs(body.gradient(places) - differences).max(axis=1) / (1 + np.linalg.norm(differences, axis=1))
    assert np.quantile(error, 0.98) < 1e-4


def test_boxes_bound_their_values(berea):
    body = pore_surface(*berea)
    rng = np.random.default_rng(1)
    lower = rng.uniform(0, 50, (300, 3))
    upper = lower + rng.uniform(0.5, 6, (300, 3))
    low, high = body.range_in(lower * berea[0].unit, upper * berea[0].unit)
    assert np.isfinite(low).any()
    inside = body.value((lower + rng.random((300, 3)) * (upper - lower)) * berea[0].unit)
    assert (inside >= low - 1e-12).all()
    assert (inside <= high + 1e-12).all()


@pytest.mark.parametrize("construction", ["contact", "blend"])
@pytest.mark.parametrize("source", ["sc", "bcc", "fcc", 2, 4, 5])
def test_surfaces_of_packs_and_noise_are_closed(source, construction):
    """PORES.md, test 33."""
    pore = pack(source, 24, 1) if isinstance(source, str) else blobs(source, (26, 24, 22))
    volume = RockVolume(pore, pore=True, voxel=1e-6)
    network = pore_network(volume)
    body = pore_surface(volume, network, construction=construction)
    mesh = body.triangulate()
    assert mesh.is_closed
    assert mesh.is_manifold
    if construction == "contact":
        assert body.porosity == pytest.approx(network.porosity, rel=0.01)


def test_wrong_parameters_are_errors(berea):
    volume, network = berea
    with pytest.raises(VolumeError, match="contact"):
        pore_surface(volume, network, construction="poisson")
    with pytest.raises(VolumeError, match="shape"):
        pore_surface(RockVolume(np.zeros((4, 4, 4)), pore=0, voxel=1), network)
