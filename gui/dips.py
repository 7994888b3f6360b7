"""Measured dips: from the document to the stereonet, and one selection of them in the net, its table and the scene."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from geofit.gui.showing import Showing
from geofit.gui.translate import translated
from geofit.gui.workspace import Workspace
from geofit.project.dip_table import dip_lines, dip_table
from geofit.project.document import Document
from geofit.report.style import horizon_colours

__all__ = ["Dips"]


class Dips(QObject):
    """Shows the dips of the chosen horizon. ``reported(text)`` says in the status bar which one was chosen."""

    reported = Signal(str)

    def __init__(self, document: Document, panels: Workspace, showing: Showing, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._panels = document, panels
        panels.stereonet.dip_chosen.connect(self._chosen_in_panel)
        panels.view.pointer.dip_picked.connect(self._picked)
        showing.also.append(self.show)

    def show(self) -> None:
        """Show the dips of the chosen horizon, and those of the site."""
        document = self._document
        measured, name = document.site.orientations, document.selection.horizon or ""
        if measured is None or not len(measured):
            self._panels.stereonet.show_dips(name, {}, {})
            return
        surface = document.surface(name) if name in document.site.horizons else None
        whole = document.whole(name) if name else ""
        tables = {
            False: dip_table(measured, name, surface, whole),
            True: dip_table(measured, "", surface, whole),
        }
        colours = horizon_colours([*document.horizons, *document.read.horizons], document.site.blocks)
        self._panels.stereonet.show_dips(name, tables, colours)

    def _chosen_in_panel(self, index: int) -> None:
        self._say(index)
        measured, view = self._document.site.orientations, self._panels.view
        if measured is not None:
            x, y, z = measured.xyz[index].tolist()
            view.focus_place(x, y, z)

    def _picked(self, index: int) -> None:
        self._say(index)
        self._panels.stereonet.choose(index)
        self._panels.reveal("stereonet")

    def _say(self, index: int) -> None:
        measured = self._document.site.orientations
        if measured is None:
            return
        words = [translated(line) for line in dip_lines(measured, index)]
        self._panels.view.pointer.surround(measured.xyz[index], words[0])
        self.reported.emit(" · ".join(words))
