"""Offers the work of sessions that did not end."""

from __future__ import annotations

import time
from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.translate import translated
from geofit.project.journal import Unfinished

__all__ = ["RecoveryDialog"]

#: Steps of a session that its entry names.
_NAMED = 3


class RecoveryDialog(QDialog):
    """Asks which session to bring back: ``chosen`` is it, or None; ``discarded`` if the others are not wanted."""

    def __init__(self, sessions: Sequence[Unfinished], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Bring back unsaved work"))
        self.chosen: Unfinished | None = None
        self.discarded = False
        text = QLabel(self.tr("geofit did not close properly. This work was not saved:"))
        text.setWordWrap(True)
        self.list = QListWidget()
        text.setBuddy(self.list)
        self.list.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        for session in sessions:
            item = QListWidgetItem(self._describe(session))
            item.setData(Qt.ItemDataRole.UserRole, session)
            self.list.addItem(item)
        self.list.setCurrentRow(0)
        self.list.itemDoubleClicked.connect(self._bring_back)
        buttons = QDialogButtonBox()
        self.bring_back = QPushButton(self.tr("&Bring back"))
        self.discard = QPushButton(self.tr("&Discard all"))
        later = QPushButton(self.tr("Ask me &later"))
        buttons.addButton(self.bring_back, QDialogButtonBox.ButtonRole.AcceptRole)
        buttons.addButton(self.discard, QDialogButtonBox.ButtonRole.DestructiveRole)
        buttons.addButton(later, QDialogButtonBox.ButtonRole.RejectRole)
        self.bring_back.setDefault(True)
        self.bring_back.clicked.connect(self._bring_back)
        self.discard.clicked.connect(self._discard)
        later.clicked.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(text)
        layout.addWidget(self.list)
        layout.addWidget(buttons)
        self.resize(560, 300)

    def _describe(self, session: Unfinished) -> str:
        file = session.project_file or session.site_file
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(session.time))
        steps = [translated(command.text) for command in session.commands]
        last = "; ".join(steps[-_NAMED:])
        more = "… " if len(steps) > _NAMED else ""
        return self.tr("{site} – {when} – steps ({count}): {steps}\n{file}").format(
            site=session.base.name, when=when, count=len(steps), steps=more + last, file=file or ""
        )

    def _bring_back(self) -> None:
        item = self.list.currentItem()
        self.chosen = None if item is None else item.data(Qt.ItemDataRole.UserRole)
        self.accept()

    def _discard(self) -> None:
        self.discarded = True
        self.reject()
