"""All keys of the window, by menu."""

from __future__ import annotations

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QMenu,
    QMenuBar,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
)

from geofit.gui.translate import bare

__all__ = ["ShortcutsDialog"]


#: Pixels between an action and its keys.
GAP = 16


class ShortcutsDialog(QDialog):
    """Lists every action of a menu bar that has a key."""

    def __init__(self, bar: QMenuBar) -> None:
        super().__init__(bar.window())
        self.setWindowTitle(self.tr("Keyboard shortcuts"))
        self.tree = QTreeWidget()
        self.tree.setHeaderLabels([self.tr("Action"), self.tr("Key")])
        for entry in bar.actions():
            menu = entry.menu()
            rows = _rows(menu.actions()) if isinstance(menu, QMenu) else []
            if rows:
                item = QTreeWidgetItem(self.tree, [bare(entry.text())])
                item.addChildren([QTreeWidgetItem(list(row)) for row in rows])
        self.tree.expandAll()
        self.tree.resizeColumnToContents(0)
        self.tree.setColumnWidth(0, self.tree.columnWidth(0) + GAP)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(self.tree)
        layout.addWidget(buttons)
        self.resize(460, 560)


def _rows(actions: list[QAction]) -> list[tuple[str, str]]:
    native = QKeySequence.SequenceFormat.NativeText
    rows = []
    for action in actions:
        below = action.menu()
        if isinstance(below, QMenu):
            rows += _rows(below.actions())
        elif action.shortcuts():
            rows.append((action.iconText(), ", ".join(key.toString(native) for key in action.shortcuts())))
    return rows
