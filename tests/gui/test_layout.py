"""The start page stands alone; the docks come with a site, as they were left."""

from __future__ import annotations

import pytest
from panel_samples import SITE, sample_site
from PySide6.QtCore import QByteArray, QEvent, QObject, Qt
from PySide6.QtWidgets import QStyle, QTabBar, QToolBar, QToolButton, QWidget

from geofit.data.site import Site
from geofit.gui.layout import BOTTOM
from geofit.gui.theme import THEMES


def opened(app):
    app.desktop.session.begin(sample_site(), SITE)
    app.idle()


def closed(app):
    app.desktop.session.begin(Site("", {}), None)
    app.idle()


def shown(window):
    """Names of what frames the middle of the window."""
    bars = {bar.objectName() for bar in window.findChildren(QToolBar) if bar.parent() is window and bar.isVisible()}
    return bars | {name for name, dock in window.panels.docks.items() if dock.isVisible()}


def in_front(window):
    return {name for name, dock in window.panels.docks.items() if not dock.visibleRegion().isEmpty()}


def test_the_start_page_stands_alone(app):
    assert app.window.panels.centre.currentWidget() is app.window.panels.start
    assert shown(app.window) == set()
    assert not app.window.menus.panels.isEnabled()
    assert not app.window.actions_["reset_layout"].isEnabled()
    assert not any(dock.toggleViewAction().isEnabled() for dock in app.window.panels.docks.values())


def test_a_site_brings_every_dock_in_its_place(app):
    opened(app)
    assert shown(app.window) == {"tool bar", "panel bar", *app.window.panels.docks} - set(BOTTOM)
    assert in_front(app.window) == {"tree", "fit"}
    assert app.window.menus.panels.isEnabled()
    assert all(dock.toggleViewAction().isEnabled() for dock in app.window.panels.docks.values())


def test_the_next_site_finds_the_docks_as_they_were_left(app):
    opened(app)
    app.window.panels.docks["tree"].close()
    app.window.panels.reveal("plan")
    app.idle()
    left, front, width = shown(app.window), in_front(app.window), app.window.panels.docks["fit"].width()
    closed(app)
    assert shown(app.window) == set()
    opened(app)
    assert shown(app.window) == left
    assert in_front(app.window) == front == {"fit", "plan"}
    assert app.window.panels.docks["fit"].width() == width


@pytest.mark.parametrize("left_on", ["the site", "the start page"])
def test_the_next_start_finds_them_too(app, qtbot, left_on):
    opened(app)
    app.window.panels.reveal("checks")
    app.window.panels.docks["log"].close()
    app.idle()
    if left_on == "the start page":
        closed(app)
    app.desktop.change_language("zh_CN")
    app.idle()
    if left_on == "the start page":
        assert shown(app.window) == set()
        opened(app)
    assert "log" not in shown(app.window)
    assert "checks" in in_front(app.window)
    app.desktop.change_language("en")


def test_a_layout_that_cannot_be_read_gives_the_first_one(app):
    app.window.panels.layout.state = QByteArray(b"\x00\xff")
    opened(app)
    assert in_front(app.window) == {"tree", "fit"}


def arranged_anew(app, width):
    """Open the sample in a window of a width, its panels where they are at first."""
    app.window.resize(width, 800)
    opened(app)
    app.trigger("reset_layout")
    app.idle()


def test_names_of_horizons_have_room_at_the_left(app):
    arranged_anew(app, 1360)
    tree = app.window.panels.tree
    assert tree.width() >= 240
    assert tree.view.textElideMode() == Qt.TextElideMode.ElideMiddle


def test_the_view_has_most_of_a_small_window(app):
    arranged_anew(app, 1280)
    view = app.window.panels.view
    assert view.width() * view.height() >= 0.55 * 1280 * 800
    assert app.window.panels.layout.folded


class Windows(QObject):
    """Hears of each widget that is shown as a window."""

    def __init__(self):
        super().__init__()
        self.shown = []

    def eventFilter(self, watched, event):  # noqa: N802
        if event.type() == QEvent.Type.Show and isinstance(watched, QWidget) and watched.isWindow():
            self.shown.append(type(watched).__name__)
        return False


