"""The list of layers, the colours, the viewpoint and the projector: plain data, no window."""

from dataclasses import replace

import numpy as np
import pytest

from geofit import FitSettings, PointSet
from geofit.data.accuracy import Seam
from geofit.gui.view3d.axes import grouped, marks, nice, ticks
from geofit.gui.view3d.camera import VIEWS, Viewpoint, framed, viewpoint_between
from geofit.gui.view3d.colouring import legible_on, points_by, ramp, seam_colours
from geofit.gui.view3d.layers import Layer, Layers
from geofit.gui.view3d.overlay import merged
from geofit.gui.view3d.projector import Projector
from geofit.gui.view3d.tools import ClipBox, Measure
from geofit.report.style import bands, rgb

ORIGIN = np.array([501_000.0, 3_100_000.0, 1_500.0])


def at(*local):
    """Return map coordinates of metres about the origin."""
    return ORIGIN + np.array(local, float)


def test_layers_tell_of_every_change_and_only_of_changes():
    layers, heard = Layers(), []
    end = layers.subscribe(lambda what, key: heard.append((what, key)))
    layers.add(Layer("ground", "ground"))
    layers.change("ground", opacity=0.5)
    layers.change("ground", opacity=0.5)
    layers.remove("ground")
    layers.remove("ground")
    end()
    layers.add(Layer("ground", "ground"))
    assert heard == [("added", "ground"), ("changed", "ground"), ("removed", "ground")]


def test_a_renewed_layer_keeps_what_was_chosen_unless_it_is_gone():
    layers = Layers()
    layers.add(Layer("surface:W", "surface", "W", choices=("plain", "dip", "standard deviation"), isolines=False))
    layers.change("surface:W", visible=False, opacity=0.4, colour_by="dip", isolines=True)
    kept = layers.add(Layer("surface:W", "surface", "W", choices=("plain", "dip"), isolines=False))
    assert (kept.visible, kept.opacity, kept.colour_by, kept.isolines) == (False, 0.4, "dip", True)
    assert layers.add(Layer("surface:W", "surface", "W", choices=("plain",))).colour_by == "plain"


def test_what_was_chosen_outlives_a_renewal_and_follows_a_name():
    layers, other = Layers(), Layers()
    for name in ("W", "F"):
        layers.add(Layer(f"surface:{name}", "surface", name))
        layers.change(f"surface:{name}", visible=False, opacity=0.4)
    layers.clear(keep=True)
    layers.rename({"W": "base of W"}.get)
    assert layers.add(Layer("surface:base of W", "surface", "base of W")).opacity == 0.4
    other.add(Layer("surface:base of W", "surface", "base of W"))
    other.take_over(layers)
    assert not other["surface:base of W"].visible
    # F was removed, and comes back.
    for one in (layers, other):
        assert not one.add(Layer("surface:F", "surface", "F")).visible
    layers.clear(keep=True)
    layers.clear()
    assert layers.add(Layer("surface:F", "surface", "F")).visible


def test_layers_refuse_what_cannot_be():
    layers = Layers()
    layers.add(Layer("ground", "ground"))
    with pytest.raises(ValueError, match="cannot be coloured by 'dip'; choose one of plain"):
        layers.change("ground", colour_by="dip")
    with pytest.raises(ValueError, match="0 to 1"):
        layers.change("ground", opacity=1.5)


def test_only_shows_one_layer():
    layers = Layers()
    for key in "abc":
        layers.add(Layer(key, "points"))
    layers.only("b")
    assert [layer.key for layer in layers if layer.visible] == ["b"]


def test_deviation_has_the_bands_of_the_report():
    settings = FitSettings()
    edges = [band.low for band in bands(settings)][1:]
    d = np.array([0.0, *edges, *(-np.array(edges))])
    points = PointSet(np.zeros((len(d), 3)))
    made = points_by("deviation", points, "#000000", d, settings, dark=False)
    shades = [(b.above, b.below) for b in bands(settings)]
    assert [tuple(c) for c in made.colour[1 : len(edges) + 1].tolist()] == [rgb(a) for a, _ in shades[1:]]
    assert [tuple(c) for c in made.colour[len(edges) + 1 :].tolist()] == [rgb(b) for _, b in shades[1:]]
    assert made.legend is not None
    assert len(made.legend.swatches) == 2 * len(edges) + 1
    assert all(np.diff(made.size[: len(edges) + 1]) > 0)


