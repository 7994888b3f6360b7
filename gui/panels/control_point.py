"""A control point: which one it is, where it stands, what it moves, what holds it, and where it shall go."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import GeofitError
from geofit.fitting.edit import acted_on, support
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import in_lengths, shown_coordinate, shown_length
from geofit.gui.panels.weight import WeightBox
from geofit.gui.translate import translated
from geofit.splines.patch import Patch

__all__ = ["ControlPointPage"]

#: Steps of the buttons, metres.
STEPS = (-1.0, -0.1, 0.1, 1.0)


class ControlPointPage(QWidget):
    """Boxes for a patch, a row and a column, a move along the height, one aside, and a weight.

    ``chosen(patch, i, j)`` follows the boxes; ``moved()`` reports every other move, ``weigh_wanted(weight)`` of every
    other weight, and ``weigh_requested(weight)`` comes from Set.
    """

    chosen = Signal(str, int, int)
    moved = Signal()
    weigh_wanted = Signal(float)
    weigh_requested = Signal(float)

    def __init__(self) -> None:
        super().__init__()
        self._surface: HorizonFit | None = None
        self.held = False
        self.patch, self.i, self.j = QComboBox(), QSpinBox(), QSpinBox()
        self.dz, self.z = QDoubleSpinBox(), QDoubleSpinBox()
        self.sideways, self.directions = (QDoubleSpinBox(), QDoubleSpinBox()), (QLabel(), QLabel())
        self.weight, self.about = WeightBox(), QLabel()
        self.steps = [QPushButton(f"{step:+g}".replace("-", "−")) for step in STEPS]
        self._set_up_boxes()
        self._lay_out()
        self.weight.requested.connect(self.weigh_requested)
        self.weight.wanted.connect(self.weigh_wanted)
        self.patch.activated.connect(lambda _: self._choose_patch())
        for box in (self.i, self.j):
            box.valueChanged.connect(lambda _: self._choose())
        self.dz.valueChanged.connect(self._follow_move)
        for side in self.sideways:
            side.valueChanged.connect(lambda _: self._follow_move(self.dz.value()))
        self.z.valueChanged.connect(self._follow_elevation)

    @property
    def target(self) -> tuple[str, int, int]:
        """The patch, the row and the column that are chosen."""
        return self.patch.currentData(), self.i.value(), self.j.value()

    @property
    def ready(self) -> bool:
        """Whether there is a move that can be made."""
        return (self.dz.value() != 0 or any(self.aside)) and not self.held

    @property
    def aside(self) -> tuple[float, float, float]:
        """The move aside in map coordinates, metres."""
        a, b = (box.value() for box in self.sideways)
        if not (a or b):
            return 0.0, 0.0, 0.0
        x, y, z = (a * self._ways()[0] + b * self._ways()[1]).tolist()
        return x, y, z

    def put(self, by: NDArray[np.float64]) -> None:
        """Show a move of (3,) metres in map coordinates, rounded to millimetres."""
        for box, way in zip((*self.sideways, self.dz), self._ways(), strict=True):
            _put(box, float(by @ way))
        self._follow_move(self.dz.value())

    def put_back(self) -> None:
        """Show no move."""
        self.put(np.zeros(3))

    def _ways(self) -> NDArray[np.float64]:
        """Return the unit vectors (3, 3) of the moves aside, and of the height: over the map, easting and northing."""
        assert self._surface is not None
        assert self._surface.model is not None
        frame = self._surface.model.problem.parametrization.frame
        return np.eye(3) if frame.kind == "map" else np.asarray(frame.axes)

    def show_surface(self, surface: HorizonFit) -> None:
        """Show a surface that has a control net; the control point stays chosen where it has it."""
        self._surface = surface
        before = self.patch.currentData()
        self.patch.clear()
        for patch in surface.patches:
            self.patch.addItem(translated(patch.name), patch.name)
        self.patch.setCurrentIndex(max(self.patch.findData(before), 0))
        self._limit()
        self._show()

    def choose(self, patch: str, i: int, j: int) -> bool:
        """Go to a control point without emitting; False if there is no such patch."""
        if self._surface is None or self.patch.findData(patch) < 0:
            return False
        self.patch.setCurrentIndex(self.patch.findData(patch))
        self._limit()
        _put(self.i, i)
        _put(self.j, j)
        self._show()
        return True

    def _set_up_boxes(self) -> None:
        self.patch.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.patch.setMinimumContentsLength(8)
        self.patch.setAccessibleName(self.tr("Patch"))
        for index, name in ((self.i, self.tr("Row")), (self.j, self.tr("Column"))):
            index.setAccessibleName(name)
            index.setMinimumWidth(44)
        named = ((self.dz, 1000.0, self.tr("Move by")), (self.z, 12000.0, self.tr("Elevation")))
        for box, most, name in (*named, *((box, 1000.0, "") for box in self.sideways)):
            box.setRange(-most, most)
            box.setDecimals(3)
            box.setSingleStep(0.1)
            box.setSuffix(self.tr(" m"))
            box.setAlignment(Qt.AlignmentFlag.AlignRight)
            box.setAccessibleName(name)
        self.z.setToolTip(self.tr("Elevation of the control point; the surface follows it part of the way."))
        self.about.setWordWrap(True)
        for step, button in zip(STEPS, self.steps, strict=True):
            button.setToolTip(self.tr("Move by {step:+g} m").format(step=step))
            button.setAccessibleName(button.toolTip())
            button.setMinimumWidth(36)
            button.clicked.connect(partial(self._step, step))

    def _lay_out(self) -> None:
        index, steps = QHBoxLayout(), QHBoxLayout()
        column = QLabel(self.tr("Column"))
        column.setBuddy(self.j)
        index.addWidget(self.i, 1)
        index.addWidget(column)
        index.addWidget(self.j, 1)
        steps.setSpacing(4)
        for button in self.steps:
            steps.addWidget(button, 1)
        form = QFormLayout()
        form.setContentsMargins(0, 0, 0, 0)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        form.addRow(self.tr("Patch"), self.patch)
        form.addRow(self.tr("Row"), index)
        form.addRow(self.tr("Move by"), self.dz)
        form.addRow(steps)
        form.addRow(self.tr("Elevation"), self.z)
        for label, box in zip(self.directions, self.sideways, strict=True):
            label.setBuddy(box)
            form.addRow(label, box)
        form.addRow(self.tr("Weight"), self.weight)
        page = QVBoxLayout(self)
        page.setContentsMargins(5, 8, 5, 8)
        page.addLayout(form)
        page.addWidget(self.about)
        page.addStretch(1)
        order = (
            self.patch, self.i, self.j, self.dz, *self.steps, self.z, *self.sideways, self.weight.value,
            self.weight.button,
        )  # fmt: skip
        for before, after in pairwise(order):
            self.setTabOrder(before, after)

    def _patch(self) -> Patch:
        assert self._surface is not None
        return self._surface.patches[max(self.patch.currentIndex(), 0)]

    def _place(self) -> np.ndarray:
        assert self._surface is not None
        return np.asarray(self._patch().control[self.i.value(), self.j.value()] + self._surface.origin)

    def _limit(self) -> None:
        """Let the boxes go as far as the patch does."""
        for box, count in zip((self.i, self.j), self._patch().control.shape[:2], strict=True):
            with QSignalBlocker(box):
                box.setRange(0, count - 1)
        self.i.setToolTip(self.tr("Row of the control point, 0 to {most}.").format(most=self.i.maximum()))
        self.j.setToolTip(self.tr("Column of the control point, 0 to {most}.").format(most=self.j.maximum()))

    def _choose_patch(self) -> None:
        self._limit()
        self._choose()

    def _choose(self) -> None:
        if self._surface is not None:
            self._show()
            self.chosen.emit(*self.target)

    def _show(self) -> None:
        """Show where the control point stands, what it moves, and what holds it; it has not moved yet."""
        x, y, z = self._place()
        for box in (self.dz, *self.sideways):
            _put(box, 0.0)
        _put(self.z, float(z))
        self._name_ways()
        words = self.tr("At ({x:.1f}, {y:.1f}, {z:.2f})").format(
            x=shown_coordinate(x), y=shown_coordinate(y), z=shown_length(z)
        )
        try:
            reach, self.held = self._reach()
            words += "\n" + reach
        except GeofitError as error:
            words, self.held = translated(str(error)), True
        self.about.setText(in_lengths(words))
        weights = self._patch().weights
        weight = 1.0 if weights is None else float(weights[self.i.value(), self.j.value()])
        self.weight.show_weight(weight, held=self.held)
        for widget in (self.dz, self.z, *self.sideways, *self.steps):
            widget.setEnabled(not self.held)

    def _name_ways(self) -> None:
        """Say where the moves aside go: over the map, or in the plane of a steep surface."""
        over = bool(np.array_equal(self._ways(), np.eye(3)))
        names = (self.tr("East"), self.tr("North")) if over else (self.tr("Along strike"), self.tr("Up dip"))
        for label, box, name in zip(self.directions, self.sideways, names, strict=True):
            label.setText(name)
            box.setAccessibleName(name)
            box.setToolTip(self.tr("Move sideways; the surface is then no longer a height field."))

    def _reach(self) -> tuple[str, bool]:
        """Return what a move would change, and whether exact points forbid it."""
        assert self._surface is not None
        u0, u1, v0, v1 = support(self._surface, *self.target)
        within, exact = acted_on(self._surface, *self.target)
        words = self.tr(
            "Moves the surface within {width:.0f} m × {height:.0f} m around it, and nowhere else. Data points there: "
            "{n}."
        ).format(width=u1 - u0, height=v1 - v0, n=int(within.sum()))
        if exact.any():
            words += "\n" + self.tr(
                "It is fixed by points that are interpolated exactly: {n}. Choose one farther from "
                "them, or exclude them."
            ).format(n=int(exact.sum()))
        return words, bool(exact.any())

    def _step(self, step: float) -> None:
        self.dz.setValue(self.dz.value() + step)

    def _follow_move(self, dz: float) -> None:
        if self._surface is not None:
            _put(self.z, float(self._place()[2]) + dz)
            self.moved.emit()

    def _follow_elevation(self, z: float) -> None:
        if self._surface is not None:
            _put(self.dz, z - float(self._place()[2]))
            self.moved.emit()


def _put(box: QDoubleSpinBox | QSpinBox, value: float) -> None:
    """Set a box without emitting."""
    with QSignalBlocker(box):
        box.setValue(value)  # type: ignore[arg-type]
