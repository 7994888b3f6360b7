"""The 3D view in a real window: what is drawn is looked at by pixel, what is picked is compared with what is known."""

import gc
import math
import os
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

# PySide6 is asked for in conftest.
from panel_samples import item_of
from PySide6.QtCore import QPoint, QPointF, Qt, QTimer
from PySide6.QtGui import QImage, QSurface
from PySide6.QtTest import QTest
from shiboken6.Shiboken import getAllValidWrappers

from geofit import HorizonFit, PointSet
from geofit.checks.check import check
from geofit.data.accuracy import Seam
from geofit.data.errors import SettingsError
from geofit.data.prediction import Suggestion, Uncertainty
from geofit.data.site import Ground, Hole, Orientations, Section, Site
from geofit.project.provenance import Row
from geofit.report.style import HORIZONS, rgb
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

ORIGIN = np.array([501_000.0, 3_100_000.0, 1_500.0])
SLOPE = 0.2
HALF = 200.0


def at(*local):
    """Return map coordinates of metres about the origin."""
    return ORIGIN + np.array(local, float)


def plane(name="W", fall=0.0, split=True):
    """A plane dipping east at a slope of 0.2 through ``fall`` metres below the origin, in one or two patches."""
    edges = [-HALF, 0.0, HALF] if split else [-HALF, HALF]
    knots = np.array([0.0, 0.0, 1.0, 1.0])
    patches = []
    for k, (west, east) in enumerate(pairwise(edges)):
        x, y = np.meshgrid([west, east], [-HALF, HALF], indexing="ij")
        control = np.stack([x, y, -SLOPE * x - fall], axis=-1)
        patches.append(Patch(("core", "east")[k], (1, 1), knots, knots, control))
    local = np.array([[-100.0, -50.0, 20.0], [0.0, 0.0, 0.05], [120.0, 90.0, -24.0], [60.0, -120.0, -11.0]])
    local[:, 2] -= fall
    points = PointSet(local + ORIGIN, kind=["borehole", "borehole", "outcrop", "section"], hole=["ZK1", "ZK2", "", ""])
    surface = HorizonFit(PatchSurface(tuple(patches), ORIGIN, name), points, name=name, core=np.zeros(4, bool))
    return surface.with_(accuracy=check(surface))


def site(surface):
    xs = np.linspace(-250, 250, 11)
    ground = Ground(xs + ORIGIN[0], xs + ORIGIN[1], np.full((11, 11), ORIGIN[2] + 80.0))
    hole = Hole("钻孔1", "borehole", np.array([0.0, 120.0]), ORIGIN + np.array([[-150, 150, 80], [-150, 150, -40]]))
    adit = Hole("PD1", "adit", np.array([0.0, 100.0]), ORIGIN + np.array([[150, -150, 20], [50, -150, 20]]))
    dips = Orientations(ORIGIN + np.array([[0.0, 50.0, 0.0]]), *map(np.array, ([90.0], [11.3], ["W"], ["a.csv"], [2])))
    return Site(
        "test",
        {surface.name: surface.points},
        boundary=ORIGIN[:2] + np.array([[-200, -200], [200, -200], [200, 200], [-200, 200]]),
        ground=ground,
        holes=(hole, adit),
        sections=(Section("C1", ORIGIN[:2] + np.array([[-200.0, 0.0], [200.0, 0.0]])),),
        orientations=dips,
    )


@pytest.fixture
def view(qtbot):
    from geofit.gui.view3d.view import SceneView

    made = SceneView()
    qtbot.addWidget(made)
    made.resize(640, 480)
    made.show()
    qtbot.waitExposed(made)
    yield made
    made.close()


@pytest.fixture
def shown(view, qtbot):
    surface = plane()
    view.show_site(site(surface))
    view.show_surface(surface)
    settle(view, qtbot)
    return view


def settle(view, qtbot):
    """Let flights and refreshes end."""
    view.canvas.land()
    qtbot.wait(30)
    qtbot.waitUntil(lambda: view.idle, timeout=5000)


def picture(view):
    image = view.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    return np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)[:, :, 2::-1].astype(int)


def drawn_at(view, xyz):
    """Return the pixel of a place."""
    return view.canvas.projector().screen(np.asarray(xyz, float))[0, :2]


