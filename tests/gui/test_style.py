"""The style: buttons without pictures, title bars that are seen, and a ring round what has the keyboard."""

from __future__ import annotations

import sys

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QPalette
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialogButtonBox,
    QDockWidget,
    QDoubleSpinBox,
    QLabel,
    QLineEdit,
    QMessageBox,
    QPushButton,
    QRadioButton,
    QStyle,
    QTableWidget,
    QTabWidget,
    QTreeWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.theme import THEMES, apply_theme


@pytest.fixture(params=["light", "dark"])
def theme(request, qapp):
    apply_theme(qapp, request.param)
    yield request.param
    apply_theme(qapp, "light")


def luminance(colour):
    parts = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in colour.getRgbF()[:3]]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_standard_buttons_have_no_picture(theme, qtbot):
    _Button = QDialogButtonBox.StandardButton
    box = QDialogButtonBox(_Button.Ok | _Button.Cancel | _Button.Close | _Button.Save | _Button.Discard)
    question = QMessageBox()
    question.setStandardButtons(QMessageBox.StandardButton.Save | QMessageBox.StandardButton.Cancel)
    for widget in (box, question):
        qtbot.addWidget(widget)
        assert len(widget.buttons()) >= 2
        assert all(button.icon().isNull() for button in widget.buttons())


def test_the_title_bars_of_docks_can_be_read(theme, qapp, qtbot):
    dock = QDockWidget("Plan")
    qtbot.addWidget(dock)
    ground = qapp.palette().color(QPalette.ColorRole.Window)
    for standard in (QStyle.StandardPixmap.SP_TitleBarCloseButton, QStyle.StandardPixmap.SP_TitleBarNormalButton):
        picture = dock.style().standardIcon(standard, None, dock).pixmap(16).toImage()
        pixels = [picture.pixelColor(x, y) for x in range(picture.width()) for y in range(picture.height())]
        darkest = max(contrast(ground, colour) for colour in pixels if colour.alpha() > 200)
        assert darkest > 7, standard


def edge(widget, image):
    """Pixels that differ from the ground around a widget, along the middle of its left edge."""
    corner, ratio = widget.mapTo(widget.window(), widget.rect().topLeft()), image.devicePixelRatio()
    y = round((corner.y() + widget.height() // 2) * ratio)
    return [image.pixelColor(round(corner.x() * ratio) + k, y) for k in range(3)]


@pytest.mark.parametrize("kind", [QLineEdit, QComboBox, QDoubleSpinBox, QPushButton, QTreeWidget, QTableWidget])
def test_what_has_the_keyboard_is_ringed(theme, qapp, qtbot, kind):
    window = QWidget()
    qtbot.addWidget(window)
    layout, first, widget = QVBoxLayout(window), QLineEdit(), kind()
    layout.addWidget(first)
    layout.addWidget(widget)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    first.setFocus()
    qtbot.wait(20)
    before = edge(widget, window.grab().toImage())
    QTest.keyClick(first, Qt.Key.Key_Tab)
    assert widget.hasFocus()
    qtbot.wait(20)
    after = edge(widget, window.grab().toImage())
    ring = qapp.palette().color(QPalette.ColorRole.Link)
    assert min(contrast(ring, colour) for colour in after) < 1.2, "no pixel of the ring"
    assert min(contrast(ring, colour) for colour in before) > 1.2, "ringed without the keyboard"
    assert contrast(ring, qapp.palette().color(QPalette.ColorRole.Window)) > 3


def test_the_tab_in_front_is_marked_in_the_dark(qapp, qtbot):
    apply_theme(qapp, "dark")
    tabs = QTabWidget()
    qtbot.addWidget(tabs)
    tabs.setTabPosition(QTabWidget.TabPosition.South)
    for name in ("One", "Two"):
        tabs.addTab(QWidget(), name)
    tabs.show()
    accent = qapp.palette().color(QPalette.ColorRole.Highlight)
    bar = tabs.tabBar()
    image = bar.grab().toImage()
    for k, marked in ((0, True), (1, False)):
        box = bar.tabRect(k)
        column = [
            image.pixelColor(box.center().x(), y) for y in range(box.top(), min(box.bottom() + 1, image.height()))
        ]
        assert (accent in column) == marked
    apply_theme(qapp, "light")


def test_qt_asks_python_for_nothing_while_it_makes_a_widget(theme, qapp, qtbot):
    """PySide would wrap thousands of incomplete widgets per window."""
    asked = []
    sys.setprofile(lambda frame, event, _: event == "call" and asked.append(frame.f_code.co_qualname))
    try:
        made = [kind() for kind in (QComboBox, QDoubleSpinBox, QLineEdit, QTableWidget, QTabWidget, QTreeWidget)]
    finally:
        sys.setprofile(None)
    for widget in made:
        qtbot.addWidget(widget)
    assert [name for name in asked if "Style" in name] == []


def test_a_theme_that_is_switched_while_the_window_is_open_reaches_every_widget(app):
    start = app.window.panels.start
    for theme in ("dark", "light", "dark"):
        app.window.actions_.themes.actions()[THEMES.index(theme)].trigger()
        app.qtbot.wait(20)
        paper = app.window.palette().color(QPalette.ColorRole.Window).lightness()
        for widget in (start.sample, start.open, start.new, *start.findChildren(QLabel)):
            role = QPalette.ColorRole.ButtonText if isinstance(widget, QPushButton) else QPalette.ColorRole.WindowText
            text = widget.palette().color(role).lightness()
            assert abs(text - paper) > 60, f"{theme}: {widget.text()!r} can hardly be read"


@pytest.mark.parametrize("kind", [QCheckBox, QRadioButton])
def test_the_label_of_what_cannot_be_checked_stands_back(theme, qtbot, kind):
    def strongest(enabled):
        box = kind("Surface")
        qtbot.addWidget(box)
        box.setEnabled(enabled)
        box.resize(box.sizeHint())
        image = box.grab().toImage()
        ground = box.palette().window().color()
        label = range(image.width() // 3, image.width())
        return max(contrast(image.pixelColor(x, y), ground) for x in label for y in range(image.height()))

    assert strongest(False) < 0.6 * strongest(True)
