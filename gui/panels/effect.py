"""The effect of a manual edit on the check, before it is applied."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel

from geofit.data.accuracy import Accuracy
from geofit.fitting.preview import MoveEffect
from geofit.gui.lengths import in_title, shown_length
from geofit.report.digits import metres

__all__ = ["Effect"]


class Effect(QFrame):
    """Figures before and after a change."""

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(8, 6, 8, 6)
        self._grid.setHorizontalSpacing(10)
        self._grid.setVerticalSpacing(2)
        self.cells = [[QLabel() for _ in range(3)] for _ in range(5)]
        for k, row in enumerate(self.cells):
            for c, label in enumerate(row):
                self._grid.addWidget(label, k, c, Qt.AlignmentFlag.AlignRight if c else Qt.AlignmentFlag.AlignLeft)
        self._grid.setColumnStretch(0, 1)
        self.words = QLabel()
        self.words.setWordWrap(True)
        self._grid.addWidget(self.words, 5, 0, 1, 3)

    def say(self, text: str) -> None:
        """Show a sentence instead of figures."""
        for label in (label for row in self.cells for label in row):
            label.hide()
        self.words.setText(text)
        self.words.show()

    def show_effect(self, before: Accuracy, after: Accuracy, *, applied: bool = False) -> None:
        """Show both checks, of a change that is tried, or ``applied`` already."""
        self._show_rows(before, after, title=self.tr("Applied") if applied else self.tr("Effect"))
        verdict = self.tr("{before} → {after}").format(before=before.verdict, after=after.verdict)
        self.words.setText(verdict)
        # Another control error may have been set between them: then it is not the change that turned the verdict.
        self.words.setVisible(before.passed != after.passed and before.epsilon == after.epsilon)

    def show_move(self, before: Accuracy, after: MoveEffect) -> None:
        """Show the figures of a move that goes on; its verdict is not known yet."""
        count = before.over["epsilon"].count if "epsilon" in before.over else 0
        self._show_rows(
            before, after, (self.tr("points beyond ε"), str(count), str(after.beyond)), title=self.tr("Effect")
        )
        self.words.hide()

    def _show_rows(
        self, before: Accuracy, after: Accuracy | MoveEffect, *more: tuple[str, str, str], title: str
    ) -> None:
        worst = before.worst[0] if before.worst else None
        rows: list[tuple[str, str, str]] = [
            (title, self.tr("before"), self.tr("after")),
            (self.tr("σ, m"), _figure(before.sigma), _figure(after.sigma)),
            (self.tr("max |d|, m"), _figure(before.max_abs), _figure(after.max_abs)),
        ]
        if worst is not None and worst < len(after.residuals):
            d0, d1 = before.residuals[worst], after.residuals[worst]
            rows.append((self.tr("worst point's d, m"), _figure(d0), _figure(d1)))
        rows += more
        for k, row in enumerate(self.cells):
            for c, label in enumerate(row):
                label.setVisible(k < len(rows))
                label.setText(in_title(rows[k][c]) if k < len(rows) else "")
        font = self.font()
        font.setBold(True)
        for label in self.cells[0]:
            label.setFont(font)


def _figure(length: float) -> str:
    """Write metres in the unit that is shown."""
    return metres(shown_length(float(length)))
