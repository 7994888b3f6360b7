"""A 3D view of one thing in a window of its own: parts that are shown and hidden, in a box."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QVBoxLayout, QWidget

from geofit.gui.theme import is_dark
from geofit.gui.view3d.camera import framed
from geofit.gui.view3d.canvas import Canvas
from geofit.gui.view3d.opengl import require_opengl

__all__ = ["SmallScene"]


class SmallScene(QWidget):
    """A canvas with named ``actors``, each of which belongs to a part that can be hidden.

    Raises
    ------
    NoOpenGLError
        If no 3D view can be drawn on this machine.
    """

    def __init__(self, parts: Iterable[str], parent: QWidget | None = None) -> None:
        require_opengl()
        super().__init__(parent)
        self.canvas = Canvas(self)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.canvas)
        self.setFocusProxy(self.canvas)
        self.actors: dict[str, Any] = {}
        self._part: dict[str, str] = {}
        self._visible = dict.fromkeys(parts, True)
        self._frame: Any = None
        self._open = True
        self.set_dark(is_dark(self.palette()))

    @property
    def shown(self) -> tuple[str, ...]:
        """Names of the actors that are drawn and seen."""
        return tuple(name for name, actor in self.actors.items() if actor.GetVisibility())

    def set_dark(self, dark: bool) -> None:
        """Follow the theme: a dark or a light background."""
        self.dark = dark
        self.canvas.set_background_colour(QColor("#1a1f24" if dark else "#ffffff"))

    def set_visible(self, part: str, visible: bool) -> None:
        """Show or hide a part."""
        self._visible[part] = visible
        for name, actor in self.actors.items():
            actor.SetVisibility(self._visible[self._part[name]])
        self.canvas.render()

    def clear(self) -> None:
        """Remove all actors and the edges of the box."""
        for name in list(self.actors):
            self.remove(name)
        self._remove_frame()
        self.canvas.render()

    def remove(self, name: str) -> None:
        """Remove an actor, if there is one of this name."""
        if name in self.actors:
            self.canvas.renderer.RemoveActor(self.actors.pop(name))

    def add(self, name: str, mesh: Any, part: str, opacity: float = 1.0) -> Any:
        """Draw a mesh in place of the one of this name; return its actor."""
        import pyvista as pv

        self.remove(name)
        actor = pv.Actor(mapper=pv.DataSetMapper(mesh))
        actor.prop.opacity = opacity
        actor.SetVisibility(self._visible[part])
        self.canvas.renderer.AddActor(actor)
        self.actors[name], self._part[name] = actor, part
        return actor

    def frame(self, box: NDArray[np.float64], *, outline: bool = True) -> None:
        """Move the camera so that a box (2, 3) and all actors are seen, and draw the edges of the box."""
        import pyvista as pv

        self._remove_frame()
        if outline:
            (x0, y0, z0), (x1, y1, z1) = box.tolist()
            self._frame = pv.Actor(mapper=pv.DataSetMapper(pv.Box((x0, x1, y0, y1, z0, z1)).outline()))
            self._frame.prop.color = "#8a939c"
            self._frame.prop.lighting = False
            self.canvas.renderer.AddActor(self._frame)
        drawn = [np.reshape(actor.GetBounds(), (3, 2)).T for actor in self.actors.values()]
        whole = np.array([np.min([box, *drawn], axis=(0, 1)), np.max([box, *drawn], axis=(0, 1))])
        self.canvas.look(framed(self.canvas.viewpoint, whole, self.width() / max(self.height(), 1)))

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self._open:
            self.set_dark(is_dark(self.palette()))

    def close(self) -> bool:
        """Let go of the view's context."""
        self._open = False
        self.canvas.close()
        return super().close()

    def _remove_frame(self) -> None:
        if self._frame is not None:
            self.canvas.renderer.RemoveActor(self._frame)
            self._frame = None
