"""The list of keys: whole words, and no step of today in it."""

from __future__ import annotations

import pytest
from panel_samples import SITE, sample_site
from PySide6.QtWidgets import QTreeWidgetItemIterator

from geofit.gui.dialogs.shortcuts import ShortcutsDialog
from geofit.project.commands import RenameSite


@pytest.fixture
def dialog(app, qtbot):
    app.desktop.session.begin(sample_site(), SITE)
    app.desktop.session.push(RenameSite("Another"))
    app.idle()
    assert app.window.menus.undo.text() != "Undo"
    dialog = ShortcutsDialog(app.window.menuBar())
    qtbot.addWidget(dialog)
    dialog.show()
    yield dialog
    dialog.close()


def rows(dialog):
    each = QTreeWidgetItemIterator(dialog.tree)
    while each.value() is not None:
        yield each.value()
        each += 1


def test_nothing_is_cut(dialog):
    tree = dialog.tree
    assert tree.header().length() <= tree.viewport().width()
    for row in rows(dialog):
        for column in range(2):
            depth = tree.indentation() * (2 if row.parent() else 1) if column == 0 else 0
            needed = tree.fontMetrics().horizontalAdvance(row.text(column)) + depth
            assert needed < tree.columnWidth(column), row.text(column)


def test_undo_is_called_undo(dialog):
    words = [row.text(0) for row in rows(dialog)]
    assert "Undo" in words
    assert "Redo" in words
    assert "Next panel" in words
    assert not any("Another" in word for word in words)
