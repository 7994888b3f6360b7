"""One thread for linear algebra: starting more costs longer than the products of small matrices."""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cache
from typing import Any

from threadpoolctl import ThreadpoolController

__all__ = ["one_thread"]


def one_thread() -> AbstractContextManager[Any]:
    """Return a context in which numpy and scipy use one thread: the last digits do not depend on the machine either."""
    limited: AbstractContextManager[Any] = _libraries().limit(limits=1)
    return limited


@cache
def _libraries() -> ThreadpoolController:
    """Find the libraries once: looking through what a process has loaded takes longer than many a check."""
    # scipy brings a library of its own, which has to be loaded to be found.
    import scipy.linalg  # noqa: F401

    return ThreadpoolController()