@pytest.mark.parametrize("dark", [False, True])
def test_the_legend_of_deviations_has_the_colours_of_the_points(dark):
    settings = FitSettings()
    edges = [band.low for band in bands(settings)]
    d = np.array([*reversed(edges[1:]), 0.0, *(-low for low in edges[1:])])
    made = points_by("deviation", PointSet(np.zeros((len(d), 3))), "#000000", d, settings, dark=dark)
    assert [rgb(swatch.colour) for swatch in made.legend.swatches] == [tuple(c) for c in made.colour.tolist()]
    shades = bands(settings, dark=dark)
    assert made.legend.swatches[0].colour == shades[-1].above
    assert made.legend.swatches[-1].colour == shades[-1].below


def test_without_residuals_deviation_is_plain():
    made = points_by("deviation", PointSet(np.zeros((2, 3))), "#102030", None, FitSettings(), dark=False)
    assert made.colour.tolist() == [[16, 32, 48]] * 2
    assert made.legend is None


def test_colours_stand_out_from_a_dark_ground():
    assert legible_on("#0b2f4a", dark=False) == "#0b2f4a"
    assert sum(rgb(legible_on("#0b2f4a", dark=True))) > 2 * sum(rgb("#0b2f4a"))


def test_ramp_has_its_ends_at_the_values_and_grey_for_nothing():
    values = np.array([2.0, np.nan, 12.0])
    made = ramp("elevation", values)
    assert (made.low, made.high) == (2.0, 12.0)
    colours = made.of(values)
    assert tuple(colours[0]) == rgb("#23506b")
    assert tuple(colours[2]) == rgb("#f3e6c8")
    assert colours[1].tolist() == [160] * 3


@pytest.mark.parametrize(("angle", "shade"), [(0.005, 0), (0.05, 1), (0.5, 2)])
def test_seams_are_coloured_by_the_limits_of_the_check(angle, shade):
    colours, legend = seam_colours([Seam("a", "b", 0.0, angle)], "angle", dark=False)
    assert colours[0] == legend.swatches[shade].colour


def test_kinds_of_all_horizons_stand_in_one_legend():
    points = PointSet(np.zeros((2, 3)), kind=["borehole", "adit"])
    legends = [
        (name, points_by("kind", one, "#000000", None, FitSettings(), dark=False).legend)
        for name, one in (("A", points), ("B", points[:1]))
    ]
    made = merged(legends)
    assert [[swatch.text for swatch in legend.swatches] for _, legend in made] == [["adit", "borehole"]]


@pytest.mark.parametrize("view", VIEWS)
def test_every_view_has_right_handed_axes(view):
    axes = Viewpoint(np.zeros(3), 0.0, 0.0, 10.0).seen_from(view).axes
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.cross(axes[0], axes[1]), axes[2], atol=1e-12)


def test_from_above_north_is_up_and_east_to_the_right():
    axes = Viewpoint(np.zeros(3), 0.0, 0.0, 10.0).seen_from("top").axes
    np.testing.assert_allclose(axes, np.eye(3), atol=1e-12)


def test_north_looks_from_the_north():
    axes = Viewpoint(np.zeros(3), 0.0, 0.0, 10.0).seen_from("north").axes
    np.testing.assert_allclose(axes, [[-1, 0, 0], [0, 0, 1], [0, 1, 0]], atol=1e-12)


def test_coming_nearer_keeps_the_place_under_the_pointer():
    viewpoint = Viewpoint(np.array([1.0, 2.0, 3.0]), 200.0, 90.0, 100.0)
    place = viewpoint.shifted(10.0, -4.0).centre
    near = viewpoint.nearer(2.0, 10.0, -4.0)
    seen = (place - near.centre) @ near.axes.T / near.half
    np.testing.assert_allclose(seen[:2], [10 / viewpoint.half, -4 / viewpoint.half], atol=1e-12)


