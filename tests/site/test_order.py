from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused
from surfaces import ORIGIN, fold, height_field, horizon

import geofit.io
from geofit import fit_horizon
from geofit.data.errors import InputError, SettingsError
from geofit.data.messages import Message
from geofit.data.site import Ground
from geofit.sample import write_site
from geofit.site.height_field import HeightField
from geofit.site.order import compare_horizons, compare_pairs, orders, thickness
from geofit.site.overlap import TOUCH
from geofit.site.zero_contours import zero_contours
from geofit.splines import bspline


def through(function, *, nu=24, nv=18, size=(1000.0, 700.0), turn=0.0, shift=(0.0, 0.0)):
    """A bicubic height field that interpolates z(x, y), local map axes, at its Greville abscissae."""
    patch = height_field(nu, nv, size=size, turn=turn)
    ku, kv = patch.knots_u, patch.knots_v
    u, v = bspline.greville(ku, 3), bspline.greville(kv, 3)
    control = patch.control.copy()
    control[..., :2] += shift
    z = np.linalg.solve(bspline.collocation(ku, 3, u), function(control[..., 0], control[..., 1]))
    control[..., 2] = np.linalg.solve(bspline.collocation(kv, 3, v), z.T).T
    return replace(patch, control=control)


def surface(function, name="T1", outline=None, **net):
    return horizon([through(function, **net)], name=name, outline=outline)


def flat(z=0.0, name="T1", **net):
    return surface(lambda x, y: np.full_like(x, z), name, **net)


def bowl(x0, y0, radius=60.0, steepness=1e-3):
    """A paraboloid below zero within a circle: bicubic nets hold it exactly."""
    return lambda x, y: steepness * ((x - x0) ** 2 + (y - y0) ** 2 - radius**2)


def local(x, y):
    return np.array([x, y]) - ORIGIN[:2]


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_a_bowl_through_a_plane_is_found_with_place_area_and_volume(turn):
    # Whatever the lower net's axes and knots are.
    lower = flat(nu=13, nv=31, turn=turn, size=(1100.0, 900.0), shift=(60.0, -150.0))
    order = compare_horizons(surface(bowl(500.0, 350.0), "T3-T2"), lower)
    (crossing,) = order.crossings
    assert crossing.area == pytest.approx(np.pi * 60**2, rel=2e-3)
    assert crossing.volume == pytest.approx(np.pi * 1e-3 * 60**4 / 2, rel=5e-3)
    assert crossing.depth == pytest.approx(3.6, abs=1e-6)
    np.testing.assert_allclose(local(crossing.x, crossing.y), (500.0, 350.0), atol=1e-2)
    assert order.min == pytest.approx(-3.6, abs=1e-6)
    np.testing.assert_allclose(local(*order.thinnest), (500.0, 350.0), atol=1e-2)


def test_the_line_of_crossing_is_exact_and_closed():
    upper, lower = surface(bowl(500.0, 350.0)), flat(nu=13)
    (line,) = compare_horizons(upper, lower).crossings[0].lines
    assert np.array_equal(line[0], line[-1])
    np.testing.assert_allclose(thickness(upper, lower, line[:, 0], line[:, 1]), -TOUCH, atol=1e-8)
    np.testing.assert_allclose(line[:, 2], ORIGIN[2], atol=2e-6)
    np.testing.assert_allclose(np.linalg.norm(line[:, :2] - ORIGIN[:2] - (500.0, 350.0), axis=1), 60.0, atol=1e-4)
    assert np.linalg.norm(np.diff(line[:, :2], axis=0), axis=1).sum() == pytest.approx(2 * np.pi * 60, rel=1e-2)


def test_two_dips_are_two_crossings_the_larger_first():
    width, high = 60.0, 10.0

    def dips(x, y):
        one = 12 * np.exp(-((x - 250) ** 2 + (y - 350) ** 2) / (2 * width**2))
        return high - one - 15 * np.exp(-((x - 750) ** 2 + (y - 350) ** 2) / (2 * width**2))

    order = compare_horizons(surface(dips, nu=80, nv=60), flat())
    assert len(order.crossings) == 2
    for crossing, (x, depth) in zip(order.crossings, ((750.0, 15.0), (250.0, 12.0)), strict=True):
        # The overlap of a Gaussian dip, by hand.
        edge = 2 * width**2 * np.log(depth / high)
        assert crossing.area == pytest.approx(np.pi * edge, rel=1e-2)
        assert crossing.volume == pytest.approx(2 * np.pi * width**2 * (depth - high) - high * np.pi * edge, rel=1e-2)
        assert local(crossing.x, crossing.y)[0] == pytest.approx(x, abs=0.5)
    assert order.crossed_volume == pytest.approx(sum(crossing.volume for crossing in order.crossings))


