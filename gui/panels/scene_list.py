"""The list of what the scene shows: seen or not, how clear, in which colours, and what the colours mean."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QRectF, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFormLayout,
    QGroupBox,
    QMenu,
    QSizePolicy,
    QSlider,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.view3d.annotations import theme_of
from geofit.gui.view3d.layer_names import layer_title, word
from geofit.gui.view3d.layers import Layer, Layers, Legend
from geofit.gui.view3d.overlay import draw_legend, legend_size

__all__ = ["SceneList"]

KEY = Qt.ItemDataRole.UserRole


class SceneList(QWidget):
    """Shows and changes :class:`Layers`; ``zoom_requested(key)`` asks to bring a layer into the picture."""

    zoom_requested = Signal(str)

    def __init__(self, layers: Layers, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.layers = layers
        self._rows: dict[str, QTreeWidgetItem] = {}
        self._groups: dict[str, QTreeWidgetItem] = {}
        self.tree = QTreeWidget()
        self.tree.setHeaderHidden(True)
        self.tree.setAccessibleName(self.tr("What the scene shows"))
        self.tree.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.tree.setMinimumHeight(120)
        self.placeholder = Placeholder(self.tree)
        self.form = _LayerForm(layers)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.setSpacing(6)
        layout.addLayout(self.placeholder, 1)
        layout.addWidget(self.form)
        self.setMinimumWidth(200)
        self.tree.itemChanged.connect(self._checked)
        self.tree.currentItemChanged.connect(lambda *_: self._choose())
        self.tree.customContextMenuRequested.connect(self._menu)
        end = layers.subscribe(self._listen)
        self.destroyed.connect(lambda: end())
        for layer in layers:
            self._add(layer)
        self._choose()

    def chosen(self) -> str | None:
        """Return the key of the layer that is chosen; None where it is a heading, or nothing."""
        row = self.tree.currentItem()
        key = row.data(0, KEY) if row is not None else None
        return key if isinstance(key, str) and key in self.layers else None

    def choose(self, key: str) -> None:
        """Choose a layer."""
        if key in self._rows:
            self.tree.setCurrentItem(self._rows[key])

    def row(self, key: str) -> QTreeWidgetItem:
        """Return the row of a layer; KeyError where the list has none of this key."""
        return self._rows[key]

    def menu_for(self, key: str) -> QMenu:
        """Return the menu of a layer."""
        menu = QMenu(self)
        menu.addAction(self.tr("Zoom to")).triggered.connect(lambda: self.zoom_requested.emit(key))
        menu.addAction(self.tr("Only this")).triggered.connect(lambda: self.layers.only(key))
        menu.addAction(self.tr("Show all")).triggered.connect(self._show_all)
        return menu

    # From the layers -----------------------------------------------------------------------------------------

    def _listen(self, what: str, key: str) -> None:
        with QSignalBlocker(self.tree):
            if what == "cleared":
                self.tree.clear()
                self._rows.clear()
                self._groups.clear()
            elif what == "removed":
                self._remove(key)
            elif key in self._rows:
                self._show(self._rows[key], self.layers[key])
            else:
                self._add(self.layers[key])
        self._choose()

    def _add(self, layer: Layer) -> None:
        with QSignalBlocker(self.tree):
            row = QTreeWidgetItem([word(layer.kind)])
            row.setData(0, KEY, layer.key)
            row.setFlags(row.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            self._show(row, layer)
            self._group(layer.horizon).addChild(row)
            self._rows[layer.key] = row

    def _group(self, horizon: str) -> QTreeWidgetItem:
        if horizon not in self._groups:
            group = QTreeWidgetItem([horizon or self.tr("Site", "SceneList")])
            group.setFlags(group.flags() | Qt.ItemFlag.ItemIsUserCheckable | Qt.ItemFlag.ItemIsAutoTristate)
            bold = group.font(0)
            bold.setBold(True)
            group.setFont(0, bold)
            # The site stands above its horizons.
            self.tree.insertTopLevelItem(self.tree.topLevelItemCount() if horizon else 0, group)
            group.setExpanded(True)
            self._groups[horizon] = group
        return self._groups[horizon]

    def _show(self, row: QTreeWidgetItem, layer: Layer) -> None:
        row.setCheckState(0, Qt.CheckState.Checked if layer.visible else Qt.CheckState.Unchecked)
        row.setIcon(0, _icon(layer))
        row.setToolTip(0, layer_title(layer.kind, layer.horizon))

    def _remove(self, key: str) -> None:
        row = self._rows.pop(key, None)
        group = row.parent() if row is not None else None
        if row is None or group is None:
            return
        group.removeChild(row)
        if not group.childCount():
            name = next(name for name, item in self._groups.items() if item is group)
            del self._groups[name]
            self.tree.takeTopLevelItem(self.tree.indexOfTopLevelItem(group))

    # From the person -----------------------------------------------------------------------------------------

    def _checked(self, row: QTreeWidgetItem) -> None:
        key = row.data(0, KEY)
        if key in self.layers:
            self.layers.change(key, visible=row.checkState(0) == Qt.CheckState.Checked)

    def _choose(self) -> None:
        if self._rows:
            self.placeholder.reveal()
        else:
            self.placeholder.say(self.tr("Nothing to show yet: open or import a site."))
        key = self.chosen()
        self.form.show_layer(self.layers[key] if key is not None else None)
        if key is not None:
            # Once the form has taken its room.
            QTimer.singleShot(0, self.tree, lambda: self.tree.scrollTo(self.tree.currentIndex()))

    def _menu(self, at: QPoint) -> None:
        row = self.tree.itemAt(at)
        key = row.data(0, KEY) if row is not None else None
        if isinstance(key, str) and key in self.layers:
            menu = self.menu_for(key)
            menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            menu.popup(self.tree.viewport().mapToGlobal(at))

    def _show_all(self) -> None:
        for layer in self.layers:
            self.layers.change(layer.key, visible=True)


class _LayerForm(QGroupBox):
    """How the chosen layer is drawn."""

    def __init__(self, layers: Layers) -> None:
        super().__init__()
        self._layers, self._key = layers, ""
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.opacity = QSlider(Qt.Orientation.Horizontal)
        self.opacity.setRange(5, 100)
        self.opacity.setPageStep(10)
        self.opacity.setAccessibleName(self.tr("Opacity"))
        self.colour_by = QComboBox()
        self.colour_by.setAccessibleName(self.tr("Colour by"))
        self.colour_by.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.colour_by.setMinimumContentsLength(10)
        self.isolines = QCheckBox(self.tr("Lines of equal elevation"))
        self.labels = QCheckBox(self.tr("Names"))
        self.legend = _LegendBox()
        self._form = QFormLayout(self)
        self._form.setContentsMargins(8, 8, 8, 8)
        self._form.setSpacing(6)
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
        self.setTitle(layer_title(layer.kind, layer.horizon))
        self.opacity.setValue(round(100 * layer.opacity))
        self.opacity.setToolTip(self.tr("{percent} %").format(percent=round(100 * layer.opacity)))
        if [self.colour_by.itemData(k) for k in range(self.colour_by.count())] != list(layer.choices):
            self.colour_by.clear()
            for choice in layer.choices:
                self.colour_by.addItem(word(choice), choice)
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
        del blockers


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


def _icon(layer: Layer) -> QIcon:
    """Return a square in the layer's colour; clear for layers that have none."""
    picture = QPixmap(12, 12)
    picture.fill(QColor(layer.colour) if layer.colour else Qt.GlobalColor.transparent)
    return QIcon(picture)
