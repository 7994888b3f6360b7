"""What every kind of body can do: balls, pores, passages, frames and fits, against a ball of known size."""

from __future__ import annotations

import numpy as np
import pytest

import geofit
from geofit.bodies.implicit_body import ImplicitBody
from geofit.caves.body import PassageBody, centreline_body
from geofit.caves.shots import ShotList
from geofit.data.errors import GeofitError
from geofit.implicit.field import Field
from geofit.medial.balls import MetaballBody
from geofit.morphing.morph import morph
from geofit.pores import RockVolume, pore_surface

CENTRE, RADIUS = np.array([12.0, 12.0, 12.0]), 9.0


class Level:
    """A horizontal surface."""

    name = "level"

    def __init__(self, z: float) -> None:
        self.z = z

    def elevation(self, x, y):
        return np.full(np.shape(x), self.z)


def balls() -> MetaballBody:
    return MetaballBody(CENTRE[None], np.array([RADIUS]))


def pores(voxel: float = 1.0):
    middle = np.indices((24, 24, 24)) + 0.5
    return pore_surface(RockVolume(((middle - 12) ** 2).sum(axis=0) < RADIUS**2, pore=True, voxel=voxel))


def passage() -> PassageBody:
    shots = ShotList(fixed={"0": (500_012.0, 3_100_012.0, 112.0)})
    shots.add_walls("0", shots.add("0", "1", np.array([1e-3, 0.0, 0.0]), 0), [RADIUS] * 4)
    return centreline_body(shots.survey("room"))


def frame():
    return morph(balls(), MetaballBody(CENTRE[None] + 2, np.array([RADIUS])), spacing=0.75)(0.0)


def fit():
    rng = np.random.default_rng(4)
    normals = rng.normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    data = geofit.BodyData(contacts=CENTRE + RADIUS * normals, normals=normals)
    return geofit.fit_body(data, geofit.BodySettings(), name="ball")


@pytest.mark.parametrize(
    ("make", "centre", "within"),
    [
        (balls, CENTRE, 1e-6),
        (pores, CENTRE, 0.5),
        (passage, CENTRE + np.array([500_000.0, 3_100_000.0, 100.0]), 2e-3),
        (frame, CENTRE, 0.1),
        (fit, CENTRE, 0.05),
    ],
    ids=["balls", "pores", "passage", "frame", "fit"],
)
def test_every_kind_of_body_measures_cuts_and_exports_a_ball(make, centre, within, tmp_path):
    body = make()
    assert isinstance(body, ImplicitBody)
    assert isinstance(body, geofit.ImplicitBody)
    assert isinstance(body.field, Field)
    places = centre + np.array([[0, 0, 4.0], [0, 0, 8.5], [0, 10.5, 0.0], [-11.0, 0.0, 0.0]])
    assert body.distance(places) == pytest.approx([-5.0, -0.5, 1.5, 2.0], abs=within)
    assert (np.sign(body.value(places)) == [-1, -1, 1, 1]).all()
    mesh = body.triangulate()
    assert mesh.is_closed
    assert (mesh.euler, mesh.components) == (2, 1)
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.05)
    assert mesh.vertices.mean(axis=0) == pytest.approx(centre, abs=0.3)
    above, below = sorted(body.cut([Level(centre[2] + 0.01)]), key=lambda piece: piece.name)
    assert above.volume + below.volume == pytest.approx(mesh.volume, rel=1e-9)
    assert above.volume == pytest.approx(below.volume, rel=0.05)
    found = body.write_step(tmp_path / "body.step")
    assert found.passed
    assert not any("nan" in str(check.text) for check in found.checks)
    assert found.volume == pytest.approx(mesh.volume, rel=0.05)
    assert body.name in repr(body)
    assert len(repr(body)) < 120


def test_a_body_of_pores_is_as_sound_at_five_micrometres(tmp_path):
    body = pores(5e-6)
    places = 5e-6 * (CENTRE + np.array([[0, 0, 4.0], [-11.0, 0.0, 0.0]]))
    assert body.distance(places) / 5e-6 == pytest.approx([-5.0, 2.0], abs=0.5)
    assert body.write_step(tmp_path / "pores.step").passed


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, 1e-4])
def test_a_spacing_that_cannot_be_used_is_refused_by_every_kind(spacing):
    for body in (balls(), fit()):
        with pytest.raises(GeofitError):
            body.triangulate(spacing)
    for body in (pores(), passage()):
        if spacing != 1e-4:
            with pytest.raises(GeofitError):
                body.triangulate(spacing)