def test_planes_that_cross_share_a_wedge():
    order = compare_horizons(surface(lambda x, y: 0.1 * (x - 400.0)), flat(nu=11, nv=9))
    (crossing,) = order.crossings
    assert crossing.area == pytest.approx(400 * 700, rel=1e-5)
    assert crossing.volume == pytest.approx(700 * 0.1 * 400**2 / 2, rel=1e-5)
    assert crossing.depth == pytest.approx(40.0, rel=1e-5)
    (line,) = crossing.lines
    np.testing.assert_allclose(line[:, 0] - ORIGIN[0], 400.0, atol=1e-4)
    assert abs(line[0, 1] - line[-1, 1]) == pytest.approx(700.0, abs=1e-3)
    assert (order.min, order.mean, order.max) == pytest.approx((-40.0, 10.0, 60.0), rel=1e-5)


def test_a_crossing_that_spreads_over_many_cells_is_measured_once(monkeypatch):
    measured = []

    def contours(*args):
        measured.append(args)
        return zero_contours(*args)

    monkeypatch.setattr("geofit.site.overlap.zero_contours", contours)
    # A trough 2 m wide between the nodes, straight across the area: its cells are gathered in several rounds.
    order = compare_horizons(surface(lambda x, y: 0.01 * (0.6 * x + 0.8 * y - 501.0) ** 2 - 0.01), flat(nu=11, nv=9))
    assert order.crossed_area == pytest.approx(2.0 * np.hypot(501 / 0.6, 501 / 0.8), rel=0.1)
    assert len(measured) == len(order.crossings)


def test_a_crossing_within_one_cell_of_the_lattice_is_found():
    spans = 50.0
    patch = height_field(23, 17, size=(20 * spans, 14 * spans), z=lambda x, y: np.zeros_like(x))
    control = patch.control.copy()
    control[10, 8, 2], control[11, 8, 2], control[10, 9, 2] = 5.0, 3.0, 1.2
    lower = horizon([replace(patch, control=control)], name="T2-T1")
    x = ORIGIN[0] + np.linspace(350, 550, 801)
    y = ORIGIN[1] + np.linspace(250, 450, 801)
    top = lower.elevation(x, y[:, None]) - ORIGIN[2]
    upper = flat(top.max() - 0.01, "T3-T2")
    for one in (upper, lower):
        plan = HeightField(one).lattice(2)
        assert thickness(upper, lower, plan[..., 0], plan[..., 1]).min() > 0
    (crossing,) = compare_horizons(upper, lower).crossings
    assert crossing.depth == pytest.approx(0.01, abs=1e-4)
    overlap = top - (top.max() - 0.01)
    cell = (x[1] - x[0]) * (y[1] - y[0])
    assert crossing.area == pytest.approx((overlap > 0).sum() * cell, rel=0.05)
    assert crossing.area < (spans / 2) ** 2
    assert crossing.volume == pytest.approx(overlap[overlap > 0].sum() * cell, rel=0.05)


def test_an_outline_cuts_area_and_crossing():
    outline = [(500, 100), (900, 100), (900, 600), (500, 600)]
    order = compare_horizons(surface(bowl(500.0, 350.0), outline=outline), flat(nu=13))
    assert order.area == pytest.approx(400 * 500, rel=1e-6)
    (crossing,) = order.crossings
    assert crossing.area == pytest.approx(np.pi * 60**2 / 2, rel=3e-3)
    assert crossing.volume == pytest.approx(np.pi * 1e-3 * 60**4 / 4, rel=6e-3)
    (line,) = crossing.lines
    assert not np.array_equal(line[0], line[-1])
    np.testing.assert_allclose(line[[0, -1], 0] - ORIGIN[0], 500.0, atol=0.1)


def test_the_mean_thickness_is_that_of_the_common_area():
    outline = np.array([(100.0, 100.0), (700.0, 150.0), (300.0, 600.0)])
    order = compare_horizons(surface(lambda x, y: 30 + 0.02 * x, outline=outline), flat(nu=15))
    assert order.mean == pytest.approx(30 + 0.02 * outline[:, 0].mean(), rel=1e-3)
    assert (order.min, order.max) == pytest.approx((32.0, 44.0), abs=1e-4)
    np.testing.assert_allclose(local(*order.thinnest), outline[0], atol=1e-3)
    assert order.check().passed