def click(view, column, row):
    QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(column), round(row)))


def only(view, *keys):
    for layer in view.layers:
        view.layers.change(layer.key, visible=layer.key in keys)


def test_a_site_and_its_surface_become_layers(shown):
    assert [layer.key for layer in shown.layers] == [
        *("ground", "boundary", "holes", "adits", "sections", "dips"),
        *("points:W", "surface:W"),
    ]


def test_the_surface_is_where_it_should_be(shown, qtbot):
    only(shown, "surface:W")
    shown.view("top")
    settle(shown, qtbot)
    pixels = picture(shown)
    for x, y, there in ((-180, -180, True), (180, 180, True), (-225, 0, False), (0, 225, False)):
        column, row = drawn_at(shown, at(x, y, -SLOPE * x)).round().astype(int)
        red, _, blue = pixels[row, column]
        assert (blue - red > 30) == there, (x, y)


def test_the_place_under_the_pointer_is_true_at_every_exaggeration(shown, qtbot):
    for factor in (1.0, 4.0):
        shown.set_exaggeration(factor)
        only(shown, "surface:W")
        shown.view("iso")
        settle(shown, qtbot)
        for x, y in ((-150.0, 30.0), (0.0, 0.0), (90.0, -170.0)):
            place = at(x, y, -SLOPE * x)
            np.testing.assert_allclose(shown.pointer.place_at(*drawn_at(shown, place)), place, atol=1e-3)
    assert shown.pointer.place_at(2, 240) is None


def test_moving_the_pointer_tells_the_place_and_leaving_tells_none(shown, qtbot):
    only(shown, "surface:W")
    settle(shown, qtbot)
    place = at(40.0, -60.0, -8.0)
    with qtbot.waitSignal(shown.pointer_moved, timeout=2000) as told:
        shown.canvas.hovered.emit(QPointF(*drawn_at(shown, place)))
    np.testing.assert_allclose(told.args, place, atol=1e-3)
    with qtbot.waitSignal(shown.pointer_moved, timeout=2000) as told:
        shown.canvas.left.emit()
    assert all(math.isnan(value) for value in told.args)


@pytest.mark.parametrize("index", range(4))
def test_clicking_a_point_picks_it_and_rings_it(shown, qtbot, index):
    only(shown, "surface:W", "points:W")
    settle(shown, qtbot)
    point = shown.contents.points["W"].xyz[index]
    with qtbot.waitSignal(shown.point_picked, timeout=2000) as told:
        click(shown, *drawn_at(shown, point))
    assert told.args == ["W", Row.of(shown.contents.points["W"], index)]
    assert f"{point[2]:.2f} m" in str(shown.pointer.ring.text)
    assert f"d {shown.contents.surfaces['W'].accuracy.residuals[index]:+.3f} m".replace("-", "−") in str(
        shown.pointer.ring.text
    )
    shown.highlight_point("W", None)
    assert shown.pointer.ring is None


def test_of_two_points_in_line_the_one_in_front_is_picked(view, qtbot):
    points = PointSet(ORIGIN + np.array([[0.0, 0.0, -50.0], [0.0, 0.0, 50.0], [100.0, 100.0, 0.0]]))
    view.show_site(Site("two", {"W": points}))
    view.view("top")
    settle(view, qtbot)
    view.set_orthographic(True)
    settle(view, qtbot)
    with qtbot.waitSignal(view.point_picked, timeout=2000) as told:
        click(view, *drawn_at(view, points.xyz[0]))
    assert told.args == ["W", Row.of(points, 1)]


def test_clicking_a_hole_picks_it(shown, qtbot):
    only(shown, "holes", "adits")
    settle(shown, qtbot)
    with qtbot.waitSignal(shown.hole_picked, timeout=2000) as told:
        click(shown, *drawn_at(shown, at(-150.0, 150.0, 20.0)))
    assert told.args == ["钻孔1"]


def test_clicking_a_control_point_picks_it(shown, qtbot):
    shown.set_control_points("W")
    only(shown, "control:W")
    settle(shown, qtbot)
    with qtbot.waitSignal(shown.control_picked, timeout=2000) as told:
        click(shown, *drawn_at(shown, at(HALF, HALF, -SLOPE * HALF)))
    assert told.args == ["W", "east", 1, 1]
    assert shown.pointer.ring.solid
    shown.set_control_points(None)
    assert shown.pointer.ring is None
    assert "control:W" not in shown.layers


