"""Work on a volume shared by the processor's cores: compiled loops that release the interpreter, a part for each."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

__all__ = ["in_parts"]

Result = TypeVar("Result")


def in_parts(work: Callable[[int, int], Result], count: int, least: int) -> list[Result]:
    """Return ``work(first, end)`` for consecutive ranges that cover 0 ... ``count`` - 1, in their order.

    Results must not depend on where the ranges end: their number is that of the cores, and no range has fewer than
    ``least`` elements, so that short work starts no thread.

    Examples
    --------
    >>> sum(in_parts(lambda first, end: end - first, 10, 20))
    10
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    parts = max(1, min(cores, count // least))
    bounds = [count * part // parts for part in range(parts + 1)]
    if parts == 1:
        return [work(0, count)]
    with ThreadPoolExecutor(parts) as pool:
        return list(pool.map(work, bounds[:-1], bounds[1:]))
