"""A change by hand: a control point moved, or the surface pulled to a point, with its effect before it is applied."""

from __future__ import annotations

from functools import partial

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSpinBox,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.accuracy import Accuracy
from geofit.errors import GeofitError
from geofit.gui.panels.effect import Effect
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.weight import WeightBox
from geofit.gui.words import spoken
from geofit.handwork import support
from geofit.surface import HorizonSurface, Patch

__all__ = ["AdjustPanel"]

#: Steps of the buttons, metres.
STEPS = (-1.0, -0.1, 0.1, 1.0)
#: Wait for the next step before an effect is asked for, milliseconds.
PAUSE = 250


class AdjustPanel(QWidget):
    """One change at a time.

    ``adjust_requested`` and ``pull_requested`` come from Apply, ``weigh_requested`` from Set; ``..._wanted`` a moment
    after the last edit, for whoever can tell the effect by :meth:`show_effect`; ``control_chosen`` follows the boxes.
    """

    adjust_requested = Signal(str, int, int, float)
    pull_requested = Signal(int, float)
    weigh_requested = Signal(str, int, int, float)
    adjust_wanted = Signal(str, int, int, float)
    pull_wanted = Signal(int, float)
    weigh_wanted = Signal(str, int, int, float)
    control_chosen = Signal(str, int, int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._surface: HorizonSurface | None = None
        self._point: int | None = None
        self._silent = self._held = False
        self.ways = QTabWidget()
        self.ways.addTab(self._control_page(), self.tr("Control point"))
        self.ways.addTab(self._point_page(), self.tr("Data point"))
        self.effect = Effect()
        self.apply_button = QPushButton(self.tr("Apply"))
        self.apply_button.setToolTip(self.tr("Change the surface. Undo takes it back."))
        self.zero_button = QPushButton(self.tr("Back to zero"))
        buttons = FlowLayout()
        buttons.addWidget(self.apply_button)
        buttons.addWidget(self.zero_button)
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addWidget(self.ways)
        column.addWidget(self.effect)
        column.addLayout(buttons)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidget(page)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.pages = Placeholder(scroll)
        self.setLayout(self.pages)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._want)
        self.apply_button.clicked.connect(self._apply)
        self.zero_button.clicked.connect(lambda: self.dz.setValue(0.0))
        self.ways.currentChanged.connect(lambda _: self._edited())
        self.show_surface(None)

    def show_surface(self, surface: HorizonSurface | None) -> None:
        """Show a surface; the control point and the data point stay chosen where it has them."""
        if surface is not None and surface is self._surface:
            return
        self._surface = surface
        self.effect.clear()
        self._pause.stop()
        if surface is None:
            self.pages.say(self.tr("No surface yet: press Fit, then change it by hand where you know better."))
            return
        if surface.model is None:
            self.pages.say(
                self.tr("This surface was read from a file: it has no control net of its own. Fit it, then adjust.")
            )
            return
        self._silent = True
        patch = self.patch.currentData()
        self.patch.clear()
        for each in surface.patches:
            self.patch.addItem(spoken(each.name), each.name)
        self.patch.setCurrentIndex(max(self.patch.findData(patch), 0))
        self.dz.setValue(0.0)
        self._silent = False
        self._limit_quietly()
        self._show_control()
        self._show_point(self._point if self._point is not None and self._point < len(surface.points) else None)
        self.pages.reveal()

    def choose_control(self, patch: str, i: int, j: int) -> None:
        """Choose a control point, as picked in 3D; nothing is emitted."""
        if self._surface is None or self.patch.findData(patch) < 0:
            return
        self._silent = True
        self.patch.setCurrentIndex(self.patch.findData(patch))
        self._limit(self._patch())
        self.i.setValue(i)
        self.j.setValue(j)
        self.dz.setValue(0.0)
        self._silent = False
        self.ways.setCurrentIndex(0)
        self._show_control()

    def choose_point(self, index: int | None) -> None:
        """Choose a data point; nothing is emitted."""
        self._silent = True
        self.ways.setCurrentIndex(0 if index is None else 1)
        self._silent = False
        self._show_point(index)

    def _show_point(self, index: int | None) -> None:
        self._point = index
        surface = self._surface
        self.share.setEnabled(index is not None)
        if surface is None or surface.accuracy is None:
            return
        if index is None:
            self.about_point.setText(self.tr("Choose a point in the view or in the residual table."))
        else:
            exact = len(surface.core) == len(surface.points) and bool(surface.core[index])
            d = float(surface.accuracy.residuals[index])
            words = self.tr("{point}\nElevation {z:.3f} m, residual {d:+.3f} m").format(
                point=surface.points.describe(index), z=surface.points.xyz[index, 2], d=d
            )
            if exact:
                words += "\n" + self.tr("The surface meets this point already.")
            self.about_point.setText(words)
        self.effect.clear()
        self._enable()

    def show_effect(self, before: Accuracy, after: Accuracy | None) -> None:
        """Show what the change would do to the check; None while nothing is known."""
        self.effect.show_effect(before, after)

    def say(self, text: str) -> None:
        """Say why a change cannot be made, in place of its effect."""
        self.effect.say(text)

    def _control_page(self) -> QWidget:
        self.patch, self.i, self.j = QComboBox(), QSpinBox(), QSpinBox()
        self.dz, self.z = QDoubleSpinBox(), QDoubleSpinBox()
        self.patch.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.patch.setMinimumContentsLength(8)
        for spin, low, high in ((self.dz, -1000.0, 1000.0), (self.z, -12000.0, 12000.0)):
            spin.setRange(low, high)
            spin.setDecimals(3)
            spin.setSingleStep(0.1)
            spin.setSuffix(self.tr(" m"))
            spin.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.about_control = QLabel()
        self.about_control.setWordWrap(True)
        index = QHBoxLayout()
        for word, box in ((self.tr("row"), self.i), (self.tr("column"), self.j)):
            index.addWidget(QLabel(word))
            index.addWidget(box, 1)
            box.setAccessibleName(word)
            box.setMinimumWidth(44)
        steps = QHBoxLayout()
        steps.setSpacing(4)
        self.steps = []
        for step in STEPS:
            button = QPushButton(f"{step:+g}".replace("-", "−"))
            button.setToolTip(self.tr("Move by {step:+g} m").format(step=step))
            button.setMinimumWidth(36)
            button.clicked.connect(partial(self._step, step))
            steps.addWidget(button, 1)
            self.steps.append(button)
        form = QFormLayout()
        form.setContentsMargins(0, 0, 0, 0)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        form.addRow(self.tr("Patch"), self.patch)
        form.addRow(index)
        form.addRow(self.tr("Move by"), self.dz)
        form.addRow(self.tr("Elevation"), self.z)
        self.weight = WeightBox()
        self.z.setToolTip(self.tr("Elevation of the control point; the surface follows it part of the way."))
        for spin, words in ((self.dz, self.tr("Move by")), (self.z, self.tr("Elevation"))):
            spin.setAccessibleName(words)
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(8, 8, 8, 8)
        column.addLayout(form)
        column.addLayout(steps)
        weight = QFormLayout()
        weight.setContentsMargins(0, 0, 0, 0)
        weight.addRow(self.tr("Weight"), self.weight)
        column.addLayout(weight)
        column.addWidget(self.about_control)
        self.weight.requested.connect(self._weigh)
        self.weight.wanted.connect(lambda value: self.weigh_wanted.emit(*self._control(), value))
        self.patch.activated.connect(lambda _: self._choose_patch())
        for box in (self.i, self.j):
            box.valueChanged.connect(lambda _: self._choose())
        self.dz.valueChanged.connect(self._moved)
        self.z.valueChanged.connect(self._lifted)
        return page

    def _point_page(self) -> QWidget:
        self.about_point = QLabel()
        self.about_point.setWordWrap(True)
        self.share = QSpinBox()
        self.share.setRange(1, 100)
        self.share.setValue(100)
        self.share.setSuffix(self.tr(" %"))
        self.share.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.share.setAccessibleName(self.tr("Share of the distance"))
        self.share.setToolTip(
            self.tr("100 % lets the surface pass through the point, 50 % takes half of the distance away.")
        )
        about = QLabel(
            self.tr(
                "The control points around the point move as little as possible. Points that are met exactly stay "
                "exact, and may leave no freedom."
            )
        )
        about.setWordWrap(True)
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(8, 8, 8, 8)
        column.addWidget(self.about_point)
        row = QHBoxLayout()
        row.addWidget(QLabel(self.tr("Pull by")))
        row.addWidget(self.share, 1)
        column.addLayout(row)
        column.addWidget(about)
        column.addStretch(1)
        self.share.valueChanged.connect(lambda _: self._edited())
        return page

    def _patch(self) -> Patch:
        assert self._surface is not None
        return self._surface.patches[max(self.patch.currentIndex(), 0)]

    def _limit(self, patch: Patch) -> None:
        rows, columns = patch.control.shape[:2]
        self.i.setRange(0, rows - 1)
        self.j.setRange(0, columns - 1)
        self.i.setToolTip(self.tr("Row of the control point, 0 to {most}.").format(most=rows - 1))
        self.j.setToolTip(self.tr("Column of the control point, 0 to {most}.").format(most=columns - 1))

    def _limit_quietly(self) -> None:
        silent, self._silent = self._silent, True
        self._limit(self._patch())
        self._silent = silent

    def _choose_patch(self) -> None:
        self._limit_quietly()
        self._choose()

    def _choose(self) -> None:
        if self._silent or self._surface is None:
            return
        self._show_control()
        self.control_chosen.emit(*self._control())

    def _show_control(self) -> None:
        """Show where the control point stands, what it moves, and what holds it."""
        assert self._surface is not None
        place = self._place()
        silent, self._silent = self._silent, True
        self.dz.setValue(0.0)
        self.z.setValue(float(place[2]))
        self._silent = silent
        words = self.tr("At ({x:.1f}, {y:.1f}, {z:.2f})").format(x=place[0], y=place[1], z=place[2])
        self._held = False
        try:
            words += "\n" + self._reach()
        except GeofitError as error:
            words, self._held = spoken(str(error)), True
        self.about_control.setText(words)
        weights = self._patch().weights
        self.weight.show_weight(
            1.0 if weights is None else float(weights[self.i.value(), self.j.value()]), held=self._held
        )
        self.effect.clear()
        self._enable()

    def _place(self) -> np.ndarray:
        assert self._surface is not None
        return np.asarray(self._patch().control[self.i.value(), self.j.value()] + self._surface.origin)

    def _reach(self) -> str:
        surface = self._surface
        assert surface is not None
        assert surface.model is not None
        u0, u1, v0, v1 = support(surface, self.patch.currentData(), self.i.value(), self.j.value())
        plane = surface.model.problem.chart.plane
        # Where the rectangle ends, the control point acts no more.
        within = (plane[:, 0] > u0) & (plane[:, 0] < u1) & (plane[:, 1] > v0) & (plane[:, 1] < v1)
        exact = within & surface.core if len(surface.core) == len(within) else np.zeros(len(within), bool)
        words = self.tr(
            "Moves the surface in a field of {width:.0f} m × {height:.0f} m around it, and nothing outside. "
            "{n} points lie there."
        ).format(width=u1 - u0, height=v1 - v0, n=int(within.sum()))
        if exact.any():
            self._held = True
            words += "\n" + self.tr(
                "{n} of them are met exactly and hold this control point. Choose one farther from them, "
                "or exclude them."
            ).format(n=int(exact.sum()))
        return words

    def _step(self, step: float) -> None:
        self.dz.setValue(self.dz.value() + step)

    def _moved(self, dz: float) -> None:
        if not self._silent and self._surface is not None:
            self._silent = True
            self.z.setValue(float(self._place()[2]) + dz)
            self._silent = False
            self._edited()

    def _lifted(self, z: float) -> None:
        if not self._silent and self._surface is not None:
            self._silent = True
            self.dz.setValue(z - float(self._place()[2]))
            self._silent = False
            self._edited()

    def _edited(self) -> None:
        if self._silent or self._surface is None:
            return
        self.effect.clear()
        self._enable()
        if self.apply_button.isEnabled():
            self._pause.start()

    def _enable(self) -> None:
        control = self.ways.currentIndex() == 0
        ready = (self.dz.value() != 0 and not self._held) if control else self._point is not None
        self.apply_button.setEnabled(ready)
        self.zero_button.setVisible(control)
        for widget in (self.dz, self.z, *self.steps):
            widget.setEnabled(not self._held)
        if not ready:
            self._pause.stop()

    def _control(self) -> tuple[str, int, int]:
        return self.patch.currentData(), self.i.value(), self.j.value()

    def _weigh(self, weight: float) -> None:
        self._pause.stop()
        self.weigh_requested.emit(*self._control(), weight)

    def _want(self) -> None:
        if self.ways.currentIndex() == 0:
            self.adjust_wanted.emit(*self._control(), self.dz.value())
        elif self._point is not None:
            self.pull_wanted.emit(self._point, self.share.value() / 100)

    def _apply(self) -> None:
        self._pause.stop()
        if self.ways.currentIndex() == 0:
            self.adjust_requested.emit(*self._control(), self.dz.value())
        elif self._point is not None:
            self.pull_requested.emit(self._point, self.share.value() / 100)
