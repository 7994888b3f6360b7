"""A control point dragged in the scene: the surface, its figures and what it moves follow; one command, or none."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import SITE, fitted, item_of, sample_site
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

import geofit
from geofit.data.errors import GeofitError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.fitting.edit import acted_on, adjust, movable
from geofit.gui.view3d.drawn import drawn_of
from geofit.gui.view3d.sight import Sight
from geofit.project.commands import SetSurface

FAR = np.array([512_000.0, 3_455_000.0, 1_400.0])


def far_site(n=600, seed=4):
    """Hills at map coordinates of seven digits, which single precision would round to a quarter of a metre."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 1500, (2, n))
    z = 35 * np.sin(x / 330) + 25 * np.cos(y / 270) + rng.normal(0, 0.1, n)
    points = PointSet(np.column_stack([x, y, z]) + FAR, kind="borehole", file="far.csv", row=np.arange(n) + 2)
    return Site("far", {"H": points})


def begin(app, site, path, surface):
    name = surface.name
    app.desktop.session.begin(site, path)
    app.document.select(name)
    if surface.settings != app.document.settings(name):
        app.window.fitting.set_settings(name, surface.settings)
    provenance = app.document.provenance(name)
    app.document.put(provenance, surface)
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.trigger("control_points")
    app.idle()
    return app


@pytest.fixture
def far(app, tmp_path):
    site = far_site()
    surface = geofit.fit_horizon(site.horizons["H"], FitSettings(core="none"), name="H")
    return begin(app, site, tmp_path / "site.toml", surface)


@pytest.fixture
def cored(app):
    return begin(app, sample_site(), SITE, fitted())


def movable_near_a_point(surface):
    """A control point in the middle of the surface that acts on points and may move."""
    middle = surface.points.xyz[:, :2].mean(axis=0)
    for k in np.argsort(np.linalg.norm(surface.points.xyz[:, :2] - middle, axis=1)):
        for patch in surface.patches:
            away = np.linalg.norm(patch.control + surface.origin - surface.points.xyz[k], axis=2)
            i, j = (int(one) for one in np.unravel_index(int(away.argmin()), away.shape))
            try:
                movable(surface, patch.name, i, j)
            except GeofitError:
                continue
            if acted_on(surface, patch.name, i, j)[0].any():
                return patch.name, i, j
    raise AssertionError("no control point can move")


def place_of(surface, name, i, j):
    return next(patch.control[i, j] for patch in surface.patches if patch.name == name) + surface.origin


def pixel(view, xyz):
    return QPoint(*view.canvas.projector().screen(xyz)[0, :2].round().astype(int).tolist())


def choose(app, control):
    """Look closely at a control point, and click it."""
    view, surface = app.window.panels.view, app.document.surface(app.document.selection.horizon)
    for layer in view.layers:
        view.layers.change(layer.key, visible=layer.kind in ("surface", "control") and layer.horizon == surface.name)
    view.focus_place(*place_of(surface, *control))
    view.canvas.land()
    for _ in range(12):
        view.canvas.look(view.canvas.viewpoint.nearer(1.3))
    app.qtbot.wait(50)
    with app.qtbot.waitSignal(view.control_picked, timeout=3000) as told:
        QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=pixel(view, place_of(surface, *control)))
    assert tuple(told.args[1:]) == control
    return view


SHIFT, PLAIN = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.NoModifier


def move(view, at, keys=PLAIN):
    """Move the pointer with the left button down; QTest's own moves forget the keys that are held."""
    place = QPointF(at)
    event = QMouseEvent(
        QEvent.Type.MouseMove, place, view.canvas.mapToGlobal(place), Qt.MouseButton.NoButton,
        Qt.MouseButton.LeftButton, keys,
    )  # fmt: skip
    QApplication.sendEvent(view.canvas, event)


def press_and_pull(view, by, aside=0, keys=SHIFT):
    """Press on the handle and pull it, along the normal; return where the pointer is."""
    start = pixel(view, view.handles()[0].xyz)
    QTest.mousePress(view.canvas, Qt.MouseButton.LeftButton, pos=start)
    for share in (0.25, 0.5, 1.0):
        move(view, start + QPoint(round(share * aside), round(share * by)), keys)
    return start + QPoint(aside, by)


