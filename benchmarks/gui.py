"""The window while it works: from Fit to the drawn surface, how long it does not answer, and memory over refits.

    xvfb-run -s "-screen 0 1600x1000x24" python benchmarks/gui.py [--refits 200]

Fits a horizon of 597 points of the sample site again and again, each time with another tolerance, so that nothing
comes from the shelf. Prints the seconds from Fit until the new surface is drawn, the longest time that the window's
thread was away from its events, and how the resident memory of the window grows after the first refits. With
``--panel section`` that panel stands in front and is drawn anew each time. Linux only.
"""

from __future__ import annotations

import argparse
import gc
import os
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

from PySide6.QtCore import QCoreApplication, QEvent, QEventLoop, QTimer

from geofit.gui.desktop import Desktop
from geofit.gui.worker import warm
from geofit.project.building import get_ready
from geofit.sample import write_site

HORIZON = "T2-T1"
#: Refits before memory counts: caches fill, and the shelf of spare surfaces.
WARM = 40
#: The timer that listens for the window's thread, milliseconds.
BEAT = 5


class Watch:
    """Hears how long the window's thread is away from its events."""

    def __init__(self) -> None:
        self.longest, self._last = 0.0, time.perf_counter()
        self._timer = QTimer(interval=BEAT)
        self._timer.timeout.connect(self._beat)
        self._timer.start()

    def _beat(self) -> None:
        now = time.perf_counter()
        self.longest = max(self.longest, now - self._last - BEAT / 1000)
        self._last = now

    def take(self) -> float:
        """Return the longest absence since the last call, seconds."""
        self._beat()
        longest, self.longest = self.longest, 0.0
        return longest


def resident() -> float:
    """Return the resident memory of this process, MB."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def resolve_conflicts(desktop: Desktop) -> None:
    """Handle events until nothing runs and everything is shown."""
    window = desktop.window
    while window.activity.busy or window.showing.drawing.busy:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 10)
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    for _ in range(3):
        QCoreApplication.processEvents()


def refit(desktop: Desktop, epsilon: float) -> float:
    """Fit once; return the seconds until the surface is drawn."""
    window, document = desktop.window, desktop.session.document
    window.fitting.set_settings(HORIZON, replace(document.settings(HORIZON), epsilon=epsilon))
    resolve_conflicts(desktop)
    began = time.perf_counter()
    window.fitting.fit(HORIZON)
    resolve_conflicts(desktop)
    return time.perf_counter() - began


def main() -> None:
    """Run the measurements."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--refits", type=int, default=200)
    parser.add_argument("--panel", default="residuals", help="the panel in front, as the View menu's names")
    asked = parser.parse_args()
    refits = asked.refits
    with tempfile.TemporaryDirectory() as folder:
        # Not the windows as their last user left them.
        os.environ.update(dict.fromkeys(("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"), folder))
        write_site(folder)
        desktop = Desktop()
        window = desktop.window
        window.show()
        for _ in range(2):
            warm(get_ready)
        window.files.open(Path(folder) / "site.toml")
        resolve_conflicts(desktop)
        desktop.session.document.select(HORIZON)
        window.panels.reveal(asked.panel)
        refit(desktop, 0.49)
        watch = Watch()
        taken, away, memory = [], [], []
        for k in range(refits):
            watch.take()
            taken.append(refit(desktop, 0.5 + 0.001 * k))
            away.append(watch.take())
            gc.collect()
            memory.append(resident())
            if k in {0, WARM} or (k + 1) % 40 == 0:
                print(f"refit {k + 1:4}: {memory[-1]:7.1f} MB", flush=True)
        print(f"Fit to drawn surface: median {median(taken):.2f} s, longest {max(taken):.2f} s")
        print(f"Window away from its events: median {1000 * median(away):.0f} ms, longest {1000 * max(away):.0f} ms")
        if refits > WARM:
            grown = memory[-1] - memory[WARM]
            each = 1000 * grown / (refits - WARM)
            print(f"Memory from refit {WARM + 1} to {refits}: {grown:+.1f} MB ({each:+.0f} kB each)")
        window.leave_without_asking()
        desktop.session.end()


if __name__ == "__main__":
    main()
