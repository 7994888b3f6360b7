"""Sizes of text and points: chosen in the preferences, seen at once, and remembered."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import SITE, sample_site
from PySide6.QtCore import QSize
from PySide6.QtWidgets import QApplication, QComboBox, QDialog

from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.dialogs.rock_volume import RockVolumeDialog
from geofit.gui.dialogs.scene_dialog import SceneDialog
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.main_window import MainWindow
from geofit.gui.preferences import Preferences


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