def drop(app, at):
    QTest.mouseRelease(app.window.panels.view.canvas, Qt.MouseButton.LeftButton, pos=at)
    app.idle()


def effect_of(app):
    return [[cell.text() for cell in row] for row in app.window.panels.adjust.effect.cells]


def test_a_drag_shows_what_it_does_and_is_one_step(far):
    before, control = far.document.surface("H"), movable_near_a_point(far.document.surface("H"))
    view, steps = choose(far, control), far.desktop.session.stack.count()
    net = item_of(view, "control:H").targets.copy()
    at = press_and_pull(view, -60)
    dz = far.window.panels.adjust.control.dz.value()
    assert dz > 0.1
    # The control point is where the pointer is, and its neighbours are where they were.
    assert (pixel(view, view.handles()[0].xyz) - at).manhattanLength() <= 4
    moved = item_of(view, "control:H").targets - net
    np.testing.assert_allclose(moved[np.abs(moved).max(axis=1) > 0], [[0, 0, dz]], atol=1e-9)
    after = adjust(before, *control, dz)
    ring = view.content(view.canvas.projector()).rings[0]
    assert f"{after.accuracy.sigma:.3g}"[:4] in ring.text
    assert effect_of(far)[1][2] in ring.text
    assert effect_of(far)[4][1:] == [str(a.over["epsilon"].count) for a in (before.accuracy, after.accuracy)]
    assert far.desktop.session.stack.count() == steps
    drop(far, at)
    edit = far.document.state.provenances["H"].edits[-1]
    assert (edit.patch, edit.i, edit.j, edit.dz) == (*control, dz)
    assert far.desktop.session.stack.count() == steps + 1
    assert far.document.surface("H").accuracy.sigma == pytest.approx(after.accuracy.sigma, abs=1e-12)
    far.desktop.session.stack.undo()
    far.idle()
    assert not far.document.state.provenances["H"].edits
    assert view.handles()[0].xyz == pytest.approx(place_of(before, *control), abs=1e-9)


def test_the_region_that_moves_is_drawn_where_the_edited_surface_is(far):
    before, control = far.document.surface("H"), movable_near_a_point(far.document.surface("H"))
    view = choose(far, control)
    at = press_and_pull(view, -50)
    dz = far.window.panels.adjust.control.dz.value()
    after = adjust(before, *control, dz)
    shape = view.control_move.drawn
    off = after.elevation(*shape.xyz[:, :2].T) - shape.xyz[:, 2]
    # The triangles of the still surface lie within centimetres of it; the bend is followed to a small share.
    assert len(shape.xyz) > 200
    assert np.nanmax(np.abs(off)) < 0.2 + 0.02 * dz
    assert np.nanmax(shape.xyz[:, 2] - before.elevation(*shape.xyz[:, :2].T)) > 0.2 * dz
    drop(far, at)


def test_escape_gives_up_the_drag(far):
    before, control = far.document.surface("H"), movable_near_a_point(far.document.surface("H"))
    view, steps = choose(far, control), far.desktop.session.stack.count()
    at = press_and_pull(view, 40)
    assert far.window.panels.adjust.control.dz.value() < -0.1
    QTest.keyClick(view.canvas, Qt.Key.Key_Escape)
    assert far.window.panels.adjust.control.dz.value() == 0
    QTest.mouseMove(view.canvas, at + QPoint(0, 30))
    drop(far, at + QPoint(0, 30))
    assert far.desktop.session.stack.count() == steps
    assert far.document.surface("H") is before
    assert view.handles()[0].xyz == pytest.approx(place_of(before, *control), abs=1e-9)


def test_a_click_on_the_handle_moves_nothing(far):
    view, steps = choose(far, movable_near_a_point(far.document.surface("H"))), far.desktop.session.stack.count()
    at = pixel(view, view.handles()[0].xyz)
    QTest.mousePress(view.canvas, Qt.MouseButton.LeftButton, pos=at)
    QTest.mouseMove(view.canvas, at + QPoint(2, 1))
    drop(far, at)
    assert far.window.panels.adjust.control.dz.value() == 0
    assert far.desktop.session.stack.count() == steps


