"""Sizes that follow the size of text, which may be chosen while the window is open."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, QTimer
from PySide6.QtWidgets import QWidget

__all__ = ["sized_by_text"]


class _Listener(QObject):
    def __init__(self, widget: QWidget, size: Callable[[], object]) -> None:
        super().__init__(widget)
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(size)
        widget.installEventFilter(self)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:  # noqa: N802
        # Its children get the new font later, and ask for another layout then.
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.LayoutRequest):
            self._later.start()
        return False


def sized_by_text(widget: QWidget, size: Callable[[], object]) -> None:
    """Call ``size`` now, and whenever the text of a widget has got another size."""
    size()
    _Listener(widget, size)
