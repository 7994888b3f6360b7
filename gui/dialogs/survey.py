"""A survey of a cave, adit or tunnel: centre line, loops, walls and body in space, volume, strata, report, files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QFileDialog,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.caves.adjust import AdjustedSurvey
from geofit.gui.dialogs.scene_dialog import SceneDialog
from geofit.gui.dialogs.sheet import LengthField
from geofit.gui.dialogs.survey_tables import figure_rows, issue_columns, loop_columns, stratum_columns, wall_columns
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.translate import user_language
from geofit.gui.view3d.cave_scene import FILLED, MEASURED, STATES, CaveScene
from geofit.project.cave_run import CaveRun
from geofit.project.cave_view import cut_view, measured_view, read_adjusted, write_view
from geofit.surfaces.protocol import Surface

__all__ = ["SurveyDialog"]


class SurveyDialog(SceneDialog):
    """Shows a survey; ``add_requested(run)`` asks for its body in the open site, ``written(files)`` names new files.

    Parameters
    ----------
    horizons : callable
        Returns the surfaces of the open site, the highest first; none where no site is open.
    can_add : callable
        Whether a site is open that can take the body.

    ``adjusted`` and ``run`` hold the survey and its body; None before.
    """

    scene: CaveScene
    add_requested = Signal(object)
    written = Signal(object)

    def __init__(
        self, horizons: Callable[[], Mapping[str, Surface]], can_add: Callable[[], bool], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Survey of passages"))
        self.setWindowFlag(Qt.WindowType.WindowMaximizeButtonHint)
        self._horizons, self._can_add = horizons, can_add
        self.adjusted: AdjustedSurvey | None = None
        self.run: CaveRun | None = None
        self._path: Path | None = None
        self.scene, self.tabs = CaveScene(), QTabWidget()
        names = {
            "figures": self.tr("Figures"), "loops": self.tr("Loops"), "walls": self.tr("Missing walls"),
            "strata": self.tr("Strata"), "rows": self.tr("Listed rows"),
        }  # fmt: skip
        self.tables = {name: DataTable() for name in names}
        for name, title in names.items():
            self.tables[name].setAccessibleName(title)
            self.tabs.addTab(self.tables[name], title)
        self.open_button = QPushButton(self.tr("&Open a survey…"))
        self.radius = LengthField(0.0, 1000.0, 0.0, decimals=2)
        self.radius.setSpecialValueText(self.tr("as measured"))
        self.radius.setToolTip(self.tr("Distance of the walls, for a survey that has none"))
        self.cut = QCheckBox(self.tr("Cut by the &horizons of the site"))
        self.shows = {
            "line": QCheckBox(self.tr("Centre &line")), "stations": QCheckBox(self.tr("S&tations")),
            "walls": QCheckBox(self.tr("&Walls")), "body": QCheckBox(self.tr("&Body")),
        }  # fmt: skip
        self.key = QLabel()
        self.key.setTextFormat(Qt.TextFormat.RichText)
        self.key.setWordWrap(True)
        self.go.setText(self.tr("&Make body"))
        self.export, self.report = QPushButton(self.tr("&Export…")), QPushButton(self.tr("&Report…"))
        self.add = QPushButton(self.tr("&Add to site"))
        self.add.setToolTip(self.tr("Add the body to the open site, where it can be undone"))
        self.fields = (self.open_button, self.radius, self.cut)
        self._lay_out()
        self._connect()
        self.refresh()

    def read(self, path: Path) -> None:
        """Read a survey, show it, and make its body."""
        self._path = path
        self.say("")
        self.begin(read_adjusted, path, on_done=self._opened, on_stopped=self._stopped, in_process=False)

    def write(self, folder: Path, *, report: bool = False) -> None:
        """Write the files of ``geofit cave`` into a folder, or the report alone, in the windows' language."""
        assert self.run is not None
        self.begin(write_view, self.run, folder, report, user_language(), on_done=self._wrote, on_stopped=self._stopped)

    def refresh(self) -> None:
        """Enable what can be done with what is open."""
        super().refresh()
        free, made = not self.running, self.run is not None
        self.go.setEnabled(free and self.adjusted is not None)
        self.cut.setEnabled(free and made and bool(self._horizons()))
        for button in (self.export, self.report):
            button.setEnabled(free and made)
        self.add.setEnabled(free and made and self._can_add())

    def _lay_out(self) -> None:
        top = QHBoxLayout()
        top.addWidget(self.open_button)
        top.addSpacing(12)
        label = QLabel(self.tr("Wall distance"))
        label.setBuddy(self.radius)
        top.addWidget(label)
        top.addWidget(self.radius)
        top.addSpacing(12)
        top.addWidget(self.cut)
        top.addStretch(1)
        switches = QHBoxLayout()
        for box in self.shows.values():
            switches.addWidget(box)
        switches.addStretch(1)
        view = QWidget()
        column = QVBoxLayout(view)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.scene, 1)
        column.addLayout(switches)
        column.addWidget(self.key)
        parts = QSplitter(Qt.Orientation.Horizontal)
        parts.addWidget(view)
        parts.addWidget(self.tabs)
        parts.setStretchFactor(0, 3)
        parts.setStretchFactor(1, 2)
        # Wide enough to show the misclosure of a loop without scrolling.
        parts.setSizes([700, 460])
        parts.setChildrenCollapsible(False)
        layout = QVBoxLayout(self)
        layout.addLayout(top)
        layout.addWidget(parts, 1)
        layout.addLayout(self.message_row)
        layout.addLayout(self.foot(self.export, self.report, self.add))
        self.resize(1180, 760)

    def _connect(self) -> None:
        self.open_button.clicked.connect(self._ask)
        self.go.clicked.connect(self._make)
        self.cut.toggled.connect(self._cut)
        self.export.clicked.connect(lambda: self._ask_folder(report=False))
        self.report.clicked.connect(lambda: self._ask_folder(report=True))
        self.add.clicked.connect(lambda: self.add_requested.emit(self.run))
        self.tables["loops"].chosen.connect(self.scene.choose_loop)
        for part, box in self.shows.items():
            box.setChecked(True)
            box.toggled.connect(lambda on, part=part: self.scene.set_visible(part, on))

    def _ask(self) -> None:
        kinds = self.tr("Surveys (*.dat *.svx *.csv *.txt *.xlsx)")
        path, _ = QFileDialog.getOpenFileName(
            self, self.tr("Open a survey"), str(self._path or ""), f"{kinds};;{self.tr('All files (*)')}"
        )
        if path:
            self.read(Path(path))

    def _ask_folder(self, *, report: bool) -> None:
        title = self.tr("Folder of the report") if report else self.tr("Folder of the files")
        folder = QFileDialog.getExistingDirectory(self, title, str(self._path.parent if self._path else ""))
        if folder:
            self.write(Path(folder), report=report)

    def _stopped(self) -> None:
        self.say(self.tr("Stopped. Nothing has changed."))

    def _opened(self, adjusted: AdjustedSurvey) -> None:
        self.adjusted, self.run = adjusted, None
        self.setWindowTitle(self.tr("Survey {name}").format(name=adjusted.survey.name))
        self.scene.show_survey(adjusted)
        self.cut.setChecked(False)
        self._show_key()
        self._show_tables()
        self._make()

    def _make(self) -> None:
        assert self.adjusted is not None
        self.say(self.tr("Making the body…"))
        radius = self.radius.metres or None
        work = (measured_view, self.adjusted.survey, radius, self._used())
        self.begin(*work, on_done=self._made, on_stopped=self._stopped)

    def _used(self) -> dict[str, Surface]:
        return dict(self._horizons()) if self.cut.isChecked() else {}

    def _cut(self) -> None:
        if self.run is not None and not self.running:
            self.begin(cut_view, self.run, self._used(), on_done=self._divided, on_stopped=self._stopped)

    def _made(self, run: CaveRun) -> None:
        self.run = run
        self.scene.show_body(run)
        self._show_tables()
        checked = [loop for loop in run.adjusted.loops if loop.suspicious]
        thin = run.body.thinner_than(run.spacing)
        if checked:
            worst = checked[0]
            text = self.tr("{count} of {all} loops exceed three times their expected misclosure. The worst: {stations}")
            stations = " – ".join(worst.stations[:6]) + ("…" if len(worst.stations) > 6 else "")
            self.say(text.format(count=len(checked), all=len(run.adjusted.loops), stations=stations), "stale")
        elif thin:
            self.say(
                self.tr("{count} passages are thinner than the triangles; the volume has them.").format(
                    count=len(thin)
                ),
                "stale",
            )
        else:
            self.say(self.tr("The body is made."), "passed")

    def _divided(self, run: CaveRun) -> None:
        self.run = run
        self._show_tables()
        if run.strata:
            self.tabs.setCurrentWidget(self.tables["strata"])
        self.say(self.tr("Cut by {count} horizons.").format(count=len(run.strata) - 2) if run.strata else "", "passed")

    def _wrote(self, run: CaveRun) -> None:
        self.say(self.tr("Wrote {names}.").format(names=", ".join(file.name for file in run.files)), "passed")
        self.written.emit(run.files)

    def _show_tables(self) -> None:
        assert self.adjusted is not None
        names, values = zip(*figure_rows(self.adjusted, self.run), strict=True)
        figures = [TableColumn(self.tr("Figure"), np.array(names)), TableColumn(self.tr("Value"), np.array(values))]
        for name, columns in {
            "figures": figures,
            "loops": loop_columns(self.adjusted),
            "walls": wall_columns(self.run),
            "strata": stratum_columns(self.run),
            "rows": issue_columns(self.adjusted.survey),
        }.items():
            self.tables[name].show_columns(columns)
            # Empty tables are hidden: there are no loops, missing walls, strata or unused rows to list.
            self.tabs.setTabVisible(self.tabs.indexOf(self.tables[name]), len(columns[0].values) > 0)
        # The volume makes the table of figures wider than it was.
        self.tables["figures"].resizeColumnsToContents()

    def _show_key(self) -> None:
        words = (
            (STATES[0], self.tr("shots without a loop")), (STATES[1], self.tr("in loops that close")),
            (STATES[2], self.tr("in loops to be checked")), (MEASURED, self.tr("measured walls")),
            (FILLED, self.tr("sections with a missing wall")),
        )  # fmt: skip
        self.key.setText("&nbsp; ".join(f'<span style="color:{colour}">■</span> {word}' for colour, word in words))
