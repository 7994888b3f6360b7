"""Fusion that can be read: a ring round what has the keyboard, and no icon that nobody can see."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QIcon, QPainter, QPalette, QPen
from PySide6.QtWidgets import QProxyStyle, QStyle, QStyleOption, QStyleOptionComplex, QWidget

from geofit.gui.icons import palette_icon

__all__ = ["Style"]

_Pixmap, _State = QStyle.StandardPixmap, QStyle.StateFlag
_Primitive, _Control, _Complex = QStyle.PrimitiveElement, QStyle.ControlElement, QStyle.ComplexControl
#: Black or coloured pictures that some platforms put before the words of buttons.
_BARE = {
    _Pixmap.SP_DialogOkButton, _Pixmap.SP_DialogCancelButton, _Pixmap.SP_DialogHelpButton, _Pixmap.SP_DialogOpenButton,
    _Pixmap.SP_DialogSaveButton, _Pixmap.SP_DialogCloseButton, _Pixmap.SP_DialogApplyButton,
    _Pixmap.SP_DialogResetButton, _Pixmap.SP_DialogDiscardButton, _Pixmap.SP_DialogYesButton,
    _Pixmap.SP_DialogNoButton,
}  # fmt: skip
#: Buttons of the docks' title bars: black on any ground.
_DRAWN = {_Pixmap.SP_TitleBarNormalButton: "float", _Pixmap.SP_TitleBarCloseButton: "cancel"}
_RINGED = {_Primitive.PE_FrameLineEdit, _Control.CE_ShapedFrame, _Complex.CC_SpinBox, _Complex.CC_ComboBox}
#: Ringed only for who goes by the keyboard: a click on a button says enough.
_RINGED_BY_KEYS = {_Primitive.PE_PanelButtonCommand}
#: Pixels.
_RING, _ROUND = 1.6, 2.5


class Style(QProxyStyle):
    """Fusion for a palette."""

    def __init__(self, palette: QPalette) -> None:
        super().__init__("Fusion")
        self._icons = {drawn: palette_icon(name, palette) for drawn, name in _DRAWN.items()}
        self._ring = QPen(palette.color(QPalette.ColorRole.Link), _RING)

    def standardIcon(  # noqa: N802
        self, standard: QStyle.StandardPixmap, option: QStyleOption | None = None, widget: QWidget | None = None
    ) -> QIcon:
        """Return no icon for a button of a dialog, and one in the text's colour for a dock's title bar."""
        if standard in _BARE:
            return QIcon()
        if standard in self._icons:
            return self._icons[standard]
        return super().standardIcon(standard, option, widget)

    def drawPrimitive(  # noqa: N802
        self, element: QStyle.PrimitiveElement, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        """Draw a line edit's frame or a button with its ring."""
        super().drawPrimitive(element, option, painter, widget)
        self._draw_ring(element, option, painter)

    def drawControl(  # noqa: N802
        self, element: QStyle.ControlElement, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        """Draw the frame of a list or a table with its ring, and a tool bar flat as the menu bar above it."""
        if element == _Control.CE_ToolBar:
            painter.fillRect(option.rect, option.palette.window())
            painter.fillRect(option.rect.adjusted(0, option.rect.height() - 1, 0, 0), option.palette.mid())
            return
        if element == _Control.CE_DockWidgetTitle and widget is not None:
            # Qt paints titles of docks in the font that the application began with.
            painter.setFont(widget.font())
        if element == _Control.CE_PushButton and widget is not None and widget.property("primary"):
            _accent(option)
        super().drawControl(element, option, painter, widget)
        self._draw_ring(element, option, painter)

    def drawComplexControl(  # noqa: N802
        self,
        control: QStyle.ComplexControl,
        option: QStyleOptionComplex,
        painter: QPainter,
        widget: QWidget | None = None,
    ) -> None:
        """Draw a spin box or a combo box with its ring."""
        super().drawComplexControl(control, option, painter, widget)
        self._draw_ring(control, option, painter)

    def _draw_ring(self, element: object, option: QStyleOption, painter: QPainter) -> None:
        if element in _RINGED:
            wanted = _State.State_HasFocus
        elif element in _RINGED_BY_KEYS:
            wanted = _State.State_HasFocus | _State.State_KeyboardFocusChange
        else:
            return
        if option.state & wanted == wanted:
            painter.save()
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(self._ring)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            inset = _RING / 2
            painter.drawRoundedRect(QRectF(option.rect).adjusted(inset, inset, -inset, -inset), _ROUND, _ROUND)
            painter.restore()


def _accent(option: QStyleOption) -> None:
    """Fill the first button of a panel with the accent, while it can be pressed."""
    if option.state & _State.State_Enabled:
        palette = QPalette(option.palette)
        palette.setColor(QPalette.ColorRole.Button, palette.color(QPalette.ColorRole.Highlight))
        palette.setColor(QPalette.ColorRole.ButtonText, palette.color(QPalette.ColorRole.HighlightedText))
        option.palette = palette
