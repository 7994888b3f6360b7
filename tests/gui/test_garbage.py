"""Unreferenced widgets are destroyed in the window's thread, not in a worker thread."""

from __future__ import annotations

import gc
import threading
import weakref

from PySide6.QtCore import QObject

from geofit.gui import worker
from geofit.gui.garbage import Collector, collect_here


class Held(QObject):
    """An object in a reference cycle, like most dialogs, whose signals refer to their own methods."""

    def __init__(self, died):
        super().__init__()
        self.me = self
        weakref.finalize(self, lambda: died.append(threading.get_ident()))


def allocate(*, progress):
    """Allocate far more objects than the threshold of Python's collector."""
    for _ in range(200):
        kept = [[] for _ in range(2000)]
    return len(kept)


def test_a_worker_thread_destroys_no_widget(qtbot, qapp):
    died, done = [], []
    for _ in range(20):
        Held(died)
    worker.run(qapp, allocate, on_done=done.append)
    qtbot.waitUntil(lambda: bool(done), timeout=20_000)
    assert done == [2000]
    gc.collect()
    assert died == 20 * [threading.get_ident()]


def test_every_generation_is_collected(qtbot, qapp):
    collector = collect_here(qapp)
    assert not gc.isenabled()
    assert collect_here(qapp) is collector
    assert len(qapp.findChildren(Collector)) == 1
    gc.collect()
    before = [generation["collections"] for generation in gc.get_stats()]
    kept = []
    for _ in range(12 * 12):
        kept.append([[] for _ in range(1000)])
        collector.collect()
    after = [generation["collections"] for generation in gc.get_stats()]
    assert len(kept) == 144
    assert all(new > old for new, old in zip(after, before, strict=True))