def test_a_flight_turns_the_shorter_way_and_arrives():
    start, end = Viewpoint(np.zeros(3), 350.0, 10.0, 100.0), Viewpoint(np.ones(3), 20.0, 40.0, 25.0)
    assert viewpoint_between(start, end, 0.5).azimuth == pytest.approx(5.0)
    there = viewpoint_between(start, end, 1.0)
    assert (there.azimuth, there.height, there.distance) == pytest.approx((20.0, 40.0, 25.0))


def _projector(viewpoint: Viewpoint, stretch: float = 1.0, width: float = 800, height: float = 600) -> Projector:
    from vtkmodules.vtkRenderingCore import vtkCamera

    camera = vtkCamera()
    viewpoint.put(camera)
    camera.SetClippingRange(0.1 * viewpoint.distance, 10 * viewpoint.distance)
    matrix = camera.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
    values = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    return Projector(values, width, height, ORIGIN, stretch)


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("stretch", [1.0, 3.0])
def test_a_ray_passes_through_what_is_drawn_there(parallel, stretch):
    view = _projector(Viewpoint(np.array([5.0, -3.0, 10.0]), 212.0, 32.0, 900.0, parallel), stretch)
    rng = np.random.default_rng(2)
    for place in ORIGIN + rng.uniform(-100, 100, (20, 3)):
        column, row, depth = view.screen(place)[0]
        near, far = view.ray(column, row)
        way = (far - near) / np.linalg.norm(far - near)
        assert np.linalg.norm(np.cross(place - near, way)) < 1e-6
        assert 0 < depth < 1
        np.testing.assert_allclose(view.on_level(column, row, place[2]), place, atol=1e-5)


def test_what_is_framed_is_in_the_picture():
    box = np.array([[-400.0, -200.0, -30.0], [300.0, 500.0, 90.0]])
    for name in VIEWS:
        for parallel in (False, True):
            viewpoint = framed(
                replace(Viewpoint(np.zeros(3), 0.0, 0.0, 1.0), parallel=parallel).seen_from(name), box, 800 / 600
            )
            corners = np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]]) + ORIGIN
            seen = _projector(viewpoint).screen(corners)
            assert seen[:, 0].min() > 0
            assert seen[:, 0].max() < 800
            assert seen[:, 1].min() > 0
            assert seen[:, 1].max() < 600


def test_axes_tell_true_coordinates_at_their_places():
    box = np.array([ORIGIN - (500, 400, 100), at(500, 400, 100)])
    view = _projector(framed(Viewpoint(np.zeros(3), 212.0, 32.0, 1.0), (box - ORIGIN) * (1, 1, 3), 4 / 3), stretch=3.0)
    found = marks(box, 200.0, view)
    assert {mark.text[0] for mark in found} >= {"E", "N"}
    heights = [mark for mark in found if str(mark.text).endswith(" m")]
    assert len(heights) >= 3
    corners = [(x, y) for x in box[:, 0] for y in box[:, 1]]
    for mark in heights:
        z = float(mark.text[:-2].replace("\u2009", ""))
        drawn = [view.screen(np.array([x, y, z]))[0, :2] for x, y in corners]
        assert min(np.hypot(*(place - (mark.x, mark.y))) for place in drawn) < 1e-6


@pytest.mark.parametrize("distance", [800.0, 1400.0, 2000.0, 2600.0, 3200.0, 4000.0])
def test_heights_beside_an_axis_stand_at_even_steps(distance):
    box = np.array([ORIGIN - (500, 400, 300), at(500, 400, 300)])
    view = _projector(Viewpoint(np.zeros(3), 212.0, 32.0, distance))
    heights = [mark.text[:-2] for mark in marks(box, 200.0, view) if mark.text.endswith(" m")]
    steps = np.diff([float(text.replace("\u2009", "").replace("−", "-")) for text in heights])
    assert len(set(np.round(steps, 6).tolist())) <= 1, heights


