"""How the chosen layer of the scene is drawn: how clear, in which colours, and what the colours mean."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSignalBlocker, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QCheckBox, QComboBox, QFormLayout, QGroupBox, QSizePolicy, QSlider, QWidget

from geofit.gui.names import literal
from geofit.gui.view3d.annotations import theme_of
from geofit.gui.view3d.layer_names import layer_title, word
from geofit.gui.view3d.layers import Layer, Layers, Legend
from geofit.gui.view3d.overlay import draw_legend, legend_size

__all__ = ["LayerForm"]


class LayerForm(QGroupBox):
    """How the chosen layer is drawn."""

    def __init__(self, layers: Layers) -> None:
        super().__init__()
        self._layers, self._key, self._name = layers, "", ""
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.opacity = QSlider(Qt.Orientation.Horizontal)
        self.opacity.setRange(5, 100)
        self.opacity.setPageStep(10)
        self.opacity.setAccessibleName(self.tr("Opacity"))
        self.colour_by = QComboBox()
        self.colour_by.setAccessibleName(self.tr("Colour by"))
        self.colour_by.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.isolines = QCheckBox(self.tr("Contours"))
        self.labels = QCheckBox(self.tr("Names"))
        self.legend = _LegendBox()
        self._form = QFormLayout(self)
        self._form.setContentsMargins(8, 8, 8, 8)
        self._form.setSpacing(6)
        # Where the dock is narrow, a box stands below its label rather than being cut off.
        self._form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        self._form.addRow(self.tr("Opacity"), self.opacity)
        self._form.addRow(self.tr("Colour by"), self.colour_by)
        self._form.addRow(self.isolines)
        self._form.addRow(self.labels)
        self._form.addRow(self.legend)
        self.opacity.valueChanged.connect(lambda value: self._change(opacity=value / 100))
        self.colour_by.activated.connect(lambda: self._change(colour_by=self.colour_by.currentData()))
        self.isolines.toggled.connect(lambda on: self._change(isolines=on))
        self.labels.toggled.connect(lambda on: self._change(labels=on))

    def _change(self, **changes: object) -> None:
        if self._key in self._layers:
            self._layers.change(self._key, **changes)

    def show_layer(self, layer: Layer | None) -> None:
        """Show a layer; nothing where none is chosen."""
        self.setVisible(layer is not None)
        if layer is None:
            return
        blockers = [QSignalBlocker(w) for w in (self.opacity, self.colour_by, self.isolines, self.labels)]
        self._key = layer.key
        self._name = layer_title(layer.kind, layer.horizon)
        self._entitle()
        self.opacity.setValue(round(100 * layer.opacity))
        self.opacity.setToolTip(self.tr("{percent} %").format(percent=round(100 * layer.opacity)))
        if [self.colour_by.itemData(k) for k in range(self.colour_by.count())] != list(layer.choices):
            self.colour_by.clear()
            for choice in layer.choices:
                self.colour_by.addItem(word(choice), choice)
            # Its own least width would cut the longest choice off.
            self.colour_by.setMinimumWidth(self.colour_by.sizeHint().width())
        self.colour_by.setCurrentIndex(self.colour_by.findData(layer.colour_by))
        self._form.setRowVisible(self.colour_by, len(layer.choices) > 1)
        for box, value in ((self.isolines, layer.isolines), (self.labels, layer.labels)):
            self._form.setRowVisible(box, value is not None)
            box.setChecked(bool(value))
        self.legend.show_legend(layer.legend)
        self._form.setRowVisible(self.legend, layer.legend is not None)
        # A row that was hidden a moment ago does not tell the layouts of its new height.
        self._form.invalidate()
        self.updateGeometry()
        self._stand()
        del blockers

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Take the height that rows have which are wrapped at this width."""
        super().resizeEvent(event)
        self._entitle()
        self._stand()

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Leave the title out: a long name would push the scene aside."""
        return QSize(self._form.totalMinimumSize().width(), super().minimumSizeHint().height())

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Leave the title out, as above."""
        return QSize(self._form.totalSizeHint().width(), super().sizeHint().height())

    def _entitle(self) -> None:
        room = max(self.width() - 16, 40)
        title = self.fontMetrics().elidedText(self._name, Qt.TextElideMode.ElideMiddle, room)
        self.setTitle(literal(title))
        self.setToolTip("" if title == self._name else self._name)

    def _stand(self) -> None:
        self.setMinimumHeight(max(self.heightForWidth(self.width()), 0))


class _LegendBox(QWidget):
    """The legend of the chosen layer."""

    def __init__(self) -> None:
        super().__init__()
        self._legend: Legend | None = None
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)

    def _title(self) -> str:
        assert self._legend is not None
        return word(self._legend.title) + (f", {self._legend.unit}" if self._legend.unit else "")

    def show_legend(self, legend: Legend | None) -> None:
        self._legend = legend
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        if self._legend is None:
            return QSize(0, 0)
        width, height = legend_size(self.font(), self._title(), self._legend)
        return QSize(min(round(width), 200), round(height + 1))

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        if self._legend is not None:
            painter = QPainter(self)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            dark = self.palette().window().color().lightnessF() < 0.5
            box = QRectF(self.rect()).adjusted(-8, 0, 8, 0)
            draw_legend(painter, box, self._title(), self._legend, theme_of(self.palette(), dark))
            painter.end()
