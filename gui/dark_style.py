"""Fusion with frames that are seen on a dark ground: its own are always darker than the window."""

from __future__ import annotations

from PySide6.QtCore import QRect
from PySide6.QtGui import QColor, QPainter, QPalette
from PySide6.QtWidgets import QStyle, QStyleOption, QStyleOptionComplex, QTabBar, QWidget

from geofit.gui.style import Style

__all__ = ["DarkStyle", "mark_tab"]

_Primitive, _Control, _Complex = QStyle.PrimitiveElement, QStyle.ControlElement, QStyle.ComplexControl
_PRIMITIVES = {
    _Primitive.PE_Frame, _Primitive.PE_FrameLineEdit, _Primitive.PE_FrameTabWidget, _Primitive.PE_IndicatorCheckBox,
    _Primitive.PE_IndicatorItemViewItemCheck, _Primitive.PE_IndicatorRadioButton, _Primitive.PE_PanelButtonCommand,
    _Primitive.PE_PanelMenu,
}  # fmt: skip
_CONTROLS = {_Control.CE_ShapedFrame}
_COMPLEX = {_Complex.CC_SpinBox, _Complex.CC_ComboBox}
_SOUTH = {QTabBar.Shape.RoundedSouth, QTabBar.Shape.TriangularSouth}
#: Pixels of the line at the tab in front.
_MARK = 2
#: Fusion draws its frames in the window's colour divided by 1.4: this gives a grey of 3 to 1 against the fields.
_FRAMES = QColor("#8d99a6")


class DarkStyle(Style):
    """Draws what has a frame with a palette whose window is light enough for it."""

    def __init__(self, palette: QPalette) -> None:
        super().__init__(palette)
        # One palette for all, so that Fusion's pictures stay in its cache.
        self._framed = QPalette(palette)
        self._framed.setColor(QPalette.ColorRole.Window, _FRAMES)

    def drawPrimitive(  # noqa: N802
        self, element: QStyle.PrimitiveElement, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        """Draw a frame, an indicator or a button."""
        own = QPalette(option.palette)
        if element in _PRIMITIVES:
            framed = self._framed_as(own)
            if widget is not None and widget.property("primary") and option.state & QStyle.StateFlag.State_Enabled:
                framed.setBrush(QPalette.ColorRole.Button, own.button())
            option.palette = framed
        super().drawPrimitive(element, option, painter, widget)
        # Fusion draws the label of a check box with the option of its indicator.
        option.palette = own

    def drawControl(  # noqa: N802
        self, element: QStyle.ControlElement, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        """Draw a frame with a shape; mark the tab in front."""
        if element not in _CONTROLS:
            super().drawControl(element, option, painter, widget)
            mark_tab(element, option, painter, widget)
            return
        own = QPalette(option.palette)
        option.palette = self._framed_as(own)
        super().drawControl(element, option, painter, widget)
        option.palette = own

    def drawComplexControl(  # noqa: N802
        self,
        control: QStyle.ComplexControl,
        option: QStyleOptionComplex,
        painter: QPainter,
        widget: QWidget | None = None,
    ) -> None:
        """Draw a spin box or a combo box."""
        if control in _COMPLEX:
            option.palette = self._framed_as(option.palette)
        super().drawComplexControl(control, option, painter, widget)

    def _framed_as(self, own: QPalette) -> QPalette:
        """Return the palette of frames, for a widget as enabled as its own palette says."""
        framed = QPalette(self._framed)
        framed.setCurrentColorGroup(own.currentColorGroup())
        return framed


def mark_tab(element: QStyle.ControlElement, option: QStyleOption, painter: QPainter, widget: QWidget | None) -> None:
    """Underline the tab in front at its free edge: its ground hardly differs from that of the others."""
    if element != _Control.CE_TabBarTabShape or not option.state & QStyle.StateFlag.State_Selected:
        return
    south = isinstance(widget, QTabBar) and widget.shape() in _SOUTH
    box = option.rect
    edge = box.bottom() - _MARK if south else box.top()
    painter.fillRect(QRect(box.left() + 2, edge, box.width() - 4, _MARK), option.palette.highlight())
