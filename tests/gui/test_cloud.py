"""Clouds by level of detail: what is drawn keeps to its budget, what is picked is what a search of all points finds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from panel_samples import item_of
from vtkmodules.vtkRenderingCore import vtkCamera

from geofit import FitSettings, PointSet
from geofit.gui.view3d.camera import Viewpoint
from geofit.gui.view3d.cloud import BLOCK, PointCloud, shares
from geofit.gui.view3d.colouring import points_by
from geofit.gui.view3d.crowd import Crowd
from geofit.gui.view3d.horizon_items import points_item
from geofit.gui.view3d.item import Item, Look
from geofit.gui.view3d.layers import Layer
from geofit.gui.view3d.picking import nearest_target
from geofit.gui.view3d.projector import Projector

ORIGIN = np.array([501_000.0, 3_100_000.0, 1_500.0])
WIDTH, HEIGHT = 900.0, 600.0
LAYER = Layer("points:W", "points", "W", "#23506b", choices=("kind", "deviation", "elevation", "plain"))


def seen(viewpoint, stretch=1.0):
    camera = vtkCamera()
    viewpoint.put(camera)
    camera.SetClippingRange(0.01 * viewpoint.distance, 100 * viewpoint.distance)
    matrix = camera.GetCompositeProjectionTransformMatrix(WIDTH / HEIGHT, -1, 1)
    values = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    return Projector(values, WIDTH, HEIGHT, ORIGIN, stretch)


def surface(rng, n):
    xy = rng.uniform(-300, 300, (n, 2))
    return np.column_stack([xy, 20 * np.sin(xy[:, 0] / 40) + rng.normal(0, 0.3, n)])


def clusters(rng, n):
    """A scanner's density: most points near a few stations, some of them twice."""
    station = rng.uniform(-300, 300, (5, 3)) * (1, 1, 0.1)
    places = station[rng.integers(5, size=n)] + rng.standard_cauchy((n, 3)).clip(-200, 200)
    places[n // 2 : n // 2 + n // 10] = places[: n // 10]
    return places


def line(rng, n):
    return np.outer(np.linspace(-300, 300, n), [1.0, 0.3, 0.0])


def volume(rng, n):
    return rng.uniform(-300, 300, (n, 3))


MADE = {made.__name__: made for made in (surface, clusters, line, volume)}
VIEWS = {
    "all": Viewpoint(np.zeros(3), 212.0, 32.0, 1500.0),
    "flat": Viewpoint(np.zeros(3), 100.0, 2.0, 1500.0),
    "amid": Viewpoint(np.zeros(3), 30.0, 20.0, 60.0),
    "map": Viewpoint(np.zeros(3), 0.0, 90.0, 900.0, parallel=True),
    "far": Viewpoint(np.zeros(3), 212.0, 32.0, 60_000.0),
}


def cloud_of(name, n=30_000, seed=0):
    return PointCloud.of(MADE[name](np.random.default_rng(seed), n) + ORIGIN)


def in_sight(view, xyz):
    column, row, _ = view.screen(xyz).T
    return (column >= 0) & (column <= WIDTH) & (row >= 0) & (row <= HEIGHT)


@pytest.mark.parametrize("n", [1, 63, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 77])
@pytest.mark.parametrize("name", MADE)
def test_every_point_is_in_one_block_and_inside_its_boxes(name, n):
    cloud = cloud_of(name, n)
    assert np.array_equal(np.sort(cloud.order), np.arange(n))
    assert cloud.sizes.sum() == n
    for k, box in enumerate(cloud.boxes):
        block = cloud.xyz[cloud.order[k * BLOCK : (k + 1) * BLOCK]]
        np.testing.assert_array_equal(box, [block.min(axis=0), block.max(axis=0)])
        for part in range(min(len(block), len(cloud.parts[k]))):
            mine = block[part :: len(cloud.parts[k])]
            assert (mine >= cloud.parts[k, part, 0]).all()
            assert (mine <= cloud.parts[k, part, 1]).all()
    np.testing.assert_array_equal(cloud.box, [cloud.xyz.min(axis=0), cloud.xyz.max(axis=0)])


def test_a_beginning_of_a_block_is_spread_over_it():
    cloud = PointCloud.of(np.column_stack([np.linspace(0, 100, BLOCK), np.zeros(BLOCK), np.zeros(BLOCK)]))
    for count in (4, 16, 50, 500):
        x = np.sort(cloud.xyz[cloud.beginnings(np.array([count])), 0])
        assert np.diff(np.concatenate([[0], x, [100]])).max() < 2.1 * 100 / count


@pytest.mark.parametrize("seed", range(8))
def test_shares_keep_to_the_budget_and_to_the_weights(seed):
    rng = np.random.default_rng(seed)
    sizes, weights = rng.integers(1, 5000, 300), rng.exponential(1.0, 300) * rng.integers(0, 2, 300)
    for budget in (0, 7, 1000, 100_000, 10_000_000):
        taken = shares(sizes, weights, budget)
        assert (taken <= sizes).all()
        assert not taken[weights == 0].any()
        assert taken.sum() <= budget
        room = sizes[weights > 0].sum()
        assert taken.sum() >= min(budget, room) - 1
        # What is not whole has one and the same share of its weight, to a point; what is whole has no more than that.
        some = (taken < sizes) & (weights > 0)
        if some.any():
            least, most = ((taken[some] - 1) / weights[some]).max(), ((taken[some] + 1) / weights[some]).min()
            assert least <= most * (1 + 1e-9)
            whole = (taken == sizes) & (weights > 0)
            assert ((sizes[whole] - 1) / weights[whole]).max(initial=0) <= most * (1 + 1e-9)


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", MADE)
def test_what_is_drawn_keeps_to_the_budget_and_is_where_one_looks(name, view):
    cloud, view = cloud_of(name), seen(VIEWS[view])
    there = np.flatnonzero(in_sight(view, cloud.xyz))
    for budget in (500, 5_000):
        drawn = cloud.drawn(view, budget)
        assert len(drawn) <= budget
        assert len(np.unique(drawn)) == len(drawn)
        # Blocks in sight have some points out of it; the budget is not spent on blocks that are wholly out of sight.
        if len(there) >= budget:
            assert in_sight(view, cloud.xyz[drawn]).mean() > min(0.25, 3 * len(there) / len(cloud))
    assert np.isin(there, cloud.drawn(view, len(cloud))).all()


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize("stretch", [1.0, 5.0])
def test_the_point_that_is_picked_is_that_of_a_search_of_all(name, view, stretch):
    cloud, view = cloud_of(name, seed=3), seen(VIEWS[view], stretch)
    crowd = Crowd(
        cloud, points_by("plain", PointSet(cloud.xyz), "#23506b", None, FitSettings(), False), None, ORIGIN, "", 1.0
    )
    quick = Item([], cloud.box, targets=cloud.xyz, crowd=crowd)
    whole = Item([], cloud.box, targets=cloud.xyz)
    rng = np.random.default_rng(1)
    screen = view.screen(cloud.xyz[rng.integers(len(cloud), size=40)])[:, :2]
    places = np.concatenate([screen[np.isfinite(screen).all(axis=1)] + rng.normal(0, 4), rng.uniform(0, 600, (20, 2))])
    box = ORIGIN + np.array([[-100, -300, -300], [300, 50, 300]])
    found = 0
    for column, row in places:
        for clip in (None, box):
            one, other = (nearest_target([(LAYER, item)], view, column, row, clip) for item in (quick, whole))
            assert (one is None) == (other is None)
            if one is not None and other is not None:
                assert (one.which, one.depth, one.away) == (other.which, other.depth, other.away)
                assert np.array_equal(one.xyz, cloud.xyz[one.which])
                found += 1
    assert found >= 5


def test_ghosts_and_sizes_are_drawn_apart_and_together_are_the_budget():
    cloud = cloud_of("surface", 20_000)
    points = PointSet(cloud.xyz)
    excluded = np.arange(len(points)) % 4 == 0
    residuals = np.random.default_rng(2).normal(0, 0.5, len(points))
    item = points_item(
        points, residuals, FitSettings(), replace(LAYER, colour_by="deviation"), Look(ORIGIN, False), excluded, cloud
    )
    crowd = item.crowd
    assert crowd.count("full") == 0, "nothing is drawn before it is known how it is seen"
    crowd.renew(seen(VIEWS["all"]), "full", 30_000)
    parts = [part for part in item.parts if part.detail == "full"]
    assert crowd.count("full") == 20_000
    assert parts[-1].opacity < 1
    assert parts[-1].actor.GetMapper().GetInput().GetNumberOfPoints() == excluded.sum()
    assert len({part.size for part in parts[:-1]}) == len(parts) - 1 > 1
    crowd.renew(seen(VIEWS["map"]), "coarse", 3_000)
    assert 2_900 <= crowd.count("coarse") <= 3_000


def test_a_cloud_above_the_budget_is_renewed_with_the_view_and_stays_whole_for_the_pointer(qtbot):
    from geofit.data.site import Site
    from geofit.gui.view3d.view import SceneView

    points = PointSet(volume(np.random.default_rng(0), 60_000) + ORIGIN)
    view = SceneView()
    qtbot.addWidget(view)
    view.resize(160, 120)
    view.show()
    qtbot.waitExposed(view)
    view.show_site(Site("cloud", {"W": points}))
    view.canvas.land()
    qtbot.waitUntil(lambda: view.idle, timeout=5000)
    view.grab()
    item = item_of(view, "points:W")
    ratio = view.canvas.devicePixelRatioF()
    still = 1.5 * 160 * 120 * ratio**2
    assert 0 < item.crowd.count("full") <= still
    view.canvas.look(replace(view.canvas.viewpoint, distance=0.3 * view.canvas.viewpoint.distance), moving=True)
    before = view.canvas.frames
    qtbot.waitUntil(lambda: view.canvas.frames > before, timeout=5000)
    assert 0 < item.crowd.count("coarse") <= 0.25 * 160 * 120 * ratio**2
    assert len(item.targets) == 60_000
    projector = view.canvas.projector()
    screen = projector.screen(points.xyz)
    inside = np.flatnonzero((screen[:, :2] > 20).all(axis=1) & (screen[:, 0] < 140) & (screen[:, 1] < 100))
    plain = Item([], item.box, targets=item.targets)
    for k in inside[:: max(len(inside) // 20, 1)]:
        hit = view.pointer.pick(*screen[k, :2])
        assert hit.which == nearest_target([(LAYER, plain)], projector, *screen[k, :2]).which
    view.close()