ELL = np.array([(100.0, 100.0), (900.0, 100.0), (900.0, 250.0), (350.0, 250.0), (350.0, 600.0), (100.0, 600.0)])
BAY = np.array([(100, 100), (900, 100), (900, 600), (650, 600), (650, 250), (300, 250), (300, 600), (100, 600.0)])
TRIANGLE = np.array([(120.0, 60.0), (880.0, 180.0), (260.0, 580.0)])


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize(
    ("above", "below"),
    [(ELL, ELL), (None, ELL), (BAY, None), (TRIANGLE, ELL), (ELL, BAY)],
    ids=["LL", "L", "U", "TL", "LU"],
)
def test_a_concave_area_is_measured_as_a_raster_measures_it(above, below, turn):
    upper = surface(lambda x, y: 8 * np.sin(x / 130) + 0.01 * y, "up", outline=above, nu=14, nv=11)
    net = {"nu": 19, "nv": 13, "turn": turn, "size": (1100.0, 900.0), "shift": (60.0, -150.0)}
    lower = surface(lambda x, y: 5 * np.cos(y / 90) + 4, "low", outline=below, **net)
    order = compare_horizons(upper, lower)
    x, y = ORIGIN[0] + np.arange(0.5, 1000), ORIGIN[1] + np.arange(0.5, 700)
    between = thickness(upper, lower, x, y[:, None])
    between = between[np.isfinite(between)]
    crossed = between < 0
    assert 0.3 < crossed.mean() < 0.9
    assert order.area == pytest.approx(between.size, rel=2e-3)
    assert order.mean == pytest.approx(between.mean(), rel=2e-3)
    assert order.crossed_area == pytest.approx(crossed.sum(), rel=2e-3)
    assert order.crossed_volume == pytest.approx(-between[crossed].sum(), rel=2e-3)


def test_an_area_between_the_nodes_of_both_lattices_is_measured():
    outline = np.array([(503.0, 352.0), (513.0, 352.0), (505.0, 362.0)])
    order = compare_horizons(surface(lambda x, y: 30 + 0.02 * x, outline=outline, nu=9, nv=9), flat(nu=9, nv=9))
    assert (order.min, order.mean, order.max) == pytest.approx((40.06, 30 + 0.02 * 507, 40.26), abs=1e-4)
    (crossing,) = compare_horizons(flat(nu=9, nv=9), surface(lambda x, y: 1 + 0 * x, outline=outline)).crossings
    assert (crossing.area, crossing.volume) == pytest.approx((50.0, 50.0), rel=1e-3)


def test_horizons_that_touch_do_not_cross():
    order = compare_horizons(surface(bowl(500.0, 350.0, radius=0.0)), flat())
    assert order.crossings == ()
    assert order.min == pytest.approx(0.0, abs=1e-9)
    same = flat(3.0)
    assert compare_horizons(same, flat(3.0, nu=12)).check().passed


def test_a_crossing_above_the_ground_is_told_from_one_in_the_rock():
    upper, lower = surface(bowl(500.0, 350.0)), flat()
    x, y = ORIGIN[0] + np.linspace(0, 1000, 11), ORIGIN[1] + np.linspace(0, 700, 8)
    for z, share, passed in ((-50.0, 1.0, True), (50.0, 0.0, False)):
        order = compare_horizons(upper, lower, Ground(x, y, np.full((8, 11), ORIGIN[2] + z)))
        assert order.crossings[0].in_air == share
        assert order.check().passed is passed
    check = compare_horizons(upper, lower, Ground(x, y, np.zeros((8, 11)))).check()
    assert check.text.code == "site.horizons-cross-above-ground"
    assert compare_horizons(upper, lower).check().passed is False


def test_the_check_says_where_how_deep_and_how_much():
    check = compare_horizons(surface(bowl(500.0, 350.0), "T3-T2"), flat(name="T2-T1")).check()
    assert (check.name, check.passed, check.unit) == ("order", False, "m")
    assert check.value == pytest.approx(3.6, abs=1e-6)
    assert isinstance(check.text, Message)
    assert check.text.code == "site.horizons-cross"
    figures = check.text.params
    assert (figures["upper"], figures["lower"], figures["count"]) == ("T3-T2", "T2-T1", 1)
    assert figures["depth"] == pytest.approx(3.6, abs=1e-6)
    assert (figures["x"], figures["y"]) == pytest.approx((500_500.0, 3_100_350.0), abs=0.05)