def test_the_mark_of_a_control_point_follows_the_surface(shown):
    shown.highlight_control("W", "east", 1, 0)
    np.testing.assert_allclose(shown.pointer.ring.xyz, at(HALF, -HALF, -SLOPE * HALF))
    shown.show_surface(plane(fall=7.0))
    np.testing.assert_allclose(shown.pointer.ring.xyz, at(HALF, -HALF, -SLOPE * HALF - 7.0))
    assert "1453.00 m" in str(shown.pointer.ring.text)
    shown.show_surface(plane(split=False))
    assert shown.pointer.ring is None


def test_letting_go_of_a_control_point_leaves_other_rings(shown):
    shown.highlight_point("W", Row.of(shown.contents.points["W"], 1))
    shown.set_control_points("W")
    shown.set_control_points(None)
    assert shown.pointer.ring is not None


def test_a_net_is_fainter_from_afar(shown, qtbot):
    shown.set_control_points("W")
    settle(shown, qtbot)
    dots = item_of(shown, "control:W").parts[1].actor.GetProperty()
    near = dots.GetOpacity()
    shown.canvas.look(replace(shown.canvas.viewpoint, distance=60 * shown.canvas.viewpoint.distance))
    assert 0 < dots.GetOpacity() < 0.5 * near


def test_the_net_leaves_its_surface_to_be_seen(view, qtbot):
    fine = np.linspace(-HALF, HALF, 80)
    x, y = np.meshgrid(fine, fine, indexing="ij")
    knots = np.concatenate([[0.0], np.linspace(0, 1, 80), [1.0]])
    patch = Patch("core", (1, 1), knots, knots, np.stack([x, y, 0 * x], axis=-1))
    view.show_surface(HorizonFit(PatchSurface((patch,), ORIGIN), name="W"))
    view.view("top")
    settle(view, qtbot)
    low, high = (drawn_at(view, at(s * 150.0, -s * 150.0, 0.0)).round().astype(int) for s in (-1, 1))
    inside = np.s_[low[1] : high[1], low[0] : high[0]]
    bare = picture(view)[inside]
    view.set_control_points("W")
    settle(view, qtbot)
    netted = picture(view)[inside]
    assert 3 < np.abs(netted - bare).mean() < 45


def test_clicking_beside_everything_picks_nothing(shown, qtbot):
    with qtbot.assertNotEmitted(shown.point_picked, wait=50), qtbot.assertNotEmitted(shown.hole_picked):
        click(shown, 3, 200)


def test_dragging_turns_and_does_not_pick(shown, qtbot):
    before = shown.canvas.viewpoint
    with qtbot.assertNotEmitted(shown.point_picked, wait=50):
        start = QPoint(*drawn_at(shown, shown.contents.points["W"].xyz[1]).round().astype(int).tolist())
        QTest.mousePress(shown.canvas, Qt.MouseButton.LeftButton, pos=start)
        QTest.mouseMove(shown.canvas, start + QPoint(60, 20))
        assert not shown.canvas.full
        QTest.mouseRelease(shown.canvas, Qt.MouseButton.LeftButton, pos=start + QPoint(60, 20))
    assert shown.canvas.viewpoint.azimuth != before.azimuth
    qtbot.waitUntil(lambda: shown.canvas.full, timeout=3000)


def test_measuring_gives_true_metres_under_exaggeration(shown, qtbot):
    shown.set_exaggeration(3.0)
    only(shown, "points:W", "surface:W")
    shown.set_measuring(True)
    settle(shown, qtbot)
    xyz = shown.contents.points["W"].xyz
    click(shown, *drawn_at(shown, xyz[0]))
    with qtbot.waitSignal(shown.measured, timeout=2000) as told:
        click(shown, *drawn_at(shown, xyz[2]))
    assert told.args[0].startswith(f"{np.linalg.norm(xyz[2] - xyz[0]):.2f} m")
    assert "Δz −44.00 m" in told.args[0]
    shown.set_measuring(False)
    assert shown.pointer.measure.figures() is None


