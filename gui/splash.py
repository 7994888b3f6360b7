"""The first picture: a small window with the application's name and what it is doing, before the heavy parts load."""

from __future__ import annotations

import sys

from PySide6.QtCore import QCoreApplication, QRectF, Qt
from PySide6.QtGui import QColor, QGuiApplication, QPainter, QPixmap
from PySide6.QtWidgets import QApplication, QSplashScreen, QWidget

from geofit import __version__
from geofit.gui.garbage import collect_here
from geofit.gui.icons import application_icon

__all__ = ["Splash", "application"]

#: Logical pixels: the picture, its icon, and the height of the bar at its foot.
WIDTH, HEIGHT, ICON, BAR = 420, 220, 72, 4
PAPER, TEXT, QUIET, ACCENT = "#f3f5f7", "#1c2733", "#5d6b7a", "#0b5c8a"


def application() -> QApplication:
    """Return Qt's application, made with its names on the first call."""
    QCoreApplication.setOrganizationName("geofit")
    QCoreApplication.setApplicationName("geofit")
    QCoreApplication.setApplicationVersion(__version__)
    if QApplication.instance() is None:
        QGuiApplication.setHighDpiScaleFactorRoundingPolicy(Qt.HighDpiScaleFactorRoundingPolicy.PassThrough)
    app = QApplication.instance() or QApplication(sys.argv[:1])
    assert isinstance(app, QApplication)
    collect_here(app)
    return app


class Splash(QSplashScreen):
    """Shows how far the start is; ``tell(text, share)`` from 0 to 1."""

    def __init__(self) -> None:
        self.text, self.share = "", 0.0
        super().__init__(_picture())
        self.setWindowTitle("geofit")

    def tell(self, text: str, share: float) -> None:
        """Say what is being done, and paint it at once."""
        self.text, self.share = text, share
        self.repaint()
        QApplication.processEvents()

    def close_for(self, window: QWidget) -> None:
        """Go as soon as a window can be seen."""
        self.tell(self.text, 1.0)
        self.finish(window)
        self.deleteLater()

    def drawContents(self, painter: QPainter) -> None:  # noqa: N802
        """Write what is being done, over a bar as long as the share that is done."""
        painter.setPen(QColor(QUIET))
        painter.drawText(QRectF(24, HEIGHT - 52, WIDTH - 48, 24), Qt.AlignmentFlag.AlignLeft, self.text)
        painter.fillRect(QRectF(0, HEIGHT - BAR, WIDTH * self.share, BAR), QColor(ACCENT))


def _picture() -> QPixmap:
    ratio = QGuiApplication.primaryScreen().devicePixelRatio()
    pixmap = QPixmap(round(WIDTH * ratio), round(HEIGHT * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(QColor(PAPER))
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    application_icon().paint(painter, 24, 40, ICON, ICON)
    font = painter.font()
    font.setPointSizeF(26)
    font.setBold(True)
    painter.setFont(font)
    painter.setPen(QColor(TEXT))
    painter.drawText(QRectF(24 + ICON + 20, 40, 280, 44), Qt.AlignmentFlag.AlignVCenter, "geofit")
    font.setPointSizeF(10)
    font.setBold(False)
    painter.setFont(font)
    painter.setPen(QColor(QUIET))
    painter.drawText(QRectF(24 + ICON + 20, 84, 280, 24), Qt.AlignmentFlag.AlignVCenter, __version__)
    painter.end()
    return pixmap
