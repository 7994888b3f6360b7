"""The weight of a control point: above 1 the surface is drawn to it."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QPushButton, QWidget

__all__ = ["WeightBox"]


class WeightBox(QWidget):
    """A number and a button; ``requested`` carries the weight when it is pressed, ``wanted`` when it is edited."""

    requested = Signal(float)
    wanted = Signal(float)

    def __init__(self) -> None:
        super().__init__()
        self.value = QDoubleSpinBox()
        self.value.setRange(0.01, 100.0)
        self.value.setDecimals(2)
        self.value.setSingleStep(0.1)
        self.value.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.value.setAccessibleName(self.tr("Weight", "WeightBox"))
        self.value.setToolTip(
            self.tr("1 is neutral; above 1 the control point attracts the surface, below 1 it attracts it less.")
        )
        self.button = QPushButton(self.tr("Set"))
        self.button.setToolTip(self.tr("Give the control point this weight. Undo takes it back."))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.value, 1)
        row.addWidget(self.button)
        self._now = 1.0
        self.value.valueChanged.connect(self._edited)
        self.button.clicked.connect(lambda: self.requested.emit(self.value.value()))

    def show_weight(self, weight: float, *, held: bool) -> None:
        """Show the weight that the control point has; ``held`` if it cannot have another. Nothing is emitted."""
        self._now = weight
        self.value.blockSignals(True)
        self.value.setValue(weight)
        self.value.blockSignals(False)
        self.value.setEnabled(not held)
        self.button.setEnabled(False)

    def _edited(self, value: float) -> None:
        self.button.setEnabled(value != self._now)
        if value != self._now:
            self.wanted.emit(value)
