"""Holes that all lie in one plane: nothing shows how wide a body is across it, and the accuracy states that."""

from __future__ import annotations

import numpy as np
import pytest

from bodies.planted import ORIGIN, SIZE, Truth, ellipsoid
from bodies.shapes import case, other_case
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_body
from geofit.data.messages import Message


def fence(truth: Truth, holes: int, turn: float = 0.0, step: float = 0.04) -> BodyData:
    """Return contacts and samples of vertical holes on a line through the middle, turned anticlockwise from east."""
    parts: dict[str, list[np.ndarray]] = {"contacts": [], "inside": [], "outside": []}
    names: dict[str, list[str]] = {name: [] for name in parts}
    z, fine = np.arange(-1 + step / 2, 1, step), np.linspace(-1, 1, 4001)
    for k, at in enumerate((np.arange(holes) + 0.5) / holes * 2 - 1):
        x, y = at * np.cos(turn), at * np.sin(turn)
        value = truth(np.column_stack([np.full(4001, x), np.full(4001, y), fine]))
        met = fine[:-1][(value[1:] < 0) != (value[:-1] < 0)]
        inside = truth(np.column_stack([np.full(len(z), x), np.full(len(z), y), z])) < 0
        for name, depth in (("contacts", met), ("inside", z[inside]), ("outside", z[~inside])):
            parts[name] += [np.array([x, y, each]) for each in depth]
            names[name] += [f"B{k}"] * len(depth)
    places = [np.array(part).reshape(-1, 3) * SIZE + ORIGIN for part in parts.values()]
    return BodyData(*places, None, *names.values(), step * SIZE, step * SIZE)


def beyond(data: BodyData) -> list[Message]:
    body = fit_body(data)
    assert body.accuracy is not None
    return [note for note in body.accuracy.warnings if note.code == "bodies.extent-beyond-data"]


@pytest.mark.parametrize(("turn", "azimuth"), [(0.0, {0, 180}), (0.7, {140})])
def test_a_fence_warns_with_figures(turn: float, azimuth: set[int]) -> None:
    axes = (0.6, 0.4, 0.3)
    # The egg turns with the fence, so that its section is the same.
    egg, cos, sin = ellipsoid(axes)[0], np.cos(turn), np.sin(turn)

    def truth(x: np.ndarray) -> np.ndarray:
        return egg(np.column_stack([cos * x[:, 0] + sin * x[:, 1], cos * x[:, 1] - sin * x[:, 0], x[:, 2]]))

    (note,) = beyond(fence(truth, 11, turn))
    figures = note.params
    assert figures["azimuth"] in azimuth
    assert figures["dip"] == 0
    assert figures["covered"] < 1.0 < 100.0 < figures["extent"]
    assert figures["area"] == pytest.approx(np.pi * axes[0] * axes[2] * SIZE**2, rel=0.05)


def test_contacts_of_a_fence_that_is_a_plane_are_enough() -> None:
    """Four contacts on one plane: all samples off it were released, and the trend across it was left free."""
    (note,) = beyond(fence(ellipsoid((0.7, 0.3, 0.15))[0], 5))
    assert note.severity == "warning"


@pytest.mark.parametrize("make", [case, other_case])
def test_holes_around_a_body_give_no_such_warning(make) -> None:
    for seed in (300, 301, 302, 303, 304):
        one = make(seed)
        assert len(one.data.contacts) < 6 or not beyond(one.data)
