"""One selection in all windows: what is clicked in one is shown in the others."""

from __future__ import annotations

from numpy.typing import ArrayLike
from PySide6.QtCore import QObject, Signal

from geofit.gui.fitting import point_not_fitted
from geofit.gui.showing import Showing
from geofit.gui.translate import translated
from geofit.gui.workspace import Workspace
from geofit.project.document import Document, Selection
from geofit.project.provenance import Row

__all__ = ["Selecting"]


class Selecting(QObject):
    """Links tree, tables, plan, section and view. ``reported(text)`` reports what was chosen, for the status bar."""

    reported = Signal(str)

    def __init__(self, document: Document, workspace: Workspace, showing: Showing, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._panels, self._showing = document, workspace, showing
        self._from_view = False
        panels = workspace
        panels.tree.horizon_chosen.connect(lambda name: document.select(name))
        panels.tree.patch_chosen.connect(lambda name, _patch: document.select(name))
        panels.tree.hole_chosen.connect(self._go_to_hole)
        panels.tree.section_chosen.connect(self._go_to_section)
        panels.view.point_picked.connect(self._picked)
        panels.view.hole_picked.connect(self._hole_picked)
        panels.view.control_picked.connect(self._control_picked)
        panels.adjust.control_chosen.connect(self._mark_control)
        panels.view.section_changed.connect(self._line_drawn)
        panels.section.line_changed.connect(self._line_edited)
        panels.section.thickness_changed.connect(self._thickness_edited)
        panels.section.point_chosen.connect(document.select)
        for table in (panels.residuals.point_chosen, panels.checks.point_chosen, panels.prediction.point_chosen):
            table.connect(self._chosen_here)
        panels.prediction.suggestion_chosen.connect(self._suggestion_chosen)
        panels.checks.place_chosen.connect(panels.view.focus_place)
        panels.tree.zoom_requested.connect(panels.view.zoom_to)
        panels.seams.seam_chosen.connect(self._seam_chosen)
        document.selection_changed.connect(self._show)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._document.selection_changed.disconnect(self._show)

    def index(self) -> int | None:
        """Return the chosen point as an index into all points of its horizon; None where there is none."""
        chosen = self._document.selection
        if chosen.horizon is None or chosen.row is None:
            return None
        return self._document.listing(chosen.horizon).index(chosen.row)

    def rows(self) -> tuple[Row, ...]:
        """Return the rows that are selected in the residual table, or the chosen one."""
        chosen, many = self._document.selection.row, self._panels.residuals.chosen_rows()
        if chosen is None:
            return many
        return many if chosen in many else (chosen,)

    def go_to_worst(self) -> None:
        """Choose the point of the chosen horizon that lies farthest from its surface."""
        name = self._document.selection.horizon
        surface = None if name is None else self._document.surface(name)
        if name is None or surface is None or surface.accuracy is None or not surface.accuracy.worst:
            self.reported.emit(self.tr("There is no surface yet: press Fit."))
            return
        self._document.select(name, Row.of(surface.points, surface.accuracy.worst[0]))

    def _chosen_here(self, row: Row) -> None:
        if self._document.selection.horizon is not None:
            self._document.select(self._document.selection.horizon, row)

    def _picked(self, name: str, row: Row) -> None:
        self._from_view = True
        self._document.select(name, row)
        self._from_view = False

    def _show(self, chosen: Selection) -> None:
        self._showing.now()
        index, panels = self.index(), self._panels
        if chosen.horizon is None:
            return
        row = None if index is None else chosen.row
        panels.tree.choose_horizon(chosen.horizon)
        panels.view.highlight_point(chosen.horizon, row)
        surface = self._document.surface(chosen.horizon)
        if surface is not None:
            panels.residuals.choose(row)
        if index is None or row is None:
            return
        if not self._from_view:
            panels.view.focus_point(chosen.horizon, row)
        fitted = None if surface is None else row.find(surface.points)
        panels.adjust.choose_point(
            fitted, "" if fitted is not None else translated(point_not_fitted(chosen.horizon, row))
        )
        points = self._document.listing(chosen.horizon).points
        self.reported.emit(f"{chosen.horizon}: {translated(points.describe(index))}")

    def _go_to_hole(self, name: str) -> None:
        self._panels.view.focus_hole(name)
        self.reported.emit(name)

    def _hole_picked(self, name: str) -> None:
        self._panels.tree.choose_hole(name)
        self.reported.emit(name)

    def _control_picked(self, horizon: str, patch: str, i: int, j: int) -> None:
        self._document.select(horizon)
        self._showing.now()
        self._panels.adjust.choose_control(patch, i, j)
        self._mark_control(patch, i, j)
        self._panels.reveal("adjust")

    def _mark_control(self, patch: str, i: int, j: int) -> None:
        if self._document.selection.horizon is not None:
            self._panels.view.highlight_control(self._document.selection.horizon, patch, i, j)

    def _go_to_section(self, name: str) -> None:
        section = next(one for one in self._document.site.sections if one.name == name)
        self._line_edited(section.line)
        self._showing.show_section()
        self._panels.reveal("section")

    def _line_drawn(self, line: ArrayLike | None) -> None:
        self._showing.line = line
        self._showing.show_section()

    def _line_edited(self, line: ArrayLike | None) -> None:
        self._showing.line = line
        self._panels.view.set_section(line, self._showing.thickness)

    def _thickness_edited(self, thickness: float) -> None:
        self._showing.thickness = thickness
        if self._showing.line is not None:
            self._panels.view.set_section(self._showing.line, thickness)

    def _suggestion_chosen(self, x: float, y: float, z: float) -> None:
        layers, key = self._panels.view.layers, f"suggestions:{self._document.selection.horizon}"
        if key in layers:
            layers.change(key, visible=True)
        self._panels.view.focus_place(x, y, z)

    def _seam_chosen(self, index: int) -> None:
        name, view = self._document.selection.horizon, self._panels.view
        if name is None:
            return
        view.set_seams(name)
        place = view.contents.seam_place(name, index)
        if place is not None:
            view.focus_place(*place)
