"""A signal for plain Python objects: those who listen are called in the order in which they asked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, ParamSpec

__all__ = ["Signal"]

P = ParamSpec("P")


class Signal(Generic[P]):
    """What an object tells to anybody who listens; it knows nothing of threads and calls in the caller's one.

    Examples
    --------
    >>> renamed: Signal[[str]] = Signal()
    >>> heard = []
    >>> renamed.connect(heard.append)
    >>> renamed.emit("dam")
    >>> heard
    ['dam']
    """

    def __init__(self) -> None:
        self._listeners: list[Callable[P, object]] = []

    def connect(self, listener: Callable[P, object]) -> None:
        """Call ``listener`` from now on."""
        self._listeners.append(listener)

    def disconnect(self, listener: Callable[P, object]) -> None:
        """Call ``listener`` no more; ValueError if it never asked."""
        self._listeners.remove(listener)

    def emit(self, *args: P.args, **kwargs: P.kwargs) -> None:
        """Call every listener."""
        for listener in tuple(self._listeners):
            listener(*args, **kwargs)
