"""The 3D view: horizons, points, holes and ground, seen from anywhere, with what can be asked of them."""

from __future__ import annotations

import math
from dataclasses import replace
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import QTimer, Signal
from PySide6.QtGui import QCloseEvent, QImage, QResizeEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from geofit.data.prediction import Suggestion, Uncertainty
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.view3d.actors import ActorPart, lines, poly
from geofit.gui.view3d.annotations import Annotations, theme_of
from geofit.gui.view3d.axes import floor_lines, marks, nice
from geofit.gui.view3d.body_items import BodyScene, MorphScene
from geofit.gui.view3d.camera import Viewpoint, framed
from geofit.gui.view3d.canvas import Canvas
from geofit.gui.view3d.contents import Contents
from geofit.gui.view3d.control_move import ControlMove
from geofit.gui.view3d.drawn import Drawn
from geofit.gui.view3d.handles import Handle, Handles
from geofit.gui.view3d.layers import Layers
from geofit.gui.view3d.opengl import require_opengl
from geofit.gui.view3d.overlay import Content, merged
from geofit.gui.view3d.pointer import Pointer
from geofit.gui.view3d.projector import Projector
from geofit.gui.view3d.screenshot import picture, write_screenshot
from geofit.gui.view3d.sight import Sight
from geofit.gui.view3d.stage import Stage
from geofit.gui.view3d.tools import ClipBox, SectionTool
from geofit.project.listing import Listing
from geofit.project.provenance import Row
from geofit.sampling.cut import section_line

__all__ = ["SceneView"]

Floats = NDArray[np.float64]

#: A chosen point is looked at from no farther than this many times the scene's width.
CLOSE = 0.9
#: A dragged section is reported at most so often, milliseconds.
SECTION = 50
#: Surfaces are made ready for a view that has rested so long, milliseconds; what is nearer to it than this share of its
#: distance is taken to be as near.
REST, NEAREST = 60, 0.1
#: About so many coordinate lines cross the picture.
LINES = 6


