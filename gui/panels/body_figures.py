"""The figures of a body: volumes with their spread, whole and by stratum, and where body and data disagree."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSplitter, QVBoxLayout, QWidget

from geofit.bodies.simulate import BodyVolumes
from geofit.bodies.violations import Violation, question_rows
from geofit.gui.lengths import in_lengths
from geofit.gui.panels.marks import icon
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.translate import translated
from geofit.project.body_building import BodyResult

__all__ = ["BodyFigures"]


class BodyFigures(QWidget):
    """Two tables side by side.

    ``violation_chosen`` carries the Violation of the row that was chosen; ``strata_requested()`` asks for the volumes
    between the horizons as they are now.
    """

    violation_chosen = Signal(object)
    strata_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.volumes, self.violations = DataTable(), DataTable()
        self.volumes.setAccessibleName(self.tr("Volumes of the body"))
        self.violations.setAccessibleName(self.tr("Violations of the body"))
        self.head, self.count, self.strata = QLabel(), QLabel(), QPushButton(self.tr("Divide by horizons"))
        self.strata.setToolTip(self.tr("Cut the body along the current horizons and compute the volume of each part."))
        self.count.setWordWrap(True)
        self.count.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._found: tuple[Violation, ...] = ()
        self._parts = parts = QSplitter(Qt.Orientation.Horizontal)
        parts.setChildrenCollapsible(False)
        for heads, table in (((self.head, self.strata), self.volumes), ((self.count,), self.violations)):
            side = QWidget()
            column = QVBoxLayout(side)
            column.setContentsMargins(0, 0, 0, 0)
            column.setSpacing(6)
            line = QHBoxLayout()
            for widget in heads:
                line.addWidget(widget, 0 if len(heads) > 1 else 1)
            if len(heads) > 1:
                line.addStretch(1)
            column.addLayout(line)
            column.addWidget(table, 1)
            parts.addWidget(side)
        parts.setStretchFactor(0, 3)
        parts.setStretchFactor(1, 2)
        parts.setSizes([600, 400])
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.addWidget(parts)
        self.pages = Placeholder(content, self)
        self.violations.chosen.connect(lambda i: self.violation_chosen.emit(self._found[i]))
        self.strata.clicked.connect(self.strata_requested)
        self.show_body("", None)

    def show_body(self, name: str, result: BodyResult | None, divide: bool = False) -> None:
        """Show the figures of a body; ``divide`` where its strata are not those of the horizons as they are now."""
        if result is None:
            self._found = ()
            self.pages.say(self.tr("No body yet: fit one in the panel Bodies to see its volumes and violations."))
            return
        self._show_volumes(name, result, divide)
        self._show_violations(result)
        self.pages.reveal()

    def choose_hole(self, hole: str) -> bool:
        """Go to the first violation of a hole, as picked elsewhere; return whether there is one."""
        rows = [i for i, one in enumerate(self._found) if one.hole == hole]
        if rows:
            self.violations.choose(rows[0])
            self.violations.select(rows)
        return bool(rows)

    def _show_volumes(self, name: str, result: BodyResult, divide: bool) -> None:
        self.head.setText(self.tr("Volumes of {name}").format(name=name))
        self.strata.setVisible(result.fitted is not None and divide)
        rows: list[tuple[str, int, BodyVolumes | float]] = []
        whole: BodyVolumes | float = result.volume if result.volumes is None else result.volumes
        rows.append((self.tr("whole body"), result.mesh.components, whole))
        rows += [(translated(part.name), part.pieces, part.volumes) for part in result.strata]
        figures = np.array([_figures(volumes) for _, _, volumes in rows])
        spread = self.tr("From conditional simulations that honour every contact and sample.")
        numeric = self.tr("Of the curved surface: flat triangles enclose a little less.") if result.volumes else ""
        titles = (
            (self.tr("Fitted, m³"), numeric),
            ("P10, m³", spread),
            ("P50, m³", spread),
            ("P90, m³", spread),
            (self.tr("Standard deviation, m³"), spread),
        )
        self.volumes.show_columns(
            [
                TableColumn(self.tr("Part", "BodyFigures"), np.array([part for part, _, _ in rows])),
                TableColumn(self.tr("Pieces"), np.array([pieces for _, pieces, _ in rows]), 0),
                *(TableColumn(title, figures[:, k], 0, about) for k, (title, about) in enumerate(titles)),
            ]
        )

    def _show_violations(self, result: BodyResult) -> None:
        broken, asked = result.violations, question_rows(result.questions)
        self._found = broken + asked
        a = result.accuracy
        if a is None:
            self.count.setText(self.tr("Nothing was fitted: there are no data to check against."))
        elif not broken:
            text = self.tr("No violations: {n} contacts within ε, {metres:.1f} m logged on the correct side.")
            self.count.setText(in_lengths(text.format(n=a.n, metres=a.logged_length)))
        else:
            text = self.tr("Violations: {n}; samples on the wrong side: {wrong}; {metres:.2f} m of {logged:.1f} m")
            wrong = a.missed_length + a.excess_length
            text = text.format(n=len(broken), wrong=a.wrong_side, metres=wrong, logged=a.logged_length)
            self.count.setText(in_lengths(text))
        if asked:
            text = self.tr("Questions between sections: {n}.").format(n=len(asked))
            self.count.setText(f"{self.count.text()} {text}")
        kinds = {
            "contact": self.tr("Contact", "BodyFigures"),
            "sample": self.tr("Sample", "BodyFigures"),
            "length": self.tr("Interval", "BodyFigures"),
            "data": self.tr("Not used", "BodyFigures"),
            "question": self.tr("Question", "BodyFigures"),
        }
        found, places = self._found, np.array([one.place for one in self._found]).reshape(-1, 3)
        if self.violations.isHidden() == bool(found):
            # A sentence needs less room than the table of volumes.
            whole = sum(self._parts.sizes()) or 1000
            self._parts.setSizes([whole * 3 // 5, whole * 2 // 5] if found else [whole * 4 // 5, whole // 5])
        self.violations.setVisible(bool(found))
        self.violations.show_columns(
            [
                TableColumn(
                    self.tr("Kind"),
                    np.array([kinds[one.kind] for one in found], str),
                    icons=lambda k: icon("warning" if found[k].kind == "question" else "failed"),
                ),
                TableColumn(
                    self.tr("Sections") if asked and not broken else self.tr("Hole"),
                    np.array([one.hole for one in found], str),
                ),
                TableColumn(
                    self.tr("Distance, m"),
                    np.array([one.distance for one in found], float),
                    3,
                    self.tr("Signed distance from the surface: positive outside."),
                ),
                TableColumn(self.tr("Length, m"), np.array([one.length for one in found], float), 2),
                TableColumn(self.tr("In words"), np.array([translated(one.text) for one in found], str)),
                TableColumn(self.tr("Easting, m"), places[:, 0], 2, coordinate=True),
                TableColumn(self.tr("Northing, m"), places[:, 1], 2, coordinate=True),
                TableColumn(self.tr("Elevation, m"), places[:, 2], 2),
            ]
        )


def _figures(volumes: BodyVolumes | float) -> tuple[float, ...]:
    if isinstance(volumes, BodyVolumes):
        return volumes.best, volumes.p10, volumes.p50, volumes.p90, volumes.sd
    return (volumes, *(float("nan"),) * 4)
