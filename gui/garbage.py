"""Garbage is collected in the window's thread alone.

Python collects cycles in whichever thread happens to allocate. Where that is a task's, the windows of these cycles die
outside the thread that they belong to, and Qt crashes then, or later.
"""

from __future__ import annotations

import gc

from PySide6.QtCore import QObject, QTimer

__all__ = ["Collector", "collect_here"]

#: Milliseconds between two looks at how much has gathered.
PAUSE = 500


class Collector(QObject):
    """Collects, in its own thread, as often as Python itself would ask for it."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        gc.disable()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.look)
        self._timer.start(PAUSE)

    def look(self) -> None:
        """Collect the oldest generation whose count is beyond its threshold."""
        counts, thresholds = gc.get_count(), gc.get_threshold()
        for generation in (2, 1, 0):
            if counts[generation] > thresholds[generation]:
                gc.collect(generation)
                return


def collect_here(application: QObject) -> Collector:
    """Collect garbage in this thread, that of the application, from now on."""
    return application.findChild(Collector) or Collector(application)
