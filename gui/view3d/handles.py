"""Handles in the scene that are dragged: of the section plane, of the clip box, and of a control point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF

from geofit.gui.view3d.free_drag import FreeDrag
from geofit.gui.view3d.projector import Projector

__all__ = ["Handle", "Handles"]

Floats = NDArray[np.float64]

#: How far from the pointer a handle may be, logical pixels.
REACH = 11.0
#: A press that moves less than this moves no handle, logical pixels.
CLICK = 4.0


@dataclass(frozen=True, eq=False)
class Handle:
    """A handle at ``xyz`` (map coordinates): moved on its level, or along ``way`` (3,); ``moved`` hears where to.

    One with a place of ``rest`` moves freely, and ``way`` is its normal. ``dropped`` hears that it was let go. A handle
    that is not ``drawn`` has a sign of its own.
    """

    xyz: Floats
    moved: Callable[[Floats], None]
    way: Floats | None = None
    dropped: Callable[[], None] = lambda: None
    drawn: bool = True
    rest: Floats | None = None


class Handles:
    """The handles of the scene; ``places`` gives them anew at every press."""

    def __init__(self, places: Callable[[], list[Handle]], view: Callable[[], Projector]) -> None:
        self._places, self._view = places, view
        self._held: Handle | None = None
        self._pressed, self._at, self._begun, self._straight = QPointF(), QPointF(), False, False
        self.free: FreeDrag | None = None

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
        self._held, self._pressed, self._at, self._begun = self.at(pos), pos, pos, False
        handle = self._held
        if handle is not None and handle.rest is not None and handle.way is not None:
            self.free = FreeDrag(handle.xyz, handle.rest, handle.way)
        return self._held is not None

    def drag(self, pos: QPointF, straight: bool = False) -> None:
        """Move the handle that is held; ``straight``: along its normal."""
        self._at, self._straight = pos, straight
        self._begun |= (pos - self._pressed).manhattanLength() >= CLICK
        if self._held is None or not self._begun:
            return
        view, handle = self._view(), self._held
        by = pos - self._pressed
        if self.free is not None:
            target = self.free.target(view, (by.x(), by.y()), straight)
        elif handle.way is None:
            target = view.on_level(pos.x(), pos.y(), float(handle.xyz[2]))
        else:
            share = view.pulled(handle.xyz, handle.way, (by.x(), by.y()))
            target = None if share is None else handle.xyz + share * handle.way
        if target is not None:
            handle.moved(target)

    def key(self, key: int, text: str) -> bool:
        """Take a key for the drag that goes on: an axis, or a figure of its length; False where it means neither."""
        if self.free is None or not self.free.key(key, text):
            return False
        self._begun = True
        self.drag(self._at, self._straight)
        return True

    def release(self) -> None:
        """Let go."""
        held, self._held, self.free = self._held, None, None
        if held is not None and self._begun:
            held.dropped()

    def cancel(self) -> None:
        """Put the handle that is held back to where it was, and let go."""
        if self._held is not None:
            self._held.moved(self._held.xyz)
            self.release()
