"""Holes that all lie in one plane: nothing shows how wide a body is across it, and the accuracy states that."""

from __future__ import annotations

import numpy as np
import pytest

from bodies.planted import ORIGIN, SIZE, Truth, ellipsoid
from bodies.shapes import case, other_case
from geofit.bodies.accuracy import across_two_sections
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


def two_fences(truth: Truth, apart: float, holes: int, turn: float) -> BodyData:
    """Return the data of two fences, each as far from the middle, turned anticlockwise from east."""
    side = np.array([-np.sin(turn), np.cos(turn), 0.0]) * apart / 2
    parts = [fence(lambda x, s=sign: truth(x + s * side), holes, turn) for sign in (-1, 1)]
    moved = [
        {name: getattr(part, name) + sign * SIZE * side for name in ("contacts", "inside", "outside")}
        for part, sign in zip(parts, (-1, 1), strict=True)
    ]
    places = [np.concatenate([part[name] for part in moved]) for name in ("contacts", "inside", "outside")]
    names = [
        np.concatenate([np.char.add(f"{k}-", getattr(part, name)) for k, part in enumerate(parts)])
        for name in ("hole", "inside_hole", "outside_hole")
    ]
    return BodyData(*places, None, *names, parts[0].inside_length[0], parts[0].outside_length[0])


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


@pytest.mark.parametrize("turn", [0.0, 0.4])
@pytest.mark.parametrize(("apart", "holes"), [(0.5, 9), (0.8, 31), (1.2, 15), (1.2, 31)])
def test_two_fences_warn_though_they_cover_most_of_the_body(turn: float, apart: float, holes: int) -> None:
    """No data bound its ends, and it was 0.3 to 1.4 times as large as it should be; without a warning from 80 m on."""
    cos, sin = np.cos(turn), np.sin(turn)
    egg = ellipsoid((0.6, 0.8, 0.3))[0]

    def truth(x: np.ndarray) -> np.ndarray:
        return egg(np.column_stack([cos * x[:, 0] + sin * x[:, 1], cos * x[:, 1] - sin * x[:, 0], x[:, 2]]))

    (note,) = beyond(two_fences(truth, apart, holes, turn))
    assert note.params["azimuth"] in ({0, 180} if turn == 0 else {157})
    assert note.params["dip"] == 0
    assert note.params["covered"] == pytest.approx(apart * SIZE, abs=0.1)
    shrunk = 1 - (apart / 2 / 0.8) ** 2
    assert note.params["area"] == pytest.approx(np.pi * 0.6 * 0.3 * shrunk * SIZE**2, rel=0.35)


def test_three_fences_and_one_are_not_two_sections() -> None:
    x, y, z = (axis.ravel() for axis in np.meshgrid(np.arange(5.0), np.arange(3.0), np.arange(40) / 8, indexing="ij"))
    grid = np.column_stack([x, y, z])
    assert across_two_sections(grid) is None
    assert across_two_sections(grid[y == 0]) is None
    pair = across_two_sections(grid[y != 1])
    assert pair is not None
    assert abs(pair[1]) == pytest.approx(1.0)


@pytest.mark.parametrize("make", [case, other_case])
def test_holes_around_a_body_give_no_such_warning(make) -> None:
    for seed in (300, 301, 302, 303, 304):
        one = make(seed)
        assert len(one.data.contacts) < 6 or not beyond(one.data)
