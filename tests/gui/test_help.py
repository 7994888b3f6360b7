"""F1 opens the page and the heading about what has the keyboard: a panel, a dialog, a dialog of a dialog."""

from __future__ import annotations

import pytest
from panel_samples import SITE, WITH_PERIPHERY, fitted, sample_site
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QColorDialog, QTabBar

from geofit.gui import help_places
from geofit.gui.dialogs.help_page import HelpPage
from geofit.gui.dialogs.order import OrderDialog
from geofit.gui.dialogs.raw_volume import RawVolumeDialog
from geofit.gui.dialogs.rock_volume import RockVolumeDialog
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.help_places import PAGES, PLACE_OF_DIALOG, PLACE_OF_PANEL, anchor
from geofit.project.commands import SetSurface

PLACES = sorted({*PLACE_OF_PANEL.values(), *PLACE_OF_DIALOG.values()})


def page() -> HelpPage | None:
    """The page that is shown."""
    found = [one for one in QApplication.topLevelWidgets() if isinstance(one, HelpPage) and one.isVisible()]
    assert len(found) < 2
    return found[0] if found else None


def top_line(shown: HelpPage) -> str:
    """The text at the top of a page."""
    return shown.text.cursorForPosition(shown.text.viewport().rect().topLeft()).block().text()


def place_of_f1(qtbot, window) -> str:
    """Press F1 in a window, close the page that opens, and return its place."""
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    QTest.keyClick(QApplication.focusWidget() or window, Qt.Key.Key_F1)
    shown = page()
    assert shown is not None
    place = shown.place
    shown.reject()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    return place


@pytest.fixture
def site(app):
    """The window with a surface."""
    app.desktop.session.begin(sample_site(), SITE)
    app.document.select(WITH_PERIPHERY)
    provenance = app.document.provenance(WITH_PERIPHERY)
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    return app


@pytest.mark.parametrize("place", PLACES)
def test_every_place_is_a_heading_of_a_page(place):
    name, _, fragment = place.partition("#")
    lines = (PAGES / name).read_text(encoding="utf-8").splitlines()
    headings = [anchor(line.lstrip("#")) for line in lines if line.startswith("#")]
    assert headings.count(fragment) == 1 if fragment else headings


def test_every_panel_has_a_place_of_its_own(app):
    names = {*app.window.panels.docks, "view", "start"}
    assert set(PLACE_OF_PANEL) == names
    assert len(set(PLACE_OF_PANEL.values())) == len(names)


def test_f1_opens_the_heading_about_the_panel_that_has_the_keyboard(site, qtbot):
    window = site.window
    for name in window.panels.docks:
        window.panels.reveal(name)
        switch = next(s for s in window.panels.reach.switches if s.text() == window.panels.docks[name].windowTitle())
        switch.trigger()
        if not window.panels.docks[name].isVisible():
            switch.trigger()
        site.idle()
        assert place_of_f1(qtbot, window) == PLACE_OF_PANEL[name]
    window.panels.view.canvas.setFocus()
    assert place_of_f1(qtbot, window) == PLACE_OF_PANEL["view"]


def test_f1_on_a_tab_is_about_its_panel(site, qtbot):
    window = site.window
    window.panels.reveal("seams")
    site.idle()
    bar = next(
        bar
        for bar in window.findChildren(QTabBar)
        if bar.isVisible() and bar.tabText(bar.currentIndex()) == window.panels.docks["seams"].windowTitle()
    )
    bar.setFocus()
    assert place_of_f1(qtbot, window) == PLACE_OF_PANEL["seams"]


def test_f1_is_about_a_panel_in_the_middle(site, qtbot):
    window = site.window
    window.panels.centring.bring("residuals")
    window.panels.residuals.search.setFocus()
    assert place_of_f1(qtbot, window) == PLACE_OF_PANEL["residuals"]


def test_f1_on_the_start_page(app, qtbot):
    assert place_of_f1(qtbot, app.window) == PLACE_OF_PANEL["start"]


def test_the_tutorial_opens_at_its_beginning_from_the_menu(site):
    site.window.panels.residuals.search.setFocus()
    site.trigger("tutorial")
    shown = page()
    assert shown.place == help_places.TUTORIAL
    assert top_line(shown) == "The desktop application, from start to finish"
    shown.reject()


def test_a_page_shows_the_heading_at_its_top_and_follows_links(app):
    app.window.help.page("tutorial.md#4-fit")
    shown = page()
    assert top_line(shown) == "4. Fit"
    assert shown.text.horizontalScrollBar().maximum() == 0, "pictures are as wide as the text"
    shown.text.verticalScrollBar().setValue(0)
    app.window.help.page("tutorial.md#4-fit")
    assert page() is shown
    assert top_line(shown) == "4. Fit"
    app.window.help.page("morph.md#in-the-window")
    assert page() is shown
    assert top_line(shown) == "In the window"
    shown.text.backward()
    assert shown.place == "tutorial.md#4-fit"
    shown.reject()


@pytest.mark.parametrize(
    ("make", "place"),
    [
        (lambda window: SurveyDialog(dict, lambda: True, window), "formats_in.md#cave-surveys-and-centre-lines"),
        (lambda window: OrderDialog(("a", "b"), window), "tutorial.md#10-check-it"),
        (lambda window: QColorDialog(window.panels.tree), help_places.TUTORIAL),
    ],
    ids=["survey", "order", "of a panel"],
)
def test_f1_opens_the_place_about_a_dialog(app, qtbot, make, place):
    dialog = make(app.window)
    dialog.setModal(True)
    dialog.show()
    assert place_of_f1(qtbot, dialog) == place
    dialog.reject()


def test_f1_helps_in_a_dialog_of_a_dialog_with_a_page_that_can_be_used(app, qtbot):
    first = RockVolumeDialog(app.window)
    first.setModal(True)
    first.show()
    second = RawVolumeDialog("core.raw", (2, 3, 4), "u2", first)
    second.setModal(True)
    second.show()
    second.activateWindow()
    qtbot.waitUntil(second.isActiveWindow)
    QTest.keyClick(second, Qt.Key.Key_F1)
    shown = page()
    assert shown.place == PLACE_OF_DIALOG["RawVolumeDialog"]
    qtbot.waitUntil(shown.isActiveWindow)
    QTest.keyClick(shown.text, Qt.Key.Key_Escape)
    assert page() is None
    second.reject()
    first.activateWindow()
    assert place_of_f1(qtbot, first) == PLACE_OF_DIALOG["RockVolumeDialog"]
    first.close()
