"""The partition in plan: what is met exactly and why, changed by dragging the core's corners."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.parametrize import Parametrization
from geofit.geometry.frame import Frame, map_frame
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.area_overlay import AreaOverlay
from geofit.gui.panels.core_box import CoreBox, core_count, parametrization_of
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.plan_view import PlanData, PlanView
from geofit.gui.text_size import sized_by_text
from geofit.gui.translate import translated
from geofit.report.style import horizon_colours
from geofit.report.view import rims

__all__ = ["PlanPanel"]

#: Width of words and tools beside the plan, and the most that Qt gives a widget, pixels.
SIDE, MOST = 220, 16_777_215


class PlanPanel(QWidget):
    """The plan of one horizon.

    ``core_changed`` carries the horizon and its new core: "auto", "all", "none", or the four corners that were dragged,
    when Use is pressed. ``area_changed`` carries the corners of the study area after each drag; None: as in the files.
    """

    core_changed = Signal(str, object)
    area_changed = Signal(object)
    pointer_moved = Signal(float, float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = PlanView()
        self.view.setAccessibleName(self.tr("Plan with the core's rectangle"))
        self.area = AreaOverlay(self.view)
        self.buttons: dict[str, QPushButton] = {}
        tools = FlowLayout()
        for key, words, about in (
            ("auto", self.tr("Auto"), self.tr("Let the fit find the dense core.")),
            ("all", self.tr("All"), self.tr("Meet every point exactly.")),
            ("none", self.tr("None"), self.tr("Approximate all points.")),
            ("draw", self.tr("Draw"), self.tr("Draw a new rectangle: press and drag in the plan.")),
            ("undo", self.tr("Undo drag"), self.tr("Undo the last drag that has not been used yet.")),
            ("use", self.tr("Use"), self.tr("Make the rectangle the core of the next fit.")),
            ("area", self.tr("Study area"), self.tr("Draw the study area, or drag its corners.")),
            ("file area", self.tr("As in files"), self.tr("Use the study area given in the site's files.")),
        ):
            button = QPushButton(words)
            button.setToolTip(about)
            button.setCheckable(key in {"auto", "all", "none", "draw", "area"})
            button.setAutoDefault(False)
            sized_by_text(button, partial(_fit_words, button))
            tools.addWidget(button)
            self.buttons[key] = button
        self.reason = QLabel()
        self.reason.setWordWrap(True)
        self.reason.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        content, side = QWidget(), QWidget()
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addLayout(tools)
        column.addWidget(self.reason, 1, Qt.AlignmentFlag.AlignTop)
        self._parts = QBoxLayout(QBoxLayout.Direction.TopToBottom, content)
        self._parts.setContentsMargins(8, 8, 8, 8)
        self._parts.setSpacing(6)
        self._parts.addWidget(side)
        self._parts.addWidget(self.view, 1)
        self._side = side
        self.pages = Placeholder(content, self)
        for word in ("auto", "all", "none"):
            self.buttons[word].clicked.connect(lambda _, word=word: self._choose_word(word))
        self.buttons["draw"].toggled.connect(self._draw)
        self.buttons["area"].toggled.connect(self._edit_area)
        self.buttons["file area"].clicked.connect(lambda: self.area_changed.emit(None))
        self.area.changed.connect(self.area_changed)
        self.buttons["undo"].clicked.connect(self.undo_drag)
        self.buttons["use"].clicked.connect(self.use)
        self.view.box_dragging.connect(self._tell_pending)
        self.view.box_dragged.connect(self._dragged)
        self.view.pointer_moved.connect(self.pointer_moved)
        self._name, self._settings = "", FitSettings()
        self._boundary: NDArray[np.float64] | None = None
        self._why = ""
        self._parametrization: Parametrization | None = None
        self._past: list[CoreBox | None] = []
        self._last: CoreBox | None = None
        self.show_surface(None, "", None, FitSettings())

    def show_surface(self, site: Site | None, name: str, surface: HorizonFit | None, settings: FitSettings) -> None:
        """Show the plan of a horizon, fitted or not; drags that were not used are dropped."""
        if site is None or (name not in site.horizons and surface is None):
            self._name = ""
            self.pages.say(self.tr("No horizon chosen: choose one in the project tree to see its plan."))
            return
        same, self._name, self._settings = name == self._name, name, settings
        points = site.horizons[name] if surface is None else surface.points
        parametrization = self._parametrization = parametrization_of(points, settings, site.boundary, surface)
        frame = map_frame(points) if parametrization is None else parametrization.frame
        self._past.clear()
        self._last = self._box(surface, frame)
        exact = np.zeros(len(points), bool)
        if surface is not None and len(surface.core) == len(points):
            exact = surface.core
        self.view.show_data(
            PlanData(
                points=points.xyz[:, :2],
                exact=exact,
                boundary=site.boundary,
                patches=() if surface is None else tuple(rim[:, :2] for rim in rims(surface).values()),
                sections=tuple((section.name, section.line) for section in site.sections),
                holes=tuple((hole.name, hole.xyz[:, :2]) for hole in site.holes),
                name=name,
                colour=horizon_colours([*site.horizons, name], site.blocks)[name],
            ),
            keep_view=same,
        )
        self._boundary = site.boundary
        self._edit_area(self.buttons["area"].isChecked())
        self.view.blank = CoreBox(frame, np.zeros(2), np.zeros(2))
        self.view.locked = frame.kind != "map"
        self.view.show_box(self._last)
        self.buttons["draw"].setChecked(False)
        self.buttons["draw"].setEnabled(not self.view.locked)
        for word in ("auto", "all", "none"):
            self.buttons[word].setChecked(settings.core == word)
        if surface is not None and surface.partition is not None:
            self._why = translated(surface.partition.reason)
        else:
            self._why = self.tr("Not fitted yet: the core is found when the horizon is fitted.")
        if self.view.locked:
            more = self.tr("A rectangle can be drawn only for a surface fitted over the map.")
            self._why = f"{self._why}\n{more}"
        self._update_state()
        self.pages.reveal()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put words and tools beside the plan where it is wide and low."""
        super().resizeEvent(event)
        wide = self.width() > 1.6 * self.height()
        self._parts.setDirection(QBoxLayout.Direction.LeftToRight if wide else QBoxLayout.Direction.TopToBottom)
        self._side.setMinimumWidth(SIDE if wide else 0)
        self._side.setMaximumWidth(SIDE if wide else MOST)

    def undo_drag(self) -> None:
        """Take back the last drag."""
        if self._past:
            self._last = self._past.pop()
            self.view.show_box(self._last)
        self._update_state()

    def use(self) -> None:
        """Make the rectangle the core of the next fit."""
        if self._last is not None:
            self._past.clear()
            self._update_state()
            corners = tuple((float(x), float(y)) for x, y in self._last.corners)
            self.core_changed.emit(self._name, corners)

    def _box(self, surface: HorizonFit | None, frame: Frame) -> CoreBox | None:
        drawn: object = self._settings.core
        if isinstance(drawn, str):
            partition = None if surface is None else surface.partition
            drawn = None if partition is None or self._settings.core == "none" else partition.corners
        return None if drawn is None else CoreBox.around(frame, np.asarray(drawn, float))

    def _choose_word(self, word: str) -> None:
        for key in ("auto", "all", "none"):
            self.buttons[key].setChecked(key == word)
        self._past.clear()
        self._update_state()
        if self._settings.core != word:
            self.core_changed.emit(self._name, word)

    def _draw(self, drawing: bool) -> None:
        self.view.drawing = drawing
        if drawing:
            self.view.setFocus()
            self.reason.setText(self.tr("Press and drag in the plan to draw the core's rectangle."))
        else:
            self._update_state()

    def _edit_area(self, editing: bool) -> None:
        self.buttons["file area"].setVisible(editing)
        if not editing:
            self.area.hide()
            return
        corners = self._boundary
        if corners is None:
            # Around the points, to be dragged from there.
            xy = self.view.data.points
            low, high = xy.min(axis=0), xy.max(axis=0)
            room = 0.05 * float((high - low).max())
            (x0, y0), (x1, y1) = low - room, high + room
            corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        self.area.edit(corners)
        self.view.fit()

    def _dragged(self, box: CoreBox) -> None:
        self._past.append(self._last)
        self._last = box
        self.buttons["draw"].setChecked(False)
        self._update_state()

    def _update_state(self) -> None:
        self.buttons["undo"].setEnabled(bool(self._past))
        self.buttons["use"].setEnabled(bool(self._past) and self._last is not None)
        if self._past and self._last is not None:
            self._tell_pending(self._last)
        else:
            self.reason.setText(self._why)

    def _tell_pending(self, box: CoreBox) -> None:
        """Say what the fit would take, while the rectangle is dragged."""
        total = len(self.view.data.points)
        if self._parametrization is None:
            inside, widened = int(box.holds(self.view.data.points).sum()), False
        else:
            inside, widened = core_count(self._parametrization, box)
        width, height = box.size
        words = self.tr("{width:.0f} m × {height:.0f} m: {inside} points inside, {outside} outside.").format(
            width=width, height=height, inside=inside, outside=total - inside
        )
        if widened:
            words += " " + self.tr("The fit widens it to the edge of the area if almost no points lie between.")
        self.reason.setText(in_lengths(words) + " " + self.tr("Press Use to take it."))


def _fit_words(button: QPushButton) -> None:
    """Make a button narrow enough for all of them to be in two lines of a dock."""
    words = button.fontMetrics().horizontalAdvance(button.text())
    button.setMinimumWidth(words + 22)
    button.setMaximumWidth(words + 34)
