"""Where patches meet: the gap and the angle of every seam, coloured as in the 3D view."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from geofit.checks.check import ANGLE_LIMIT, GAP_LIMIT
from geofit.data.accuracy import Seam
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.panels.marks import icon
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.tables import DataTable, TableColumn, translated_column
from geofit.gui.theme import is_dark
from geofit.gui.view3d.colouring import seam_colours

__all__ = ["SeamTable", "seam_holds"]


def seam_holds(seam: Seam, settings: FitSettings) -> tuple[bool, bool | None]:
    """Return whether a seam's gap and its angle keep their limits; None for an angle that is allowed to break."""
    gap = seam.gap <= min(GAP_LIMIT, settings.boundary_tolerance)
    return gap, seam.angle <= ANGLE_LIMIT if settings.seam == "tangent" else None


class SeamTable(QWidget):
    """All seams of a surface; ``seam_chosen`` carries the seam's index in ``accuracy.seams``."""

    seam_chosen = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.head = QLabel()
        self.head.setWordWrap(True)
        self.table = DataTable()
        self.table.setAccessibleName(self.tr("Seams between patches"))
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addWidget(self.head)
        column.addWidget(self.table, 1)
        self.pages = Placeholder(content, self)
        self.table.chosen.connect(self.seam_chosen)
        self.show_surface(None)

    def show_surface(self, surface: HorizonFit | None) -> None:
        """Show the seams of a checked surface; None while there is none."""
        if surface is None or surface.accuracy is None:
            self.pages.say(self.tr("No surface yet: press Fit, and the seams between its patches are listed here."))
            return
        seams = surface.accuracy.seams
        if not seams:
            self.pages.say(self.tr("This surface is one patch: it has no seams."))
            return
        dark = is_dark(self.palette())
        gaps, angles = (seam_colours(seams, by, dark)[0] for by in ("gap", "angle"))
        held = [seam_holds(seam, surface.settings) for seam in seams]
        gap = min(GAP_LIMIT, surface.settings.boundary_tolerance)
        if surface.settings.seam == "tangent":
            words = self.tr("Seams: {n}; gaps up to {gap:g} mm and angles up to {angle:g}° are allowed")
        else:
            words = self.tr("Seams: {n}; gaps up to {gap:g} mm are allowed, and breaks of any angle")
        self.head.setText(words.format(n=len(seams), gap=1000 * gap, angle=ANGLE_LIMIT))
        self.table.show_columns(
            [
                TableColumn(self.tr("Patch"), translated_column([seam.first for seam in seams])),
                TableColumn(self.tr("Meets"), translated_column([seam.second for seam in seams])),
                TableColumn(
                    self.tr("Gap, mm"),
                    np.array([1000 * seam.gap for seam in seams]),
                    6,
                    self.tr("Largest distance between the two edges, at 200 places."),
                    lambda i: icon(f"dot:{gaps[i]}" if held[i][0] else "failed"),
                ),
                TableColumn(
                    self.tr("Angle, °"),
                    np.array([seam.angle for seam in seams]),
                    4,
                    self.tr("Largest angle between the normals of both patches along the seam."),
                    lambda i: icon("failed" if held[i][1] is False else f"dot:{angles[i]}" if held[i][1] else "none"),
                ),
            ]
        )
        self.pages.reveal()

    def choose(self, index: int | None) -> None:
        """Go to a seam's row; nothing is emitted."""
        self.table.choose(index)
