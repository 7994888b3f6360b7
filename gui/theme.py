"""Light, dark, or as the system has it: one palette each, the same on every platform."""

from __future__ import annotations

from typing import Literal

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFont, QFontDatabase, QPalette
from PySide6.QtWidgets import QApplication

from geofit.gui.dark_style import DarkStyle
from geofit.gui.style import Style

__all__ = ["THEMES", "Theme", "apply_theme", "is_dark", "missing_chinese", "set_font", "set_text_size"]

Theme = Literal["system", "light", "dark"]
THEMES: tuple[Theme, ...] = ("system", "light", "dark")

_LIGHT = {
    "Window": "#f3f5f7", "WindowText": "#1c2733", "Base": "#ffffff", "AlternateBase": "#f3f6f9", "Text": "#1c2733",
    "Button": "#eceff2", "ButtonText": "#1c2733", "BrightText": "#a3271c", "ToolTipBase": "#ffffff",
    "ToolTipText": "#1c2733", "Highlight": "#0b5c8a", "HighlightedText": "#ffffff", "Link": "#0b5c8a",
    "LinkVisited": "#5b4a8a", "PlaceholderText": "#6b7885", "Accent": "#0b5c8a", "Light": "#ffffff",
    "Midlight": "#e3e7eb", "Mid": "#c3cad1", "Dark": "#a3abb3", "Shadow": "#7a828a",
}  # fmt: skip
_DARK = {
    "Window": "#22282e", "WindowText": "#e3e8ed", "Base": "#1a1f24", "AlternateBase": "#20262c", "Text": "#e3e8ed",
    "Button": "#2d343b", "ButtonText": "#e3e8ed", "BrightText": "#ff8d7d", "ToolTipBase": "#2d343b",
    "ToolTipText": "#e3e8ed", "Highlight": "#2f86bd", "HighlightedText": "#ffffff", "Link": "#69b7e8",
    "LinkVisited": "#b3a0e0", "PlaceholderText": "#8d98a3", "Accent": "#2f86bd", "Light": "#454e57",
    "Midlight": "#39414a", "Mid": "#3b434b", "Dark": "#171b1f", "Shadow": "#0d1013",
}  # fmt: skip
_MUTED = {"light": "#95a0aa", "dark": "#6d7882"}


#: Property of the application that keeps the system's own size of text, points.
_SYSTEM_SIZE = "geofit system text size"


def apply_theme(app: QApplication, theme: Theme) -> None:
    """Give all windows the colours of a theme."""
    dark = theme == "dark" or (theme == "system" and app.styleHints().colorScheme() == Qt.ColorScheme.Dark)
    palette = QPalette()
    for role, colour in (_DARK if dark else _LIGHT).items():
        palette.setColor(getattr(QPalette.ColorRole, role), QColor(colour))
    for role in ("WindowText", "Text", "ButtonText"):
        muted = QColor(_MUTED["dark" if dark else "light"])
        palette.setColor(QPalette.ColorGroup.Disabled, getattr(QPalette.ColorRole, role), muted)
    app.setPalette(palette)
    app.setStyle(DarkStyle(palette) if dark else Style(palette))


def is_dark(palette: QPalette) -> bool:
    """Whether text on this palette is lighter than its ground."""
    return palette.color(QPalette.ColorRole.Window).lightness() < 128


def missing_chinese() -> bool:
    """Whether no font of this machine has simplified Chinese characters."""
    return not QFontDatabase.families(QFontDatabase.WritingSystem.SimplifiedChinese)


def set_font(app: QApplication) -> None:
    """Take the system's font, with the calmest Chinese one that there is behind it."""
    from geofit.report.fonts import CHINESE

    known = set(QFontDatabase.families())
    font = QFont(app.font())
    behind = [family for family in CHINESE if family in known][:1]
    font.setFamilies([*font.families(), *behind])
    app.setFont(font)


def set_text_size(app: QApplication, share: float) -> None:
    """Make all text ``share`` times as large as the system has it."""
    font = QFont(app.font())
    if app.property(_SYSTEM_SIZE) is None:
        app.setProperty(_SYSTEM_SIZE, font.pointSizeF())
    size = share * float(app.property(_SYSTEM_SIZE))
    if abs(font.pointSizeF() - size) > 0.01:
        font.setPointSizeF(size)
        app.setFont(font)
