"""What the application runs on, as text that can be copied into a message."""

from __future__ import annotations

import importlib.metadata
import platform
import sys

from PySide6.QtCore import QLibraryInfo, qVersion
from PySide6.QtGui import QFontDatabase, QGuiApplication, QOffscreenSurface, QOpenGLContext
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from geofit import __version__
from geofit.gui.theme import missing_chinese

__all__ = ["SystemReport", "system_report"]

_PACKAGES = (
    "numpy", "scipy", "cadquery", "cadquery-ocp", "vtk", "pyvista", "pyvistaqt", "matplotlib", "shapely", "fpdf2",
)  # fmt: skip
_GL_VENDOR, _GL_RENDERER, _GL_VERSION = 0x1F00, 0x1F01, 0x1F02


def system_report() -> str:
    """Return versions, graphics, fonts and screens, a line each; no name of a person or machine."""
    app = QGuiApplication.instance()
    lines = [
        f"geofit {__version__}",
        f"Python {platform.python_version()} ({platform.machine()}), {platform.platform()}",
        f"Qt {qVersion()} on {QGuiApplication.platformName()}, build {QLibraryInfo.build()!s}",
        f"OpenGL: {opengl()}",
    ]
    for name in _PACKAGES:
        try:
            lines.append(f"{name} {importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            lines.append(f"{name}: not installed")
    for screen in QGuiApplication.screens():
        size = screen.geometry()
        lines.append(f"Screen {size.width()} x {size.height()}, scale {screen.devicePixelRatio():g}")
    chinese = QFontDatabase.families(QFontDatabase.WritingSystem.SimplifiedChinese)
    lines.append(f"Font: {QGuiApplication.font().family()}; Chinese: {', '.join(chinese[:4]) or 'NONE'}")
    if missing_chinese():
        lines.append(
            "  No font has Chinese characters: install one (Debian and Ubuntu: apt-get install fonts-noto-cjk)"
        )
    lines.append(f"Frozen application: {'yes' if getattr(sys, 'frozen', False) else 'no'}")
    assert app is not None
    return "\n".join(lines)


def opengl() -> str:
    """Return version, renderer and maker of the OpenGL that windows get here."""
    context, surface = QOpenGLContext(), QOffscreenSurface()
    surface.create()
    if not (context.create() and surface.isValid() and context.makeCurrent(surface)):
        return "none"
    functions = context.functions()
    words = [str(functions.glGetString(name)) for name in (_GL_VERSION, _GL_RENDERER, _GL_VENDOR)]
    context.doneCurrent()
    surface.destroy()
    return ", ".join(words)


class SystemReport(QDialog):
    """Shows the report, with a button that copies it."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("System report"))
        self.text = QPlainTextEdit(system_report())
        self.text.setReadOnly(True)
        self.text.setAccessibleName(self.windowTitle())
        copy = QPushButton(self.tr("&Copy"))
        copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(self.text.toPlainText()))
        buttons = QDialogButtonBox()
        buttons.addButton(copy, QDialogButtonBox.ButtonRole.ActionRole)
        close = buttons.addButton(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(self.text)
        layout.addWidget(buttons)
        # Now that it is in the dialog; else Enter would press the first button.
        close.setDefault(True)
        self.resize(620, 420)