def test_a_move_that_is_stopped_puts_the_control_point_back(far):
    control = movable_near_a_point(far.document.surface("H"))
    view = choose(far, control)
    at = press_and_pull(view, -40)
    QTest.mouseRelease(view.canvas, Qt.MouseButton.LeftButton, pos=at)
    assert not view.handles()
    far.window.activity.cancel()
    far.idle()
    assert far.window.panels.adjust.control.dz.value() == 0
    assert view.handles()[0].xyz == pytest.approx(place_of(far.document.surface("H"), *control), abs=1e-9)


def test_a_typed_move_is_shown_in_the_scene(far):
    control = movable_near_a_point(far.document.surface("H"))
    view = choose(far, control)
    far.window.panels.adjust.control.dz.setValue(1.5)
    assert view.handles()[0].xyz[2] == pytest.approx(place_of(far.document.surface("H"), *control)[2] + 1.5)
    assert "+1.50" in view.content(view.canvas.projector()).rings[0].text


def test_seen_from_above_up_in_the_picture_lifts(far):
    view = choose(far, movable_near_a_point(far.document.surface("H")))
    view.view("top")
    view.canvas.land()
    far.qtbot.wait(50)
    at = press_and_pull(view, -30)
    assert far.window.panels.adjust.control.dz.value() > 0
    QTest.keyClick(view.canvas, Qt.Key.Key_Escape)
    drop(far, at)


def test_exact_points_hold_a_control_point_and_the_scene_says_so(cored):
    surface = cored.document.surface("T3-T2")
    i, columns = surface.patches[0].control.shape[0] // 2, surface.patches[0].control.shape[1]
    j = next(j for j in range(columns) if acted_on(surface, "core", i, j)[1].any())
    steps = cored.desktop.session.stack.count()
    view = choose(cored, ("core", i, j))
    assert "met exactly" in view.content(view.canvas.projector()).rings[0].text
    at = press_and_pull(view, -40)
    assert "met exactly" in cored.window.statusBar().currentMessage()
    drop(cored, at)
    assert cored.desktop.session.stack.count() == steps
    assert cored.document.surface("T3-T2") is surface


def test_a_surface_that_got_finer_triangles_is_cut_by_these(far):
    surface, control = far.document.surface("H"), movable_near_a_point(far.document.surface("H"))
    view = choose(far, control)
    sight = Sight(view.canvas.projector(), 1.0)
    finer = drawn_of(surface, sight=sight)
    assert len(finer.shape.triangles) != len(view.contents.drawn["H"].shape.triangles)
    view.sharpen(surface, finer)
    at = press_and_pull(view, -50)
    dz = far.window.panels.adjust.control.dz.value()
    assert dz > 0.1
    # Triangles that come while the control point is held wait for its release.
    view.sharpen(surface, drawn_of(surface))
    assert view.contents.drawn["H"] is finer
    shape = view.control_move.drawn
    off = adjust(surface, *control, dz).elevation(*shape.xyz[:, :2].T) - shape.xyz[:, 2]
    assert np.nanmax(np.abs(off)) < 0.2 + 0.02 * dz
    drop(far, at)


def moved_by(view):
    """How far the chosen control point is from where it rests, east, north and up."""
    return view.handles()[0].xyz - view.handles()[0].rest