def test_horizons_apart_in_plan_have_no_order():
    order = compare_horizons(flat(), flat(shift=(5000.0, 0.0)))
    assert order.area == 0
    assert order.check().passed is None


def test_every_pair_of_a_sequence_is_compared():
    surfaces = {"A": flat(20.0, "A"), "B": flat(10.0, "B"), "C": surface(bowl(500, 350, 200.0), "C")}
    found = orders(surfaces, ["A", "B", "C"])
    assert [(order.upper, order.lower) for order in found] == [("A", "B"), ("A", "C"), ("B", "C")]
    assert [order.min for order in orders(surfaces, ["A", "B"])] == pytest.approx([10.0])


@pytest.mark.parametrize(
    ("sequence", "code", "params"),
    [
        (["A", "X"], "site.order-without-surface", {"name": "X"}),
        (["A", "A"], "site.order-repeats-horizon", {}),
        (["A", "M"], "site.not-a-height-field", {"name": "M"}),
    ],
)
def test_a_sequence_that_cannot_be_is_refused(sequence, code, params):
    surfaces = {"A": flat(name="A"), "M": horizon([fold()], name="M")}
    with refused(SettingsError, code, **params):
        orders(surfaces, sequence)


@pytest.fixture(scope="module")
def sample(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    write_site(folder)
    site = geofit.io.read_site(folder / "site.toml")
    fitted = {
        name: fit_horizon(site.horizons[name], site.settings[name], site.boundary, name=name) for name in site.order
    }
    return site, fitted


def test_the_clean_sample_site_is_silent_and_a_planted_crossing_is_found(sample):
    site, fitted = sample
    assert site.order == ("T3-T2", "T2-T1")
    (order,) = orders(fitted, site.order, site.ground)
    assert order.crossings == ()
    assert order.check().passed
    # The truth's thickness, on an even sample of the area.
    assert 55 < order.min < 70
    assert 75 < order.mean < 85
    low = fitted["T3-T2"].with_(origin=fitted["T3-T2"].origin - np.array([0, 0, order.min + 2.0]))
    (planted,) = orders({**fitted, "T3-T2": low}, site.order, site.ground)
    assert planted.check().passed is False
    deepest = max(planted.crossings, key=lambda crossing: crossing.depth)
    assert deepest.depth == pytest.approx(2.0, abs=1e-6)
    assert (deepest.x, deepest.y) == pytest.approx(order.thinnest, abs=0.1)


def read_small(folder, order, faults=""):
    (folder / "picks.csv").write_text("horizon,x,y,z\n" + "".join(f"{n},1,2,3\n" for n in ("A", "B", "F1")), "utf-8")
    text = f'[site]\norder = {order}\n[picks]\nfile = "picks.csv"\n[faults]\n{faults}\n'
    (folder / "site.toml").write_text(text, "utf-8")
    return geofit.io.read_site(folder / "site.toml")


def test_the_site_file_states_order_and_faults(tmp_path):
    site = read_small(tmp_path, '["B", "A"]', 'F1 = ["A"]')
    assert site.order == ("B", "A")
    assert site.faults == {"F1": ("A",)}


@pytest.mark.parametrize(
    ("order", "faults", "code", "params"),
    [
        ('["A", "b"]', "", "io.key-names-unknown-horizon", {"key": "order", "where": "[site]", "name": "b"}),
        ('["A", "A"]', "", "io.key-names-horizon-twice", {"name": "A"}),
        ('"A"', "", "io.mapping-value-wrong-kind", {"key": "order", "where": "[site]"}),
        ('["A", "F1"]', 'F1 = ["B"]', "io.fault-in-order", {"fault": "F1"}),
        ('["A"]', 'F1 = ["F1"]', "io.fault-cuts-itself", {"fault": "F1"}),
        ('["A"]', 'F2 = ["A"]', "io.key-names-unknown-horizon", {"key": "faults", "name": "F2"}),
        ('["A"]', 'F1 = ["C"]', "io.key-names-unknown-horizon", {"key": "F1", "name": "C"}),
    ],
)
def test_an_order_or_fault_that_cannot_be_is_refused_by_name(tmp_path, order, faults, code, params):
    with refused(InputError, code, **params):
        read_small(tmp_path, order, faults)


def wedge(name="base"):
    """A plane that rises through zero at the middle of the area: below a flat top it pinches out there."""
    return surface(lambda x, y: (x - 500.0) / 50.0, name)


def test_what_lies_between_horizons_ends_where_they_cross():
    order = compare_horizons(flat(0.0, "top"), wedge())
    # Ten metres thick in the west, zero in the middle; 0.5 m, the control error, 25 m before it.
    assert order.volume == pytest.approx(0.5 * 500 * 10 * 700, rel=2e-3)
    assert order.present == pytest.approx(475 * 700, rel=2e-3)
    assert order.mean == pytest.approx(0.0, abs=1e-6)
    layer = order.check().text.params["layer"]
    assert layer.code == "site.layer-between"
    assert (layer.params["volume"], layer.params["present"]) == (order.volume, order.present)


@pytest.mark.parametrize(
    ("height", "volume", "present"),
    [
        (20.0, 10.0 * 700_000, 700_000),  # above both
        (4.0, 4.0 * 700_000, 700_000),  # between them
        (-5.0, 0.0, 0.0),  # below both
    ],
)
def test_above_the_ground_nothing_lies_between_horizons(height, volume, present):
    x, y = ORIGIN[0] + np.linspace(0, 1000, 11), ORIGIN[1] + np.linspace(0, 700, 8)
    ground = Ground(x, y, np.full((8, 11), ORIGIN[2] + height))
    order = compare_horizons(flat(10.0, "top"), flat(0.0, "base"), ground)
    assert (order.volume, order.present) == pytest.approx((volume, present), rel=1e-6, abs=1e-6)
    assert (order.area, order.mean) == pytest.approx((700_000, 10.0), rel=1e-6)
    assert order.check().passed
    assert order.check().text.params["layer"].code == "site.layer-below-ground"


def test_a_valley_cuts_what_lies_between_horizons():
    """A ground that falls through both horizons along the easting: the rock between them is a trapezium."""
    x, y = ORIGIN[0] + np.linspace(0, 1000, 201), ORIGIN[1] + np.linspace(0, 700, 8)
    ground = Ground(x, y, np.tile(ORIGIN[2] + 20.0 - 0.04 * (x - x[0]), (8, 1)))
    order = compare_horizons(flat(10.0, "top"), flat(0.0, "base"), ground)
    # Whole for 250 m, then thinner over the next 250 m, gone beyond.
    assert order.volume == pytest.approx((10 * 250 + 0.5 * 10 * 250) * 700, rel=2e-3)
    assert order.present == pytest.approx((500 - 12.5) * 700, rel=2e-3)


def test_horizons_that_were_separated_by_centimetres_are_no_layer():
    order = compare_horizons(flat(0.04, "top"), flat(0.0, "base"))
    assert order.check().passed
    assert order.present == 0.0


def test_what_another_horizon_of_the_order_claims_of_a_layer_is_stated():
    """A flat unconformity cuts a tilted layer of 20 m, whose upper horizon rises above it in the east."""
    surfaces = {
        "U": flat(0.0, "U"),
        "A": wedge("A"),
        "B": surface(lambda x, y: (x - 500.0) / 50.0 - 20.0, "B"),
    }
    over, whole, layer = orders(surfaces, ["U", "A", "B"])
    assert layer.check().passed
    assert layer.volume == pytest.approx(20 * 700_000, rel=1e-6)
    assert layer.disputed == pytest.approx(0.5 * 500 * 10 * 700, rel=5e-3)
    disputed = layer.layer.params["disputed"]
    assert disputed.code == "site.layer-disputed"
    assert disputed.params["volume"] == layer.disputed
    assert (over.disputed, whole.disputed) == pytest.approx((0.0, 0.0), abs=1.0)
    assert not over.layer.params["disputed"]
    assert compare_horizons(surfaces["A"], surfaces["B"]).disputed == 0.0
    pairs = compare_pairs(surfaces, [("U", "A"), ("U", "B"), ("A", "B")], None)
    assert [one.disputed for one in pairs] == [over.disputed, whole.disputed, layer.disputed]


def test_a_horizon_that_rises_into_a_layer_from_below_claims_what_is_under_it():
    surfaces = {"U": flat(20.0, "U"), "A": flat(0.0, "A"), "B": wedge("B")}
    (layer, *_) = orders(surfaces, ["U", "A", "B"])
    assert layer.volume == pytest.approx(20 * 700_000, rel=1e-6)
    assert layer.disputed == pytest.approx(0.5 * 500 * 10 * 700, rel=5e-3)