def test_a_chosen_point_comes_to_the_middle_seen_from_the_same_side(shown, qtbot):
    before = shown.canvas.viewpoint
    shown.focus_point("W", Row.of(shown.contents.points["W"], 2))
    settle(shown, qtbot)
    np.testing.assert_allclose(drawn_at(shown, shown.contents.points["W"].xyz[2]), (320, 240), atol=0.5)
    assert (shown.canvas.viewpoint.azimuth, shown.canvas.viewpoint.height) == (before.azimuth, before.height)
    shown.focus_hole("PD1")
    settle(shown, qtbot)
    np.testing.assert_allclose(drawn_at(shown, at(100.0, -150.0, 20.0)), (320, 240), atol=0.5)


def test_the_section_plane_is_moved_by_its_handles(shown, qtbot):
    shown.view("top")
    settle(shown, qtbot)
    line = ORIGIN[:2] + np.array([[-100.0, -80.0], [120.0, 60.0]])
    shown.set_section(line, 20.0)
    settle(shown, qtbot)
    handle = shown.handles()[0]
    start = QPoint(*drawn_at(shown, handle.xyz).round().astype(int).tolist())
    QTest.mousePress(shown.canvas, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(shown.canvas, start + QPoint(40, 0))
    with qtbot.waitSignal(shown.section_changed, timeout=2000) as told:
        QTest.mouseRelease(shown.canvas, Qt.MouseButton.LeftButton, pos=start + QPoint(40, 0))
    moved = told.args[0]
    np.testing.assert_allclose(moved[1], line[1])
    assert moved[0, 0] > line[0, 0] + 10
    assert moved[0, 1] == pytest.approx(line[0, 1], abs=2.0)
    shown.set_section(None)
    assert not shown.handles()


def test_the_clip_box_hides_what_lies_outside_from_eye_and_pointer(shown, qtbot):
    only(shown, "surface:W")
    shown.view("top")
    shown.set_clip(True)
    settle(shown, qtbot)
    place = at(-100.0, 30.0, 20.0)
    column, row = drawn_at(shown, place)
    assert picture(shown)[round(row), round(column)].min() < 235
    shown.handles()[0].moved(ORIGIN - (20.0, 0.0, 0.0))
    settle(shown, qtbot)
    assert shown.pointer.place_at(column, row) is None
    assert picture(shown)[round(row), round(column)].min() > 235
    shown.set_clip(False)
    settle(shown, qtbot)
    assert shown.pointer.place_at(column, row) is not None


def test_colours_follow_the_data(shown, qtbot):
    below = plane("T", fall=60.0)
    grid = np.linspace(-HALF, HALF, 5)
    sd = np.tile(np.linspace(0.1, 0.5, 5), (5, 1))
    uncertainty = Uncertainty(grid + ORIGIN[0], grid + ORIGIN[1], sd, 1.0, 0.3, 0.5, np.ones((5, 5)))
    shown.show_surface(shown.contents.surfaces["W"], uncertainty)
    shown.show_surface(below)
    expected = {
        "dip": (np.degrees(np.arctan(SLOPE)),) * 2,
        "thickness": (60.0, 60.0),
        "standard deviation": (0.0, 0.5),
        "elevation": (1460.0, 1540.0),
    }
    for by, (low, high) in expected.items():
        shown.layers.change("surface:W", colour_by=by)
        legend = shown.layers["surface:W"].legend
        assert (legend.title, legend.low) == (by, pytest.approx(low, abs=1e-6))
        assert legend.high == pytest.approx(high, abs=2e-3)
    shown.layers.change("surface:W", isolines=True)
    assert len(item_of(shown, "surface:W").parts) > 2
    assert {"upper:W", "lower:W"} <= {layer.key for layer in shown.layers}
    shown.layers.change("upper:W", visible=True)
    upper = item_of(shown, "upper:W").box[1, 2]
    assert upper == pytest.approx(1540.0 + 1.6449 * 0.1, abs=1e-3)


def test_the_legend_of_the_standard_deviation_ends_at_the_figure_of_the_panel(shown, qtbot):
    """Vertices on the border of the study area lie beyond the grid, and have more there than anywhere in it."""
    surface = shown.contents.surfaces["W"]
    grid = np.linspace(-HALF, HALF, 5)
    sd = np.tile(np.linspace(0.1, 0.5, 5), (5, 1))
    for most in (0.4, 0.7):
        shown.show_surface(
            surface, Uncertainty(grid + ORIGIN[0], grid + ORIGIN[1], sd, 1.0, 0.3, most, np.ones((5, 5)))
        )
        shown.layers.change("surface:W", colour_by="standard deviation")
        legend = shown.layers["surface:W"].legend
        assert (legend.low, legend.high, legend.beyond) == (0.0, most, most == 0.4)
        settle(shown, qtbot)
    # The largest of what is drawn ends other colours, as those of the elevation.
    shown.layers.change("surface:W", colour_by="elevation")
    assert shown.layers["surface:W"].legend.high == pytest.approx(1540.0, abs=2e-3)


def test_seams_have_their_places_and_colours(shown):
    surface = shown.contents.surfaces["W"]
    steep = replace(surface.accuracy, seams=(Seam("core", "east", 0.0, 5.0),))
    shown.show_surface(surface.with_(accuracy=steep))
    shown.set_seams("W")
    item = item_of(shown, "seams:W")
    np.testing.assert_allclose(item.box, ORIGIN + np.array([[0, -HALF, 0], [0, HALF, 0]]), atol=1e-9)
    shown.layers.change("seams:W", colour_by="gap")
    assert shown.layers["seams:W"].legend.title == "gap"
    shown.set_seams(None)
    assert "seams:W" not in shown.layers


def test_next_holes_and_a_dark_background_are_drawn(shown, qtbot):
    shown.show_suggestions("W", (Suggestion(*at(50.0, 50.0, -10.0), 0.4, 0.2, 0.3),))
    assert "suggestions:W" in shown.layers
    light = picture(shown)[5, 320]
    shown.set_dark(True)
    settle(shown, qtbot)
    assert picture(shown)[5, 320].max() < 60 < light.min()
    shown.show_suggestions("W", ())
    assert "suggestions:W" not in shown.layers


def test_the_exaggeration_stands_in_the_corner_and_a_bad_one_is_refused(shown, qtbot):
    note = shown.content(shown.canvas.projector()).note
    assert str(note) == "Vertical 1×"
    shown.set_exaggeration(2.5)
    assert shown.content(shown.canvas.projector()).note == "Vertical 2.5×"
    settle(shown, qtbot)
    corner = picture(shown)[-45:-8, 10:110]
    assert (corner.max(axis=(0, 1)) - corner.min(axis=(0, 1))).min() > 100
    with pytest.raises(ValueError, match="give a number above 0"):
        shown.set_exaggeration(0.0)


def test_the_screenshot_has_the_pixels_asked_for_and_the_same_picture(shown, qtbot, tmp_path):
    settle(shown, qtbot)
    path = tmp_path / "剖面.png"
    shown.screenshot(path, 2.0)
    large = QImage(str(path))
    assert (large.width(), large.height()) == (1280, 960)
    assert large.dotsPerMeterX() == round(2 * 96 / 0.0254)
    small = large.scaled(640, 480, Qt.AspectRatioMode.IgnoreAspectRatio, Qt.TransformationMode.SmoothTransformation)
    small = small.convertToFormat(QImage.Format.Format_RGB32)
    pixels = np.frombuffer(small.constBits(), np.uint8).reshape(480, 640, 4)[:, :, 2::-1].astype(int)
    assert np.abs(pixels - picture(shown)).mean() < 6
    assert list(tmp_path.glob("*.part*")) == []
    with pytest.raises(SettingsError, match="below 25"):
        shown.screenshot(path, 100.0)


def test_while_moving_a_large_cloud_is_thinned_and_comes_back(view, qtbot):
    rng = np.random.default_rng(0)
    points = PointSet(ORIGIN + rng.uniform(-100, 100, (60_000, 3)))
    view.show_site(Site("cloud", {"W": points}))
    settle(view, qtbot)
    item = item_of(view, "points:W")
    counts = {p.detail: p.actor.GetMapper().GetInput().GetNumberOfPoints() for p in item.parts}
    assert counts["full"] == 60_000
    assert counts["coarse"] <= 10_001
    view.canvas.look(view.canvas.viewpoint.turned(5, 0), moving=True)
    assert {p.detail for p in item.parts if p.actor.GetVisibility()} == {"coarse"}
    qtbot.waitUntil(lambda: view.canvas.full, timeout=3000)
    assert {p.detail for p in item.parts if p.actor.GetVisibility()} == {"full"}


def test_many_changes_are_one_render(shown, qtbot):
    settle(shown, qtbot)
    before = shown.canvas.frames
    for k in range(20):
        shown.layers.change("surface:W", opacity=0.3 + 0.02 * k)
    settle(shown, qtbot)
    assert 1 <= shown.canvas.frames - before <= 3
    still = shown.canvas.frames
    qtbot.wait(300)
    assert shown.canvas.frames == still


def test_a_horizon_keeps_the_colour_of_its_place_in_the_site(shown):
    surface = shown.contents.surfaces["W"]
    shown.show_site(Site("more", {"T": surface.points, "W": surface.points}))
    assert {(layer.horizon, layer.colour) for layer in shown.layers if layer.colour} == {
        ("T", HORIZONS[0]),
        ("W", HORIZONS[1]),
    }
    assert item_of(shown, "surface:W").parts[0].actor.GetProperty().GetColor() == pytest.approx(
        [byte / 255 for byte in rgb(HORIZONS[1])]
    )


def test_what_is_gone_from_the_site_is_gone_from_the_scene(shown):
    surface = shown.contents.surfaces["W"]
    shown.show_site(Site("other", {"T": surface.points}))
    assert [layer.key for layer in shown.layers] == ["points:T"]
    shown.clear()
    assert len(shown.layers) == 0
    assert shown.canvas.renderer.GetActors().GetNumberOfItems() <= 1


def test_showing_a_surface_again_and_again_keeps_memory(shown, qtbot):
    surface = plane("again", split=False)

    def rounds(count):
        for _ in range(count):
            shown.show_surface(surface)
            shown.canvas.repaint()
            shown.remove_surface("again")
        qtbot.wait(10)
        gc.collect()
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    if not os.path.exists("/proc/self/statm"):
        pytest.skip("the memory of a process is read from /proc, which this system does not have")
    shown.resize(160, 120)
    before = rounds(40)
    assert rounds(200) - before < 8.0


def test_a_view_can_be_closed_twice_and_leaves_no_timer(shown, qtbot):
    shown.reset_camera()
    shown.close()
    shown.close()
    timers = shown.findChildren(QTimer)
    assert len(timers) >= 5
    assert not any(timer.isActive() for timer in timers)


def test_a_closed_view_holds_no_surface_of_opengl(shown):
    def surfaces():
        return sum(type(wrapper) is QSurface for wrapper in getAllValidWrappers())

    before = surfaces()
    shown.close()
    assert surfaces() == before - 1


def test_without_opengl_the_view_says_what_is_missing():
    code = (
        "from PySide6.QtWidgets import QApplication\n"
        "app = QApplication([])\n"
        "from geofit.gui.view3d.opengl import NoOpenGLError\n"
        "from geofit.gui.view3d.view import SceneView\n"
        "try:\n    SceneView()\n"
        "except NoOpenGLError as error:\n    print(error)\n"
    )
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=120, check=True
    )
    assert "needs a display" in done.stdout
    assert "offscreen" in done.stdout


def test_nothing_is_said_on_the_console(tmp_path):
    """VTK writes its warnings past Python."""
    code = (
        "import sys; sys.path[:0] = sys.argv[1:3]\n"
        "from PySide6.QtWidgets import QApplication\n"
        "app = QApplication([])\n"
        "from test_view3d import plane, site\n"
        "from geofit.gui.view3d.view import SceneView\n"
        "view = SceneView(); view.resize(400, 300); view.show()\n"
        "surface = plane(); view.show_site(site(surface)); view.show_surface(surface); view.set_seams('W')\n"
        "view.layers.change('surface:W', opacity=0.5, isolines=True)\n"
        "app.processEvents(); view.screenshot(sys.argv[3], 1.5); view.clear(); app.processEvents(); view.close()\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code, *map(str, Path(__file__).parents[:2]), str(tmp_path / "a.png")],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    assert done.stderr == ""
    assert done.stdout == ""
