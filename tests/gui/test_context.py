"""What lies under the pointer: named when it rests, and with a menu of what can be done, in scene and tree."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import SITE, fitted, sample_site
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QInputDialog, QMessageBox

from geofit.project.commands import SetSurface
from geofit.project.provenance import Row

NAME = "T3-T2"


@pytest.fixture
def shown(app):
    app.desktop.session.begin(sample_site(), SITE)
    provenance = app.document.provenance(NAME)
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.document.select(NAME)
    app.trigger("top")
    app.idle()
    app.qtbot.wait(600)
    return app


def hit_of(shown, kind, name=NAME):
    """What lies where a thing of a kind is drawn in front."""
    view = shown.window.panels.view
    projector, size = view.canvas.projector(), view.canvas.size()
    for layer, item in view.contents.stage.items():
        if layer.kind != kind or (layer.horizon and layer.horizon != name):
            continue
        if kind in ("points", "surface"):
            places = item.targets if kind == "points" else item.shape.xyz
        else:
            places = np.concatenate([xyz for _, xyz in item.ways])
        for x, y, _ in projector.screen(np.asarray(places)):
            if 0 < x < size.width() and 0 < y < size.height():
                hit = view.pointer.under(QPointF(x, y))
                if hit is not None and hit.layer.key == layer.key:
                    return hit
    pytest.fail(f"no {kind} in sight")


def texts(menu):
    return [action.text() for action in menu.actions() if not action.isSeparator()]


def choose(menu, text):
    next(action for action in menu.actions() if action.text() == text).trigger()


def test_the_pointer_names_points_holes_and_surfaces(shown):
    context, document = shown.window.context, shown.document
    point = hit_of(shown, "points")
    words = context.words(point)
    row = Row.of(document.listing(NAME).points, int(point.which))
    assert f"row {row.row}" in words
    assert "residual" in words
    for layer in shown.window.panels.view.layers:
        if layer.kind == "points":
            shown.window.panels.view.layers.change(layer.key, visible=False)
    shown.idle()
    hole = hit_of(shown, "holes", "")
    assert str(hole.which) in context.words(hole)
    assert "m along it" in context.words(hole)
    for layer in shown.window.panels.view.layers:
        if layer.kind in ("points", "holes", "adits", "ground"):
            shown.window.panels.view.layers.change(layer.key, visible=False)
    shown.idle()
    surface = hit_of(shown, "surface")
    words = context.words(surface)
    z = document.surface(NAME).elevation(*surface.xyz[:2])
    assert abs(float(z) - surface.xyz[2]) < 0.1
    assert "dip" in words


def test_resting_shows_a_tool_tip_and_the_right_button_a_menu(shown):
    from PySide6.QtWidgets import QMenu, QToolTip

    view = shown.window.panels.view
    hit = hit_of(shown, "points")
    x, y, _ = view.canvas.projector().screen(hit.xyz[None])[0]
    at = QPointF(x, y)
    view.canvas.hovered.emit(at)
    shown.qtbot.waitUntil(lambda: NAME in QToolTip.text(), timeout=3000)
    globally = QPointF(view.canvas.mapToGlobal(at.toPoint()))
    for kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonRelease):
        held = Qt.MouseButton.RightButton
        event = QMouseEvent(kind, at, globally, held, held, Qt.KeyboardModifier.NoModifier)
        QApplication.sendEvent(view.canvas, event)
    menus = [one for one in shown.window.findChildren(QMenu) if one.isVisible()]
    assert len(menus) == 1
    assert "Exclude point" in texts(menus[0])
    menus[0].close()


def test_a_point_is_excluded_and_included_from_its_menu(shown):
    context, document = shown.window.context, shown.document
    hit = hit_of(shown, "points")
    row = Row.of(document.listing(NAME).points, int(hit.which))
    choose(context.menu_at(hit), "Exclude point")
    shown.idle()
    assert document.state.excluded[NAME] == {row}
    choose(context.menu_at(hit), "Include point")
    shown.idle()
    assert not document.state.excluded[NAME]
    choose(context.menu_at(hit), "Section through here")
    shown.idle()
    line = np.asarray(shown.window.showing.line)
    assert line[0, 1] == line[1, 1] == pytest.approx(hit.xyz[1])
    assert line[0, 0] < hit.xyz[0] < line[1, 0]
    assert shown.window.actions_["section"].isChecked()


def test_a_horizon_is_hidden_isolated_renamed_merged_and_removed_from_the_tree(shown, monkeypatch):
    context, document = shown.window.context, shown.document
    layers = shown.window.panels.view.layers
    choose(context.menu_of("horizon", NAME), "Isolate")
    assert {layer.horizon for layer in layers if layer.horizon and layer.visible} == {NAME}
    choose(context.menu_of("horizon", NAME), "Show all")
    choose(context.menu_of("horizon", NAME), "Hide")
    assert not any(layer.visible for layer in layers if layer.horizon == NAME)
    choose(context.menu_of("horizon", NAME), "Show")
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: ("base of T3", True))
    choose(context.menu_of("horizon", NAME), "Rename…")
    shown.idle()
    assert "base of T3" in document.horizons
    assert not document.stale("base of T3")
    assert document.surface("base of T3") is not None
    choose(context.menu_of("horizon", "W"), "Remove from the site")
    shown.idle()
    assert "W" not in document.horizons
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: ("both", True))
    menu = context.menu_of("horizon", "base of T3")
    merge = next(action for action in menu.actions() if action.text() == "Merge with").menu()
    choose(merge, "T2-T1")
    shown.idle()
    assert "both" in document.horizons
    for _ in range(3):
        shown.window.menus.undo.trigger()
        shown.idle()
    assert document.horizons == tuple(sample_site().horizons)
    assert document.surface(NAME) is not None


def test_properties_of_a_hole_from_the_tree(shown, monkeypatch):
    said = []
    monkeypatch.setattr(QMessageBox, "exec", lambda box: said.append(box.text()))
    name = sample_site().holes[0].name
    choose(shown.window.context.menu_of("hole", name), "Properties…")
    assert name in said[0]
    asked = []
    tree = shown.window.panels.tree
    tree.menu_requested.connect(lambda *what: asked.append(what[:2]))
    index = tree.view.currentIndex()
    tree.view.customContextMenuRequested.emit(tree.view.visualRect(index).center())
    assert asked == [("horizon", NAME)]
    for menu in QApplication.topLevelWidgets():
        if menu.inherits("QMenu"):
            menu.close()


def test_a_double_click_on_a_title_makes_a_panel_the_centre_and_puts_it_back(shown):
    panels = shown.window.panels
    panels.reveal("section")
    shown.idle()
    dock = panels.docks["section"]

    def double_click(widget, at):
        for kind in (QEvent.Type.MouseButtonDblClick, QEvent.Type.MouseButtonRelease):
            held = Qt.MouseButton.LeftButton
            event = QMouseEvent(kind, at, QPointF(widget.mapToGlobal(at.toPoint())), held, held,
                                Qt.KeyboardModifier.NoModifier)  # fmt: skip
            QApplication.sendEvent(widget, event)

    before = panels.section.width() * panels.section.height()
    double_click(dock, QPointF(40, 6))
    shown.idle()
    assert panels.centring.name == "section"
    assert dock.isHidden()
    assert panels.section.isVisible()
    assert panels.view.isVisible(), "side by side"
    assert panels.section.width() > panels.view.width()
    assert panels.section.width() * panels.section.height() > 1.3 * before
    panels.reveal("section")
    assert dock.isHidden(), "an empty dock must not come"
    double_click(panels.centring.frame.head, QPointF(30, 5))
    shown.idle()
    assert panels.centring.name is None
    assert dock.widget() is panels.section
    assert panels.section.isVisible()
    panels.centring.bring("plan")
    shown.trigger("reset_layout")
    assert panels.docks["plan"].widget() is panels.plan
