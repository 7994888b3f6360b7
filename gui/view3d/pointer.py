"""What the pointer means in the scene: picking, measuring, the place under it, and the ring about what was chosen."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, QTimer, Signal

from geofit.gui.lengths import in_lengths
from geofit.gui.translate import translated
from geofit.gui.view3d.canvas import Canvas
from geofit.gui.view3d.contents import Contents
from geofit.gui.view3d.layer_names import word
from geofit.gui.view3d.overlay import Ring
from geofit.gui.view3d.picking import Hit, Sights, nearest_target, nearest_way
from geofit.gui.view3d.stage import Stage
from geofit.gui.view3d.tools import ClipBox, Measure
from geofit.project.provenance import Row

__all__ = ["Pointer"]

Floats = NDArray[np.float64]

#: The pointer's place is found at most so often, milliseconds.
OFTEN = 60
#: What the pointer rests on is named after so long, milliseconds.
REST = 350


def _nothing() -> Ring | None:
    return None


class Pointer(QObject):
    """Listens to the canvas's mouse; ``changed`` signals that the ring or the measure is another one.

    ``rested(hit, pos)`` and ``asked(hit, pos)`` carry what the pointer rests on, and what the right button asked of.
    """

    point_picked = Signal(str, object)
    control_picked = Signal(str, str, int, int)
    hole_picked = Signal(str)
    dip_picked = Signal(int)
    moved = Signal(float, float, float)
    measured = Signal(str)
    changed = Signal()
    rested = Signal(object, QPointF)
    asked = Signal(object, QPointF)

    def __init__(self, canvas: Canvas, stage: Stage, contents: Contents, clip: ClipBox, parent: QObject) -> None:
        super().__init__(parent)
        self._canvas, self._stage, self._contents, self._clip = canvas, stage, contents, clip
        self.measure, self.measuring = Measure(), False
        self.ring: Ring | None = None
        # Makes the ring anew when surfaces change; None where its place is gone.
        self._about: Callable[[], Ring | None] = _nothing
        self._sights, self._at = Sights(), QPointF()
        self.timer = QTimer(self, interval=OFTEN, singleShot=True)
        self.timer.timeout.connect(self._tell)
        canvas.clicked.connect(self._click)
        canvas.double_clicked.connect(self._turn_about)
        canvas.hovered.connect(self._hover)
        canvas.left.connect(self._leave)
        canvas.asked.connect(lambda pos: self.asked.emit(self.under(pos), pos))
        self.resting = QTimer(self, interval=REST, singleShot=True)
        self.resting.timeout.connect(lambda: self.rested.emit(self.under(self._at), self._at))

    def pick(self, column: float, row: float) -> Hit | None:
        """Return what a click there means: a control point or a point first, then a hole."""
        view, items = self._canvas.projector(), list(self._stage.items())
        return nearest_target(items, view, column, row, self._clip.box) or nearest_way(items, view, column, row)

    def under(self, pos: QPointF) -> Hit | None:
        """Return what lies at a place of the view: a point or a hole first, then the surface in front."""
        found = self.pick(pos.x(), pos.y())
        if found is not None:
            return found
        return self._sights.first(self._stage.items(), self._canvas.projector(), pos.x(), pos.y(), self._clip.box)

    def place_at(self, column: float, row: float) -> Floats | None:
        """Return the map coordinates of the surface under a pixel; None beside all."""
        hit = self._sights.first(self._stage.items(), self._canvas.projector(), column, row, self._clip.box)
        return None if hit is None else hit.xyz

    def get_ready(self) -> None:
        """Prepare to find the surfaces that are seen, so that the first question is answered as fast as the next."""
        self._sights.prepare(item for _, item in self._stage.items())

    def choose(self, horizon: str, row: Row | None) -> None:
        """Put a ring about a point; it stays there when other rows come or go. None takes it away."""
        self._about = _nothing if row is None else partial(self._about_point, horizon, row)
        self.renew()

    def choose_control(self, horizon: str, patch: str, i: int, j: int) -> None:
        """Put a mark on a control point; it follows the point when the surface changes."""
        self._about = partial(self._about_control, horizon, patch, i, j)
        self.renew()

    def let_go(self) -> None:
        """Take the mark off a control point; any other ring stays."""
        if self.ring is not None and self.ring.solid:
            self.choose("", None)

    def surround(self, xyz: Floats, text: str) -> None:
        """Put a ring about a place."""
        ring = Ring(xyz, text)
        self._about = lambda: ring
        self.renew()

    def renew(self) -> None:
        """Write the figures of what was chosen anew: it may have another surface."""
        self.ring = self._about()
        self.changed.emit()

    def _about_point(self, horizon: str, row: Row) -> Ring | None:
        points = self._contents.points.get(horizon)
        index = None if points is None else row.find(points)
        if points is None or index is None:
            return None
        residuals = self._contents.residuals(horizon)
        where = points.hole[index] or points.section[index]
        text = f"{word(str(points.kind[index]))} {where}".strip() + f" · {points.xyz[index, 2]:.2f} m"
        if residuals is not None and np.isfinite(residuals[index]):
            text += f" · d {residuals[index]:+.3f} m".replace("-", "−")
        return Ring(points.xyz[index], in_lengths(text))

    def _about_control(self, horizon: str, name: str, i: int, j: int) -> Ring | None:
        surface = self._contents.surfaces.get(horizon)
        patches = () if surface is None else surface.patches
        patch = next((one for one in patches if one.name == name), None)
        if surface is None or patch is None or i >= patch.control.shape[0] or j >= patch.control.shape[1]:
            return None
        place = patch.control[i, j] + surface.origin
        return Ring(place, in_lengths(f"{translated(name)} [{i}, {j}] · {place[2]:.2f} m"), solid=True)

    def set_measuring(self, on: bool) -> None:
        """Let clicks measure, or pick again."""
        self.measuring = on
        self.measure.places.clear()
        self.changed.emit()

    def measure_text(self) -> str:
        """Return the measure in words; empty before its second place."""
        return in_lengths(
            self.measure.text(
                self.tr("{distance} m\nhorizontal {flat} m · Δz {rise} m\nazimuth {azimuth}° · dip {dip}°")
            )
        )

    def clear(self) -> None:
        """Forget ring and measure."""
        self.measure.places.clear()
        self.choose("", None)

    def _click(self, pos: QPointF) -> None:
        hit = self.pick(pos.x(), pos.y())
        if self.measuring:
            self._take(hit.xyz if hit is not None else self.place_at(pos.x(), pos.y()))
        elif hit is None:
            return
        elif hit.layer.kind == "points":
            row = Row.of(self._contents.points[hit.layer.horizon], int(hit.which))
            self.choose(hit.layer.horizon, row)
            self.point_picked.emit(hit.layer.horizon, row)
        elif hit.layer.kind == "control":
            patch, i, j = self._contents.control[hit.layer.horizon][hit.which]
            self.choose_control(hit.layer.horizon, patch, i, j)
            self.control_picked.emit(hit.layer.horizon, patch, i, j)
        elif hit.layer.kind == "dips":
            self.dip_picked.emit(int(hit.which))
        else:
            self.surround(hit.xyz, str(hit.which))
            self.hole_picked.emit(hit.which)

    def _take(self, place: Floats | None) -> None:
        if place is not None:
            self.measure.add(place)
            self.changed.emit()
            if text := self.measure_text():
                self.measured.emit(text)

    def _turn_about(self, pos: QPointF) -> None:
        place = self.place_at(pos.x(), pos.y())
        if place is not None:
            canvas = self._canvas
            canvas.fly(replace(canvas.target, centre=(place - canvas.origin) * (1.0, 1.0, canvas.stretch)))

    def _hover(self, pos: QPointF) -> None:
        self._at = pos
        if not self.timer.isActive():
            self.timer.start()
        self.resting.start()

    def _leave(self) -> None:
        self.timer.stop()
        self.resting.stop()
        self.moved.emit(math.nan, math.nan, math.nan)

    def _tell(self) -> None:
        place = self.place_at(self._at.x(), self._at.y())
        self.moved.emit(*((math.nan,) * 3 if place is None else place.tolist()))