def test_no_panel_flashes_up_as_a_window_of_its_own(app, qapp):
    windows = Windows()
    qapp.installEventFilter(windows)
    try:
        app.desktop.change_language("zh_CN")
    finally:
        qapp.removeEventFilter(windows)
    assert windows.shown == ["MainWindow"]
    app.desktop.change_language("en")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_tab_below_the_view_of_a_small_window_can_be_read(app, theme):
    app.window.resize(1280, 800)
    opened(app)
    app.window.actions_.themes.actions()[THEMES.index(theme)].trigger()
    app.window.panels.reveal("plan")
    app.idle()
    bar = max((bar for bar in app.window.findChildren(QTabBar) if bar.isVisible()), key=QTabBar.count)
    assert bar.count() > 10
    # Qt cuts names as soon as the tabs do not have the room that the style gives them.
    room = bar.style().pixelMetric(QStyle.PixelMetric.PM_TabBarTabHSpace, None, bar)
    for k in range(bar.count()):
        name = bar.tabText(k)
        assert bar.tabRect(k).right() < bar.width(), name
        assert bar.fontMetrics().horizontalAdvance(name) + room <= bar.tabRect(k).width(), name


@pytest.mark.parametrize("code", ["en", "zh_CN"])
def test_no_tab_of_a_narrow_window_is_cut_off_and_each_can_be_come_to(app, code):
    app.desktop.change_language(code)
    app.window.resize(960, 640)
    opened(app)
    app.window.panels.reveal("plan")
    app.idle()
    bar = max((bar for bar in app.window.findChildren(QTabBar) if bar.isVisible()), key=QTabBar.count)
    arrows = [button for button in bar.findChildren(QToolButton) if button.isVisible()]
    for k in range(bar.count()):
        name = bar.tabText(k)
        assert bar.fontMetrics().horizontalAdvance(name) < bar.tabRect(k).width(), name
        assert bar.tabToolTip(k) == name
        bar.setCurrentIndex(k)
        app.qtbot.wait(20)
        right = min([bar.width(), *(arrow.x() for arrow in arrows)])
        assert 0 <= bar.tabRect(k).left() < bar.tabRect(k).right() <= right, name
    app.desktop.change_language("en")


def test_a_button_unfolds_a_panel_and_folds_all_away_again(app):
    opened(app)
    panels = app.window.panels
    high = panels.view.height()
    panels.bar.buttons["checks"].trigger()
    app.idle()
    assert "checks" in in_front(app.window)
    assert panels.view.height() < 0.75 * high
    assert not panels.bar.isVisible(), "the panels have tabs now"
    panels.reveal("plan")
    app.idle()
    assert "plan" in in_front(app.window)
    app.trigger("fold")
    app.idle()
    assert panels.layout.folded
    assert panels.bar.isVisible()
    assert panels.view.height() == high
    app.trigger("fold")
    app.idle()
    assert "plan" in in_front(app.window), "what was in front comes back"


def test_panels_can_be_reset(app):
    opened(app)
    for dock in app.window.panels.docks.values():
        dock.close()
    app.window.menus.tools.hide()
    app.trigger("reset_layout")
    app.idle()
    assert shown(app.window) == {"tool bar", "panel bar", *app.window.panels.docks} - set(BOTTOM)


def test_long_names_push_no_dock_over_the_scene(app, tmp_path):
    names = ("base_of_the_weathered_granodiorite_of_the_left_abutment_below_1600_campaign_1987", "a long name " * 12)
    rows = [f"{x},{y},{x % 7 - 9 * k},{name}" for k, name in enumerate(names) for x in range(9) for y in range(9)]
    (tmp_path / "p.csv").write_text("\n".join(["x,y,z,horizon", *rows]), encoding="utf-8")
    (tmp_path / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "p.csv"\n', encoding="utf-8")
    app.window.files.open(tmp_path / "site.toml")
    app.idle()
    app.window.fitting.fit_all()
    app.idle()
    for name in app.document.horizons:
        app.document.select(name)
        app.idle()
        assert app.window.panels.tree.form.isVisible()
        wide = {one: dock.minimumSizeHint().width() for one, dock in app.window.panels.docks.items()}
        assert max(wide["tree"], wide["fit"]) < 300, wide
        assert app.window.panels.centre.width() > app.window.width() / 3
