"""Away from the data: what leaving holes out says of the surface, where the next hole would tell most, and outliers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from geofit.data.points import PointSet
from geofit.data.prediction import LeftOut, PredictionResult
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.translate import translated
from geofit.project.provenance import Row

__all__ = ["PredictionPanel"]

#: Rows of a table before it scrolls.
MOST_ROWS = 8


class PredictionPanel(QWidget):
    """Cross-validation, uncertainty, suggested holes and outliers of one horizon."""

    examine_requested = Signal()
    suggestion_chosen = Signal(float, float, float)
    point_chosen = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._prediction: PredictionResult | None = None
        self._points: PointSet | None = None
        self.figures, self.notes = QLabel(), QLabel()
        self.left_out, self.suggestions, self.outliers = DataTable(), DataTable(), DataTable()
        self.again = QPushButton(self.tr("Examine again"))
        self.again.setToolTip(self.tr("Leave out each hole and section in turn, and fit without it."))
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        self._heads: dict[str, QLabel] = {}
        for key, words, widget in (
            ("figures", self.tr("Uncertainty of the surface"), self.figures),
            ("left_out", self.tr("Error where data was left out"), self.left_out),
            ("suggestions", self.tr("Where the next holes would help most"), self.suggestions),
            ("outliers", self.tr("Outliers: points that their neighbours contradict"), self.outliers),
            ("notes", self.tr("Notes"), self.notes),
        ):
            head = QLabel(words)
            font = head.font()
            font.setBold(True)
            head.setFont(font)
            head.setWordWrap(True)
            if self._heads:
                column.addSpacing(6)
            column.addWidget(head)
            column.addWidget(widget)
            widget.setAccessibleName(words)
            self._heads[key] = head
        column.addWidget(self.again, 0, Qt.AlignmentFlag.AlignLeft)
        column.addStretch(1)
        for label in (self.figures, self.notes):
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        # Three rows at most: marks of a sorting would only take room.
        self.left_out.setSortingEnabled(False)
        for table in (self.left_out, self.suggestions, self.outliers):
            table.setVerticalScrollMode(DataTable.ScrollMode.ScrollPerPixel)
        scroll = QScrollArea()
        scroll.setWidget(page)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.pages = Placeholder(scroll, self)
        self.pages.button.clicked.connect(self.examine_requested)
        self.again.clicked.connect(self.examine_requested)
        self.suggestions.chosen.connect(self._tell_suggestion)
        self.outliers.chosen.connect(self._tell_outlier)
        self.show_prediction(None)

    def show_prediction(
        self, prediction: PredictionResult | None, points: PointSet | None = None, *, fitted: bool = True
    ) -> None:
        """Show what was found away from the data.

        Parameters
        ----------
        prediction : PredictionResult or None
            None while nobody asked; the panel then offers to examine.
        points : PointSet or None
            The horizon's points, to name the outliers.
        fitted : bool
            Whether there is a surface to examine.
        """
        self._prediction, self._points = prediction, points
        if prediction is None:
            if fitted:
                words = self.tr(
                    "Not examined yet: the prediction error away from the data is found by leaving out "
                    "each hole and section in turn."
                )
                self.pages.say(words, self.tr("Examine"))
            else:
                self.pages.say(self.tr("No surface yet: press Fit, then examine it away from the data."))
            return
        self._show_figures(prediction)
        self._show("left_out", self.left_out, self._left_out_columns(prediction) if prediction.left_out else ())
        self._show(
            "suggestions", self.suggestions, self._suggestion_columns(prediction) if prediction.suggestions else ()
        )
        self._show("outliers", self.outliers, self._outlier_columns(prediction) if prediction.outliers else ())
        self.notes.setText("\n".join(translated(note) for note in prediction.notes))
        for widget in (self.notes, self._heads["notes"]):
            widget.setVisible(bool(prediction.notes))
        self.pages.reveal()

    def choose_point(self, index: int | None) -> None:
        """Go to a point's row among the outliers; nothing is emitted."""
        indices = [] if self._prediction is None else [outlier.index for outlier in self._prediction.outliers]
        self.outliers.choose(indices.index(index) if index in indices else None)

    def _show_figures(self, prediction: PredictionResult) -> None:
        lines = []
        sd = prediction.uncertainty
        if sd is not None:
            words = (
                self.tr("Standard deviation over the study area: {mean:.2f} m on average, {most:.2f} m at most.")
                if sd.frame == "map"
                else self.tr("Standard deviation within its points: {mean:.2f} m on average, {most:.2f} m at most.")
            )
            lines.append(words.format(mean=sd.mean, most=sd.max))
            words = (
                self.tr(
                    "Widened by a factor of {factor:.2f}, so that 90 % of the left-out points lie in the 90 % band."
                )
                if sd.factor > 1
                else self.tr("Not widened: the 90 % band contains 90 % of the left-out points or more.")
                if prediction.left_out and all(left.inside >= 0.9 for left in prediction.left_out)
                else self.tr("The 90 % band was not widened.")
            )
            lines.append(words.format(factor=sd.factor))
        for left in prediction.left_out:
            words = self.tr(
                "{name}: {inside:.0f} % of the left-out points lie in the 90 % band ({raw:.0f} % before calibration)."
            )
            lines.append(
                words.format(name=self._scheme(left.scheme), inside=100 * left.inside, raw=100 * left.inside_raw)
            )
        self.figures.setText(
            in_lengths("\n".join(lines)) or self.tr("No value could be found; the notes give the reason.")
        )

    def _scheme(self, scheme: str) -> str:
        words = {
            "hole": self.tr("Holes"), "section": self.tr("Sections"), "block": self.tr("Blocks")
        }  # fmt: skip
        return words.get(scheme, scheme)

    def _left_out_columns(self, prediction: PredictionResult) -> list[TableColumn]:
        left_out = prediction.left_out
        references = {"thin plate": self.tr("Thin plate, m"), "kriging": self.tr("Kriging, m")}
        found = dict.fromkeys(name for left in left_out for name in left.references)
        about = self.tr("Root mean square error of another method with the same points left out.")
        return [
            TableColumn(self.tr("Left out"), np.array([self._scheme(left.scheme) for left in left_out])),
            TableColumn(
                self.tr("geofit, m"), _of(left_out, lambda left: left.rms), 3,
                self.tr("Root mean square error at the points that were left out."),
            ),
            *(
                TableColumn(references.get(name, f"{name}, m"), _of(left_out, partial(_peer, name)), 3, about)
                for name in found
            ),
            TableColumn(
                self.tr("In band, %"),
                _of(left_out, lambda left: 100 * left.inside),
                0,
                self.tr("Share of the left-out points in the 90 % band."),
            ),
            TableColumn(self.tr("Mean |e|, m"), _of(left_out, lambda left: left.mean_abs), 3),
            TableColumn(self.tr("Bias, m"), _of(left_out, lambda left: left.bias), 3),
            TableColumn(self.tr("Largest, m"), _of(left_out, lambda left: left.max_abs), 3),
            TableColumn(self.tr("Groups"), np.array([left.groups for left in left_out]), 0),
        ]  # fmt: skip

    def _suggestion_columns(self, prediction: PredictionResult) -> list[TableColumn]:
        holes = prediction.suggestions
        return [
            TableColumn(self.tr("No."), np.arange(1, len(holes) + 1), 0),
            TableColumn(
                self.tr("sd, m"), _of(holes, lambda hole: hole.sd), 2, self.tr("Standard deviation there now.")
            ),
            TableColumn(
                self.tr("Mean after, m"), _of(holes, lambda hole: hole.mean_after), 2,
                self.tr("Average standard deviation of the surface after this hole and those before it."),
            ),
            TableColumn(self.tr("Largest after, m"), _of(holes, lambda hole: hole.max_after), 2),
            TableColumn(self.tr("Easting, m"), _of(holes, lambda hole: hole.x), 1, coordinate=True),
            TableColumn(self.tr("Northing, m"), _of(holes, lambda hole: hole.y), 1, coordinate=True),
            TableColumn(self.tr("Elevation, m"), _of(holes, lambda hole: hole.z), 1),
        ]  # fmt: skip

    def _outlier_columns(self, prediction: PredictionResult) -> list[TableColumn]:
        outliers = prediction.outliers
        named = [
            str(o.index) if self._points is None else translated(self._points.describe(o.index)) for o in outliers
        ]  # fmt: skip
        return [
            TableColumn(self.tr("Point"), np.array(named)),
            TableColumn(
                self.tr("Error, m"), _of(outliers, lambda o: o.error), 2, self.tr("Point minus the surface without it.")
            ),
            TableColumn(self.tr("sd, m"), _of(outliers, lambda o: o.sd), 2),
            TableColumn(
                self.tr("Ratio"), _of(outliers, lambda o: o.ratio), 1, self.tr("Error in standard deviations.")
            ),
        ]

    def _show(self, key: str, table: DataTable, columns: Sequence[TableColumn]) -> None:
        table.show_columns(columns)
        for widget in (table, self._heads[key]):
            widget.setVisible(bool(columns))
        rows = min(table.rows.rowCount(), MOST_ROWS)
        line = table.verticalHeader().defaultSectionSize()
        bar = table.horizontalScrollBar().sizeHint().height()
        table.setFixedHeight(rows * line + table.horizontalHeader().sizeHint().height() + bar + 4)

    def _tell_suggestion(self, row: int) -> None:
        if self._prediction is not None:
            hole = self._prediction.suggestions[row]
            self.suggestion_chosen.emit(hole.x, hole.y, hole.z)

    def _tell_outlier(self, row: int) -> None:
        if self._prediction is not None and self._points is not None:
            self.point_chosen.emit(Row.of(self._points, self._prediction.outliers[row].index))


def _peer(name: str, left: LeftOut) -> float:
    return left.references.get(name, np.nan)


def _of(items: Sequence[Any], value: Callable[..., float]) -> NDArray[np.float64]:
    return np.array([value(item) for item in items], float)
