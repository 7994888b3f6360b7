"""Sizes of text and points: chosen in the preferences, seen at once, and remembered."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import SITE, fitted, sample_site
from PySide6.QtCore import QSize
from PySide6.QtGui import QFontMetricsF
from PySide6.QtWidgets import QApplication, QComboBox, QDialog, QLabel

from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.dialogs.rock_volume import RockVolumeDialog
from geofit.gui.dialogs.scene_dialog import SceneDialog
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.main_window import MainWindow
from geofit.gui.panels.adjust import AdjustPanel
from geofit.gui.panels.morph_timeline import MorphTimeline
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.panels.verdict import VerdictBadge
from geofit.gui.preferences import Preferences
from geofit.gui.theme import set_text_size


@pytest.fixture
def accepted(monkeypatch):
    """Answers the preferences: a function that takes the shares to choose."""

    def answer(text, points):
        def choose(dialog):
            for box in dialog.findChildren(QComboBox):
                for share in (text, points):
                    # Each box holds its own shares; only one of them has text's, and one the points'.
                    if box.findData(share) >= 0:
                        box.setCurrentIndex(box.findData(share))
            return QDialog.DialogCode.Accepted

        monkeypatch.setattr(PreferencesDialog, "exec", choose)

    return answer


#: A screen of 1366 x 768 at 125 %, with a task bar.
SMALL = QSize(1092, 580)


@pytest.fixture
def small_screen(monkeypatch):
    class Screen:
        def availableSize(self):  # noqa: N802
            return SMALL

    for kind in (SceneDialog, MainWindow):
        monkeypatch.setattr(kind, "screen", lambda _: Screen(), raising=False)


@pytest.mark.parametrize(
    "make", [RockVolumeDialog, lambda: SurveyDialog(dict, lambda: False)], ids=["rock volume", "survey"]
)
def test_a_large_dialog_fits_a_small_screen(qtbot, small_screen, make):
    dialog = make()
    qtbot.addWidget(dialog)
    assert dialog.size().boundedTo(SMALL) == dialog.size()
    dialog.close()


def test_the_window_fits_a_small_screen(small_screen, app):
    assert app.window.size().boundedTo(SMALL) == app.window.size()


@pytest.fixture
def usual_text(qapp):
    font = qapp.font()
    yield font.pointSizeF()
    qapp.setFont(font)


def dark_pixels(view):
    """How much of the picture is neither ground nor grid: points, mostly."""
    picture = view.canvas.grabFramebuffer()
    rows = np.frombuffer(picture.constBits(), np.uint8).reshape(picture.height(), -1, 4)[:, : picture.width(), :3]
    return int((rows.astype(int).sum(axis=2) < 450).sum())


def test_text_and_points_grow_and_are_remembered(app, qapp, accepted, usual_text):
    app.desktop.session.begin(sample_site(), SITE)
    app.idle()
    window = app.window
    tree = window.panels.tree
    for layer in window.panels.view.layers:
        window.panels.view.layers.change(layer.key, visible=layer.kind == "points")
    app.trigger("top")
    app.idle()
    app.qtbot.wait(900)
    before, letters = dark_pixels(window.panels.view), tree.fontInfo().pointSizeF()
    accepted(1.3, 2.0)
    app.trigger("preferences")
    app.qtbot.wait(600)
    assert QApplication.font().pointSizeF() == pytest.approx(1.3 * usual_text)
    assert tree.fontInfo().pointSizeF() > 1.2 * letters
    assert dark_pixels(window.panels.view) > 1.5 * before
    stored = Preferences()
    assert (stored.text_size, stored.point_size) == (1.3, 2.0)
    # Back to the usual sizes: the size of the system, not of the last choice.
    accepted(1.0, 1.0)
    # Both boxes hold 1.0.
    app.trigger("preferences")
    app.qtbot.wait(300)
    assert QApplication.font().pointSizeF() == pytest.approx(usual_text)
    assert Preferences().point_size == 1.0


def test_a_share_that_nobody_offers_is_the_usual_one():
    from PySide6.QtCore import QSettings

    QSettings().setValue("text_size", 17.0)
    assert Preferences().text_size == 1.0


def test_panels_grow_with_the_text(qtbot, qapp, usual_text):
    panel, badge, table = AdjustPanel(), VerdictBadge(), DataTable()
    table.show_columns([TableColumn("Residual, m", np.arange(3.0))])
    for widget in (panel, badge, table):
        qtbot.addWidget(widget)
        widget.show()
    panel.show_surface(fitted())
    letters = [label.font().pointSizeF() for label in badge.findChildren(QLabel)]
    column, row = table.columnWidth(0), table.verticalHeader().defaultSectionSize()
    width = panel.minimumSizeHint().width()
    set_text_size(qapp, 1.5)
    inner = panel.control.parentWidget()

    def grown():
        now = [label.font().pointSizeF() for label in badge.findChildren(QLabel)]
        assert now == pytest.approx([1.5 * size for size in letters], rel=0.01)
        assert table.columnWidth(0) > 1.2 * column
        assert table.verticalHeader().defaultSectionSize() > 1.2 * row
        # It has no horizontal scroll bar: all of it must fit.
        assert panel.minimumSizeHint().width() >= inner.minimumSizeHint().width() > width

    qtbot.waitUntil(grown)


def test_the_buttons_of_a_dialog_stay_on_the_screen_however_long_its_message_is(qtbot):
    dialog = RockVolumeDialog()
    qtbot.addWidget(dialog)
    dialog.show()
    dialog.say("A reason that goes on and on. " * 900)
    assert dialog.height() <= dialog.screen().availableSize().height()
    dialog.close()


@pytest.mark.parametrize("size", [1.0, 1.5])
def test_no_digit_of_a_volume_is_cut_off_at_the_slider(qtbot, qapp, usual_text, size):
    set_text_size(qapp, size)
    timeline = MorphTimeline()
    qtbot.addWidget(timeline)
    timeline.resize(600, 120)
    timeline.show_curves([0.0, 1.0], [333_466_885.0, 11_478_812.0], [2.0, 2.0])
    font = timeline.font()
    font.setPointSizeF(0.88 * font.pointSizeF())
    widest = QFontMetricsF(font).horizontalAdvance("333 466 885 m³".replace(" ", "\N{NO-BREAK SPACE}"))
    assert timeline.plot().left() > widest
