"""A section beside the view: any line, any thickness; traces of the surfaces with holes, points and the ground."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.backend_bases import MouseEvent
from matplotlib.figure import Figure
from numpy.typing import ArrayLike
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QPaintEvent
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from geofit.errors import GeofitError
from geofit.gui.panels.canvas import Canvas, Ink
from geofit.gui.panels.curtain import Curtain, Meshes, Traces, extent, trace
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.section_ink import SectionData, draw_section, near_points
from geofit.gui.words import spoken
from geofit.gui.worker import Task, run
from geofit.offdata import Uncertainty
from geofit.site import Site
from geofit.surface import HorizonSurface

__all__ = ["SectionPanel"]

#: Wait for the next step of a spin box, milliseconds.
PAUSE = 120
#: Vertical exaggerations on offer.
FACTORS = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0)
#: Room for the names of holes above the drawing, as a share of its height.
NAMES = 0.25
#: A point is picked within so many pixels.
NEAR = 8


class SectionPanel(QWidget):
    """The 2D section.

    ``line_changed`` carries the new line (k, 2) and ``thickness_changed`` metres, when the user edits them here;
    ``point_chosen`` the horizon and the index of the point that was clicked.
    """

    line_changed = Signal(object)
    thickness_changed = Signal(float)
    point_chosen = Signal(str, int)
    failed = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.along = QComboBox()
        self.along.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.azimuth = _spin(0, 359.9, 5, self.tr("°"), "359.9°")
        self.azimuth.setWrapping(True)
        self.position = _spin(-1e6, 1e6, 10, self.tr(" m"), "-9999.9 m")
        self.thickness = _spin(0.1, 1e5, 10, self.tr(" m"), "999.9 m")
        self.factor = QComboBox()
        for factor in FACTORS:
            self.factor.addItem(f"× {factor:g}", factor)
        tools = FlowLayout()
        for words, widget, about in (
            (self.tr("Along"), self.along, self.tr("A section of the site, or a line of your own.")),
            (self.tr("Azimuth"), self.azimuth, self.tr("Direction of the section, clockwise from north.")),
            (self.tr("Position"), self.position, self.tr("Right of the site's middle, looking along the azimuth.")),
            (self.tr("Thickness"), self.thickness, self.tr("Holes and points within half of this to each side.")),
            (self.tr("Height"), self.factor, self.tr("How much higher elevations are drawn than distances.")),
        ):  # fmt: skip
            tools.addWidget(_labelled(words, widget, about))
        self.canvas = Canvas(self._paint)
        self.canvas.setAccessibleName(self.tr("Section drawing"))
        self.state = QLabel()
        self.state.setWordWrap(True)
        content = QWidget()
        column = QVBoxLayout(content)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addLayout(tools)
        column.addWidget(self.canvas, 1)
        column.addWidget(self.state)
        self.pages = Placeholder(content)
        self.setLayout(self.pages)
        self._data: SectionData | None = None
        self._surfaces: Mapping[str, HorizonSurface] = {}
        self._meshes: Meshes = {}
        self._task: Task | None = None
        self._again = self._due = False
        self._grip: tuple[float, float] | None = None
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._tell_line)
        self.azimuth.valueChanged.connect(lambda _: self._edit_line())
        self.position.valueChanged.connect(lambda _: self._edit_line())
        self.thickness.valueChanged.connect(self._edit_thickness)
        self.along.activated.connect(self._choose_section)
        self.factor.activated.connect(self._rescale)
        self.canvas.mpl_connect("scroll_event", self._zoom)
        self.canvas.mpl_connect("button_press_event", self._press)
        self.canvas.mpl_connect("motion_notify_event", self._move)
        self.canvas.mpl_connect("button_release_event", self._release)
        self.show_section(None, {}, None, 50.0)

    def show_section(
        self,
        site: Site | None,
        surfaces: Mapping[str, HorizonSurface],
        line: ArrayLike | None,
        thickness: float,
        uncertainty: Mapping[str, Uncertainty] | None = None,
    ) -> None:
        """Show a section of a site; without a line, one through its middle. Nothing is emitted."""
        if site is None:
            self._data = None
            self.pages.say(self.tr("No site open: open one to cut a section through it."))
            return
        new = self._data is None or self._data.site is not site
        box = extent(site, surfaces)
        curtain = Curtain.straight(90.0, 0.0, box) if line is None else Curtain.along(line)
        self._surfaces = surfaces
        for gone in self._meshes.keys() - surfaces.keys():
            del self._meshes[gone]
        kept = {} if self._data is None else {n: t for n, t in self._data.traces.items() if n in surfaces}
        self._data = SectionData(site, curtain, thickness, kept, uncertainty or {})
        if new:
            self.along.clear()
            self.along.addItem(self.tr("Own line"))
            self.along.addItems([section.name for section in site.sections])
        self._show_inputs(curtain, thickness, box)
        self.pages.reveal()
        self._cut()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Cut what changed while nobody saw it."""
        super().paintEvent(event)
        if self._due:
            self._due = False
            QTimer.singleShot(0, self, self._cut)

    @property
    def line(self) -> object:
        """The line that is shown, (k, 2); None without a site."""
        return None if self._data is None else self._data.curtain.line

    def _show_inputs(self, curtain: Curtain, thickness: float, box: np.ndarray) -> None:
        values = (
            (self.azimuth, curtain.azimuth), (self.position, curtain.position(box)), (self.thickness, thickness)
        )  # fmt: skip
        for spin, value in values:
            spin.blockSignals(True)
            spin.setValue(value)
            spin.blockSignals(False)
        assert self._data is not None
        own = [
            s.line.shape == curtain.line.shape and np.allclose(s.line, curtain.line) for s in self._data.site.sections
        ]
        self.along.setCurrentIndex(own.index(True) + 1 if True in own else 0)

    def _edit_line(self) -> None:
        if self._data is None:
            return
        box = extent(self._data.site, self._surfaces)
        self._take(Curtain.straight(self.azimuth.value(), self.position.value(), box))
        self.along.setCurrentIndex(0)

    def _choose_section(self, index: int) -> None:
        if self._data is None or index == 0:
            return
        curtain = Curtain.along(self._data.site.sections[index - 1].line)
        self._show_inputs(curtain, self._data.thickness, extent(self._data.site, self._surfaces))
        self._take(curtain)

    def _rescale(self) -> None:
        if self._data is not None:
            self._say_line()
            self.canvas.repaint_figure()

    def _take(self, curtain: Curtain) -> None:
        assert self._data is not None
        self._data = SectionData(
            self._data.site, curtain, self._data.thickness, self._data.traces, self._data.uncertainty
        )
        self._pause.start()

    def _tell_line(self) -> None:
        if self._data is not None:
            self._cut()
            self.line_changed.emit(self._data.curtain.line)

    def _edit_thickness(self, value: float) -> None:
        if self._data is None:
            return
        d = self._data
        self._data = SectionData(d.site, d.curtain, value, d.traces, d.uncertainty)
        self.canvas.repaint_figure()
        self.thickness_changed.emit(value)

    def _cut(self) -> None:
        """Cut beside the window; while a cut is under way only the last wish is kept."""
        # A dock behind others counts as visible, but nothing of it is seen.
        self._due = self._data is not None and self.visibleRegion().isEmpty()
        if self._data is None or self._due:
            return
        if self._task is not None:
            self._again = True
            self._task.cancel()
            return
        self.state.setText(
            self.tr("Cutting…") if self._surfaces else self.tr("No surfaces yet: press Fit to see their traces.")
        )
        self.canvas.repaint_figure()
        if not self._surfaces:
            return
        curtain = self._data.curtain
        self._task = run(
            self, trace, dict(self._surfaces), curtain.line, self._meshes,
            on_done=lambda found: self._show_traces(curtain, found), on_failed=self._tell_failure,
            title=self.tr("Section"),
        )  # fmt: skip
        self._task.ended.connect(self._ended)

    def _show_traces(self, curtain: Curtain, found: Traces) -> None:
        if self._data is not None and self._data.curtain is curtain:
            d = self._data
            self._data = SectionData(d.site, curtain, d.thickness, found, d.uncertainty)
            self._say_line()
            self.canvas.repaint_figure()

    def _tell_failure(self, error: Exception) -> None:
        self.state.setText(spoken(str(error)) if isinstance(error, GeofitError) else str(error))
        self.failed.emit(error)

    def _ended(self) -> None:
        self._task = None
        if self._again:
            self._again = False
            self._cut()

    def _scale(self) -> str:
        factor = float(self.factor.currentData())
        return self.tr("true to scale") if factor == 1 else self.tr("elevations × {factor:g}").format(factor=factor)

    def _say_line(self) -> None:
        assert self._data is not None
        (x0, y0), (x1, y1) = self._data.curtain.line[[0, -1]]
        self.state.setText(
            self.tr("From ({x0:.1f}, {y0:.1f}) to ({x1:.1f}, {y1:.1f}), {length:.0f} m; {scale}").format(
                x0=x0, y0=y0, x1=x1, y1=y1, length=self._data.curtain.length, scale=self._scale()
            )
        )

    def _paint(self, figure: Figure, ink: Ink) -> None:
        if self._data is None:
            return
        axes = figure.subplots()
        factor = float(self.factor.currentData())
        words = {
            "ground": self.tr("ground"),
            "band": self.tr("90 % band"),
            "distance": self.tr("Distance along the section, m"),
            "elevation": self.tr("Elevation, m"),
        }
        draw_section(axes, self._data, ink, words)
        low, high = axes.dataLim.intervaly
        # The names of the holes stand above everything else.
        axes.update_datalim([(0.0, low), (self._data.curtain.length, high + NAMES * (high - low))])
        axes.autoscale_view()
        axes.set_aspect(factor, adjustable="datalim")
        if axes.get_legend_handles_labels()[0]:
            figure.legend(
                loc="outside lower center" if self.canvas.narrow else "outside right upper", labelcolor=ink.text,
                ncols=3 if self.canvas.narrow else 1, fontsize=7.5,
            )  # fmt: skip

    def _zoom(self, event: MouseEvent) -> None:
        if event.inaxes is None or event.xdata is None or event.ydata is None:
            return
        factor = 0.83 if event.step > 0 else 1.2
        axes = event.inaxes
        axes.set_xlim(*(event.xdata + factor * (x - event.xdata) for x in axes.get_xlim()))
        axes.set_ylim(*(event.ydata + factor * (z - event.ydata) for z in axes.get_ylim()))
        self.canvas.refresh()

    def _press(self, event: MouseEvent) -> None:
        if event.dblclick:
            self.canvas.repaint_figure()
        elif event.inaxes is not None and event.xdata is not None and event.ydata is not None:
            self._grip = (event.xdata, event.ydata)
            self._pressed = (event.x, event.y)

    def _move(self, event: MouseEvent) -> None:
        if self._grip is None or event.inaxes is None or event.xdata is None or event.ydata is None:
            return
        axes = event.inaxes
        if np.hypot(event.x - self._pressed[0], event.y - self._pressed[1]) < 4:
            return
        axes.set_xlim(*(x + self._grip[0] - event.xdata for x in axes.get_xlim()))
        axes.set_ylim(*(z + self._grip[1] - event.ydata for z in axes.get_ylim()))
        self.canvas.refresh()

    def _release(self, event: MouseEvent) -> None:
        held, self._grip = self._grip, None
        if held is None or event.inaxes is None or self._data is None:
            return
        if np.hypot(event.x - self._pressed[0], event.y - self._pressed[1]) < 4:
            self._pick(event)

    def _pick(self, event: MouseEvent) -> None:
        assert self._data is not None
        assert event.inaxes is not None
        best, least = None, float(NEAR * self.canvas.device_pixel_ratio)
        for name in self._data.site.horizons:
            places, index = near_points(self._data, name)
            if len(index):
                away = np.hypot(*(event.inaxes.transData.transform(places) - [event.x, event.y]).T)
                if away.min() < least:
                    best, least = (name, int(index[away.argmin()])), float(away.min())
        if best is not None:
            self.point_chosen.emit(*best)


def _spin(low: float, high: float, step: float, unit: str, longest: str) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setRange(low, high)
    spin.setDecimals(1)
    spin.setSingleStep(step)
    spin.setSuffix(unit)
    spin.setKeyboardTracking(False)
    spin.setAlignment(Qt.AlignmentFlag.AlignRight)
    spin.setFixedWidth(spin.fontMetrics().horizontalAdvance(longest) + 30)
    return spin


def _labelled(words: str, widget: QWidget, about: str) -> QWidget:
    pair = QWidget()
    row = QHBoxLayout(pair)
    row.setContentsMargins(0, 0, 0, 0)
    row.setSpacing(4)
    label = QLabel(words)
    label.setBuddy(widget)
    row.addWidget(label)
    row.addWidget(widget)
    widget.setAccessibleName(words)
    for each in (label, widget):
        each.setToolTip(about)
    return pair
