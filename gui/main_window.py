"""The main window: it holds the widgets and the controllers, and connects actions with what they do."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QChildEvent, QEvent, QSize, Qt, Signal
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QInputDialog, QMainWindow, QTabBar

from geofit.gui.actions import Actions
from geofit.gui.activity import Activity
from geofit.gui.activity_bar import ActivityBar
from geofit.gui.adjusting import Adjusting
from geofit.gui.bodies import Bodies
from geofit.gui.comparing_fits import ComparingFits
from geofit.gui.context import ContextMenus
from geofit.gui.dialogs.error import ErrorDialog
from geofit.gui.dialogs.steps import StepsDialog
from geofit.gui.dips import Dips
from geofit.gui.exporting import Delivering
from geofit.gui.files import Files
from geofit.gui.fitting import Fitting
from geofit.gui.help import Help
from geofit.gui.icons import application_icon
from geofit.gui.lengths import in_lengths
from geofit.gui.living import Living
from geofit.gui.menus import Menus
from geofit.gui.morphing import Morphing
from geofit.gui.ordering import Ordering
from geofit.gui.preferences import Preferences
from geofit.gui.selecting import Selecting
from geofit.gui.session import Session
from geofit.gui.showing import Showing
from geofit.gui.surveys import Surveys
from geofit.gui.tab_style import TabStyle
from geofit.gui.theme import apply_theme, is_dark, set_text_size
from geofit.gui.view3d.mouse import Scheme
from geofit.gui.worker import finish_all
from geofit.gui.workspace import Workspace
from geofit.project.commands import RenameSite
from geofit.project.provenance import Row

__all__ = ["MainWindow"]

#: Actions that need no open site.
_ALWAYS = {
    "new", "open", "sample", "quit", "preferences", "help", "tutorial", "shortcuts", "rock_volume", "survey",
    "system_report", "about",
}  # fmt: skip
#: What needs a horizon: a site may have bodies alone.
_OF_HORIZONS = {"fit", "fit_all", "order", "exclude", "faded"}
#: What needs fitted surfaces, so many; and what needs one of the chosen horizon.
_OF_SURFACES = {
    "check_order": 2, "separate": 2, "export_step": 1, "export_other": 1, "plan_sheet": 1, "report": 1,
}  # fmt: skip
_OF_THE_SURFACE = {"examine", "worst", "seams", "control_points"}


class MainWindow(QMainWindow):
    """The window on a session; it can be closed and made anew (another language) while the session goes on."""

    language_chosen = Signal(str)
    lengths_chosen = Signal(str)
    closed = Signal()

    def __init__(self, session: Session, preferences: Preferences) -> None:
        super().__init__()
        self.session, self.preferences = session, preferences
        self._ready = self._leaving = False
        self._tab_style = TabStyle()
        self._tab_style.setParent(self)
        self.steps: StepsDialog | None = None
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        available = self.screen().availableSize()
        self.setMinimumSize(QSize(960, 640).boundedTo(available))
        self.resize(QSize(1280, 800).boundedTo(available))
        self.activity = Activity(self)
        self.actions_ = Actions(self)
        self.menus = Menus(self, self.actions_, session.stack)
        self.panels = Workspace(self)
        self.bar = ActivityBar(self, self.activity)
        self.bar.add_fold(self.actions_["fold"], self.panels.bar)
        document = session.document
        self.showing = Showing(document, self.panels, self, lambda: self.activity.busy)
        self.fitting = Fitting(session, self.activity, self)
        self.files = Files(session, self.activity, self.fitting, preferences, self)
        self.living = Living(session, self.activity, self.fitting, self.panels, self.panels.offer, self)
        self.files.built.connect(self.living.build)
        self.files.work_lost.connect(self.living.hear_lost)
        self.showing.also.append(self.living.show)
        self.selecting = Selecting(document, self.panels, self.showing, self)
        self.dips = Dips(document, self.panels, self.showing, self)
        self.comparing_fits = ComparingFits(document, self.fitting, self)
        self.adjusting = Adjusting(document, self.fitting, self.activity, self.panels.adjust, self.panels.view, self)
        self.showing.drawn.connect(self.adjusting.renew)
        self.ordering = Ordering(document, self.activity, self.fitting, self.showing, self.panels, self)
        self.delivering = Delivering(document, self.activity, preferences, self.panels, self.showing, self)
        self.context = ContextMenus(document, self.panels, self.fitting, self.selecting, self.actions_, self)
        self.bodies = Bodies(session, self.activity, self.fitting, self.showing, self.panels, preferences, self)
        self.morphing = Morphing(session.document, self.activity, self.fitting, self.bodies, self.panels, self)
        self.surveys = Surveys(session.document, self.activity, self.bodies, self.ordering, self)
        self.help = Help(self, self._panel_in_use)
        self._connect_actions()
        self._connect_panels()
        self._connect_messages()
        self.menus.show_panels(self.panels.reach.switches)
        self._show_recent()
        self._choose_in(self.actions_.themes, preferences.theme)
        self.check_language()
        self._set_mouse(preferences.mouse)
        self._set_sizes(preferences.text_size, preferences.point_size)
        self._restore_layout()
        self.showing.everything()
        self._show_title()
        self._enable()
        self._ready = True

    def fail(self, title: str, error: Exception) -> None:
        """Tell of a failure in a dialog."""
        ErrorDialog(title, error, self).exec()

    def tell(self, text: str) -> None:
        """Say something in the status bar for a while."""
        self.statusBar().showMessage(in_lengths(text), 8000)

    @property
    def busy(self) -> bool:
        """Whether something is computed or filmed, also in the dialog of a survey: it would go with the window."""
        survey = self.surveys.dialog
        return self.activity.busy or self.morphing.filming.running or (survey is not None and survey.running)

    def take_over(self, other: MainWindow) -> None:
        """Go on with what another window on the session has found and the session itself does not keep."""
        self.panels.log.take_over(other.panels.log)
        self.living.take_over(other.living)
        self.showing.take_over(other.showing)
        self.delivering.take_over(other.delivering)
        self.panels.view.take_over(other.panels.view)
        self.morphing.take_over(other.morphing)
        self._choose_in(self.actions_.exaggerations, self.panels.view.canvas.stretch)
        for name in ("orthographic", "faded", "section", "clip"):
            self.actions_[name].setChecked(other.actions_[name].isChecked())

    def check_language(self) -> None:
        """Mark the language of the window in its menu."""
        self._choose_in(self.actions_.languages, self.preferences.language)

    def leave_without_asking(self) -> None:
        """Close at the next chance: the session goes on, or the user has been asked."""
        self._leaving = True
        self.close()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Check whether to save, end what runs, and let go of the 3D view."""
        if not self._leaving and self.session.document.dirty:
            event.ignore()
            self.files.leave(self.leave_without_asking)
            return
        self._ready = False
        self.panels.centring.close()
        self.preferences.layout = (self.saveGeometry(), self.panels.layout.state)
        self.activity.cancel()
        finish_all(helpers=False)
        for part in (
            self.comparing_fits, self.showing, self.selecting, self.fitting, self.living, self.bodies, self.morphing,
            self.surveys, self.delivering, self.ordering, self.help,
        ):  # fmt: skip
            part.close()
        for end in self._ends:
            end()
        self.session.recorded.disconnect(self.tell)
        if self.steps is not None:
            self.steps.close()
        self.panels.close()
        event.accept()
        self.closed.emit()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802
        """Take files, wherever they are dropped."""
        self.panels.start.dragEnterEvent(event)

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802
        """Open or import what is dropped."""
        self.panels.start.dropEvent(event)

    def focusNextPrevChild(self, forward: bool) -> bool:  # noqa: N802
        """Let Tab pass over docks that are behind others: Qt would give the keyboard to what nobody sees."""
        start = QApplication.focusWidget()
        while super().focusNextPrevChild(forward):
            now = QApplication.focusWidget()
            # Of docks that are folded away Qt keeps the bar with their tabs.
            unseen = isinstance(now, QTabBar) and now.visibleRegion().isEmpty()
            if now is start or not (unseen or self.panels.reach.behind(now)):
                return True
        return False

    def childEvent(self, event: QChildEvent) -> None:  # noqa: N802
        """Draw the tabs of docks close together and whole, in each bar that Qt makes for them."""
        super().childEvent(event)
        if event.type() != QEvent.Type.ChildPolished:
            return
        child = event.child()
        if isinstance(child, QTabBar):
            child.setStyle(self._tab_style)
            # Where the window is too narrow for all of them the bar scrolls; Qt would cut their names first.
            child.setElideMode(Qt.TextElideMode.ElideNone)

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.ActivationChange and self._ready and self.isActiveWindow():
            self.living.look()
            self.bodies.watch.look()
        if event.type() == QEvent.Type.PaletteChange and self._ready:
            self.actions_.draw_icons()
            self.menus.draw_icons()
            self.panels.view.set_dark(is_dark(self.palette()))

    def _connect_actions(self) -> None:
        files, view, give = self.files, self.panels.view, self.delivering
        for name, do in {
            "new": lambda: files.import_files([]),
            "open": files.ask_open,
            "sample": lambda: files.open_sample(),
            "save": files.save,
            "save_as": files.save_as,
            "export_step": give.export_step,
            "export_other": give.export_other,
            "section_sheet": give.section_sheet,
            "plan_sheet": give.plan_sheet,
            "report": give.report,
            "screenshot": give.screenshot,
            "issues": lambda: self.help.issues(self.session.document.site),
            "add_data": self.living.ask_files,
            "reload": self.living.reload,
            "build_horizon": self.living.build_horizon,
            "close": files.close,
            "quit": self.close,
            "steps": self._show_steps,
            "rename": self._rename,
            "preferences": lambda: self.help.preferences(
                self.preferences,
                self._set_theme,
                self.language_chosen.emit,
                self._set_mouse,
                self._set_sizes,
                self.lengths_chosen.emit,
            ),
            "home": view.reset_camera,
            "fold": self.panels.bar.toggle,
            "next_panel": lambda: self.panels.reach.step(1),
            "previous_panel": lambda: self.panels.reach.step(-1),
            "reset_layout": self.panels.arrange,
            "fit": self._with_horizon(self._fit),
            "fit_all": self.fitting.fit_all,
            "examine": self._with_horizon(self.fitting.examine),
            "compare_fits": self._with_horizon(self.comparing_fits.open),
            "check_order": self.ordering.check,
            "order": self.ordering.edit,
            "separate": self.ordering.ask_separation,
            "worst": self.selecting.go_to_worst,
            "exclude": lambda: self._exclude(self.selecting.rows()),
            "stop": self.activity.cancel,
            "help": self.help.on_panel,
            "tutorial": self.help.tutorial,
            "shortcuts": lambda: self.help.shortcuts(self.menuBar()),
            "rock_volume": self.help.rock_volume,
            "survey": self.surveys.open,
            "system_report": self.help.system_report,
            "about": self.help.about,
        }.items():
            self.actions_[name].triggered.connect(_plain(do))
        for name in ("top", "north", "south", "east", "west", "iso"):
            self.actions_[name].triggered.connect(lambda _=False, name=name: view.view(name))
        for name, switch in {
            "orthographic": view.set_orthographic,
            "clip": view.set_clip,
            "faded": self.showing.set_faded,
            "measure": view.set_measuring,
            "section": self._switch_section,
            "control_points": lambda on: view.set_control_points(self._horizon() if on else None),
            "seams": lambda on: view.set_seams(self._horizon() if on else None),
        }.items():
            self.actions_[name].toggled.connect(switch)
        self.actions_["faded"].setChecked(True)
        self.actions_.exaggerations.triggered.connect(lambda action: view.set_exaggeration(action.data()))
        self.actions_.themes.triggered.connect(lambda action: self._set_theme(action.data()))
        self.actions_.languages.triggered.connect(lambda action: self.language_chosen.emit(action.data()))

    def _connect_panels(self) -> None:
        panels, fitting, files = self.panels, self.fitting, self.files
        panels.start.sample_requested.connect(lambda: files.open_sample())
        panels.start.open_requested.connect(files.ask_open)
        panels.start.import_requested.connect(files.import_files)
        panels.start.file_chosen.connect(files.open)
        files.survey_chosen.connect(self.surveys.open)
        panels.fit.applied.connect(fitting.set_settings)
        panels.fit.fit_requested.connect(fitting.fit)
        panels.fit.fit_all_requested.connect(fitting.fit_all)
        panels.plan.core_changed.connect(fitting.set_core)
        panels.plan.area_changed.connect(fitting.set_area)
        # Also one that was refused: the plan goes back to what holds.
        panels.plan.area_changed.connect(lambda _: self.showing.renew())
        panels.plan.pointer_moved.connect(lambda x, y: self.bar.show_place(x, y, float("nan")))
        panels.residuals.exclude_requested.connect(self._exclude)
        panels.residuals.move_requested.connect(self.adjusting.move_to)
        panels.prediction.examine_requested.connect(self._with_horizon(fitting.examine))
        panels.changes.add_requested.connect(self.living.ask_files)
        panels.stereonet.add_requested.connect(self.living.ask_files)
        panels.changes.fit_requested.connect(fitting.fit)
        panels.changes.place_chosen.connect(panels.view.focus_place)
        panels.section.failed.connect(lambda error: self.fail(self.tr("Section"), error))
        panels.view.pointer_moved.connect(self.bar.show_place)
        panels.view.measured.connect(self.tell)
        panels.view.set_dark(is_dark(self.palette()))

    def _connect_messages(self) -> None:
        document = self.session.document
        self.activity.failed.connect(self.fail)
        self.activity.began.connect(lambda _: self._enable())
        self.activity.ended.connect(self._enable)
        self.activity.ended.connect(self.showing.renew)
        for refusing in (self.fitting, self.delivering, self.ordering, self.bodies, self.morphing):
            refusing.refused.connect(lambda error: self.fail("", error))
        self.panels.start.refused.connect(lambda error: self.fail("", error))
        self.showing.drawing.failed.connect(lambda error: self.fail(self.tr("Drawing"), error))
        for part in (
            self.files, self.delivering, self.ordering, self.fitting, self.living, self.bodies, self.morphing,
            self.surveys,
        ):  # fmt: skip
            part.reported.connect(self.tell)
        self.fitting.displaced.connect(self.showing.show_cuts)
        self.selecting.reported.connect(self.tell)
        self.adjusting.reported.connect(self.tell)
        self.dips.reported.connect(self.tell)
        self.comparing_fits.reported.connect(self.tell)
        self.session.recorded.connect(self.tell)
        self._ends: list[Callable[[], None]] = []
        for signal, listener in (
            (document.site_opened, self._on_opened),
            (document.site_changed, self._on_site),
            (document.saved_changed, self._show_title),
            (document.name_changed, self._show_title),
        ):
            signal.connect(listener)
            self._ends.append(lambda signal=signal, listener=listener: signal.disconnect(listener))  # type: ignore[misc]
        document.result_changed.connect(self._on_surfaces)
        document.selection_changed.connect(self._on_surfaces)
        self._ends.append(lambda: document.result_changed.disconnect(self._on_surfaces))
        self._ends.append(lambda: document.selection_changed.disconnect(self._on_surfaces))

    def _on_surfaces(self, *_: object) -> None:
        self._enable()

    def _on_opened(self) -> None:
        for name in ("section", "clip"):
            self.actions_[name].setChecked(False)

    def _on_site(self) -> None:
        self._show_recent()
        self._show_title()
        self._enable()
        self.statusBar().clearMessage()

    def _show_title(self) -> None:
        document = self.session.document
        file = document.project_file or document.site_file
        name = f"{document.state.name}[*] – {file.name} – geofit" if file else "geofit[*]"
        self.setWindowTitle(name)
        self.setWindowModified(document.dirty)
        self.bar.crs.setText(document.site.crs)
        self._show_recent()

    def _show_recent(self) -> None:
        recent = self.preferences.recent
        self.panels.start.show_recent(recent)
        self.menus.show_recent(recent, self.files.open)

    def _enable(self) -> None:
        """Enable what can be done with what is open."""
        document = self.session.document
        is_open, layered = document.is_open, bool(document.horizons)
        surfaces, chosen = document.surfaces(), document.selection.horizon
        for name, action in self.actions_.all().items():
            if name not in _ALWAYS:
                given = (layered or name not in _OF_HORIZONS) and len(surfaces) >= _OF_SURFACES.get(name, 0)
                # What is switched on can be switched off.
                given &= chosen in surfaces or name not in _OF_THE_SURFACE or action.isChecked()
                action.setEnabled(is_open and given)
        for name in ("fit", "fit_all"):
            self.actions_[name].setEnabled(layered and not self.showing.waiting)
        self.actions_["stop"].setEnabled(self.activity.busy)
        self.actions_.exaggerations.setEnabled(is_open)
        self.menus.panels.setEnabled(is_open)

    def _panel_in_use(self) -> str:
        if self.panels.centre.currentWidget() is self.panels.start:
            return "start"
        return self.panels.centring.holds(QApplication.focusWidget()) or self.panels.reach.place()

    def _horizon(self) -> str | None:
        return self.session.document.selection.horizon

    def _with_horizon(self, do: Callable[[str], object]) -> Callable[[], None]:
        def with_chosen() -> None:
            name = self._horizon()
            if name is not None:
                do(name)

        return with_chosen

    def _fit(self, name: str) -> None:
        """Fit a horizon with the settings that the panel shows, as its own button does."""
        if self.panels.fit.apply(name):
            self.fitting.fit(name)
        else:
            self.panels.reveal("fit")
            self.tell(self.tr("A setting is out of its range: see the panel Fit."))

    def _switch_section(self, on: bool) -> None:
        if on and self.isVisible():
            # A window that takes over from another one shows the panels that it restores.
            self.panels.reveal("section")
        if on:
            self.showing.begin_section()
        self.panels.view.set_section(self.showing.line if on else None, self.showing.thickness)

    def _exclude(self, rows: tuple[Row, ...]) -> None:
        name = self._horizon()
        if name is not None:
            self.fitting.exclude(name, rows)

    def _show_steps(self) -> None:
        """List the steps; one list at a time."""
        if self.steps is None:
            self.steps = StepsDialog(self.session.stack, self)
            steps = self.steps
            self.activity.began.connect(lambda *_: steps.set_busy(True))
            self.activity.ended.connect(lambda *_: steps.set_busy(False))
        self.steps.set_busy(self.activity.busy)
        self.steps.show()
        self.steps.raise_()

    def _rename(self) -> None:
        name, given = QInputDialog.getText(
            self, self.tr("Rename site"), self.tr("Name of the site"), text=self.session.document.state.name
        )
        name = name.strip()
        if given and name != self.session.document.state.name:
            self.fitting.push(RenameSite(name))

    def _set_theme(self, theme: str) -> None:
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        self.preferences.theme = theme  # type: ignore[assignment]
        self._choose_in(self.actions_.themes, theme)
        apply_theme(app, self.preferences.theme)

    def _set_mouse(self, scheme: Scheme) -> None:
        self.preferences.mouse = self.panels.view.canvas.scheme = scheme

    def _set_sizes(self, text: float, points: float) -> None:
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        self.preferences.text_size, self.preferences.point_size = text, points
        set_text_size(app, text)
        self.panels.view.set_point_size(points)

    def _choose_in(self, group: object, value: object) -> None:
        for action in group.actions():  # type: ignore[attr-defined]
            action.setChecked(action.data() == value)

    def _restore_layout(self) -> None:
        layout = self.preferences.layout
        if layout is not None:
            self.restoreGeometry(layout[0])
            self.panels.layout.state = layout[1]


def _plain(do: Callable[[], object]) -> Callable[..., None]:
    """Return a slot that drops what the signal carries."""

    def slot(*_: object) -> None:
        do()

    return slot
