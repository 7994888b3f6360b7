"""Threads: one for linear algebra, as starting more takes longer than small products; all for compiled loops."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from functools import cache
from typing import Any, TypeVar

from threadpoolctl import ThreadpoolController

__all__ = ["alongside", "one_thread", "side_by_side"]

T = TypeVar("T")

#: Rows that one thread works on at a time.
PART = 5_000


def one_thread() -> AbstractContextManager[Any]:
    """Return a context in which numpy and scipy use one thread: the last digits do not depend on the machine either."""
    limited: AbstractContextManager[Any] = _libraries().limit(limits=1)
    return limited


def side_by_side(work: Callable[[slice], None], n: int) -> None:
    """Call ``work`` for all parts of n rows, on all processors; what it calls must not hold the interpreter's lock."""
    parts = [slice(start, min(start + PART, n)) for start in range(0, n, PART)]
    if len(parts) <= 1 or (os.cpu_count() or 1) == 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(work, parts))


def alongside(work: Callable[[], T]) -> Callable[[], T]:
    """Start work on a thread of its own; return what waits for it and returns its result, or raises its error."""
    pool = ThreadPoolExecutor(1)
    waiting = pool.submit(work)
    pool.shutdown(wait=False)
    return waiting.result


@cache
def _libraries() -> ThreadpoolController:
    """Find the libraries once: looking through what a process has loaded takes longer than many a check."""
    # scipy brings a library of its own, which has to be loaded to be found.
    import scipy.linalg  # noqa: F401

    return ThreadpoolController()
