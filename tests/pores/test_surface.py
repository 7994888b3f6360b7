"""The rebuilt body: closed, with the volume of its voxels, smooth, bounded."""

from contextlib import nullcontext

import numpy as np
import pytest
from brute import blobs
from scipy.spatial import cKDTree
from shapes import pack

from geofit.implicit.field import Field
from geofit.pores import RockVolume, VolumeError, euler_number, pore_network, pore_surface


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
    # Blended balls lose the gaps between grains of the densest pack, and all but a hundredth of the finest noise.
    narrow = construction == "blend" and source in ("fcc", 4)
    with pytest.warns(UserWarning, match="voxels wide") if narrow else nullcontext():
        body = pore_surface(volume, network, construction=construction)
    mesh = body.triangulate()
    assert mesh.is_closed
    assert mesh.is_manifold
    if construction == "contact":
        assert body.porosity == pytest.approx(network.porosity, rel=0.01)


@pytest.fixture(scope="module")
def two_balls():
    """Two balls that overlap, in the middle of 30 x 30 x 30 voxels, and the signed distance from their union."""
    middles, radii = np.array([[12.0, 12, 12], [19, 18, 17]]), np.sqrt([80.0, 50.0])

    def outside(places):
        return (np.linalg.norm(places[..., None, :] - middles, axis=-1) - radii).min(axis=-1)

    x = np.stack(np.meshgrid(*[np.arange(30) + 0.5] * 3, indexing="ij"), axis=-1)
    return outside(x) < 0, outside


@pytest.mark.parametrize("unit", [1.0, 2e-6])
def test_distances_from_contacts_are_those_of_the_nearest_wall(two_balls, unit):
    """Where all voxels around are of one kind the field is constant, and a walk to the wall may get lost there."""
    pore, outside = two_balls
    body = pore_surface(RockVolume(pore, pore=True, voxel=unit))
    places = np.random.default_rng(0).uniform(2, 28, (300, 3))
    distance = body.distance(places * unit) / unit
    truth = outside(places)
    # Within, the union's nearest wall may lie at the edge where the balls meet, farther than that of either.
    error = np.abs(distance - truth)[truth > 0]
    assert error.max() < 0.5
    fine = body.triangulate(unit / 4)
    most = cKDTree(fine.vertices).query(places * unit)[0] / unit
    assert (np.abs(distance) < most + 0.25).all()
    assert (np.abs(distance) > most - 0.5).all()


def test_distances_are_those_of_the_wall_not_of_the_samples_faces():
    x = np.arange(20) + 0.5
    pore = np.repeat(((x[:, None] - 10) ** 2 + (x - 10) ** 2 < 36)[..., None], 8, axis=2)
    body = pore_surface(RockVolume(pore, pore=True, voxel=1.0))
    # Along the axis up to the faces of the sample.
    places = np.column_stack([np.full(9, 11.0), np.full(9, 10.0), np.linspace(0.1, 7.9, 9)])
    assert body.distance(places) == pytest.approx(-5.0, abs=0.25)


@pytest.mark.parametrize(
    ("shape", "voxel", "spacing"),
    [
        ((100, 100, 3), (1, 1, 1), 2.0),
        ((60, 60, 60), (1, 1, 1), 1.9),
        ((60, 60, 5), (1, 1, 1.5), None),
        ((20, 20, 1), (1, 1, 1.45), None),
    ],
)
def test_meshes_end_at_the_faces_of_the_sample(shape, voxel, spacing):
    x, y = np.ogrid[: shape[0], : shape[1]]
    middle = (shape[0] - 1) / 2
    pore = np.broadcast_to(((x - middle) ** 2 + (y - middle) ** 2 < (0.3 * shape[0]) ** 2)[..., None], shape)
    volume = RockVolume(pore, pore=True, voxel=tuple(1e-6 * edge for edge in voxel))
    body = pore_surface(volume)
    upper = body.bounds[1]
    truth = volume.porosity * upper.prod()
    mesh = body.triangulate(spacing and spacing * 1e-6)
    assert mesh.is_closed
    assert mesh.vertices[:, 2].min() == 0
    assert mesh.vertices[:, 2].max() == pytest.approx(upper[2], rel=1e-12)
    assert mesh.volume == pytest.approx(truth, rel=0.015)
    assert body.size.volume == pytest.approx(truth, rel=0.01)
    assert body.porosity == pytest.approx(volume.porosity, rel=0.01)


def test_channels_one_voxel_wide_keep_their_volume_and_their_way_through():
    line = np.zeros((18, 15, 15), bool)
    line[:, 7, 7] = True
    checkers = np.indices((8, 9, 10)).sum(axis=0) % 2 == 0
    for pore in (line, checkers):
        volume = RockVolume(pore, pore=True, voxel=1e-6)
        network = pore_network(volume)
        body = pore_surface(volume, network)
        assert body.overview_spacing < body.spacing
        mesh = body.triangulate()
        assert mesh.is_closed
        assert body.porosity == pytest.approx(network.porosity, rel=0.05)
        if pore is line:
            assert mesh.components == 1
            assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(18e-6)


def test_wrong_parameters_are_errors(berea):
    volume, network = berea
    with pytest.raises(VolumeError, match="contact"):
        pore_surface(volume, network, construction="poisson")
    with pytest.raises(VolumeError, match="shape"):
        pore_surface(RockVolume(np.zeros((4, 4, 4)), pore=0, voxel=1), network)


def thin_rock(kind):
    """Walls round a wide pore, and in it rock that is one voxel thick."""
    rock = np.zeros((30, 30, 30), bool)
    rock[:3] = rock[-3:] = rock[:, :3] = rock[:, -3:] = True
    if kind == "voxel":
        rock[15, 15, 15] = True
    elif kind == "rod":
        rock[15, 15] = True
    elif kind == "wall":
        rock[:, 15] = True
    return ~rock


@pytest.mark.parametrize("kind", ["voxel", "rod", "wall"])
def test_rock_one_voxel_thick_is_kept(kind):
    """Balls touch it from opposite sides: one plane for all of them is none, and made half-balls and broken walls."""
    volume = RockVolume(thin_rock(kind), pore=True, voxel=1e-6)
    body = pore_surface(volume)
    np.testing.assert_array_equal(body.voxels(), volume.pore)
    assert body.porosity == pytest.approx(volume.porosity, rel=2e-3)


def test_noise_of_single_voxels_does_not_grow():
    """One voxel in 500 of a wide pore: each became rock of twenty voxels."""
    pore = thin_rock("none") & (np.random.default_rng(0).random((30, 30, 30)) >= 0.002)
    body = pore_surface(RockVolume(pore, pore=True, voxel=1e-6))
    assert (body.voxels() != pore).mean() < 0.004
    assert euler_number(body.voxels()) == euler_number(pore)
