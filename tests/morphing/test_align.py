"""Alignment of a body with a turned, scaled and shifted copy of itself."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import geofit
import geofit.implicit as implicit

Floats = NDArray[np.float64]

SHIFT = np.array([0.7, -1.1, 0.4])


def chain(points: list[list[float]], radius: float) -> implicit.Field:
    return implicit.RoundCones(points, np.full(len(points), radius))


SHAPES = {
    "ellipsoid": implicit.ellipsoid([0, 0, 0], [1.5, 1.0, 0.6]),
    "L-shape": chain([[2, 0, 0], [0, 0, 0], [0, 1.3, 0]], 0.4),
    # Its mirror image is another body.
    "tripod": implicit.union(
        chain([[0, 0, 0], [1.8, 0, 0]], 0.4), chain([[0, 0, 0], [0, 1.3, 0]], 0.4), chain([[0, 0, 0], [0, 0, 0.9]], 0.4)
    ),
    "near-sphere": implicit.ellipsoid([0, 0, 0], [1.0, 1.03, 0.98]),
}


def copy_of(field: implicit.Field, rotation: Floats, scale: float) -> implicit.Field:
    """Return the body scaled, turned and shifted."""

    def back(x: Floats) -> Floats:
        return np.asarray((x - SHIFT) @ rotation / scale)

    lower, upper = field.bounds
    corners = np.array(np.meshgrid(*zip(lower, upper, strict=True))).reshape(3, -1).T @ rotation.T * scale + SHIFT
    return implicit.FunctionField(
        lambda x: scale * field.value(back(x)),
        lambda x: field.gradient(back(x)) @ rotation.T,
        (corners.min(axis=0), corners.max(axis=0)),
        field.lipschitz,
    )


@pytest.mark.parametrize(
    ("name", "turn", "scale"),
    [
        ("ellipsoid", [0.3, -0.5, 0.8], 1.3),
        ("L-shape", [0, 0, np.pi], 0.8),
        ("L-shape", [0.3, -0.5, 0.8], 1.3),
        ("tripod", [np.pi, 0, 0], 1.0),
        ("tripod", [0.3, -0.5, 0.8], 0.8),
        ("near-sphere", [0, 0, np.pi], 1.3),
    ],
)
def test_a_turned_scaled_and_shifted_copy_is_found(name: str, turn: list[float], scale: float) -> None:
    shape, rotation = SHAPES[name], Rotation.from_rotvec(turn).as_matrix()
    m = geofit.morph(shape, copy_of(shape, rotation, scale), align="principal", cells=40)
    found = m.alignment
    assert found.applied
    assert found.after >= 0.99
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)
    assert found.scale == pytest.approx(scale, rel=0.01)
    places = np.asarray(m(0).overview.vertices)
    carried = found.points(places)
    off = np.abs(implicit.signed_distance(copy_of(shape, rotation, scale), carried)).max()
    assert off <= 0.2 * m.lattice.spacing
    if name == "tripod":
        assert np.degrees(Rotation.from_matrix(found.rotation.T @ rotation).magnitude()) <= 0.5


def test_a_mirror_image_is_never_made() -> None:
    tripod = SHAPES["tripod"]
    mirrored = copy_of(tripod, np.diag([-1.0, 1.0, 1.0]), 1.0)
    found = geofit.morph(tripod, mirrored, align="principal", cells=48).alignment
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)
    assert found.before <= found.after < 0.97
