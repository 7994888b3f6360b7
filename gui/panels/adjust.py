"""A manual edit: a control point moved, or the surface moved to a point, with its effect before it is applied."""

from __future__ import annotations

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QFrame, QPushButton, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from geofit.data.accuracy import Accuracy
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.preview import MoveEffect
from geofit.gui.panels.control_point import ControlPointPage
from geofit.gui.panels.data_point import DataPointPage
from geofit.gui.panels.effect import Effect
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.text_size import sized_by_text
from geofit.project.provenance import Row

__all__ = ["AdjustPanel"]

#: Wait for the next step before an effect is asked for, milliseconds.
PAUSE = 250


class AdjustPanel(QWidget):
    """One change at a time.

    ``adjust_requested`` and ``move_requested`` come from Apply, ``weigh_requested`` from Set; ``..._wanted`` a moment
    after the last edit, for whoever can tell the effect by :meth:`show_effect`; ``control_chosen`` follows the boxes,
    ``control_moved()`` every move at once, for whoever can tell its figures by :meth:`show_move`.
    """

    adjust_requested = Signal(str, int, int, float, object)
    move_requested = Signal(object, float)
    weigh_requested = Signal(str, int, int, float)
    adjust_wanted = Signal(str, int, int, float, object)
    move_wanted = Signal(int, float)
    weigh_wanted = Signal(str, int, int, float)
    control_chosen = Signal(str, int, int)
    control_moved = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._surface: HorizonFit | None = None
        #: The check after the edit that was applied last: its effect is shown until something else is.
        self._applied: Accuracy | None = None
        self.control, self.point = ControlPointPage(), DataPointPage()
        self.ways = QTabWidget()
        self.ways.addTab(self.control, self.tr("Control point"))
        self.ways.addTab(self.point, self.tr("Data point"))
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
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        # It is at least as wide as its contents: there is no horizontal scroll bar.
        sized_by_text(page, lambda: scroll.setMinimumWidth(page.minimumSizeHint().width()))
        self.pages = Placeholder(scroll, self)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._want)
        self.apply_button.clicked.connect(self.apply)
        self.zero_button.clicked.connect(self.control.put_back)
        self.ways.currentChanged.connect(lambda _: self._edited())
        self.control.moved.connect(self._edited)
        self.control.moved.connect(self.control_moved)
        self.control.chosen.connect(self._tell_control)
        self.control.weigh_wanted.connect(lambda weight: self.weigh_wanted.emit(*self.control.target, weight))
        self.control.weigh_requested.connect(self._weigh)
        self.point.edited.connect(self._edited)
        self.show_surface(None)

    def show_surface(self, surface: HorizonFit | None) -> None:
        """Show a surface; the control point and the data point stay chosen where it has them."""
        if surface is not None and surface is self._surface:
            return
        self._surface = surface
        if surface is None or surface.model is None:
            self._rest()
            self.pages.say(
                self.tr("No surface yet: press Fit, then edit it manually where you know better.")
                if surface is None
                else self.tr("This surface was read from a file: it has no control net. Fit it, then adjust.")
            )
            return
        self.control.show_surface(surface)
        self.point.show_surface(surface)
        if surface.accuracy is not None and surface.accuracy is self._applied:
            self._pause.stop()
            self._enable()
        else:
            self._rest()
        self.pages.reveal()

    def choose_control(self, patch: str, i: int, j: int) -> None:
        """Choose a control point, as picked in 3D; nothing is emitted."""
        if self.control.choose(patch, i, j):
            self.ways.setCurrentWidget(self.control)
            self._rest()

    def choose_point(self, index: int | None, absent: str = "") -> None:
        """Choose a data point; ``absent`` states why the surface cannot be moved to it. Its effect is asked for."""
        self.point.choose(index, absent)
        self.ways.setCurrentWidget(self.point)
        self._rest()
        self._begin()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Ask for the effect on a data point that was chosen while the panel was hidden."""
        super().showEvent(event)
        self._begin()

    def show_effect(self, before: Accuracy, after: Accuracy) -> None:
        """Show what the change would do to the check."""
        self.effect.show_effect(before, after)

    def show_applied(self, before: Accuracy, after: Accuracy) -> None:
        """Show what an edit did to the check, until another surface is shown or something else is edited."""
        self._applied = after
        self.effect.show_effect(before, after, applied=True)

    def show_move(self, before: Accuracy, after: MoveEffect) -> None:
        """Show the figures of a move of the control point, while it goes on."""
        self.effect.show_move(before, after)

    def say(self, text: str) -> None:
        """Say why a change cannot be made, in place of its effect."""
        self.effect.say(text)

    def _rest(self) -> None:
        """Forget the effect that was asked for; what is chosen now has not been edited."""
        self._pause.stop()
        self._forget()
        self._enable()

    def _forget(self) -> None:
        """Say how an effect is seen."""
        self._applied = None
        self.effect.say(
            self.tr("Effect: move the control point to see the deviation before and after.")
            if self.ways.currentWidget() is self.control
            else self.tr("Effect: choose a data point to see the deviation before and after.")
        )

    def _begin(self) -> None:
        """Ask for the effect on the chosen data point, which needs no edit, where it is seen."""
        if self.isVisible() and self.ways.currentWidget() is self.point and self._applied is None:
            self._edited()

    def _edited(self) -> None:
        if self._surface is None:
            return
        self._forget()
        self._enable()
        if self.apply_button.isEnabled():
            self._pause.start()
        else:
            self._pause.stop()

    def _enable(self) -> None:
        by_control = self.ways.currentWidget() is self.control
        self.apply_button.setEnabled(self.control.ready if by_control else self.point.point is not None)
        self.zero_button.setVisible(by_control)

    def _tell_control(self, patch: str, i: int, j: int) -> None:
        self._rest()
        self.control_chosen.emit(patch, i, j)

    def _weigh(self, weight: float) -> None:
        self._pause.stop()
        self.weigh_requested.emit(*self.control.target, weight)

    def _want(self) -> None:
        if self.ways.currentWidget() is self.control:
            self.adjust_wanted.emit(*self.control.target, self.control.dz.value(), self.control.aside)
        elif self.point.point is not None:
            self.move_wanted.emit(self.point.point, self.point.share.value() / 100)

    def apply(self) -> None:
        """Ask for the change that is shown, where there is one that can be made."""
        self._pause.stop()
        if not self.apply_button.isEnabled():
            return
        if self.ways.currentWidget() is self.control:
            self.adjust_requested.emit(*self.control.target, self.control.dz.value(), self.control.aside)
        elif self.point.point is not None and self._surface is not None:
            row = Row.of(self._surface.points, self.point.point)
            self.move_requested.emit(row, self.point.share.value() / 100)
