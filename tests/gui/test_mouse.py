"""The mouse in the scene, as in other programs: chosen in the preferences, kept for the next start."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import SITE, sample_site
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QDialog

from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.preferences import Preferences

LEFT, MIDDLE, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton
NONE, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier


def drag(canvas, button, keys):
    """Return what a drag did: "turn", "shift", "zoom" or "" for nothing."""
    start = QPointF(canvas.width() / 2, canvas.height() / 2)
    before = canvas.viewpoint
    for kind, at in (
        (QEvent.Type.MouseButtonPress, start),
        (QEvent.Type.MouseMove, start + QPoint(30, 20)),
        (QEvent.Type.MouseMove, start + QPoint(60, 40)),
        (QEvent.Type.MouseButtonRelease, start + QPoint(60, 40)),
    ):
        place = QPointF(canvas.mapToGlobal(at.toPoint()))
        QApplication.sendEvent(canvas, QMouseEvent(kind, at, place, button, button, keys))
    after = canvas.viewpoint
    if after.azimuth != before.azimuth:
        return "turn"
    if after.distance != before.distance:
        return "zoom"
    return "" if np.array_equal(after.centre, before.centre) else "shift"


@pytest.mark.parametrize(
    ("scheme", "left", "shift_left", "middle", "shift_middle", "right"),
    [
        ("geofit", "turn", "shift", "shift", "shift", "shift"),
        ("cad", "", "", "shift", "turn", ""),
        ("leapfrog", "turn", "shift", "shift", "shift", "zoom"),
        ("paraview", "turn", "turn", "shift", "shift", "zoom"),
    ],
)
def test_each_scheme(app, monkeypatch, scheme, left, shift_left, middle, shift_middle, right):
    app.desktop.session.begin(sample_site(), SITE)
    app.idle()

    def accept(dialog):
        dialog.mouse_box.setCurrentIndex(dialog.mouse_box.findData(scheme))
        return QDialog.DialogCode.Accepted

    monkeypatch.setattr(PreferencesDialog, "exec", accept)
    app.trigger("preferences")
    assert Preferences().mouse == scheme
    canvas = app.window.panels.view.canvas
    for button, keys, wanted in (
        (LEFT, NONE, left), (LEFT, SHIFT, shift_left), (MIDDLE, NONE, middle), (MIDDLE, SHIFT, shift_middle),
        (RIGHT, NONE, right),
    ):  # fmt: skip
        assert drag(canvas, button, keys) == wanted, (button, keys)
    app.idle()