def test_a_free_drag_goes_where_the_pointer_goes_in_the_plane_of_the_view(far):
    before, control = far.document.surface("H"), movable_near_a_point(far.document.surface("H"))
    view = choose(far, control)
    at = press_and_pull(view, -40, aside=50, keys=PLAIN)
    by, panel = moved_by(view), far.window.panels.adjust
    assert (pixel(view, view.handles()[0].xyz) - at).manhattanLength() <= 2
    seen = view.canvas.projector().screen(np.stack([view.handles()[0].rest, view.handles()[0].xyz]))
    assert seen[0, 2] == pytest.approx(seen[1, 2], abs=1e-6), "as far from the viewer as before"
    assert np.abs(by[:2]).max() > 0.1
    dz, aside = panel.control.dz.value(), panel.control.aside
    np.testing.assert_allclose([*aside[:2], dz], by, atol=2e-3)
    after = adjust(before, *control, dz, aside)
    ring = view.content(view.canvas.projector()).rings[0]
    assert f"{after.accuracy.sigma:.3g}"[:4] in ring.text
    assert "sideways" in ring.text
    shape = view.control_move.drawn
    off = np.abs(after.surface.distance(shape.xyz))
    assert off.max() < 0.2 + 0.02 * np.linalg.norm(by)
    drop(far, at)
    edit = far.document.state.provenances["H"].edits[-1]
    assert edit.aside == aside
    assert far.document.surface("H").accuracy.sigma == pytest.approx(after.accuracy.sigma, abs=1e-12)
    far.desktop.session.stack.undo()
    far.idle()
    assert view.handles()[0].xyz == pytest.approx(place_of(before, *control), abs=1e-9)


@pytest.mark.parametrize(("key", "axis"), [(Qt.Key.Key_X, 0), (Qt.Key.Key_Y, 1), (Qt.Key.Key_Z, 2)])
def test_a_key_locks_the_drag_to_an_axis_and_frees_it(far, key, axis):
    view = choose(far, movable_near_a_point(far.document.surface("H")))
    at = press_and_pull(view, -35, aside=45, keys=PLAIN)
    QTest.keyClick(view.canvas, key)
    by = moved_by(view)
    assert abs(by[axis]) > 0.05
    assert np.abs(np.delete(by, axis)).max() < 1e-6
    assert "XYZ"[axis] in view.content(view.canvas.projector()).rings[0].text
    QTest.keyClick(view.canvas, key)
    assert np.abs(moved_by(view)).min() > 1e-3, "free again"
    QTest.keyClick(view.canvas, Qt.Key.Key_Escape)
    drop(far, at)
    assert not far.document.state.provenances["H"].edits


def test_figures_that_are_typed_while_dragging_are_the_length_of_the_move(far):
    control = movable_near_a_point(far.document.surface("H"))
    view, steps = choose(far, control), far.desktop.session.stack.count()
    at = press_and_pull(view, -20, keys=PLAIN)
    QTest.keyClick(view.canvas, Qt.Key.Key_Z)
    for letter in "-1.2":
        QTest.keyClick(view.canvas, letter)
    QTest.keyClick(view.canvas, "5")
    assert moved_by(view) == pytest.approx([0, 0, -1.25], abs=1e-9)
    assert "-1.25" in view.content(view.canvas.projector()).rings[0].text
    QTest.keyClick(view.canvas, Qt.Key.Key_Backspace)
    assert moved_by(view) == pytest.approx([0, 0, -1.2], abs=1e-9)
    move(view, at + QPoint(40, 40))
    assert moved_by(view) == pytest.approx([0, 0, -1.2], abs=1e-9), "the hand does not change what was typed"
    QTest.keyClick(view.canvas, Qt.Key.Key_Return)
    far.idle()
    assert far.desktop.session.stack.count() == steps + 1
    edit = far.document.state.provenances["H"].edits[-1]
    assert (edit.dz, edit.aside) == (-1.2, (0.0, 0.0, 0.0))
    drop(far, at)
    assert far.desktop.session.stack.count() == steps + 1, "the release after Enter does nothing more"


def test_an_edit_aside_comes_back_after_saving_and_opening(far, tmp_path):
    control = movable_near_a_point(far.document.surface("H"))
    view = choose(far, control)
    panel = far.window.panels.adjust
    panel.control.sideways[0].setValue(3.0)
    assert moved_by(view) == pytest.approx([3.0, 0, 0], abs=1e-9)
    assert panel.apply_button.isEnabled()
    panel.apply_button.click()
    far.idle()
    provenance = far.document.state.provenances["H"]
    assert provenance.edits[-1].aside == (3.0, 0.0, 0.0)
    assert type(provenance).from_data(provenance.to_data()) == provenance
    assert "sideways" in str(far.desktop.session.stack.undoText())
