"""Every panel is reached from the menu and with the keyboard, and Tab never leads to what nobody sees."""

from __future__ import annotations

import pytest
from panel_samples import SITE, fitted, sample_site
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from geofit.data.messages import message
from geofit.gui.panels.fit_panel import FIRST
from geofit.project.commands import SetSurface


@pytest.fixture
def shown(app, qtbot):
    """The window with a surface, active."""
    app.desktop.session.begin(sample_site(), SITE)
    app.document.select("T3-T2")
    provenance = app.document.provenance("T3-T2")
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.window.activateWindow()
    qtbot.waitUntil(app.window.isActiveWindow)
    return app


def at(window):
    """Name of the dock that has the keyboard; "view" for the middle."""
    widget = QApplication.focusWidget()
    for name, dock in window.panels.docks.items():
        if dock is widget or dock.isAncestorOf(widget):
            return name
    return "view" if window.panels.view.isAncestorOf(widget) else None


def press(key, modifier=Qt.KeyboardModifier.NoModifier):
    QTest.keyClick(QApplication.focusWidget(), key, modifier)


def test_one_key_goes_round_all_panels_and_another_back(shown):
    docks = list(shown.window.panels.docks)
    shown.window.panels.reveal("residuals")
    shown.window.panels.view.canvas.setFocus()
    assert at(shown.window) == "view"
    went = []
    for _ in range(len(docks) + 1):
        press(Qt.Key.Key_Tab, Qt.KeyboardModifier.ControlModifier)
        went.append(at(shown.window))
        if went[-1] != "view":
            assert not shown.window.panels.docks[went[-1]].visibleRegion().isEmpty(), f"{went[-1]} is behind"
    assert went == [*docks, "view"]
    press(Qt.Key.Key_Backtab, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    assert at(shown.window) == docks[-1]


def test_a_panel_is_come_back_to_where_it_was_left(shown):
    shown.window.panels.fit.more.setChecked(True)
    box = shown.window.panels.fit.fields["seam"].box
    box.setFocus()
    shown.trigger("next_panel")
    assert at(shown.window) == "adjust"
    shown.trigger("previous_panel")
    assert QApplication.focusWidget() is box


def test_a_closed_panel_is_passed_over(shown):
    shown.window.panels.docks["fit"].close()
    shown.window.panels.tree.view.setFocus()
    shown.trigger("next_panel")
    assert at(shown.window) == "adjust"


def test_the_menu_brings_to_the_front_what_stands_behind_and_closes_what_is_in_front(shown):
    checks = shown.window.panels.docks["checks"]
    switch = next(one for one in shown.window.menus.panels.actions() if one.text() == checks.windowTitle())
    assert not switch.isChecked(), "folded away at first"
    assert checks.visibleRegion().isEmpty()
    switch.trigger()
    shown.idle()
    assert not checks.visibleRegion().isEmpty()
    assert switch.isChecked()
    assert at(shown.window) == "checks"
    switch.trigger()
    assert checks.isHidden()
    assert not switch.isChecked()
    switch.trigger()
    shown.idle()
    assert at(shown.window) == "checks"
    checks.close()
    assert not switch.isChecked(), "closed by its own button"


@pytest.mark.parametrize("key", [Qt.Key.Key_Tab, Qt.Key.Key_Backtab])
def test_tab_passes_over_what_stands_behind(shown, key):
    shown.window.panels.reveal("residuals")
    shown.idle()
    shown.window.panels.tree.search.setFocus()
    places = set()
    for _ in range(80):
        press(key)
        widget = QApplication.focusWidget()
        assert not widget.visibleRegion().isEmpty(), f"{widget} in {at(shown.window)} is not seen"
        places.add(at(shown.window))
        if widget is shown.window.panels.tree.search:
            break
    else:
        pytest.fail(message("test.text", "Tab never came round"))
    assert {"tree", "fit", "residuals", "view"} <= places
    assert not places & {"adjust", "section", "plan", "checks"}


def test_tab_goes_down_the_fit_panel(shown):
    panel = shown.window.panels.fit
    panel.more.setChecked(True)
    shown.idle()
    order = [field.focusProxy() for field in panel.fields.values()]
    order.insert(len(FIRST), panel.more)
    assert [box.mapToGlobal(box.rect().topLeft()).y() for box in order] == sorted(
        box.mapToGlobal(box.rect().topLeft()).y() for box in order
    )
    order[0].setFocus()
    for box in (*order[1:], panel.fit_button, panel.all_button):
        press(Qt.Key.Key_Tab)
        assert QApplication.focusWidget() is box
