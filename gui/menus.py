"""The menu bar and the tool bar: which action stands where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QKeySequence, QUndoStack
from PySide6.QtWidgets import QMainWindow, QMenu, QSizePolicy, QToolBar, QWidget

from geofit.gui.actions import Actions
from geofit.gui.icons import palette_icon
from geofit.gui.names import literal
from geofit.gui.translate import bare

__all__ = ["Menus"]

#: Actions of the tool bar, a bar between groups.
_TOOLS = (
    "open", "save", "|", "undo", "redo", "|", "fit", "fit_all", "examine", "|", "home", "clip", "measure", "section",
    "|", "export_step", "report",
)  # fmt: skip


class Menus(QObject):
    """Builds the menus of a window; ``recent`` and ``panels`` are filled by others."""

    def __init__(self, window: QMainWindow, actions: Actions, stack: QUndoStack) -> None:
        super().__init__(window)
        self._window, self._actions = window, actions
        self.undo, self.redo = QAction(window), QAction(window)
        self.undo.setShortcut(QKeySequence("Ctrl+Z"))
        self.redo.setShortcuts([QKeySequence("Ctrl+Y"), QKeySequence("Ctrl+Shift+Z")])
        self._connect(stack)
        self.draw_icons()
        bar = window.menuBar()
        file = self._menu(bar.addMenu(self.tr("&File")), "new open sample")
        self.recent = file.addMenu(self.tr("Open &recent"))
        self._menu(
            file,
            "| add_data reload | save save_as | export_step export_other section_sheet plan_sheet report screenshot "
            "| issues close | quit",
        )
        edit = bar.addMenu(self.tr("&Edit"))
        edit.addActions([self.undo, self.redo])
        self._menu(edit, "steps | exclude rename | preferences")
        view = self._menu(bar.addMenu(self.tr("&View")), "home top north south east west iso | orthographic clip")
        view.addMenu(_group_menu(self.tr("Vertical e&xaggeration"), actions.exaggerations.actions(), window))
        self._menu(view, "faded control_points seams |")
        self.panels = view.addMenu(self.tr("&Panels"))
        view.addMenu(_group_menu(self.tr("T&heme"), actions.themes.actions(), window))
        view.addMenu(_group_menu(self.tr("&Language"), actions.languages.actions(), window))
        horizon = "fit fit_all | build_horizon | examine compare_fits worst | order check_order separate | stop"
        self._menu(bar.addMenu(self.tr("Hori&zon")), horizon)
        self._menu(bar.addMenu(self.tr("&Tools")), "measure section | rock_volume survey")
        self._menu(bar.addMenu(self.tr("&Help")), "help tutorial shortcuts | system_report about")
        self.tools = self._tool_bar()

    def _connect(self, stack: QUndoStack) -> None:
        """Let undo and redo follow the stack; not Qt's own actions, which put the key's mark amid a Chinese text."""
        self.undo.triggered.connect(stack.undo)
        self.redo.triggered.connect(stack.redo)
        for action, words, able, changed in (
            (self.undo, self.tr("&Undo"), stack.canUndo(), stack.canUndoChanged),
            (self.redo, self.tr("&Redo"), stack.canRedo(), stack.canRedoChanged),
        ):
            action.setIconText(bare(words))
            action.setEnabled(able)
            changed.connect(action.setEnabled)
        stack.undoTextChanged.connect(self._name_undo)
        stack.redoTextChanged.connect(self._name_redo)
        self._name_undo(stack.undoText())
        self._name_redo(stack.redoText())

    def _name_undo(self, step: str) -> None:
        named = self.tr("&Undo {step}").format(step=literal(step))
        self.undo.setText(named if step else self.tr("&Undo"))

    def _name_redo(self, step: str) -> None:
        named = self.tr("&Redo {step}").format(step=literal(step))
        self.redo.setText(named if step else self.tr("&Redo"))

    def draw_icons(self) -> None:
        """Draw the icons anew, in the colours of the present theme."""
        self.undo.setIcon(palette_icon("undo"))
        self.redo.setIcon(palette_icon("redo"))

    def show_recent(self, files: Sequence[Path], choose: Callable[[Path], object]) -> None:
        """Fill the menu of recent files."""
        self.recent.clear()
        self.recent.setEnabled(bool(files))
        for number, file in enumerate(files, 1):
            name = literal(f"{file.parent.name}/{file.name}")
            action = self.recent.addAction(f"&{number % 10} {name}")
            action.setToolTip(str(file))
            action.triggered.connect(lambda _=False, file=file: choose(file))

    def show_panels(self, switches: Sequence[QAction]) -> None:
        """Fill the menu of panels."""
        self.panels.clear()
        self.panels.addActions(list(switches))
        self._menu(self.panels, "| fold next_panel previous_panel | reset_layout")

    def _menu(self, menu: QMenu, names: str) -> QMenu:
        for name in names.split():
            if name == "|":
                menu.addSeparator()
            else:
                menu.addAction(self._actions[name])
        menu.setToolTipsVisible(True)
        return menu

    def _tool_bar(self) -> QToolBar:
        bar = QToolBar(self.tr("Tool bar"), self._window)
        bar.setObjectName("tool bar")
        bar.setMovable(False)
        for name in _TOOLS:
            if name == "|":
                bar.addSeparator()
            elif name in ("undo", "redo"):
                bar.addAction(getattr(self, name))
            else:
                bar.addAction(self._actions[name])
        filler = QWidget()
        filler.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        bar.addWidget(filler)
        self._window.addToolBar(bar)
        return bar


def _group_menu(title: str, choices: Sequence[QAction], window: QMainWindow) -> QMenu:
    menu = QMenu(title, window)
    menu.addActions(list(choices))
    return menu
