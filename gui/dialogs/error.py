"""What went wrong, what to do about it, and the details for whoever helps."""

from __future__ import annotations

import platform
import traceback

from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QSizePolicy,
    QStyle,
    QWidget,
)

from geofit import __version__
from geofit.data.errors import GeofitError, InputError
from geofit.gui.translate import bare, failure, translated

__all__ = ["ErrorDialog"]


class ErrorDialog(QDialog):
    """Reports a failure.

    ``title`` states what was being done. An error that geofit raises on purpose carries its own remedy; any other is a
    mistake in geofit, and the dialog asks to pass the details on.
    """

    def __init__(self, title: str, error: Exception, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("geofit"))
        self.details = _details(title, error)
        sign = QLabel()
        size = self.style().pixelMetric(QStyle.PixelMetric.PM_LargeIconSize)
        sign.setPixmap(self.style().standardIcon(QStyle.StandardPixmap.SP_MessageBoxWarning).pixmap(size))
        heading = QLabel(
            self.tr("{task} did not work.").format(task=title) if title else self.tr("That cannot be done now.")
        )
        font = heading.font()
        font.setBold(True)
        heading.setFont(font)
        heading.setWordWrap(True)
        self.message = QLabel(self._message(error))
        self.message.setWordWrap(True)
        self.message.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.message.setMinimumWidth(420)
        self.message.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.MinimumExpanding)
        self._text = QPlainTextEdit(self.details)
        self._text.setReadOnly(True)
        self._text.setMinimumSize(560, 180)
        self._text.hide()
        more = QPushButton(self.tr("&Details"))
        more.setCheckable(True)
        self._text.setAccessibleName(bare(more.text()))
        more.toggled.connect(self._show_details)
        copy = QPushButton(self.tr("&Copy details"))
        copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(self.details))
        buttons = QDialogButtonBox()
        buttons.addButton(more, QDialogButtonBox.ButtonRole.ActionRole)
        buttons.addButton(copy, QDialogButtonBox.ButtonRole.ActionRole)
        close = buttons.addButton(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        layout = QGridLayout(self)
        layout.setSizeConstraint(QGridLayout.SizeConstraint.SetMinAndMaxSize)
        layout.setHorizontalSpacing(12)
        layout.addWidget(sign, 0, 0, 2, 1, Qt.AlignmentFlag.AlignTop)
        layout.addWidget(heading, 0, 1)
        layout.addWidget(self.message, 1, 1)
        layout.addWidget(self._text, 2, 0, 1, 2)
        layout.addWidget(buttons, 3, 0, 1, 2)
        # Now that it is in the dialog; else Enter would press the first button.
        close.setDefault(True)

    def _message(self, error: Exception) -> str:
        if isinstance(error, InputError) and error.remedy:
            return f"{translated(error.fault)}\n\n{translated(error.remedy)}"
        if isinstance(error, GeofitError):
            return translated(error)
        if isinstance(error, OSError):
            return self.tr("{reason}\n\nCheck that the folder is there, can be written, and has room.").format(
                reason=failure(error)
            )
        if isinstance(error, MemoryError):
            return self.tr("There is not enough memory. Close other programs, or work with fewer points.")
        return self.tr(
            "This is a mistake in geofit, not in your data. Your work is still here: save it. Then copy the details "
            "and send them to whoever looks after geofit.\n\n{error}"
        ).format(error=failure(error))

    def _show_details(self, shown: bool) -> None:
        self._text.setVisible(shown)
        self.adjustSize()


def _details(title: str, error: Exception) -> str:
    head = f"geofit {__version__}, Python {platform.python_version()}, {platform.platform()}\n{title}\n\n"
    return head + "".join(traceback.format_exception(error))
