"""The verdict: PASS or FAIL with the figures behind it, told by shape and word as well as colour."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from geofit.data.accuracy import Accuracy
from geofit.gui.panels.marks import is_dark, paint, readable
from geofit.report.digits import count, given, metres
from geofit.report.style import FAIL, PASS, QUIET

__all__ = ["VerdictBadge"]


class _Mark(QWidget):
    """The mark, painted as large as the word beside it."""

    def __init__(self) -> None:
        super().__init__()
        self.name = "none"
        self.setFixedSize(QSize(30, 30))

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the mark."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        paint(painter, QRectF(self.rect()).adjusted(2, 2, -2, -2), self.name)
        painter.end()


class VerdictBadge(QFrame):
    """A badge: disc and tick for PASS, square and cross for FAIL, a hatched frame where the result is stale."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._mark, self._word, self._figures, self._more = _Mark(), QLabel(), QLabel(), QLabel()
        self._old = QLabel()
        font = self._word.font()
        font.setPointSizeF(font.pointSizeF() * 1.35)
        font.setBold(True)
        self._word.setFont(font)
        for label in (self._figures, self._more, self._old):
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        words = QVBoxLayout()
        words.setSpacing(2)
        for label in (self._word, self._figures, self._more, self._old):
            words.addWidget(label)
        grid = QGridLayout(self)
        grid.setContentsMargins(12, 8, 8, 8)
        grid.setHorizontalSpacing(10)
        grid.addWidget(self._mark, 0, 0, Qt.AlignmentFlag.AlignTop)
        grid.addLayout(words, 0, 1)
        grid.setColumnStretch(1, 1)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self._passed: bool | None = None
        self._stale = False
        self.show_accuracy(None, False)

    @property
    def text(self) -> str:
        """Everything that the badge says, in lines."""
        labels = (self._word, self._figures, self._more, self._old)
        return "\n".join(label.text() for label in labels if label.text())

    def show_accuracy(self, accuracy: Accuracy | None, stale: bool = False) -> None:
        """Show the check of a surface; None while there is none."""
        self._stale = stale and accuracy is not None
        self._passed = None if accuracy is None else accuracy.passed
        self._mark.name = "none" if self._passed is None else "passed" if self._passed else "failed"
        if accuracy is None:
            self._word.setText(self.tr("No surface yet"))
            self._figures.setText(self.tr("Press Fit to lay one and check it against ε."))
            self._more.clear()
        else:
            self._word.setText(self.tr("PASS") if accuracy.passed else self.tr("FAIL"))
            words = (
                self.tr("σ {sigma} m < ε {epsilon} m") if accuracy.passed else self.tr("σ {sigma} m ≥ ε {epsilon} m")
            )
            self._figures.setText(words.format(sigma=metres(accuracy.sigma), epsilon=given(accuracy.epsilon)))
            beyond = " · ".join(
                self.tr("{count} over {limit}").format(count=count(over.count), limit=f"{given(over.limit)} m")
                for over in accuracy.over.values()
            )
            most = self.tr("max |d| {most} m of {n} points").format(most=metres(accuracy.max_abs), n=count(accuracy.n))
            self._more.setText(f"{most}\n{beyond}")
        self._old.setText(self.tr("Older than the settings: press Fit") if self._stale else "")
        for label in (self._figures, self._more, self._old):
            label.setVisible(bool(label.text()))
        self.setToolTip(
            ""
            if accuracy is None
            else self.tr(
                "σ = √(Σ d² / (n − 1)) over all {n} original points, d the orthogonal distance to the surface; "
                "the surface passes when σ is below the control error ε."
            ).format(n=accuracy.n)
        )
        self.setAccessibleName(self.text.replace("\n", ", "))
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the ground: tinted, barred at the left; hatched where stale."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        palette = self.palette()
        colour = readable(QUIET if self._passed is None else PASS if self._passed else FAIL, palette)
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
