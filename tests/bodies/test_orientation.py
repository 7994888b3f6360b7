"""A body whose normals point inwards, or whose inside and outside are exchanged, fails a check that says so."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from bodies.planted import ORIGIN
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_body

Floats = NDArray[np.float64]
AXES = np.array([60.0, 45.0, 30.0])
VOLUME = 4 / 3 * np.pi * float(AXES.prod())


def unit() -> Floats:
    found = np.random.default_rng(3).normal(size=(80, 3))
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def normals(places: Floats) -> Floats:
    return np.asarray((places / AXES) / np.linalg.norm(places / AXES, axis=1, keepdims=True))


def failed(data: BodyData) -> tuple[float, set[str]]:
    """Return the volume over that of the ellipsoid, and the checks that fail."""
    body = fit_body(data)
    assert body.accuracy is not None
    return body.overview.volume / VOLUME, {check.name for check in body.accuracy.checks if check.passed is False}


@pytest.mark.parametrize("share", [1.0, 0.7])
def test_normals_that_point_inwards(share: float) -> None:
    place = unit()
    place = place[np.argsort(place[:, 0])][: round(share * len(place))]
    contacts = ORIGIN + AXES * place
    volume, wrong = failed(BodyData(contacts, normals=normals(place)))
    assert volume == pytest.approx(1, abs=0.05)
    assert wrong == set()
    volume, wrong = failed(BodyData(contacts, normals=-normals(place)))
    assert volume > 10
    assert "orientation" in wrong


def test_normals_of_half_a_body_that_point_inwards() -> None:
    place = unit()
    place = place[place[:, 2] > 0]
    volume, wrong = failed(BodyData(ORIGIN + AXES * place, normals=-normals(place)))
    assert volume > 10
    assert wrong == {"far from data"}


def test_inside_and_outside_exchanged() -> None:
    on, inner, outer = (ORIGIN + size * AXES * unit() for size in (1.0, 0.5, 1.5))
    volume, wrong = failed(BodyData(on, inside=inner, outside=outer))
    assert volume == pytest.approx(1, abs=0.02)
    assert wrong == set()
    volume, wrong = failed(BodyData(on, inside=outer, outside=inner))
    assert volume > 10
    assert wrong == {"orientation"}


def test_a_shell_has_contacts_on_its_cavity_and_passes() -> None:
    place = unit()
    contacts = np.concatenate([AXES * place, 0.6 * AXES * place])
    outwards = np.concatenate([normals(place), -normals(place)])
    volume, wrong = failed(BodyData(ORIGIN + contacts, normals=outwards))
    assert volume == pytest.approx(1 - 0.6**3, abs=0.05)
    assert wrong == set()
