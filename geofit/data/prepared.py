"""What is prepared from an object that never changes: made once, and kept as long as the object lives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self, TypeVar

__all__ = ["Preparing"]

T = TypeVar("T")


class Preparing:
    """An object that keeps what was prepared from it."""

    def prepared(self, make: Callable[[Self], T]) -> T:
        """Return ``make(self)``, made at the first call and kept."""
        kept: dict[Any, Any] = self.__dict__.setdefault("_prepared", {})
        if make not in kept:
            kept[make] = make(self)
        result: T = kept[make]
        return result

    def __getstate__(self) -> dict[str, Any]:
        """Pickle the object without what was prepared from it."""
        return {name: value for name, value in self.__dict__.items() if name != "_prepared"}
