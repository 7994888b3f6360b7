"""Icons of the actions: line drawings beside this module, in the colour of the theme's text."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from PySide6.QtCore import QByteArray, QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QIcon, QImage, QPainter, QPalette, QPixmap
from PySide6.QtSvg import QSvgRenderer

__all__ = ["application_icon", "palette_icon"]

FOLDER = Path(__file__).with_name("icons")
#: Pixels, for tool bars and menus at 1x to 3x.
SIZES = (16, 24, 32, 48, 72)


def palette_icon(name: str, palette: QPalette | None = None) -> QIcon:
    """Return an icon in the text's colour of a palette; the application's, if none is given."""
    palette = palette or QGuiApplication.palette()
    drawn = QIcon()
    for mode, group in (
        (QIcon.Mode.Normal, QPalette.ColorGroup.Active),
        (QIcon.Mode.Disabled, QPalette.ColorGroup.Disabled),
    ):
        colour = palette.color(group, QPalette.ColorRole.ButtonText)
        for size in SIZES:
            drawn.addPixmap(_pixmap(name, size, colour), mode)
    return drawn


def application_icon() -> QIcon:
    """Return the icon of the windows."""
    drawn = QIcon()
    for size in (16, 32, 48, 64, 128, 256):
        drawn.addPixmap(_pixmap("geofit", size, QColor()))
    return drawn


def _pixmap(name: str, size: int, colour: QColor) -> QPixmap:
    return QPixmap.fromImage(_image(name, size, colour.name()))


# A window has some 240 of them, and the next window, in another language, the same. An image may outlive the
# application, unlike a pixmap.
@cache
def _image(name: str, size: int, colour: str) -> QImage:
    text = (FOLDER / f"{name}.svg").read_text(encoding="utf-8").replace("currentColor", colour)
    image = QImage(QSize(size, size), QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(Qt.GlobalColor.transparent)
    painter = QPainter(image)
    QSvgRenderer(QByteArray(text.encode())).render(painter)
    painter.end()
    return image
