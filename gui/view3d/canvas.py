"""The VTK surface inside the window: one render a frame, a turntable under the mouse, less detail while it moves."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QWidget
from pyvistaqt import QtInteractor
from vtkmodules.vtkRenderingCore import vtkLight

from geofit.gui.view3d.camera import Viewpoint, viewpoint_between
from geofit.gui.view3d.mouse import Scheme, drag_of
from geofit.gui.view3d.projector import Projector

__all__ = ["Canvas"]

Floats = NDArray[np.float64]

#: The full detail comes back when the viewpoint has rested so long, milliseconds.
REST = 150
#: A flight to another place takes so long, seconds; a frame of it is asked for every so many milliseconds.
FLIGHT, FRAME = 0.35, 15
#: Degrees a pixel of dragging, share of the distance a notch of the wheel.
TURN, NOTCH = 0.35, 1.2
#: Pixels of a drag that are one notch of the wheel.
DRAG = 18.0
#: While the viewpoint moves, a frame that takes longer than SLOW is followed by one with half, then a third of the
#: pixels a
#: side; below QUICK they come back. Seconds.
SLOW, QUICK, LEAST = 0.022, 0.006, 3
#: Every so many frames one is timed to its end; the others let Qt write while OpenGL still draws.
TIMED = 4
#: A press that moves less than this is a click, logical pixels.
CLICK = 4.0

_KEYS = {
    Qt.Key.Key_Left: (-5.0, 0.0),
    Qt.Key.Key_Right: (5.0, 0.0),
    Qt.Key.Key_Up: (0.0, 5.0),
    Qt.Key.Key_Down: (0.0, -5.0),
}


class Canvas(QtInteractor):
    """A render window whose camera is an :class:`Viewpoint`.

    Left drag turns, middle or right drag (or Shift with left) moves sideways, the wheel comes nearer to what is under
    the pointer. ``clicked``, ``asked`` (the right button)
    and ``hovered`` tell the pointer's place in logical pixels. ``handle``, if set, is asked
    first: ``press(pos) -> bool``, then ``drag(pos, shift)`` and ``key(key, text)``, and ``release()``, which Enter
    does, too, or ``cancel()`` where Escape is pressed.
    ``prepare`` is told of every frame before it is drawn: how it is seen, and how many pixels it has.
    """

    clicked = Signal(QPointF)
    double_clicked = Signal(QPointF)
    hovered = Signal(QPointF)
    asked = Signal(QPointF)
    left = Signal()
    viewpoint_changed = Signal()
    detail_changed = Signal(bool)
    pixels_changed = Signal(float)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, auto_update=False, multi_samples=0, lighting="none")
        self.setAcceptDrops(False)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.viewpoint = Viewpoint(np.zeros(3), 212.0, 32.0, 1000.0)
        self.origin: Floats = np.zeros(3)
        self.stretch = 1.0
        self.full = True
        self.frames = 0
        self.shrink = 1
        self.handle: Any = None
        self.prepare: Callable[[Projector, int], None] = lambda view, pixels: None
        self._held: str | None = None
        self.scheme: Scheme = "geofit"
        self._pressed = self._last = QPointF()
        self._still = QTimer(self, interval=REST, singleShot=True)
        self._still.timeout.connect(self.rest)
        self._fly = QTimer(self, interval=FRAME)
        self._fly.timeout.connect(self._step)
        self._from, self._to, self._began = self.viewpoint, self.viewpoint, 0.0
        # VTK would render at every event and Qt once more to show it: here only paintGL renders.
        self.ren_win.GetInteractor().EnableRenderOff()
        self._lights()

    def _lights(self) -> None:
        # The sun of a hill-shaded map is in the north-west; a light at the viewpoint lifts the shadows.
        sun, lamp = vtkLight(), vtkLight()
        sun.SetLightTypeToSceneLight()
        sun.SetPosition(-1.0, 0.9, 1.1)
        sun.SetFocalPoint(0.0, 0.0, 0.0)
        sun.SetIntensity(0.56)
        lamp.SetLightTypeToHeadlight()
        lamp.SetIntensity(0.52)
        for light in (sun, lamp):
            self.renderer.AddLight(light)

    # Rendering -----------------------------------------------------------------------------------------------

    def render(self) -> None:  # type: ignore[override]
        """Ask for one render; many asked for at once are one."""
        self.update()

    def Render(self) -> None:  # noqa: N802 - VTK's name
        """Ask for one render."""
        self.update()

    def paintGL(self) -> None:  # noqa: N802 - Qt's name
        """Render into Qt's framebuffer."""
        interactor = self.ren_win.GetInteractor() if self.ren_win is not None else None
        if interactor is None or getattr(self, "_closed", False):
            return
        began = time.perf_counter()
        self._resize()
        width, height = self.ren_win.GetSize()
        self.prepare(self.projector(), width * height)
        self.place()
        interactor.EnableRenderOn()
        super().paintGL()  # type: ignore[no-untyped-call]
        interactor.EnableRenderOff()
        self.frames += 1
        if not self.full:
            # The rest counts from the end of the frame: a slow frame is not a rest.
            self._still.start()
            if self.frames % TIMED == 0:
                self.finish()
                took = time.perf_counter() - began
                self.shrink = min(max(self.shrink + (took > SLOW) - (took < QUICK), 1), LEAST)

    def _resize(self) -> None:
        """Give VTK fewer pixels while the viewpoint moves on a slow machine; Qt spreads them over the widget."""
        ratio = self.devicePixelRatioF() / (1 if self.full else self.shrink)
        size = max(round(self.width() * ratio), 1), max(round(self.height() * ratio), 1)
        if tuple(self.ren_win.GetSize()) != size:
            self.ren_win.SetSize(*size)
            self.pixels_changed.emit(ratio)

    def realize(self) -> None:
        """Make the OpenGL context of a widget that was never painted."""
        self._ensure_initialized()  # type: ignore[no-untyped-call]

    def place(self) -> None:
        """Give the camera the viewpoint's place."""
        self.viewpoint.put(self.renderer.GetActiveCamera())
        self.renderer.ResetCameraClippingRange()

    def set_background_colour(self, colour: QColor) -> None:
        """Set the background."""
        self.renderer.SetBackground(colour.redF(), colour.greenF(), colour.blueF())
        self.render()

    def projector(self, width: float | None = None, height: float | None = None) -> Projector:
        """Return the camera as numbers, for the widget's size or another one."""
        width, height = width or max(self.width(), 1), height or max(self.height(), 1)
        self.place()
        camera = self.renderer.GetActiveCamera()
        matrix = camera.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
        values = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
        return Projector(values, width, height, self.origin, self.stretch)

    # The viewpoint -------------------------------------------------------------------------------------------------

    @property
    def target(self) -> Viewpoint:
        """Where the viewpoint is, or is on its way to."""
        return self._to if self._fly.isActive() else self.viewpoint

    def look(self, viewpoint: Viewpoint, *, moving: bool = False) -> None:
        """Put the viewpoint somewhere; ``moving`` draws less until it rests."""
        if not moving:
            self._fly.stop()
        self.viewpoint = viewpoint
        if moving:
            self._move()
        self.viewpoint_changed.emit()
        self.render()

    def fly(self, viewpoint: Viewpoint) -> None:
        """Move the viewpoint smoothly."""
        if not self.isVisible():
            self.look(viewpoint)
            return
        self._from, self._to, self._began = self.viewpoint, viewpoint, time.monotonic()
        self._fly.start()

    def land(self) -> None:
        """End a flight at once, at its end."""
        if self._fly.isActive():
            self._fly.stop()
            self.look(self._to)
            self.rest()

    def _step(self) -> None:
        share = (time.monotonic() - self._began) / FLIGHT
        self._move()
        if share >= 1:
            self._fly.stop()
        self.look(viewpoint_between(self._from, self._to, min(share, 1.0)), moving=True)

    def _move(self) -> None:
        if self.full:
            self.full = False
            self.detail_changed.emit(False)
        self._still.start()

    def finish(self) -> None:
        """Wait until everything asked of OpenGL is drawn."""
        self.ren_win.WaitForCompletion()

    def rest(self) -> None:
        """Draw the full detail, unless a button still holds the scene."""
        if self._held in ("turn", "shift", "zoom"):
            self._still.start()
        elif not self.full:
            self._still.stop()
            self.full = True
            self.detail_changed.emit(True)
            self.render()

    def metres(self) -> float:
        """Metres of a logical pixel at the centre."""
        return 2 * self.viewpoint.half / max(self.height(), 1)

    # Mouse and keys ------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take a handle, or begin to turn or move."""
        self._pressed = self._last = event.position()
        self._fly.stop()
        left = event.button() == Qt.MouseButton.LeftButton
        if left and self.handle is not None and self.handle.press(event.position()):
            self._held = "handle"
        else:
            shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self._held = drag_of(self.scheme, event.button(), shift)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Turn, move, drag a handle, or tell where the pointer is."""
        here = event.position()
        step, self._last = here - self._last, here
        if self._held is None:
            self.hovered.emit(here)
        elif self._held == "handle":
            self.handle.drag(here, bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier))
        elif self._held == "turn":
            if (here - self._pressed).manhattanLength() >= CLICK or not self.full:
                self.look(self.viewpoint.turned(-TURN * step.x(), TURN * step.y()), moving=True)
        elif self._held == "zoom":
            self.look(self.viewpoint.nearer(NOTCH ** (-step.y() / DRAG)), moving=True)
        elif self._held == "shift":
            metres = self.metres()
            self.look(self.viewpoint.shifted(-metres * step.x(), metres * step.y()), moving=True)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go; a press that did not move is a click."""
        held, self._held = self._held, None
        if held == "handle":
            self.handle.release()
        elif (event.position() - self._pressed).manhattanLength() < CLICK:
            shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            if event.button() == Qt.MouseButton.LeftButton and not shift:
                self.clicked.emit(event.position())
            elif event.button() == Qt.MouseButton.RightButton:
                self.asked.emit(event.position())

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Tell of a double click."""
        self._held = None
        self.double_clicked.emit(event.position())

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Come nearer to what is under the pointer, or go back."""
        metres, at = self.metres(), event.position()
        right, up = (at.x() - self.width() / 2) * metres, (self.height() / 2 - at.y()) * metres
        self.look(self.viewpoint.nearer(NOTCH ** (event.angleDelta().y() / 120), right, up), moving=True)
        event.accept()

    def event(self, event: QEvent) -> bool:
        """While something is dragged, keys belong to it, not to the shortcuts of the menus."""
        if event.type() == QEvent.Type.ShortcutOverride and self._held == "handle":
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Turn by the arrow keys, come nearer by plus and minus; Escape gives up a drag, Enter ends it."""
        if event.key() == Qt.Key.Key_Escape and self._held == "handle":
            self._held = "cancelled"
            self.handle.cancel()
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self._held == "handle":
            self._held = "ended"
            self.handle.release()
        elif self._held == "handle" and self.handle.key(event.key(), event.text()):
            pass
        elif (turn := _KEYS.get(Qt.Key(event.key()))) is not None:
            self.look(self.viewpoint.turned(*turn), moving=True)
        elif event.text() in ("+", "-"):
            self.look(self.viewpoint.nearer(NOTCH if event.text() == "+" else 1 / NOTCH), moving=True)
        else:
            event.ignore()

    def keyReleaseEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Leave every key to the window."""
        event.ignore()

    def enterEvent(self, event: QEvent) -> None:  # noqa: N802
        """Keep VTK out of it."""
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802
        """Tell that the pointer is gone."""
        event.accept()
        self.left.emit()

    def close(self) -> None:  # type: ignore[override]
        """Stop the timers and give OpenGL's memory back; may be called again."""
        self._still.stop()
        self._fly.stop()
        super().close()
        # Qt deletes the surface of OpenGL with the widget. PySide does not learn of that, as it would of a QObject: a
        # wrapper that outlives it would be taken for whatever object Qt makes at that address next.
        self._forget_context()  # type: ignore[no-untyped-call]
