"""A section beside the view: any line, any thickness; traces of the surfaces with holes, points and the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import MouseEvent
from numpy.typing import ArrayLike
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QPaintEvent
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from geofit.data.prediction import Uncertainty
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.lengths import length_mark, shown_coordinate, shown_length
from geofit.gui.panels.canvas import PlotCanvas, PlotColours, place_axes
from geofit.gui.panels.curtain import Curtain, Meshes, Traces, site_extent, trace
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.length_axes import number_lengths
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.section_bodies import SectionBody, draw_bodies
from geofit.gui.panels.section_painter import (
    SectionData,
    explain,
    near_points,
    paint_section,
    seen_in,
    thin_names,
)
from geofit.gui.panels.section_scale import automatic, grown, window
from geofit.gui.text_size import sized_by_text
from geofit.gui.translate import failure
from geofit.gui.worker import Task, run
from geofit.project.provenance import Row

__all__ = ["SectionPanel"]

#: Wait for the next step of a spin box, milliseconds.
PAUSE = 120
#: Vertical exaggerations on offer, besides the one that is found by itself.
FACTORS = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0)
#: A drawing lower than this has no line to spare, logical pixels.
LOW = 220.0
#: A point is picked within so many pixels.
NEAR = 8


class SectionPanel(QWidget):
    """The 2D section.

    ``line_changed`` carries the new line (k, 2) and ``thickness_changed`` metres, when the user edits them here;
    ``point_chosen`` the horizon and the Row of the point that was clicked.
    """

    line_changed = Signal(object)
    thickness_changed = Signal(float)
    point_chosen = Signal(str, object)
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
        self.factor.addItem(self.tr("Auto"), None)
        for factor in FACTORS:
            self.factor.addItem(f"× {factor:g}", factor)
        tools = FlowLayout()
        for words, widget, about in (
            (self.tr("Along"), self.along, self.tr("A section of the site, or a line of your own.")),
            (self.tr("Azimuth"), self.azimuth, self.tr("Direction of the section, clockwise from north.")),
            (self.tr("Position"), self.position, self.tr("Right of the site's middle, looking along the azimuth.")),
            (self.tr("Thickness"), self.thickness, self.tr("Holes and points within half of this to each side.")),
            (self.tr("Height"), self.factor, self.tr("How much higher elevations are drawn; numbers stay true.")),
        ):  # fmt: skip
            tools.addWidget(_labelled(words, widget, about))
        self.canvas = PlotCanvas(self._paint, self._arrange)
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
        self.pages = Placeholder(content, self)
        self.data: SectionData | None = None
        self._surfaces: Mapping[str, HorizonFit] = {}
        self._uncertainty: Mapping[str, Uncertainty] = {}
        self.meshes: Meshes = {}
        self._bodies: tuple[SectionBody, ...] = ()
        self.preview: SectionBody | None = None
        self._task: Task | None = None
        self._again = self._due = False
        self._grasped: tuple[float, float] | None = None
        # Size of the drawing, its edges and exaggeration; magnified or moved, they stay until another line is shown.
        self._size, self._edges, self._shown, self._moved = (1.0, 1.0), ((0.0, 1.0), (0.0, 1.0)), 1.0, False
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
        surfaces: Mapping[str, HorizonFit],
        line: ArrayLike | None,
        thickness: float,
        uncertainty: Mapping[str, Uncertainty] | None = None,
        *,
        faded: bool = False,
    ) -> None:
        """Show a section of a site; without a line, one through its middle. Nothing is emitted."""
        if site is None:
            self.data = None
            self.pages.say(self.tr("No site open: open one to cut a section through it."))
            return
        new = self.data is None or self.data.site is not site
        box = site_extent(site, surfaces)
        curtain = Curtain.straight(90.0, 0.0, box) if line is None else Curtain.along(line)
        self._moved &= self.data is not None and np.array_equal(curtain.line, self.data.curtain.line)
        self._surfaces = surfaces
        for gone in self.meshes.keys() - surfaces.keys():
            del self.meshes[gone]
        kept = {} if self.data is None else {n: t for n, t in self.data.traces.items() if n in surfaces}
        self._uncertainty = uncertainty or {}
        self.data = SectionData(site, curtain, thickness, kept, faded)
        if new:
            self.along.clear()
            self.along.addItem(self.tr("Own line"))
            self.along.addItems([section.name for section in site.sections])
        self._show_inputs(curtain, thickness, box)
        self.pages.reveal()
        self._cut()

    def show_bodies(self, bodies: Sequence[SectionBody]) -> None:
        """Cut other bodies, too."""
        self._bodies = tuple(bodies)
        if self.data is not None:
            self.canvas.repaint_figure()

    def show_preview(self, body: SectionBody | None, text: str = "") -> None:
        """Cut a body with the settings that are being edited, too; None: no more, and ``text`` states the reason."""
        changed = body is not self.preview
        self.preview = body
        if text:
            self.state.setText(text)
        if changed and self.data is not None:
            self.canvas.repaint_figure()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Cut what changed while nobody saw it."""
        super().paintEvent(event)
        if self._due:
            self._due = False
            QTimer.singleShot(0, self, self._cut)

    @property
    def idle(self) -> bool:
        """Whether no cut is under way, and none about to begin."""
        return self._task is None and not self._pause.isActive()

    @property
    def line(self) -> object:
        """The line that is shown, (k, 2); None without a site."""
        return None if self.data is None else self.data.curtain.line

    def _show_inputs(self, curtain: Curtain, thickness: float, box: np.ndarray) -> None:
        values = (
            (self.azimuth, curtain.azimuth), (self.position, curtain.position(box)), (self.thickness, thickness)
        )  # fmt: skip
        for spin, value in values:
            spin.blockSignals(True)
            spin.setValue(value)
            spin.blockSignals(False)
        assert self.data is not None
        own = [
            s.line.shape == curtain.line.shape and np.allclose(s.line, curtain.line) for s in self.data.site.sections
        ]
        self.along.setCurrentIndex(own.index(True) + 1 if True in own else 0)

    def _edit_line(self) -> None:
        if self.data is None:
            return
        box = site_extent(self.data.site, self._surfaces)
        self._take(Curtain.straight(self.azimuth.value(), self.position.value(), box))
        self.along.setCurrentIndex(0)

    def _choose_section(self, index: int) -> None:
        if self.data is None or index == 0:
            return
        curtain = Curtain.along(self.data.site.sections[index - 1].line)
        self._show_inputs(curtain, self.data.thickness, site_extent(self.data.site, self._surfaces))
        self._take(curtain)

    def _rescale(self) -> None:
        if self.data is not None:
            self._show_all()

    def _show_all(self) -> None:
        self._moved = False
        self.canvas.repaint_figure()

    def _take(self, curtain: Curtain) -> None:
        assert self.data is not None
        self._moved = False
        self.data = replace(self.data, curtain=curtain)
        self._pause.start()

    def _tell_line(self) -> None:
        if self.data is not None:
            self._cut()
            self.line_changed.emit(self.data.curtain.line)

    def _edit_thickness(self, value: float) -> None:
        if self.data is None:
            return
        self.data = replace(self.data, thickness=value)
        self.canvas.repaint_figure()
        self.thickness_changed.emit(value)

    def _cut(self) -> None:
        """Cut beside the window; while a cut is under way only the last wish is kept."""
        # A dock behind others counts as visible, but nothing of it is seen.
        self._due = self.data is not None and self.visibleRegion().isEmpty()
        if self.data is None or self._due:
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
        curtain = self.data.curtain
        self._task = run(
            self, trace, dict(self._surfaces), dict(self._uncertainty), curtain.line, self.meshes,
            on_done=lambda found: self._show_traces(curtain, found), on_failed=self._tell_failure,
            title=self.tr("Section"),
        )  # fmt: skip
        self._task.ended.connect(self._ended)

    def _show_traces(self, curtain: Curtain, found: Traces) -> None:
        if self.data is not None and self.data.curtain is curtain:
            self.data = replace(self.data, traces=found)
            self._say_line()
            self.canvas.repaint_figure()

    def _tell_failure(self, error: Exception) -> None:
        self.state.setText(failure(error))
        self.failed.emit(error)

    def _ended(self) -> None:
        self._task = None
        if self._again:
            self._again = False
            self._cut()

    def _say_line(self) -> None:
        assert self.data is not None
        (x0, y0), (x1, y1) = self.data.curtain.line[[0, -1]]
        text = self.tr("From ({x0:.1f}, {y0:.1f}) to ({x1:.1f}, {y1:.1f}), {length:.0f} m")
        x0, y0, x1, y1 = (shown_coordinate(float(value)) for value in (x0, y0, x1, y1))
        length = shown_length(float(self.data.curtain.length))
        self.state.setText(text.format(x0=x0, y0=y0, x1=x1, y1=y1, length=length).removesuffix("m") + length_mark())

    def _paint(self, colours: PlotColours) -> None:
        if self.data is None:
            return
        words = {
            "ground": self.tr("ground", "SectionPanel"),
            "band": self.tr("90 % band of a new hole"),
            "elevation": self.tr("Elevation, m"),
        }
        axes = self.canvas.axes(1)[0]
        paint_section(axes, self.data, colours, words)
        bodies = self._bodies if self.preview is None else (*self._bodies, self.preview)
        draw_bodies(axes, bodies, self.data.curtain, self.data.thickness, colours)

    def _arrange(self, colours: PlotColours) -> None:
        """Put the drawing beside or above its legend, with all of the section in it unless somebody moved it."""
        assert self.data is not None
        axes = self.canvas.figure.axes[0]
        note, room = explain(self.canvas.figure, colours, narrow=self.canvas.narrow)
        # Other limits have other numbers, which may leave more or less room.
        for _ in range(2):
            size = self._place(axes, room)
            if self._moved:
                beside, levels = grown(*self._edges, self._size, size)
            else:
                seen, chosen = seen_in(axes, self.data.curtain), self.factor.currentData()
                self._shown = automatic(seen, size) if chosen is None else float(chosen)
                beside, levels = window(seen, size, self._shown)
            self._size = size
            self._look(axes, beside, levels)
        note.set_text(self.tr("Vertical {factor}×").format(factor=f"{self._shown:g}"))

    def _place(self, axes: Axes, room: tuple[float, float, float, float]) -> tuple[float, float]:
        """Place the drawing; where it is low, what the distances are is next to their numbers, not below."""
        low = room[3] < LOW and not self.canvas.narrow
        axes.set_xlabel("" if low else self.tr("Distance along the section, m"), ha="left" if low else "center")
        size = place_axes(axes, *room)
        if low:
            axes.set_xlabel(self.tr("Distance, m"), ha="left")
            axes.xaxis.set_label_coords(1 + 14 / size[0], -8 / size[1])
        number_lengths(axes)
        return size

    def _look(self, axes: Axes, beside: tuple[float, float], levels: tuple[float, float]) -> None:
        self._edges = beside, levels
        axes.set_xlim(beside)
        axes.set_ylim(levels)
        thin_names(axes)

    def look_at(self, beside: tuple[float, float], levels: tuple[float, float]) -> None:
        """Show distances and elevations of the section (metres) from edge to edge, until another line is shown."""
        self._moved = True
        self._look(self.canvas.figure.axes[0], beside, levels)
        self.canvas.refresh()

    def _zoom(self, event: MouseEvent) -> None:
        if event.inaxes is None or event.xdata is None or event.ydata is None:
            return
        factor, axes = 0.83 if event.step > 0 else 1.2, event.inaxes
        beside = [event.xdata + factor * (x - event.xdata) for x in axes.get_xlim()]
        levels = [event.ydata + factor * (z - event.ydata) for z in axes.get_ylim()]
        self.look_at((beside[0], beside[1]), (levels[0], levels[1]))

    def _press(self, event: MouseEvent) -> None:
        if event.dblclick:
            self._show_all()
        elif event.inaxes is not None and event.xdata is not None and event.ydata is not None:
            self._grasped = (event.xdata, event.ydata)
            self._pressed = (event.x, event.y)

    def _move(self, event: MouseEvent) -> None:
        if self._grasped is None or event.inaxes is None or event.xdata is None or event.ydata is None:
            return
        axes = event.inaxes
        if np.hypot(event.x - self._pressed[0], event.y - self._pressed[1]) < 4:
            return
        beside = [x + self._grasped[0] - event.xdata for x in axes.get_xlim()]
        levels = [z + self._grasped[1] - event.ydata for z in axes.get_ylim()]
        self.look_at((beside[0], beside[1]), (levels[0], levels[1]))

    def _release(self, event: MouseEvent) -> None:
        held, self._grasped = self._grasped, None
        if held is None or event.inaxes is None or self.data is None:
            return
        if np.hypot(event.x - self._pressed[0], event.y - self._pressed[1]) < 4:
            self._pick(event)

    def _pick(self, event: MouseEvent) -> None:
        assert self.data is not None
        assert event.inaxes is not None
        best, least = None, float(NEAR * self.canvas.device_pixel_ratio)
        for name in self.data.site.horizons:
            places, index = near_points(self.data, name)
            if len(index):
                away = np.hypot(*(event.inaxes.transData.transform(places) - [event.x, event.y]).T)
                if away.min() < least:
                    best, least = (name, int(index[away.argmin()])), float(away.min())
        if best is not None:
            name, chosen = best
            self.point_chosen.emit(name, Row.of(self.data.site.horizons[name], chosen))


def _spin(low: float, high: float, step: float, unit: str, longest: str) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setRange(low, high)
    spin.setDecimals(1)
    spin.setSingleStep(step)
    spin.setSuffix(unit)
    spin.setKeyboardTracking(False)
    spin.setAlignment(Qt.AlignmentFlag.AlignRight)
    sized_by_text(spin, lambda: spin.setFixedWidth(spin.fontMetrics().horizontalAdvance(longest) + 30))
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
