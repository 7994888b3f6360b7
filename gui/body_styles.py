"""How bodies are drawn, named and deleted: from the tree, its menu, the panel and the scene to commands."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, QPoint, Qt, QTimer, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QColorDialog, QInputDialog, QMenu, QWidget

from geofit.gui.fitting import Fitting
from geofit.gui.workspace import Workspace
from geofit.project.body_commands import DeleteBody, RenameBody, StyleBody
from geofit.project.body_record import BodyStyle
from geofit.project.document import Document

__all__ = ["BodyStyles"]

#: A slider that is dragged is one step, milliseconds after it rests.
REST = 400
OPACITIES = (1.0, 0.75, 0.5, 0.25)


class BodyStyles(QObject):
    """Changes of style, name and existence of bodies; ``export_requested(name)`` asks to write one."""

    export_requested = Signal(str)

    def __init__(self, document: Document, fitting: Fitting, workspace: Workspace, window: QWidget) -> None:
        super().__init__(window)
        self._document, self._fitting, self._panels, self._window = document, fitting, workspace, window
        tree, panel = workspace.tree, workspace.bodies
        tree.body_checked.connect(lambda name, on: self.restyle(name, visible=on))
        tree.view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        tree.view.customContextMenuRequested.connect(self._menu)
        panel.rename_requested.connect(self.ask_name)
        panel.delete_requested.connect(self.delete)
        self._rest = QTimer(self, singleShot=True, interval=REST)
        self._rest.timeout.connect(self._take_over)
        self._end = workspace.view.layers.subscribe(self._listen)

    def close(self) -> None:
        """Listen no more."""
        self._rest.stop()
        self._end()

    def restyle(self, name: str, **changes: object) -> None:
        """Change colour, opacity or visibility of a body."""
        record = self._document.state.bodies.get(name)
        if record is not None and (style := replace(record.style, **changes)) != record.style:  # type: ignore[arg-type]
            self._fitting.push(StyleBody(name, style))

    def rename(self, name: str, new: str) -> None:
        """Give a body another name."""
        if new.strip() and new.strip() != name:
            self._fitting.push(RenameBody(name, new.strip()))

    def delete(self, name: str) -> None:
        """Take a body out of the document; it can be undone."""
        self._fitting.push(DeleteBody(name))

    def ask_name(self, name: str) -> None:
        """Ask for another name of a body."""
        new, given = QInputDialog.getText(self._window, self.tr("Rename body"), self.tr("Name of the body"), text=name)
        if given:
            self.rename(name, new)

    def ask_colour(self, name: str) -> None:
        """Ask for another colour of a body."""
        style = self._document.state.bodies[name].style
        colour = QColorDialog.getColor(
            QColor(style.colour), self._window, self.tr("Colour of {name}").format(name=name)
        )
        if colour.isValid():
            self.restyle(name, colour=colour.name())

    def menu_for(self, name: str) -> QMenu:
        """Return the menu of a body."""
        style = self._document.state.bodies[name].style
        menu = QMenu(self._window)
        shown = menu.addAction(self.tr("Show"))
        shown.setCheckable(True)
        shown.setChecked(style.visible)
        shown.toggled.connect(lambda on: self.restyle(name, visible=on))
        menu.addAction(self.tr("Zoom to")).triggered.connect(lambda: self._panels.view.zoom_to(f"body:{name}"))
        menu.addAction(self.tr("Colour…")).triggered.connect(lambda: self.ask_colour(name))
        clear = menu.addMenu(self.tr("Opacity"))
        for opacity in OPACITIES:
            action = clear.addAction(self.tr("{percent} %").format(percent=round(100 * opacity)))
            action.setCheckable(True)
            action.setChecked(opacity == style.opacity)
            action.triggered.connect(lambda _=False, opacity=opacity: self.restyle(name, opacity=opacity))
        menu.addSeparator()
        menu.addAction(self.tr("Rename…")).triggered.connect(lambda: self.ask_name(name))
        export = menu.addAction(self.tr("Export…"))
        export.setEnabled(self._document.body(name) is not None)
        export.triggered.connect(lambda: self.export_requested.emit(name))
        menu.addAction(self.tr("Delete")).triggered.connect(lambda: self.delete(name))
        return menu

    def _menu(self, at: QPoint) -> None:
        tree = self._panels.tree
        name = tree.body_at(at)
        if name in self._document.state.bodies and name is not None:
            menu = self.menu_for(name)
            menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            menu.popup(tree.view.viewport().mapToGlobal(at))

    def _listen(self, what: str, key: str) -> None:
        if what == "changed" and key.startswith("body:"):
            self._rest.start()

    def _take_over(self) -> None:
        """Take what was changed in the scene into the document."""
        layers = self._panels.view.layers
        for name, record in tuple(self._document.state.bodies.items()):
            key = f"body:{name}"
            if key in layers:
                layer = layers[key]
                style = BodyStyle(record.style.colour, layer.opacity, layer.visible)
                if style != record.style and self._document.body(name) is not None:
                    self._fitting.push(StyleBody(name, style))
