"""The panel of a metamorphosis: bodies in order, mode, pace, dates; slider and curves; play, step, take and export."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QComboBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.marks import icon
from geofit.gui.panels.morph_timeline import MorphTimeline
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.settings_form import scrolling
from geofit.gui.translate import translated
from geofit.morphing.body import GEOMETRY_ONLY

__all__ = ["MorphPanel"]

#: Pause between two frames of the play, milliseconds, and frames of the whole way.
PAUSE, FRAMES = 60, 60


class MorphPanel(QWidget):
    """Asks how bodies are joined, and shows where between them one is.

    Signals: ``run_requested()``, ``stop_requested()``; ``moved(tau)`` while the slider is dragged or plays,
    ``rested(tau)`` when it is let go; ``skin_toggled(on)``; ``take_requested()``, ``export_requested()``,
    ``film_requested()`` for a film of the view,
    ``add_requested()`` for a body of a file, ``horizons_requested()`` for bodies between horizons.
    """

    run_requested = Signal()
    stop_requested = Signal()
    moved = Signal(float)
    rested = Signal(float)
    skin_toggled = Signal(bool)
    take_requested = Signal()
    export_requested = Signal()
    film_requested = Signal()
    add_requested = Signal()
    horizons_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.list = QListWidget()
        self.list.setAccessibleName(self.tr("Bodies in order"))
        self.list.setDragDropMode(QAbstractItemView.DragDropMode.InternalMove)
        self.list.setToolTip(self.tr("Check two or more bodies; drag them into their order: A, B, C…"))
        self.list.setMinimumHeight(64)
        self.add = QPushButton(self.tr("Add a body from a file…"))
        self.horizons = QPushButton(self.tr("Close horizons to bodies…"))
        self.horizons.setToolTip(
            self.tr("Bodies between horizons and a common base, such as the ground at two surveys")
        )
        self.mode, self.pace = QComboBox(), QComboBox()
        for box, choices in (
            (self.mode, (("arrival", self.tr("Front from A")), ("pde", self.tr("Level set, smoothed")),
                         ("blend", self.tr("Linear blend")))),
            (self.pace, (("progress", self.tr("By progress")), ("volume", self.tr("By volume")),
                         ("time", self.tr("By the front's time")))),
        ):  # fmt: skip
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(9)
            for value, words in choices:
                box.addItem(words, value)
        self.dates = QLineEdit()
        self.dates.setPlaceholderText("2024-05-31, 2025-05-31")
        self.dates.setToolTip(
            self.tr("A date for each body, separated by commas; progress is then proportional to time.")
        )
        self.seeds = QCheckBox(self.tr("Seed unreached parts"))
        self.run, self.stop = QPushButton(self.tr("Join")), QPushButton(self.tr("Stop"))
        self.run.setProperty("primary", True)
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.timeline = MorphTimeline()
        self.back, self.play, self.forth = QToolButton(), QToolButton(), QToolButton()
        for button, sign, words in (
            (self.back, "◀", self.tr("Previous frame")), (self.play, "▶", self.tr("Play or stop")),
            (self.forth, "▶|", self.tr("Next frame")),
        ):  # fmt: skip
            button.setText(sign)
            button.setToolTip(words)
            button.setAccessibleName(words)
        self.back.setText("|◀")
        self.play.setCheckable(True)
        self.skin = QCheckBox(self.tr("Onion skin of the ends"))
        self.skin.setChecked(True)
        self.take, self.export = QPushButton(self.tr("Take as body…")), QPushButton(self.tr("Export frames…"))
        self.film = QPushButton(self.tr("Film of the view…"))
        self.film.setToolTip(self.tr("GIF or MP4 of all frames as seen in the 3D view"))
        self.where, self.note = QLabel(), QLabel(translated(GEOMETRY_ONLY))
        self.note.setWordWrap(True)
        self._lay_out()
        self._playing = QTimer(self, interval=PAUSE)
        self._playing.timeout.connect(lambda: self.step(1))
        self.run.clicked.connect(self.run_requested)
        self.stop.clicked.connect(self.stop_requested)
        self.add.clicked.connect(self.add_requested)
        self.horizons.clicked.connect(self.horizons_requested)
        self.take.clicked.connect(self.take_requested)
        self.export.clicked.connect(self.export_requested)
        self.film.clicked.connect(self.film_requested)
        self.skin.toggled.connect(self.skin_toggled)
        self.timeline.moved.connect(self.moved)
        self.timeline.rested.connect(self.rested)
        self.play.toggled.connect(self._play)
        self.back.clicked.connect(lambda: self._step_once(-1))
        self.forth.clicked.connect(lambda: self._step_once(1))
        self.list.itemChanged.connect(lambda _: self._check())
        self.list.model().rowsMoved.connect(lambda *_: self._check())
        self.set_running(False)
        self.set_ready(False, False)
        self.show_bodies(())

    def show_bodies(self, names: Sequence[tuple[str, str]]) -> None:
        """Offer bodies by name and mark; those that are known stay checked and in their order."""
        known = [self.list.item(k) for k in range(self.list.count())]
        order = [item.data(Qt.ItemDataRole.UserRole) for item in known]
        on = {item.data(Qt.ItemDataRole.UserRole) for item in known if item.checkState() == Qt.CheckState.Checked}
        marks = dict(names)
        kept = [name for name in order if name in marks]
        with QSignalBlocker(self.list):
            self.list.clear()
            for name in (*kept, *(name for name in marks if name not in kept)):
                item = QListWidgetItem(icon(marks[name]), name)
                item.setData(Qt.ItemDataRole.UserRole, name)
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
                item.setCheckState(Qt.CheckState.Checked if name in on else Qt.CheckState.Unchecked)
                self.list.addItem(item)
        if names:
            self.pages.reveal()
        else:
            self.pages.say(
                self.tr(
                    "No bodies yet: fit two in the panel Bodies, read them from files, or close horizons to bodies "
                    "with a common base."
                )
            )
        self._check()

    def take_over(self, other: MorphPanel) -> None:
        """Take the order of the bodies, and what is chosen and entered, from another panel."""
        with QSignalBlocker(self.list):
            self.list.clear()
            for k in range(other.list.count()):
                self.list.addItem(other.list.item(k).clone())
        for mine, theirs in ((self.mode, other.mode), (self.pace, other.pace)):
            mine.setCurrentIndex(theirs.currentIndex())
        self.dates.setText(other.dates.text())
        for box, former in ((self.seeds, other.seeds), (self.skin, other.skin)):
            with QSignalBlocker(box):
                box.setChecked(former.isChecked())

    def chosen(self) -> tuple[str, ...]:
        """Return the bodies that are checked, in their order."""
        items = [self.list.item(k) for k in range(self.list.count())]
        return tuple(
            item.data(Qt.ItemDataRole.UserRole) for item in items if item.checkState() == Qt.CheckState.Checked
        )

    def given_dates(self) -> tuple[str, ...]:
        """Return the dates as they are written."""
        return tuple(word for word in self.dates.text().replace("，", ",").replace(",", " ").split())

    def say(self, text: str) -> None:
        """Say something about the way: what is not reached, or what is missing."""
        self.said.setText(text)
        self.said.setVisible(bool(text))

    def show_place(self, text: str) -> None:
        """Say where between the bodies one is."""
        self.where.setText(text)

    def set_running(self, running: bool) -> None:
        """Show Stop in place of Join; what is joined and how rests meanwhile."""
        self.stop.setVisible(running)
        self.run.setVisible(not running)
        for widget in (self.list, self.mode, self.pace, self.dates, self.seeds):
            widget.setEnabled(not running)

    def set_ready(self, preview: bool, full: bool) -> None:
        """Enable the slider once there is a preview, and what needs the full grid once that is there."""
        for widget in (self.timeline, self.back, self.play, self.forth, self.skin):
            widget.setEnabled(preview)
        for button in (self.take, self.export, self.film):
            button.setEnabled(full)
        if not preview:
            self.play.setChecked(False)

    def rest(self) -> None:
        """Stop playing."""
        self.play.setChecked(False)
        self._playing.stop()

    def step(self, by: int) -> None:
        """Go some frames on; the play ends at the last body."""
        tau = self.timeline.tau
        if by > 0 and tau >= 1.0:
            self.rest()
            self.rested.emit(1.0)
            return
        self.timeline.put(round(tau * FRAMES + by) / FRAMES)
        self.moved.emit(self.timeline.tau)

    def _step_once(self, by: int) -> None:
        self.rest()
        self.step(by)
        self.rested.emit(self.timeline.tau)

    def _play(self, on: bool) -> None:
        self.play.setText("❚❚" if on else "▶")
        if on:
            if self.timeline.tau >= 1.0:
                self.timeline.put(0.0)
            self._playing.start()
        elif self._playing.isActive():
            self._playing.stop()
            self.rested.emit(self.timeline.tau)

    def _check(self) -> None:
        self.run.setEnabled(len(self.chosen()) >= 2)

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.setContentsMargins(0, 0, 0, 0)
        form.setVerticalSpacing(4)
        for words, box in (
            (self.tr("Mode"), self.mode), (self.tr("Pace"), self.pace), (self.tr("Dates"), self.dates),
        ):  # fmt: skip
            form.addRow(words, box)
            box.setAccessibleName(words)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(8, 8, 12, 8)
        column.setSpacing(4)
        column.addWidget(self.list, 1)
        column.addWidget(self.add, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self.horizons, 0, Qt.AlignmentFlag.AlignLeft)
        column.addLayout(form)
        column.addWidget(self.seeds)
        row = QHBoxLayout()
        for button in (self.run, self.stop):
            row.addWidget(button, 1)
        side = QWidget()
        outer = QVBoxLayout(side)
        outer.setContentsMargins(0, 0, 0, 8)
        outer.addWidget(scrolling(left), 1)
        line = QHBoxLayout()
        line.setContentsMargins(8, 0, 8, 0)
        line.addLayout(row)
        outer.addLayout(line)
        tools = FlowLayout()
        for widget in (self.back, self.play, self.forth, self.where, self.skin, self.take, self.export, self.film):
            tools.addWidget(widget)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(4, 8, 8, 8)
        column.setSpacing(6)
        column.addWidget(self.said)
        column.addLayout(tools)
        column.addWidget(self.timeline, 1)
        column.addWidget(self.note)
        parts = QSplitter(Qt.Orientation.Horizontal)
        parts.setChildrenCollapsible(False)
        parts.addWidget(side)
        # Where there is little room nothing lies over another thing.
        shown = scrolling(right)
        shown.setMinimumWidth(self.timeline.minimumWidth() + 30)
        parts.addWidget(shown)
        parts.setSizes([280, 540])
        parts.setStretchFactor(1, 1)
        self.pages = Placeholder(parts, self)
        for button in (self.add, self.horizons):
            self.pages.offer(button)
