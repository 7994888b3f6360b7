"""The area of a layer that is absent in places, by surfaces that do not know it and holes that do."""

from __future__ import annotations

import numpy as np
import pytest
from surfaces import ORIGIN, height_field, horizon

from geofit import fit_horizon
from geofit.data.points import PointSet
from geofit.data.site import Ground
from geofit.site.order import compare_horizons
from geofit.site.presence import presence_of

WALL = 1000.0 * 700.0


def contacts(plan, z, hole=None):
    names = [f"Z{k}" for k in range(len(plan))] if hole is None else hole
    return PointSet(np.column_stack([plan, z]), kind="borehole", hole=names)


@pytest.fixture(scope="module")
def half():
    """Two planes a metre apart, and 80 holes of which those in the eastern half met both at one contact."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(50.0, 1000.0, 100.0), np.arange(0.0, 701.0, 100.0)))
    plan = ORIGIN[:2] + np.column_stack([x, y])
    low = contacts(plan, np.full(len(plan), ORIGIN[2]))
    top = contacts(plan, ORIGIN[2] + np.where(x < 500, 1.0, 0.0))
    return [
        horizon([height_field(12, 12, z=lambda x, y, z=z: 0.0 * x + z)], name=name).with_(points=points)
        for z, points, name in ((1.0, top, "top"), (0.0, low, "base"))
    ]


def test_the_layer_is_where_the_nearest_hole_has_it(half):
    order = compare_horizons(*half)
    assert order.without == 40
    assert order.volume == pytest.approx(WALL, rel=1e-6)
    assert order.present == pytest.approx(WALL / 2, rel=1e-2)
    # Between the last hole with the layer and the first without it the edge may be anywhere.
    assert order.at_least == pytest.approx(400 * 700, rel=1e-2)
    assert order.at_most == pytest.approx(WALL - 400 * 700, rel=1e-2)
    assert order.doubtful == pytest.approx(400 * 700, rel=1e-2)
    seen = order.check().text.params["layer"].params["seen"]
    assert seen.code == "site.layer-area-by-holes"
    assert (seen.params["low"], seen.params["high"], seen.params["count"]) == (order.at_least, order.at_most, 40)


def test_above_the_ground_there_is_no_layer_at_most(half):
    x, y = ORIGIN[0] + np.linspace(0, 1000, 101), ORIGIN[1] + np.linspace(0, 700, 8)
    # The ground falls below the base at 300 m.
    ground = Ground(x, y, np.tile(ORIGIN[2] + (300.0 - (x - x[0])) / 10, (8, 1)))
    order = compare_horizons(*half, ground)
    assert order.at_most == pytest.approx(300 * 700, rel=1e-2)
    # It is thicker than the control error of 0.5 m up to 5 m before.
    assert order.present == pytest.approx(295 * 700, rel=1e-2)
    assert order.at_least == pytest.approx((295 - 50) * 700, rel=1e-2)


def test_without_such_holes_the_surfaces_alone_count(half):
    upper, lower = half
    every = upper.with_(points=contacts(upper.points.xyz[:, :2], np.full(len(upper.points), ORIGIN[2] + 1.0)))
    order = compare_horizons(every, lower)
    assert (order.without, order.present) == (0, pytest.approx(WALL, rel=1e-6))
    assert order.at_least == order.at_most == order.present
    assert not order.check().text.params["layer"].params["seen"]


def test_contacts_belong_together_by_hole_or_place():
    plan = np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0], [20.0, 20.0]])
    low = contacts(plan, np.zeros(5), ["A", "B", "C", "", "E"])
    # Hole A is inclined; B and the place without a hole lack the layer; C contradicts itself; D is of one horizon.
    shift = np.array([[1.0, 0.0], [0, 0], [0, 0], [0, 0], [5, 5]])
    top = contacts(plan + shift, [5.0, 0.0, -3.0, 0.0, 4.0], ["A", "B", "C", "", "D"])
    seen = presence_of(top, low)
    assert {(x, y): bool(has) for (x, y), has in zip(seen.plan.tolist(), seen.layer.tolist(), strict=True)} == {
        (1.0, 0.0): True, (10.0, 0.0): False, (10.0, 10.0): False,
    }  # fmt: skip
    assert presence_of(top[np.array([0])], low) is None
    assert [part.tolist() for part in seen.around(np.array([[5.0, 1.0]]))] == [[False], [False]]


def test_the_area_of_a_lens_is_right_where_its_holes_are_many():
    """Top and base are fitted each by itself: outside the lens they differ by more than the control error."""
    rng = np.random.default_rng(0)
    plan = np.column_stack([rng.uniform(0, 2000, 104), rng.uniform(0, 1500, 104)])
    plan[:4] = [(0, 0), (2000, 0), (2000, 1500), (0, 1500)]
    x, y = plan.T
    thick = np.maximum(18 * (1 - ((x - 900) / 700) ** 2 - ((y - 800) / 450) ** 2), 0)
    base = 100 + 0.02 * x - 0.01 * y + 8 * np.sin(x / 310) * np.cos(y / 270) + 3 * np.sin(x / 140 + y / 190)
    upper, lower = (fit_horizon(contacts(plan, z), name=name) for z, name in ((base + thick, "top"), (base, "base")))
    order = compare_horizons(upper, lower)
    truth = np.pi * 700 * 450 * (1 - 0.5 / 18)
    assert order.present == pytest.approx(truth, rel=0.08)
    assert order.at_least < truth < order.at_most
    bare = PointSet(np.empty((0, 3)))
    assert compare_horizons(upper.with_(points=bare), lower.with_(points=bare)).present > 1.15 * truth
