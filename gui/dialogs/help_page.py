"""A page of the documentation in a window, at one of its headings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QImage, QTextBlock, QTextCursor, QTextDocument
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QPushButton,
    QStyle,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.help_places import PAGES, anchor

__all__ = ["HelpPage"]

#: Pixels around the text.
_MARGIN = 16


class HelpPage(QDialog):
    """Shows a page next to what it explains; also over a dialog that lets nothing else be used."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Help"))
        self.text = _Browser()
        self.text.setAccessibleName(self.tr("Help"))
        back, forward = QPushButton(self.tr("&Back")), QPushButton(self.tr("&Forward"))
        for button, able, go in (
            (back, self.text.backwardAvailable, self.text.backward),
            (forward, self.text.forwardAvailable, self.text.forward),
        ):
            button.setEnabled(False)
            button.setAutoDefault(False)
            able.connect(button.setEnabled)
            button.clicked.connect(go)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        row = QHBoxLayout()
        row.addWidget(back)
        row.addWidget(forward)
        row.addWidget(buttons, 1)
        layout = QVBoxLayout(self)
        layout.addWidget(self.text)
        layout.addLayout(row)
        available = self.screen().availableSize()
        self.resize(min(860, available.width()), min(720, round(0.9 * available.height())))
        self.text.setFocus()

    @property
    def place(self) -> str:
        """Page and anchor that were opened last, as in :mod:`geofit.gui.help_places`."""
        url = self.text.source()
        return url.fileName() + (f"#{url.fragment()}" if url.hasFragment() else "")

    def open_place(self, place: str) -> None:
        """Show a page at a heading; the window comes to the front."""
        name, _, fragment = place.partition("#")
        url = QUrl.fromLocalFile(str(PAGES / name))
        if fragment:
            url.setFragment(fragment)
        self.show()
        self.raise_()
        self.activateWindow()
        self.text.setSource(url)
        # The same place once more does not change the source, but the text may have been scrolled.
        self.text.show_heading()


class _Browser(QTextBrowser):
    """Text whose headings links can name: Qt gives headings of Markdown no anchors."""

    def __init__(self) -> None:
        super().__init__()
        self.setOpenExternalLinks(True)
        self.document().setDocumentMargin(_MARGIN)
        self.sourceChanged.connect(self.show_heading)

    def show_heading(self, _: object = None) -> None:
        """Put the heading that the source names at the top."""
        wanted = self.source().fragment()
        block = next((b for b in _headings(self.document()) if anchor(b.text()) == wanted), None)
        if block is None:
            return
        self.setTextCursor(QTextCursor(block))
        top = self.document().documentLayout().blockBoundingRect(block).top()
        self.verticalScrollBar().setValue(round(top))

    def loadResource(self, kind: int, name: QUrl | str) -> Any:  # noqa: N802
        """Load what a page names; pictures no wider than the text."""
        loaded = super().loadResource(kind, name)
        if kind == QTextDocument.ResourceType.ImageResource.value:
            image = QImage.fromData(loaded) if loaded is not None else QImage()
            # The bar comes when the page is longer than the window, after its pictures.
            bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent, None, self)
            width = self.contentsRect().width() - bar - 2 * _MARGIN
            if image.width() > width > 0:
                return image.scaledToWidth(width, Qt.TransformationMode.SmoothTransformation)
            return image
        return loaded


def _headings(document: QTextDocument) -> Iterator[QTextBlock]:
    block = document.begin()
    while block.isValid():
        if block.blockFormat().headingLevel():
            yield block
        block = block.next()
