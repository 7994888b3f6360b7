"""A survey of a cave, adit or tunnel: centre line, loops, walls and body in space, volume, strata, report, files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QFileDialog,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from geofit.caves.adjust import AdjustedSurvey
from geofit.data.errors import GeofitError
from geofit.data.messages import plural_message
from geofit.data.site import ImportIssue
from geofit.gui.dialogs.scene_dialog import SceneDialog
from geofit.gui.dialogs.sheet import LengthField
from geofit.gui.dialogs.survey_tables import figure_rows, issue_columns, loop_columns, stratum_columns, wall_columns
from geofit.gui.names import literal
from geofit.gui.panels.tables import DataTable, TableColumn
from geofit.gui.save_file import may_replace
from geofit.gui.translate import translated, user_language
from geofit.gui.view3d.cave_scene import FILLED, MEASURED, STATES, CaveScene
from geofit.project.cave_run import CaveRun
from geofit.project.cave_view import (
    cut_view,
    measured_view,
    read_adjusted,
    view_files,
    wall_distance_counts,
    write_view,
)
from geofit.surfaces.protocol import HasElevation

__all__ = ["SurveyDialog"]


class SurveyDialog(SceneDialog):
    """Shows a survey; ``add_requested(run)`` asks for its body in the open site, ``written(files)`` names new files.

    Parameters
    ----------
    horizons : callable
        Returns the strata of the open site, the highest first; none where no site is open.
    can_add : callable
        Whether a site is open that can take the body.

    ``adjusted`` and ``run`` hold the survey and its body; None before. A change of the wall distance puts the body out
    of date: it is not cut, written or added until it is made again.
    """

    scene: CaveScene
    add_requested = Signal(object)
    written = Signal(object)

    def __init__(
        self,
        horizons: Callable[[], Mapping[str, HasElevation]],
        can_add: Callable[[], bool],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Survey of passages"))
        self.setWindowFlag(Qt.WindowType.WindowMaximizeButtonHint)
        self._horizons, self._can_add = horizons, can_add
        self.adjusted: AdjustedSurvey | None = None
        self.run: CaveRun | None = None
        self._path: Path | None = None
        #: The wall distance of the body, as the field shows it.
        self._distance = 0.0
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
        self.fields = (self.open_button,)
        self._lay_out()
        self._connect()
        self.refresh()

    def read(self, path: Path) -> None:
        """Read a survey, show it, and make its body."""
        self._path = path
        self.say("")
        self._show_rows(() if self.adjusted is None else self.adjusted.survey.issues)
        self.begin(read_adjusted, path, on_done=self._opened, on_stopped=self._stopped, in_process=False)

    def write(self, folder: Path, *, report: bool = False) -> None:
        """Write the files of ``geofit cave`` into a folder, or the report alone, in the windows' language.

        Asks before files are replaced.
        """
        assert self.run is not None
        files = view_files(self.run, folder, report)
        if not may_replace(files, self.windowTitle(), self):
            return
        work = (write_view, self.run, folder, report, user_language())
        self.begin(*work, on_done=self._wrote, on_stopped=self._stopped, files=files)

    def refresh(self) -> None:
        """Enable what can be done with what is open."""
        super().refresh()
        free, made = not self.running, self.run is not None and not self._stale
        self.go.setEnabled(free and self.adjusted is not None)
        self.cut.setEnabled(free and made and bool(self._horizons()))
        for button in (self.export, self.report):
            button.setEnabled(free and made)
        self.add.setEnabled(free and made and self._can_add())
        counts = self.adjusted is not None and wall_distance_counts(self.adjusted.survey)
        self.radius.setEnabled(free and counts)
        self.radius.setToolTip(
            self.tr("Not used: the survey has walls of its own")
            if self.adjusted is not None and not counts
            else self.tr("Distance of the walls, where a survey has none at its sides, or none above and below")
        )

    def tell_failure(self, error: Exception) -> None:
        """Say what went wrong, and show the rows of a file that is refused."""
        super().tell_failure(error)
        if isinstance(error, GeofitError) and error.issues and self._path is not None:
            self._show_rows(error.issues, self._path.name)
            self.tabs.setCurrentWidget(self.tables["rows"])

    @property
    def _stale(self) -> bool:
        """Whether the body has another wall distance than the field."""
        return self.run is not None and self.radius.value() != self._distance

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
        # Wide enough to show everything about a loop without scrolling.
        parts.setSizes([580, 580])
        parts.setChildrenCollapsible(False)
        layout = QVBoxLayout(self)
        layout.addLayout(top)
        layout.addWidget(parts, 1)
        layout.addLayout(self.message_row)
        layout.addLayout(self.foot(self.export, self.report, self.add))
        self.resize(QSize(1180, 760).boundedTo(self.screen().availableSize()))

    def _connect(self) -> None:
        self.open_button.clicked.connect(self._ask)
        self.go.clicked.connect(self._make)
        self.cut.toggled.connect(self._cut)
        self.export.clicked.connect(lambda: self._ask_folder(report=False))
        self.report.clicked.connect(lambda: self._ask_folder(report=True))
        self.radius.valueChanged.connect(self._changed)
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
        lacking = self.adjusted is not None and self.run is None
        otherwise = self.tr("Stopped. No body was made.") if lacking else self.tr("Stopped. Nothing has changed.")
        words = self.stopped_words(otherwise)
        self.say("\n".join([words, *self._out_of_date()]))

    def _opened(self, adjusted: AdjustedSurvey) -> None:
        self.adjusted, self.run = adjusted, None
        self.radius.setValue(0.0)
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
        self.begin(*work, on_done=partial(self._made, self.radius.value()), on_stopped=self._stopped)

    def _changed(self) -> None:
        if self.run is not None:
            self._conclude(self.tr("The body is made."))
        self.refresh()

    def _used(self) -> dict[str, HasElevation]:
        return dict(self._horizons()) if self.cut.isChecked() else {}

    def _cut(self) -> None:
        if self.run is not None and not self.running:
            self.begin(cut_view, self.run, self._used(), on_done=self._divided, on_stopped=self._stopped)

    def _made(self, distance: float, run: CaveRun) -> None:
        self.run, self._distance = run, distance
        self.scene.show_body(run)
        self._show_tables()
        self._conclude(self.tr("The body is made."))

    def _divided(self, run: CaveRun) -> None:
        self.run = run
        self._show_tables()
        if run.strata:
            self.tabs.setCurrentWidget(self.tables["strata"])
            self._conclude(self.tr("Cut by {count} horizons.").format(count=len(run.strata) - 2))
        else:
            self._conclude(self.tr("The body is made."))

    def _wrote(self, run: CaveRun) -> None:
        self._conclude(self.tr("Wrote {names}.").format(names=", ".join(file.name for file in run.files)))
        self.written.emit(run.files)

    def _conclude(self, done: str) -> None:
        """Say what was done, or that the body is out of date, and what is to be checked."""
        warnings = self._warnings()
        text = "\n".join([*(self._out_of_date() or [done]), *warnings])
        self.say(text, "stale" if self._stale else "warning" if warnings else "passed")

    def _out_of_date(self) -> list[str]:
        return [self.tr("The wall distance has changed: make the body again.")] if self._stale else []

    def _warnings(self) -> list[str]:
        """Return what must be checked before the body is used."""
        assert self.run is not None
        loops, issues = self.run.adjusted.loops, self.run.adjusted.survey.issues
        rejected = len({(one.file, one.row) for one in issues if one.severity == "error"})
        checked = [loop for loop in loops if loop.suspicious]
        thin = self.run.body.thinner_than(self.run.spacing)
        found = []
        if rejected:
            text = plural_message(
                "gui.survey-rows-not-used",
                "{count} row was not used: see the tab Listed rows.",
                "{count} rows were not used: see the tab Listed rows.",
                count=rejected,
            )
            found.append(translated(text))
        if checked:
            worst = checked[0]
            words = self.tr(
                "{count} of {all} loops exceed three times their expected misclosure. The worst: {stations}"
            )
            stations = " – ".join(worst.stations[:6]) + ("…" if len(worst.stations) > 6 else "")
            found.append(words.format(count=len(checked), all=len(loops), stations=stations))
        if thin:
            words = self.tr("{count} passages are thinner than the triangles; the volume has them.")
            found.append(words.format(count=len(thin)))
        return found

    def _show_tables(self) -> None:
        assert self.adjusted is not None
        names, values = zip(*figure_rows(self.adjusted, self.run), strict=True)
        figures = [TableColumn(self.tr("Figure"), np.array(names)), TableColumn(self.tr("Value"), np.array(values))]
        for name, columns in {
            "figures": figures,
            "loops": loop_columns(self.adjusted),
            "walls": wall_columns(self.run),
            "strata": stratum_columns(self.run),
        }.items():
            self._show_table(name, columns)
        self._show_rows(self.adjusted.survey.issues)
        # A loop may have long names of stations; its numbers come first.
        self.tables["loops"].horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        # The volume makes the table of figures wider than it was.
        self.tables["figures"].resizeColumnsToContents()

    def _show_table(self, name: str, columns: Sequence[TableColumn]) -> None:
        self.tables[name].show_columns(columns)
        # An empty table has nothing to tell.
        self.tabs.setTabVisible(self.tabs.indexOf(self.tables[name]), len(columns[0].values) > 0)

    def _show_rows(self, issues: Sequence[ImportIssue], refused: str = "") -> None:
        """List what a reader found; ``refused`` names its file where that is not the survey that is shown."""
        self._show_table("rows", issue_columns(issues))
        title = self.tr("Listed rows of {file} ({count})") if refused else self.tr("Listed rows ({count})")
        place = self.tabs.indexOf(self.tables["rows"])
        self.tabs.setTabText(place, title.format(file=literal(refused), count=len(issues)))

    def _show_key(self) -> None:
        words = (
            (STATES[0], self.tr("shots without a loop")), (STATES[1], self.tr("in loops that close")),
            (STATES[2], self.tr("in loops to be checked")), (MEASURED, self.tr("measured walls")),
            (FILLED, self.tr("sections with a missing wall")),
        )  # fmt: skip
        self.key.setText("&nbsp; ".join(f'<span style="color:{colour}">■</span>&nbsp;{word}' for colour, word in words))
