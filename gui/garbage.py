"""Cyclic garbage is collected in the window's thread only.

Python collects reference cycles in whichever thread allocates. A collection in a worker thread destroys unreferenced
widgets outside the thread that owns them, and Qt crashes immediately or later.
"""

from __future__ import annotations

import gc

from PySide6.QtCore import QObject, QTimer

__all__ = ["Collector", "collect_here"]

#: Milliseconds between two checks of the collector's counts.
PAUSE = 500


class Collector(QObject):
    """Replaces Python's automatic collection by a timer in the thread of its parent."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        gc.disable()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.collect)
        self._timer.start(PAUSE)

    def collect(self) -> None:
        """Collect the oldest generation whose count exceeds its threshold."""
        counts, thresholds = gc.get_count(), gc.get_threshold()
        for generation in (2, 1, 0):
            if counts[generation] > thresholds[generation]:
                gc.collect(generation)
                return


def collect_here(application: QObject) -> Collector:
    """Collect garbage in the application's thread only, from now on."""
    return application.findChild(Collector) or Collector(application)
