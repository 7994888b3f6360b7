"""The verdict: a word and three lamps with the figures behind them, shown by shape and word as well as colour."""

from __future__ import annotations

import re

from PySide6.QtCore import QEvent, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QSizePolicy, QWidget

from geofit.data.accuracy import Accuracy
from geofit.data.verdict import Lamp, Level, Verdict, verdict_of
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.marks import level_mark, paint, readable
from geofit.gui.theme import is_dark
from geofit.gui.translate import translated
from geofit.report.digits import count, given, metres
from geofit.report.style import FAIL, PASS, QUIET, WARNING

__all__ = ["VerdictBadge", "verdict_word"]

_COLOURS: dict[Level, str] = {"none": QUIET, "pass": PASS, "warning": WARNING, "fail": FAIL}


class _Mark(QWidget):
    """A painted mark."""

    def __init__(self, size: int) -> None:
        super().__init__()
        self.name = "none"
        self.setFixedSize(QSize(size, size))

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the mark."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        paint(painter, QRectF(self.rect()).adjusted(2, 2, -2, -2), self.name)
        painter.end()


class VerdictBadge(QFrame):
    """A badge: the word, then a row a lamp; hatched where the result is stale."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.mark, self._word, self._more, self._old = _Mark(26), QLabel(), QLabel(), QLabel()
        self.lamps = [(_Mark(18), QLabel()) for _ in range(3)]
        self._size_texts()
        texts = (*(label for _, label in self.lamps), self._more, self._old)
        for label in texts:
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        grid = QGridLayout(self)
        grid.setContentsMargins(12, 6, 8, 6)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(3)
        grid.addWidget(self.mark, 0, 0, Qt.AlignmentFlag.AlignHCenter)
        grid.addWidget(self._word, 0, 1)
        for row, (mark, label) in enumerate(self.lamps, 1):
            grid.addWidget(mark, row, 0, Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignHCenter)
            grid.addWidget(label, row, 1)
        grid.addWidget(self._more, 4, 1)
        grid.addWidget(self._old, 5, 0, 1, 2)
        grid.setColumnStretch(1, 1)
        # Maximum would cap the height at the size hint, which assumes wider lines, and cut long texts in a narrow dock.
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Minimum)
        self._level: Level = "none"
        self._stale = False
        self.show_accuracy(None, False)

    @property
    def text(self) -> str:
        """Everything that the badge says, in lines."""
        labels = (self._word, *(label for _, label in self.lamps), self._more, self._old)
        return "\n".join(label.text() for label in labels if label.text()).replace("\N{NO-BREAK SPACE}", " ")

    def show_accuracy(
        self,
        accuracy: Accuracy | None,
        stale: bool = False,
        verdict: Verdict | None = None,
        waiting: bool = False,
        *,
        stopped: bool = False,
    ) -> None:
        """Show the check of a surface, None while there is none; ``verdict`` has what else is known of it.

        ``waiting`` states that there is a surface, which is still being read or made; ``stopped`` that its making was
        stopped.
        """
        self._stale = stale and accuracy is not None
        judged = verdict_of(accuracy) if verdict is None and accuracy is not None else verdict
        self._level = "none" if judged is None else judged.level
        self.mark.name = level_mark(self._level)
        if waiting:
            word = self.tr("Reading the surface…")
            advice = self.tr("It is part of the project, and its verdict follows in a moment.")
        elif stopped:
            word = self.tr("Surface not made again")
            advice = self.tr("That was stopped. Press Fit to make it as it was, with its manual edits.")
        else:
            word = self.tr("No surface yet")
            advice = self.tr("Press Fit to fit one and check it against ε.")
        self._word.setText(word if judged is None else verdict_word(judged))
        self._show_lamps(() if judged is None else judged.lamps)
        if accuracy is None:
            self._more.setText(advice)
            self.setToolTip("")
        else:
            beyond = " · ".join(
                self.tr("{count} over {limit}").format(count=count(over.count), limit=f"{given(over.limit)} m")
                for over in accuracy.over.values()
            )
            most = self.tr("max |d| {most} m of {n} points").format(most=metres(accuracy.max_abs), n=count(accuracy.n))
            self._more.setText(in_lengths(f"{most}\n{beyond}"))
            self.setToolTip(
                self.tr(
                    "σ = √(Σ d² / (n − 1)) over all {n} original points, d the orthogonal distance to the surface. "
                    "FAIL: σ is not below the control error ε. WARNING: it is, but a check fails or the surface is "
                    "worse away from its data."
                ).format(n=accuracy.n)
            )
        self._old.setText(self.tr("Older than its data or settings: press Fit") if self._stale else "")
        for label in (self._more, self._old):
            label.setVisible(bool(label.text()))
        self.setAccessibleName(self.text.replace("\n", ", "))
        self.update()

    def _show_lamps(self, lamps: tuple[Lamp, ...]) -> None:
        for k, (mark, label) in enumerate(self.lamps):
            shown = k < len(lamps)
            mark.setVisible(shown)
            label.setVisible(shown)
            mark.name = level_mark(lamps[k].level) if shown else "none"
            label.setText(_unbroken(in_lengths(translated(lamps[k].text))) if shown else "")
            label.setToolTip(translated(lamps[k].title) if shown else "")
            mark.update()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the size of text."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.FontChange:
            self._size_texts()

    def _size_texts(self) -> None:
        """Write the word large, and what is behind it a little smaller than other text."""
        for label, share in ((self._word, 1.3), (self._more, 0.92)):
            font = self.font()
            font.setPointSizeF(font.pointSizeF() * share)
            font.setBold(label is self._word)
            label.setFont(font)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the ground: tinted, barred at the left; hatched where stale."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        palette = self.palette()
        colour = readable(_COLOURS[self._level], palette)
        ground = QColor(colour)
        ground.setAlpha(55 if is_dark(palette) else 28)
        box = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(QPen(colour, 1, Qt.PenStyle.DashLine if self._stale else Qt.PenStyle.SolidLine))
        painter.setBrush(palette.color(QPalette.ColorRole.Base))
        painter.drawRoundedRect(box, 4, 4)
        painter.setBrush(ground)
        painter.drawRoundedRect(box, 4, 4)
        if self._stale:
            ground.setAlpha(90)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(ground)
            brush = painter.brush()
            brush.setStyle(Qt.BrushStyle.BDiagPattern)
            painter.setBrush(brush)
            painter.drawRoundedRect(box, 4, 4)
        else:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(colour)
            painter.drawRoundedRect(QRectF(0, 0, 5, self.height()), 2, 2)
        # Not when Python lets go of it: a traceback would hold it beyond the event.
        painter.end()


def _unbroken(text: str) -> str:
    """Return a text whose numbers stay on one line with their units."""
    return re.sub(r"(?<=\d) (?=(?:m|ft|%|ε)(?!\w))", "\N{NO-BREAK SPACE}", text)


def verdict_word(verdict: Verdict) -> str:
    """Return the word of a verdict in the language of the windows."""
    return translated(verdict.word)
