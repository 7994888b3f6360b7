"""Handles in the scene that are dragged: of the section plane and of the clip box."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF

from geofit.gui.view3d.projector import Projector

__all__ = ["Handle", "Handles"]

Floats = NDArray[np.float64]

#: How far from the pointer a handle may be, logical pixels.
REACH = 11.0


@dataclass(frozen=True, eq=False)
class Handle:
    """A handle at ``xyz`` (map coordinates): moved on its level, or along ``way`` (3,); ``moved`` hears where to."""

    xyz: Floats
    moved: Callable[[Floats], None]
    way: Floats | None = None


class Handles:
    """The handles of the scene; ``places`` gives them anew at every press."""

    def __init__(
        self, places: Callable[[], list[Handle]], view: Callable[[], Projector], done: Callable[[], None]
    ) -> None:
        self._places, self._view, self._done = places, view, done
        self._held: Handle | None = None

    def at(self, pos: QPointF) -> Handle | None:
        """Return the handle under the pointer."""
        handles = self._places()
        if not handles:
            return None
        seen = self._view().screen(np.array([handle.xyz for handle in handles]))
        away = np.nan_to_num(np.hypot(seen[:, 0] - pos.x(), seen[:, 1] - pos.y()), nan=np.inf)
        return handles[int(away.argmin())] if away.min() <= REACH else None

    def press(self, pos: QPointF) -> bool:
        """Take the handle under the pointer; False if there is none."""
        self._held = self.at(pos)
        return self._held is not None

    def drag(self, pos: QPointF) -> None:
        """Move the handle that is held."""
        if self._held is None:
            return
        view, handle = self._view(), self._held
        if handle.way is None:
            target = view.on_level(pos.x(), pos.y(), float(handle.xyz[2]))
        else:
            share = view.along(pos.x(), pos.y(), handle.xyz, handle.way)
            target = None if share is None else handle.xyz + share * handle.way
        if target is not None:
            handle.moved(target)

    def release(self) -> None:
        """Let go."""
        self._held = None
        self._done()