class SceneView(QWidget):
    """Shows a site and its surfaces; coordinates in and out are map coordinates in metres.

    Call :meth:`close` before the window that holds it is destroyed: it stops the timers and frees OpenGL's memory.

    Signals: ``point_picked(horizon, row)``, ``control_picked(horizon, patch, i, j)``, ``hole_picked(name)``,
    ``control_dragged(vector)``, ``control_dropped()`` and ``control_refused(reason)`` while the chosen control point is
    dragged, ``pointer_moved(x, y, z)`` (nan off every surface), ``measured(text)``, ``section_changed(line)`` with a
    (k, 2) array, ``sharper_wanted(horizon, sight)`` where the view has come to rest so near to a surface that its
    triangles show: answer by :meth:`sharpen`.

    Raises
    ------
    NoOpenGLError
        If no 3D view can be drawn on this machine.
    """

    point_picked = Signal(str, object)
    control_picked = Signal(str, str, int, int)
    control_dragged = Signal(object)
    control_dropped = Signal()
    control_refused = Signal(str)
    hole_picked = Signal(str)
    pointer_moved = Signal(float, float, float)
    measured = Signal(str)
    section_changed = Signal(object)
    sharper_wanted = Signal(str, object)

    def __init__(self, parent: QWidget | None = None, layers: Layers | None = None) -> None:
        require_opengl()
        super().__init__(parent)
        self.setAccessibleName(self.tr("3D view"))
        self.canvas = Canvas(self)
        self.layers = layers if layers is not None else Layers()
        self._stage = Stage(self.layers, self.canvas.renderer, self.canvas.ren_win, self._changed)
        self.contents, self.bodies = Contents(self._stage), BodyScene(self._stage)
        self.morph = MorphScene(self._stage)
        self._section, self._clip = SectionTool(self._section_moved, self._tell_section), ClipBox(self._clip_moved)
        self.pointer = Pointer(self.canvas, self._stage, self.contents, self._clip, self)
        self.control_move = ControlMove(
            self._stage, self.contents, self._control_pulled, self.control_dropped.emit, self.control_refused.emit
        )
        self._step, self._framed, self._closed = 0.0, False, False
        self._annotations = Annotations(self, self.canvas.projector, self.content)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.canvas)
        self._telling = QTimer(self, interval=SECTION, singleShot=True)
        self._telling.timeout.connect(self._tell_section)
        self._changes = QTimer(self, interval=0, singleShot=True)
        self._changes.timeout.connect(self._refresh)
        self._resting = QTimer(self, interval=REST, singleShot=True)
        self._resting.timeout.connect(self._look_closely)
        self._connect()
        self.setFocusProxy(self.canvas)
        self.set_dark(False)

    def _connect(self) -> None:
        canvas = self.canvas
        self._hands = canvas.handle = Handles(self.handles, canvas.projector)
        canvas.viewpoint_changed.connect(self._viewpoint_moved)
        canvas.detail_changed.connect(self._set_detail)
        canvas.pixels_changed.connect(self._stage.set_pixels)
        canvas.prepare = self._stage.renew
        pointer = self.pointer
        pointer.point_picked.connect(self.point_picked)
        pointer.control_picked.connect(self.control_picked)
        pointer.hole_picked.connect(self.hole_picked)
        pointer.moved.connect(self.pointer_moved)
        pointer.measured.connect(self.measured)
        pointer.changed.connect(self._ring_changed)

    # What is shown -------------------------------------------------------------------------------------------

    def show_site(self, site: Site) -> None:
        """Show a site in place of the one before; what a person has chosen for its layers is kept."""
        self.contents.show_site(site)
        self._placed()

    def show_listing(self, name: str, listing: Listing) -> None:
        """Show all points of a horizon, excluded ones as ghosts, with their residuals."""
        self.contents.show_listing(name, listing)
        self.pointer.renew()

    def show_surface(
        self, surface: HorizonFit, uncertainty: Uncertainty | None = None, drawn: Drawn | None = None
    ) -> None:
        """Show a surface or its new fit; ``drawn`` (:func:`drawn_of`, in a worker) spares the window 0.3 s."""
        self.contents.show_surface(surface, uncertainty, drawn)
        if self.control_move.horizon == surface.name:
            self.control_move.show("", None)
        self._placed()
        self.pointer.renew()

    def sharpen(self, surface: HorizonFit, drawn: Drawn) -> None:
        """Draw a surface with triangles that were made for a view."""
        self.contents.sharpen(surface, drawn)
        self._changed()

    def remove_surface(self, name: str) -> None:
        """Take a surface away; its points stay."""
        self.contents.remove_surface(name)
        if self.control_move.horizon == name:
            self.control_move.show("", None)
        self.pointer.renew()

    def show_suggestions(self, horizon: str, suggestions: tuple[Suggestion, ...]) -> None:
        """Show where the next holes should stand; an empty tuple takes them away."""
        self.contents.show_suggestions(horizon, suggestions)

    def set_seams(self, horizon: str | None) -> None:
        """Show the seams of one horizon, coloured by angle or gap; None: of none."""
        self._one_of("seams", horizon)

    def set_control_points(self, horizon: str | None) -> None:
        """Show the control points of one horizon, which can then be picked; None: of none."""
        self._one_of("control", horizon)
        if horizon is None:
            self.pointer.let_go()

    def _one_of(self, kind: str, horizon: str | None) -> None:
        for layer in (*self.layers, *self.layers.kept.values()):
            if layer.kind == kind and layer.horizon != horizon:
                self.layers.remove(layer.key)
        if horizon is not None and horizon in self.contents.surfaces:
            (self.contents.show_seams if kind == "seams" else self.contents.show_control)(horizon)

    def clear(self, *, keep: bool = False) -> None:
        """Take everything away; ``keep`` viewpoint, section, clip box and what was chosen for the layers."""
        self.contents.clear(keep=keep)
        self.control_move.show("", None)
        self.pointer.clear()
        if not keep:
            self._framed = False
            self.set_section(None, 0.0)
            self.set_clip(False)
        self._changed()

    def take_over(self, other: SceneView) -> None:
        """Show the same site as another view does: layers, heights, clip box, and from the same viewpoint."""
        self.layers.take_over(other.layers)
        self._clip.take_over(other._clip)
        self.set_exaggeration(other.canvas.stretch)
        if self._framed and other._framed:
            viewpoint = other.canvas.target
            place = viewpoint.centre / (1.0, 1.0, other.canvas.stretch) + other.canvas.origin
            self.canvas.look(replace(viewpoint, centre=self._in_scene(place)))

    # Looking -------------------------------------------------------------------------------------------------

    def view(self, name: str) -> None:
        """Look from "top", "north", "south", "east", "west" or "iso" (the south-west), all in the picture."""
        self._frame(self.canvas.target.seen_from(name))

    def reset_camera(self) -> None:
        """Bring everything into the picture, seen from the same side."""
        self._frame(self.canvas.target)

    def zoom_to(self, key: str) -> None:
        """Bring one layer into the picture."""
        box = self._stage.box(key)
        if box is not None:
            self.canvas.fly(framed(self.canvas.target, self._in_scene(box), self._aspect()))

    def set_orthographic(self, on: bool) -> None:
        """Draw without perspective; then a scale bar is shown."""
        self.canvas.look(replace(self.canvas.target, parallel=on))

    def set_exaggeration(self, factor: float) -> None:
        """Draw heights ``factor`` times larger; numbers stay true.

        Raises
        ------
        ValueError
            If the factor is not above 0.
        """
        if not (factor > 0 and math.isfinite(factor)):
            raise ValueError(f"The vertical exaggeration is {factor}; give a number above 0.")
        canvas = self.canvas
        viewpoint = canvas.target
        viewpoint = replace(viewpoint, centre=viewpoint.centre * (1.0, 1.0, factor / canvas.stretch))
        canvas.stretch = factor
        self._stage.set_stretch(factor)
        if self._clip.box is not None:
            self._clip_moved()
        canvas.look(viewpoint)

    def focus_point(self, horizon: str, row: Row) -> None:
        """Choose a point and move the viewpoint to it, keeping the direction."""
        self.highlight_point(horizon, row)
        points = self.contents.points[horizon]
        index = row.find(points)
        if index is not None:
            self._focus(points.xyz[index])

    def focus_hole(self, name: str) -> None:
        """Move the viewpoint to the middle of a borehole or adit, keeping the direction."""
        holes = self.contents.site.holes if self.contents.site is not None else ()
        hole = next((hole for hole in holes if hole.name == name), None)
        if hole is not None:
            self.pointer.surround(hole.xyz[0], name)
            self._focus((hole.xyz.min(axis=0) + hole.xyz.max(axis=0)) / 2)

    def focus_place(self, x: float, y: float, z: float) -> None:
        """Move the viewpoint to a place, keeping the direction."""
        self._focus(np.array([x, y, z]))

    def highlight_point(self, horizon: str, row: Row | None) -> None:
        """Put a ring and its figures about a point; None takes it away."""
        self.pointer.choose(horizon, row)

    def highlight_control(self, horizon: str, patch: str, i: int, j: int) -> None:
        """Put a mark and its elevation on a control point."""
        self.pointer.choose_control(horizon, patch, i, j)

    def _control_pulled(self, by: Floats) -> None:
        """Let the surface follow the hand; as while the viewpoint moves, less detail is drawn."""
        self.canvas.look(self.canvas.viewpoint, moving=True)
        self.control_dragged.emit(by)

    def _ring_changed(self) -> None:
        """Something else was chosen, or nothing: no control point can be dragged any more."""
        if self.control_move.shown and not self.control_marked:
            self.control_move.show("", None)
        self._annotations.update()

    @property
    def control_marked(self) -> bool:
        """Whether the mark is on a control point."""
        return self.pointer.ring is not None and self.pointer.ring.solid

    def set_dark(self, dark: bool) -> None:
        """Follow the theme: a dark or a light background."""
        self._annotations.dark = dark
        self.canvas.set_background_colour(theme_of(self.palette(), dark).paper)
        self._stage.set_look(replace(self._stage.look, origin=self.canvas.origin, dark=dark))
        self._changed()

    def set_point_size(self, share: float) -> None:
        """Draw data points ``share`` times as large as usual."""
        self._stage.set_look(replace(self._stage.look, points=share))
        self._changed()

    # Tools ---------------------------------------------------------------------------------------------------

    def set_section(self, line: ArrayLike | None, thickness: float = 0.0) -> None:
        """Show a vertical plane along a line of the plan, (k, 2); its handles move it. None takes it away."""
        self._section.line = None if line is None else section_line(line)
        self._section.thickness = max(float(thickness), 0.0)
        self._changed()

    def set_faded(self, on: bool) -> None:
        """Fade surfaces above the ground and beyond their data, or draw them in full."""
        self.contents.set_faded(on)
        self._changed()

    def set_clip(self, on: bool) -> None:
        """Show a box whose sides can be moved, and nothing outside of it."""
        if on and self._clip.box is None and (box := self._stage.box()) is not None:
            self._clip.open(box)
            self._clip_moved()
        elif not on and self._clip.box is not None:
            self._clip.box = None
            self._stage.set_clip(None)
            self._changed()

    def set_measuring(self, on: bool) -> None:
        """Let clicks measure: two places, points before surfaces. Off takes the measure away."""
        self.pointer.set_measuring(on)

    def screenshot(self, path: str | PathLike[str], scale: float = 2.0) -> QImage:
        """Write the scene as PNG with ``scale`` times the pixels of the widget, and all that is drawn over it.

        Raises
        ------
        SettingsError
            If the picture would have more than 16,000 pixels a side.
        """
        self.canvas.land()
        self._refresh()
        return write_screenshot(self.canvas, self._stage, path, scale, self._annotations.write)

    def picture(self) -> QImage:
        """Return the scene with the pixels of the widget, and all that is drawn over it."""
        self.canvas.land()
        self._refresh()
        return picture(self.canvas, self._stage, 1.0, self._annotations.write)

    # Keeping up ----------------------------------------------------------------------------------------------

    def _changed(self) -> None:
        """Something has changed: one refresh for many changes."""
        if not self._closed:
            self._changes.start()

    def _refresh(self) -> None:
        self._changes.stop()
        self._axes(force=True)
        box = self._stage.box()
        self._stage.set_extra("section", [] if box is None else self._section.parts(box, self._stage.look))
        self._stage.set_extra("clip", self._clip.parts(self._stage.look))
        self.control_move.follow()
        self._changes.stop()
        self.canvas.render()
        self._annotations.update()
        self._resting.start()

    def _look_closely(self) -> None:
        """Ask for more triangles of the surfaces that are too coarse for the view, once it rests."""
        if not self._closed and self.canvas.full and self.canvas.target is self.canvas.viewpoint:
            self.pointer.get_ready()
            sight = Sight(self.canvas.projector(), NEAREST * self.canvas.viewpoint.distance)
            for name in self.contents.too_coarse(sight):
                self.sharper_wanted.emit(name, sight)

    def _placed(self) -> None:
        """Keep the scene's zero near the data, and bring the first things shown into the picture."""
        known = self.contents.everything()
        if len(known):
            middle, reach = (known.min(axis=0) + known.max(axis=0)) / 2, np.ptp(known, axis=0).max()
            if np.abs(middle - self.canvas.origin).max() > max(10.0 * float(reach), 1.0) or not self._framed:
                self.canvas.origin = np.round(middle)
                self._stage.set_look(replace(self._stage.look, origin=self.canvas.origin))
                if self._clip.box is not None:
                    self._clip_moved()
            if not self._framed:
                self._framed = True
                self.canvas.viewpoint = framed(self.canvas.viewpoint, self._in_scene(self._box()), self._aspect())
        self._changed()

    def _viewpoint_moved(self) -> None:
        self._axes()
        self._annotations.update()

    def _set_detail(self, full: bool) -> None:
        self._stage.set_detail(full)
        self._annotations.update()
        self._resting.start()

    def _axes(self, force: bool = False) -> None:
        """Draw the coordinate lines anew where their spacing has changed."""
        viewpoint = self.canvas.viewpoint
        self._stage.set_metres(self.canvas.metres())
        step = nice(2 * viewpoint.half * max(self._aspect(), 1.0) / LINES)
        if force or step != self._step:
            self._step = step
            parts = []
            if (box := self._stage.box()) is not None:
                points, runs = floor_lines(self._padded(box), step)
                data = poly(points - self.canvas.origin, runs=runs)
                parts = [ActorPart(lines(data, self._stage.look.text, 0.0), width=1.0, opacity=0.16)]
            self._stage.set_extra("axes", parts)

    def content(self, view: Projector) -> Content:
        """Return what is written over the scene: names, scales, legends, and what was measured."""
        viewpoint = self.canvas.viewpoint
        box = self._stage.box()
        seen, pointer = list(self._stage.items()), self.pointer
        return Content(
            names=[(item.places, item.names) for _, item in seen],
            rings=[self.control_move.dressed(pointer.ring, self._hands.free)] if pointer.ring is not None else [],
            path=np.array(pointer.measure.places) if pointer.measure.places else None,
            path_text=pointer.measure_text(),
            handles=[handle.xyz for handle in self.handles() if handle.drawn],
            legends=merged([(layer.horizon, layer.legend) for layer, _ in seen if layer.legend is not None]),
            marks=marks(self._padded(box), self._step, view) if box is not None and self._step else [],
            note=self.tr("Vertical {factor}×").format(factor=f"{self.canvas.stretch:g}"),
            directions=viewpoint.axes,
            metres=self.canvas.metres() if viewpoint.parallel else None,
        )

    def handles(self) -> list[Handle]:
        """Return what can be dragged: the control point, the ends of the section, the sides of the clip box."""
        box, ring = self._stage.box(), self.pointer.ring
        chosen = (
            self.control_move.handles()
            if ring is None
            else [*self.control_move.handles(), *self.control_move.held(ring)]
        )
        return [] if box is None else [*chosen, *self._section.handles(box), *self._clip.handles()]

    def _section_moved(self) -> None:
        self._changed()
        if not self._telling.isActive():
            self._telling.start()

    def _tell_section(self) -> None:
        self._telling.stop()
        if self._section.line is not None:
            self.section_changed.emit(self._section.line.copy())

    def _clip_moved(self) -> None:
        self._stage.set_clip(self._clip.planes(self.canvas.origin, self.canvas.stretch))
        self._changed()

    @property
    def idle(self) -> bool:
        """Whether the scene shows all that has changed, at full detail."""
        return self.canvas.full and not self._changes.isActive()

    # Small things --------------------------------------------------------------------------------------------

    def _focus(self, place: Floats) -> None:
        box = self._stage.box()
        reach = float(np.ptp(box, axis=0).max()) if box is not None else 100.0
        viewpoint = self.canvas.target
        self.canvas.fly(
            replace(viewpoint, centre=self._in_scene(place), distance=min(viewpoint.distance, CLOSE * reach))
        )

    def _frame(self, viewpoint: Viewpoint) -> None:
        self.canvas.fly(framed(viewpoint, self._in_scene(self._box()), self._aspect()))

    def _box(self) -> Floats:
        box = self._stage.box()
        return box if box is not None else np.stack([self.canvas.origin - 500.0, self.canvas.origin + 500.0])

    def _padded(self, box: Floats) -> Floats:
        pad = np.array([0.02, 0.02, 0.0]) * np.ptp(box, axis=0).max()
        return np.stack([box[0] - pad, box[1] + pad])

    def _in_scene(self, xyz: Floats) -> Floats:
        return np.asarray((xyz - self.canvas.origin) * (1.0, 1.0, self.canvas.stretch))

    def _aspect(self) -> float:
        return max(self.width(), 1) / max(self.height(), 1)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        """Keep the writing over the canvas."""
        super().resizeEvent(event)
        self._annotations.setGeometry(self.rect())
        self._annotations.raise_()
        self._changed()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 - Qt's name
        """Stop the timers and free OpenGL's memory."""
        if not self._closed:
            self._closed = True
            for timer in (self.pointer.timer, self.pointer.resting, self._telling, self._changes, self._resting):
                timer.stop()
            self._stage.close()
            self.canvas.close()
        super().closeEvent(event)
