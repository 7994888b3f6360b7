"""What lies under the pointer, in words and in a menu: in the scene, and in the project tree."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from PySide6.QtCore import QObject, QPoint, QPointF, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QInputDialog, QMenu, QMessageBox, QToolTip, QWidget

from geofit.data.messages import Message
from geofit.gui.actions import Actions
from geofit.gui.fitting import Fitting
from geofit.gui.lengths import in_lengths
from geofit.gui.names import literal
from geofit.gui.panels.curtain import site_extent
from geofit.gui.selecting import Selecting
from geofit.gui.translate import translated
from geofit.gui.view3d.picking import Hit
from geofit.gui.workspace import Workspace
from geofit.project.commands import RemoveHorizons, RenameHorizon
from geofit.project.dip_table import dip_lines
from geofit.project.document import Document
from geofit.project.identify import hole_lines, point_lines, surface_lines
from geofit.project.provenance import Row

__all__ = ["ContextMenus"]

#: Length to each side of a section through a place, as a share of the scene's longer side.
SIDE = 0.35
#: Kinds of layers whose things are named under the pointer.
_NAMED = ("points", "holes", "adits", "dips", "surface")


class ContextMenus(QObject):
    """Menus of horizons, points, holes and places; and what the pointer rests on, in a tool tip."""

    def __init__(
        self, document: Document, panels: Workspace, fitting: Fitting, selecting: Selecting, actions: Actions,
        window: QWidget,
    ) -> None:  # fmt: skip
        super().__init__(window)
        self._document, self._panels, self._fitting = document, panels, fitting
        self._selecting, self._actions, self._window = selecting, actions, window
        pointer = panels.view.pointer
        pointer.rested.connect(self._tell)
        pointer.asked.connect(self._ask)
        panels.tree.menu_requested.connect(self._ask_tree)

    def words(self, hit: Hit) -> str:
        """Return what is known of the thing under the pointer, a line each; empty where nothing is."""
        return in_lengths("\n".join(map(translated, self._lines(hit))))

    def menu_at(self, hit: Hit | None) -> QMenu:
        """Return the menu of what lies under the pointer; of the scene itself where nothing does."""
        menu = QMenu(self._window)
        if hit is None or hit.layer.kind not in _NAMED:
            for name in ("home", "top", "clip", "measure"):
                menu.addAction(self._actions[name])
            return menu
        head = menu.addAction(literal(self.words(hit).split("\n", 1)[0]))
        head.setEnabled(False)
        menu.addSeparator()
        if hit.layer.kind == "points":
            row = self._row(hit)
            out = row in self._document.state.excluded.get(hit.layer.horizon, frozenset())
            words = self.tr("Include point") if out else self.tr("Exclude point")
            self._add(menu, words, lambda: self._fitting.exclude(hit.layer.horizon, (row,)))
            self._add(menu, self.tr("Show in the residual table"), partial(self._to_table, hit.layer.horizon, row))
        self._add(menu, self.tr("Section through here"), partial(self._section, hit))
        self._add(menu, self.tr("Properties…"), partial(self._properties, self.words(hit)))
        if hit.layer.horizon:
            menu.addSeparator()
            self._fill(menu, hit.layer.horizon)
        else:
            self._add(menu, self.tr("Hide"), lambda: self._panels.view.layers.change(hit.layer.key, visible=False))
        return menu

    def menu_of(self, kind: str, name: str) -> QMenu:
        """Return the menu of a row of the project tree: "horizon", "hole" or "section"."""
        menu = QMenu(self._window)
        if kind == "horizon":
            self._fill(menu, name)
        elif kind == "hole":
            self._add(menu, self.tr("Go to"), lambda: self._panels.view.focus_hole(name))
            words = in_lengths("\n".join(map(translated, hole_lines(self._document.site, name))))
            self._add(menu, self.tr("Properties…"), partial(self._properties, words))
        elif kind == "section":
            self._add(menu, self.tr("Cut here"), lambda: self._panels.tree.section_chosen.emit(name))
        return menu

    def _fill(self, menu: QMenu, name: str) -> None:
        """Add what can be done with a horizon."""
        document, layers = self._document, self._panels.view.layers
        # Of the horizon in the panel as its own button does: with what is written there.
        fit = self._actions["fit"].trigger if name == document.selection.horizon else partial(self._fitting.fit, name)
        self._add(menu, self.tr("Fit"), fit)
        examine = self._add(menu, self.tr("Examine away from the data"), lambda: self._fitting.examine(name))
        examine.setEnabled(document.surface(name) is not None)
        menu.addSeparator()
        own = [layer.key for layer in layers if layer.horizon == name]
        others = [layer.key for layer in layers if layer.horizon and layer.horizon != name]
        shown = any(layers[key].visible for key in own)
        self._add(menu, self.tr("Hide") if shown else self.tr("Show"), lambda: self._show(own, not shown))
        self._add(menu, self.tr("Isolate"), partial(self._isolate, own, others))
        self._add(menu, self.tr("Show all"), lambda: self._show([*own, *others], True))
        menu.addSeparator()
        self._add(menu, self.tr("Rename…"), partial(self._rename, name))
        merge = menu.addMenu(self.tr("Merge with"))
        for other in document.horizons:
            if other != name:
                merge.addAction(literal(other)).triggered.connect(lambda _=False, other=other: self._merge(name, other))
        remove = self._add(menu, self.tr("Remove from the site"), lambda: self._remove(name))
        remove.setEnabled(len(document.horizons) > 1)
        menu.addSeparator()
        export = self._add(menu, self.tr("Export…"), lambda: self._export(name))
        export.setEnabled(document.surface(name) is not None)

    def _add(self, menu: QMenu, words: str, do: Callable[[], object]) -> QAction:
        action = menu.addAction(words)
        action.triggered.connect(lambda *_: do())
        return action

    def _row(self, hit: Hit) -> Row:
        return Row.of(self._panels.view.contents.points[hit.layer.horizon], int(hit.which))

    def _lines(self, hit: Hit) -> tuple[Message, ...]:
        document, name = self._document, hit.layer.horizon
        if hit.layer.kind == "points":
            listing = document.listing(name)
            row = self._row(hit)
            index = listing.index(row)
            if index is None:
                return ()
            residuals = self._panels.view.contents.residuals(name)
            residual = None if residuals is None else float(residuals[int(hit.which)])
            out = row in document.state.excluded.get(name, frozenset())
            return point_lines(name, listing.points, index, residual, excluded=out)
        if hit.layer.kind == "dips":
            measured = document.site.orientations
            return () if measured is None else dip_lines(measured, int(hit.which))
        if hit.layer.kind in ("holes", "adits"):
            return hole_lines(document.site, str(hit.which), hit.xyz)
        surface = document.surface(name) if hit.layer.kind == "surface" else None
        if surface is None:
            return ()
        prediction = document.prediction(name)
        return surface_lines(surface, hit.xyz, None if prediction is None else prediction.uncertainty)

    def _tell(self, hit: Hit | None, at: QPointF) -> None:
        canvas = self._panels.view.canvas
        words = "" if hit is None else self.words(hit)
        QToolTip.showText(canvas.mapToGlobal(at.toPoint()), words, canvas)

    def _ask(self, hit: Hit | None, at: QPointF) -> None:
        self._pop_up(self.menu_at(hit), self._panels.view.canvas.mapToGlobal(at.toPoint()))

    def _ask_tree(self, kind: str, name: str, at: QPoint) -> None:
        self._pop_up(self.menu_of(kind, name), at)

    def _pop_up(self, menu: QMenu, at: QPoint) -> None:
        if menu.isEmpty():
            menu.deleteLater()
            return
        QToolTip.hideText()
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(at)

    def _show(self, keys: list[str], visible: bool) -> None:
        for key in keys:
            self._panels.view.layers.change(key, visible=visible)

    def _isolate(self, own: list[str], others: list[str]) -> None:
        self._show(others, False)
        self._show(own, True)

    def _to_table(self, horizon: str, row: Row) -> None:
        self._document.select(horizon, row)
        self._panels.reveal("residuals")

    def _section(self, hit: Hit) -> None:
        """Cut a section from west to east through a place."""
        size = np.ptp(site_extent(self._document.site, {}), axis=0).max()
        x, y = float(hit.xyz[0]), float(hit.xyz[1])
        line = np.array([[x - SIDE * size, y], [x + SIDE * size, y]])
        self._panels.section.line_changed.emit(line)
        self._actions["section"].setChecked(True)

    def _properties(self, words: str) -> None:
        box = QMessageBox(self._window)
        box.setWindowTitle(self.tr("Properties"))
        box.setTextFormat(Qt.TextFormat.PlainText)
        box.setText(words)
        box.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        box.exec()

    def _rename(self, name: str) -> None:
        new, given = QInputDialog.getText(self._window, self.tr("Rename"), self.tr("Name of the horizon"), text=name)
        if given and new.strip() != name:
            self._fitting.push(RenameHorizon(name, new.strip()))

    def _merge(self, name: str, other: str) -> None:
        new, given = QInputDialog.getText(
            self._window, self.tr("Merge"), self.tr("Name of the merged horizon"), text=name
        )
        if given:
            self._fitting.push(self._document.merging((name, other), new.strip()))

    def _remove(self, name: str) -> None:
        self._fitting.push(RemoveHorizons((name,)))

    def _export(self, name: str) -> None:
        self._document.select(name)
        self._actions["export_step"].trigger()
