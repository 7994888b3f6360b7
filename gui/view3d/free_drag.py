"""A hand that drags freely: in the plane of the view, along one axis, or as far as is typed. No Qt widget."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, Qt

from geofit.gui.view3d.projector import Projector

__all__ = ["FreeDrag"]

Floats = NDArray[np.float64]

#: Axes that a key locks the drag to, and how they are written.
_AXES = {
    Qt.Key.Key_X: ("X", np.array([1.0, 0.0, 0.0])),
    Qt.Key.Key_Y: ("Y", np.array([0.0, 1.0, 0.0])),
    Qt.Key.Key_Z: ("Z", np.array([0.0, 0.0, 1.0])),
}
#: What may be typed: a number that is not finished yet.
_NUMBER = re.compile(r"[-−]?\d{0,5}(?:[.,]\d{0,3})?")


@dataclass(eq=False)
class FreeDrag:
    """One drag of something at ``start`` that stands still at ``rest``; ``normal`` is its own unit vector.

    All in map coordinates. A key chooses an axis, pressed again frees it; Shift goes along the normal; figures give
    the length of the move from ``rest``, metres, along the axis, or on in the direction that it has.
    """

    start: Floats
    rest: Floats
    normal: Floats
    axis: Floats | None = None
    name: str = ""
    typed: str = ""
    _reached: Floats | None = None

    def key(self, key: int, text: str) -> bool:
        """Take a key; False where it means nothing to a drag."""
        if (found := _AXES.get(Qt.Key(key))) is not None:
            name, axis = found
            self.name, self.axis = ("", None) if self.name == name else (name, axis)
        elif key == Qt.Key.Key_Backspace and self.typed:
            self.typed = self.typed[:-1]
        elif text and _NUMBER.fullmatch(self.typed + text):
            self.typed += text
        else:
            return False
        return True

    def target(self, view: Projector, by: tuple[float, float], straight: bool) -> Floats | None:
        """Return where the hand has pulled it that has moved ``by`` pixels; ``straight``: along the normal."""
        way = self.axis if self.axis is not None else self.normal if straight else None
        if (length := self._length()) is not None:
            return self.rest + length * (way if way is not None else self._direction())
        if way is None:
            self._reached = view.in_picture_plane(self.start, by)
        else:
            share = view.pulled(self.start, way, by)
            # Along an axis from where it rests: what it moved before in another direction is given up.
            along = self.rest + way * float((self.start - self.rest) @ way)
            self._reached = None if share is None else along + share * way
        return self._reached

    @property
    def words(self) -> str:
        """What holds the drag and what was typed, "" for neither."""
        locked = QCoreApplication.translate("FreeDrag", "along {axis}").format(axis=self.name) if self.name else ""
        return " · ".join(word for word in (locked, f"{self.typed}▏m" if self.typed else "") if word)

    def _length(self) -> float | None:
        try:
            return float(self.typed.replace("−", "-").replace(",", "."))
        except ValueError:
            return None

    def _direction(self) -> Floats:
        """Return the direction of the move so far; the normal before there is one."""
        move = np.zeros(3) if self._reached is None else self._reached - self.rest
        size = float(np.linalg.norm(move))
        return move / size if size > 1e-9 else self.normal
