"""A data point that the surface shall be moved to, all the way or by a share."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSpinBox, QVBoxLayout, QWidget

from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths
from geofit.gui.translate import translated
from geofit.project.provenance import Row

__all__ = ["DataPointPage"]


class DataPointPage(QWidget):
    """The chosen point with its residual, and the share; ``edited()`` reports every other share."""

    edited = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._surface: HorizonFit | None = None
        self.point: int | None = None
        self.about = QLabel()
        self.about.setWordWrap(True)
        self.share = QSpinBox()
        self.share.setRange(1, 100)
        self.share.setValue(100)
        self.share.setSuffix(self.tr(" %"))
        self.share.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.share.setAccessibleName(self.tr("Share of the distance"))
        self.share.setToolTip(self.tr("100 % moves the surface through the point, 50 % halves its distance."))
        what = QLabel(
            self.tr(
                "The control points around the point move as little as possible. Points that are met exactly stay "
                "exact, and may leave no freedom."
            )
        )
        what.setWordWrap(True)
        label = QLabel(self.tr("Move by"))
        label.setBuddy(self.share)
        row = QHBoxLayout()
        row.addWidget(label)
        row.addWidget(self.share, 1)
        page = QVBoxLayout(self)
        page.setContentsMargins(8, 8, 8, 8)
        page.addWidget(self.about)
        page.addLayout(row)
        page.addWidget(what)
        page.addStretch(1)
        self.share.valueChanged.connect(lambda _: self.edited.emit())

    def show_surface(self, surface: HorizonFit) -> None:
        """Show a surface; the point stays chosen where it has it."""
        former, self._surface = self._surface, surface
        row = None if former is None or self.point is None else Row.of(former.points, self.point)
        self.choose(None if row is None else row.find(surface.points))

    def choose(self, index: int | None, absent: str = "") -> None:
        """Choose a data point; nothing is emitted. ``absent`` states why the surface has no point that was chosen."""
        self.point = index
        self.share.setEnabled(index is not None)
        surface = self._surface
        if surface is None or surface.accuracy is None:
            return
        if index is None:
            self.about.setText(absent or self.tr("Choose a point in the view or in the residual table."))
            return
        words = self.tr("{point}\nElevation {z:.3f} m\nResidual {d:+.3f} m").format(
            point=translated(surface.points.describe(index)),
            z=surface.points.xyz[index, 2],
            # Adding 0 turns -0.000 into +0.000.
            d=round(float(surface.accuracy.residuals[index]), 3) + 0.0,
        )
        if len(surface.core) == len(surface.points) and surface.core[index]:
            words += "\n" + self.tr("The surface meets this point already.")
        self.about.setText(in_lengths(words))