def test_numbers_are_grouped_and_ticks_few():
    assert grouped(3_100_500) == "3\u2009100\u2009500"
    assert grouped(-0.25) == "−0.25"
    assert (nice(7.0), nice(0.03), nice(1.0)) == (5.0, 0.02, 1.0)
    assert len(ticks(0.0, 1e6, 1.0)) <= 42
    np.testing.assert_array_equal(ticks(499_950, 500_250, 100.0), [500_000, 500_100, 500_200])


def test_a_measure_gives_true_figures():
    measure = Measure()
    measure.add(ORIGIN)
    assert measure.figures() is None
    measure.add(at(30.0, 40.0, -50.0))
    distance, flat, rise, azimuth, dip = measure.figures()
    assert (flat, rise, dip) == pytest.approx((50.0, -50.0, 45.0))
    assert distance == pytest.approx(50 * np.sqrt(2))
    assert azimuth == pytest.approx(np.degrees(np.arctan2(30, 40)))
    measure.add(ORIGIN)
    assert len(measure.places) == 1


def test_the_clip_box_cannot_be_turned_inside_out():
    clip = ClipBox(lambda: None)
    clip.open(np.array([[0.0, 0.0, 0.0], [100.0, 100.0, 10.0]]))
    west = next(handle for handle in clip.handles() if handle.xyz[0] < 0)
    west.moved(np.array([500.0, 0.0, 0.0]))
    assert clip.box[0, 0] < clip.box[1, 0]
    clip.handles()[0].moved(np.array([-500.0, 0.0, 0.0]))
    assert clip.box[0, 0] == pytest.approx(-1.0)


def test_the_disc_of_a_dip_lies_as_it_was_measured():
    from vtkmodules.util.numpy_support import vtk_to_numpy

    from geofit.data.site import Orientations
    from geofit.gui.view3d.item import Look
    from geofit.gui.view3d.site_items import dips_item

    one = Orientations(ORIGIN[None], *map(np.array, ([60.0], [25.0], ["W"], ["a.csv"], [2])))
    item = dips_item(one, 1000.0, Layer("dips", "dips", labels=True), Look(ORIGIN, False))
    data = item.parts[0].actor.GetMapper().GetInput()
    places = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    normal = np.array([np.sin(np.radians(60)), np.cos(np.radians(60)), 1 / np.tan(np.radians(25))])
    normal /= np.linalg.norm(normal)
    np.testing.assert_allclose(places @ normal, 0.0, atol=1e-4)
    np.testing.assert_allclose(vtk_to_numpy(data.GetPointData().GetNormals())[0], normal, atol=1e-6)
    assert item.names == ("060/25",)


@pytest.mark.parametrize("seed", range(3))
def test_triangles_are_split_where_a_value_changes_its_sign(seed):
    from geofit.gui.view3d.shape import Shape, split

    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(9.0), np.arange(7.0))
    xyz = np.column_stack([x.ravel(), y.ravel(), rng.normal(0, 0.3, x.size)])
    n = np.arange(x.size).reshape(x.shape)
    a, b, c, d = n[:-1, :-1].ravel(), n[:-1, 1:].ravel(), n[1:, 1:].ravel(), n[1:, :-1].ravel()
    whole = Shape(
        xyz, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]), np.tile([0.0, 0.0, 1.0], (63, 1))
    )

    def value(places):
        return 3.3 - np.hypot(places[:, 0] - 4.1, places[:, 1] - 3.2)

    parted = split(whole, value(xyz))

    def areas(shape):
        p, q, r = (shape.xyz[shape.triangles[:, k], :2] for k in range(3))
        return 0.5 * ((q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0])

    assert areas(parted).sum() == pytest.approx(48.0)
    assert areas(parted).min() > -1e-12, "no triangle is turned round"
    inner = areas(parted)[value(parted.xyz[parted.triangles].mean(axis=1)) >= 0].sum()
    assert inner == pytest.approx(np.pi * 3.3**2 - 1.0, abs=1.5)
    assert len(parted.xyz) > len(xyz)
