"""Contacts are met at any number and place, offsets are measured with their sign, and the usual way does worse."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree

from bodies.planted import ORIGIN, SIZE, drilled, ellipsoid
from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData, prepare
from geofit.bodies.fit import fit_body
from geofit.bodies.settings import BodySettings
from geofit.data.errors import FitError, SettingsError

Floats = NDArray[np.float64]


def bumpy(count: int) -> tuple[Floats, Floats]:
    """Return contacts (n, 3) and outward normals of a ball of 1 km that has gentle bumps."""
    i = np.arange(count) + 0.5
    z, turn = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    unit = np.column_stack([np.cos(turn) * np.sqrt(1 - z**2), np.sin(turn) * np.sqrt(1 - z**2), z])
    wave, slope = np.sin(3 * unit[:, :1]), 3 * np.cos(3 * unit[:, :1]) * np.eye(3)[:1]
    radius = 500 * (1 + 0.04 * wave)
    normal = unit - 0.04 * (slope - (slope * unit).sum(axis=1, keepdims=True) * unit) / (1 + 0.04 * wave)
    return radius * unit + ORIGIN, normal / np.linalg.norm(normal, axis=1, keepdims=True)


@pytest.mark.parametrize("kernel", ["r3", "r"])
@pytest.mark.parametrize("count", [50, 500, 5000])
def test_contacts_are_met_by_both_kernels(kernel: str, count: int) -> None:
    contacts, _ = bumpy(count)
    body = fit_body(BodyData(contacts, inside=[ORIGIN]), BodySettings(kernel=kernel))
    assert np.abs(body.distance(contacts)).max() < 1e-8
    assert body.overview.is_closed
    assert body.overview.components == 1
    smooth = 4 / 3 * np.pi * 500**3
    assert abs(body.overview.volume / smooth - 1) < 0.015


def test_the_kernel_r_is_another_body_with_a_spread_and_no_normals() -> None:
    truth, volume = ellipsoid((0.6, 0.4, 0.3))
    data = drilled(truth, 3)
    smooth, tight = (fit_body(data, BodySettings(kernel=kernel)) for kernel in ("r3", "r"))
    assert tight.accuracy is not None
    assert tight.accuracy.wrong_side == 0
    assert 0.8 < tight.overview.volume / (volume * SIZE**3) < smooth.overview.volume / (volume * SIZE**3)
    volumes = tight.volumes()
    assert volumes.p10 < volumes.best < volumes.p90
    contacts, normals = bumpy(50)
    with pytest.raises(FitError, match="no slope at its contacts"):
        fit_body(BodyData(contacts, normals=normals), BodySettings(kernel="r"))
    with pytest.raises(SettingsError, match="Kernel"):
        BodySettings(kernel="gauss")


@pytest.mark.parametrize("count", [50, 500])
def test_contacts_and_normals_are_met_at_map_coordinates(count: int) -> None:
    contacts, normals = bumpy(count)
    plain = fit_body(BodyData(contacts, inside=[ORIGIN]))
    assert np.abs(plain.distance(contacts)).max() < 1e-8
    some = np.where(np.arange(count)[:, None] % 4 == 0, normals, np.nan)
    turned = fit_body(BodyData(contacts, normals=some))
    assert np.abs(turned.distance(contacts)).max() < 1e-8
    np.testing.assert_allclose(turned.gradient(contacts[::4]), normals[::4], atol=1e-6)


@pytest.mark.parametrize("name", ["ring", "two"])
def test_planted_offsets_are_measured_with_their_sign(name: str, request: pytest.FixtureRequest) -> None:
    body: BodyFit = request.getfixturevalue(name)
    rng = np.random.default_rng(5)
    surface = body.overview.vertices + body.origin
    foot = surface[rng.choice(len(surface), 200, replace=False)]
    # Vertices lie on the surface within a millionth of a cell; what is left of it is taken off first.
    foot = foot - body.distance(foot)[:, None] * unit(body.gradient(foot))
    offset = rng.uniform(-1.0, 1.0, len(foot))
    measured = body.distance(foot + offset[:, None] * unit(body.gradient(foot)))
    np.testing.assert_allclose(measured, offset, atol=1e-6)
    sigma, planted = (np.sqrt((d**2).sum() / (len(d) - 1)) for d in (measured, offset))
    assert abs(sigma - planted) < 1e-6


def unit(x: Floats) -> Floats:
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def test_inequalities_come_closer_than_all_samples_as_equalities() -> None:
    truth, volume = ellipsoid((0.6, 0.4, 0.3))
    line = (np.arange(28) + 0.5) / 28 * 2 - 1
    nodes = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    own, usual = [], []
    for seed in (0, 3, 7):
        data = drilled(truth, seed)
        body = fit_body(data)
        own.append(abs(body.overview.volume / (volume * SIZE**3) - 1))
        samples = np.concatenate([data.inside, data.outside])
        side = np.where(np.arange(len(samples)) < len(data.inside), -1.0, 1.0)
        height = np.minimum(cKDTree(data.contacts).query(samples)[0], 6.0)
        places = np.concatenate([data.contacts, samples])
        values = np.concatenate([np.zeros(len(data.contacts)), side * height])
        field = RBFInterpolator((places - ORIGIN) / SIZE, values, kernel="linear")
        usual.append(abs((field(nodes) < 0).mean() * 8 / volume - 1))
    assert max(own) < 0.05
    assert np.median(own) < np.median(usual) / 2


def scattered() -> BodyData:
    """Return 150 contacts scattered on a torus of 40 and 12 m, its middle line inside, and places 10 m outside."""
    u, v = np.random.default_rng(0).uniform(0, 2 * np.pi, (2, 150))
    normal = np.column_stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)])
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    middle, ring = (40 * np.column_stack([np.cos(t), np.sin(t), 0 * t]) for t in (turn, u))
    return BodyData(ring + 12 * normal, inside=middle, outside=ring + 22 * normal)


@pytest.mark.parametrize("apart", [1e-5, 1e-3, 1e-2])
def test_contacts_read_twice_are_one_contact(apart: float) -> None:
    """Zero at two places of a centimetre, a field cannot rise from one to the other: the volume was off by 11 %."""
    once = scattered()
    again = once.contacts + np.random.default_rng(1).normal(0, apart, once.contacts.shape)
    twice = fit_body(BodyData(np.concatenate([once.contacts, again]), once.inside, once.outside))
    volume = 2 * np.pi**2 * 40 * 12**2
    assert twice.size.volume == pytest.approx(volume, rel=0.015)
    assert twice.size.volume == pytest.approx(fit_body(once).size.volume, rel=1e-6)
    assert twice.accuracy is not None
    assert 0.1 * apart < twice.accuracy.sigma < 2 * apart
    merged = [issue for issue in twice.issues if issue.kind == "coincident"]
    assert len(merged) == len(once.contacts)
    assert all(issue.used for issue in merged)


def test_contacts_of_a_thin_part_stay_two() -> None:
    """Contacts of a seam of 2 cm are as near as readings, but of one hole, of opposite normals, or around a sample."""
    place = np.array([(x, y, 0.0) for x in range(0, 50, 10) for y in range(0, 50, 10)])
    up, half = np.array([0, 0, 1.0]), np.array([0, 0, 0.01])
    contacts = np.concatenate([place + half, place - half])
    names = [f"B{k}" for k in range(len(place))]
    normals = np.concatenate([np.tile(up, (len(place), 1)), np.tile(-up, (len(place), 1))])
    between = BodyData(contacts, inside=place, outside=place + up)
    named = BodyData(contacts, outside=place + up, inside=place[:1] + 5, hole=names * 2, outside_hole=names)
    oriented = BodyData(contacts, normals=normals)
    for data in (between, named, oriented):
        assert len(prepare(data, BodySettings()).contacts) == len(contacts)
    bare = BodyData(contacts, inside=place[:1] + 5, outside=place + up)
    assert len(prepare(bare, BodySettings()).contacts) == len(place)


def test_contacts_that_almost_coincide_are_refused() -> None:
    """Such a body had no volume, or a field of zeros that passed with sigma 0. Contacts of one hole are not merged."""
    once = scattered()
    contacts = np.concatenate([once.contacts, once.contacts + np.random.default_rng(1).normal(0, 1e-5, (150, 3))])
    with pytest.raises(FitError, match="so close to each other"):
        fit_body(BodyData(contacts, once.inside, once.outside, hole=[f"B{k}" for k in range(150)] * 2))
