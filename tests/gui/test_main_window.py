"""The main window: actions, switches, messages, another language, recovery, and that nothing stays behind."""

from __future__ import annotations

import hashlib
import json
import logging
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent, QGuiApplication, QKeySequence
from PySide6.QtWidgets import QDialog, QMessageBox
from shiboken6 import isValid

from geofit.data.errors import FitError, InputError
from geofit.data.messages import message
from geofit.data.site import ImportIssue, Site, TableCount
from geofit.gui.dialogs.error import ErrorDialog
from geofit.gui.dialogs.issues import IssuesDialog
from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.dialogs.recovery import RecoveryDialog
from geofit.gui.dialogs.shortcuts import ShortcutsDialog
from geofit.gui.dialogs.system_report import SystemReport, system_report
from geofit.gui.preferences import Preferences
from geofit.gui.theme import is_dark
from geofit.gui.translate import translated
from geofit.project.commands import RenameSite
from geofit.project.journal import unfinished
from geofit.project.state import State

WINDOW_KILLS = 3


@pytest.fixture
def small(tmp_path):
    """A site of two horizons that opens and fits in no time."""
    rows = [f"{x},{y},{0.1 * x + 0.02 * y:.3f},low" for x in range(0, 100, 20) for y in range(0, 100, 20)]
    rows += [f"{x},{y},{0.1 * x + 20:.3f},up" for x in range(0, 100, 20) for y in range(0, 100, 20)]
    (tmp_path / "picks.csv").write_text("\n".join(["x,y,z,horizon", *rows, "1,1,none,low"]), encoding="utf-8")
    text = (
        '[site]\nname = "Small"\n[[picks]]\nfile = "picks.csv"\n[[horizon]]\nname = "up"\n[[horizon]]\nname = "low"\n'
    )
    (tmp_path / "site.toml").write_text(text, encoding="utf-8")
    return tmp_path / "site.toml"


def test_what_needs_surfaces_can_be_done_once_there_are_as_many(app, small):
    of_chosen, of_any, of_two = {"examine", "worst", "seams"}, {"export_step", "report"}, {"check_order", "separate"}
    app.window.files.open(small)
    app.idle()

    def enabled():
        return {name for name in of_chosen | of_any | of_two if app.window.actions_[name].isEnabled()}

    assert not enabled()
    app.trigger("fit")
    app.idle()
    assert enabled() == of_chosen | of_any
    app.document.select("low")
    assert enabled() == of_any, "nothing is fitted to the chosen horizon"
    app.trigger("fit")
    app.idle()
    assert enabled() == of_chosen | of_any | of_two
    app.trigger("seams")
    app.window.session.stack.undo()
    app.idle()
    assert enabled() == of_any | {"seams"}, "what is switched on can be switched off"


def test_the_menu_fits_with_what_the_panel_shows_as_its_button_does(app, small):
    app.window.files.open(small)
    app.idle()
    panel, document = app.window.panels.fit, app.document
    panel.fields["epsilon"].edit.setText("-1")
    app.trigger("fit")
    app.idle()
    assert document.surface("up") is None
    assert "out of its range" in app.window.statusBar().currentMessage()
    panel.fields["epsilon"].edit.setText("0.25")
    app.trigger("fit")
    # What is written while it runs is still there when it has ended.
    panel.fields["interior_tolerance"].edit.setText("0.125")
    app.idle()
    assert document.surface("up").settings.epsilon == 0.25
    assert document.settings("up").interior_tolerance != 0.125
    assert panel.edited().interior_tolerance == 0.125
    assert panel.apply_button.isEnabled()


def test_every_action_has_words_a_tip_and_a_key_of_its_own(app):
    keys = {}
    for name, action in app.window.actions_.all().items():
        assert action.text(), name
        assert action.toolTip(), name
        for key in action.shortcuts():
            text = key.toString()
            assert text not in keys, f"{name} and {keys.get(text)} share {text}"
            keys[text] = name
    assert keys["F5"] == "fit"
    undo = app.window.menus.undo
    assert QKeySequence("Ctrl+Z") in undo.shortcuts()


def test_opening_fitting_and_failing(app, small):
    app.window.files.open(small)
    app.idle()
    assert app.document.state.name == "Small"
    app.trigger("fit_all")
    app.idle()
    assert set(app.document.surfaces()) == {"up", "low"}
    app.window.statusBar().clearMessage()
    app.window.fitting.fit("up")
    app.idle()
    assert "up is up to date" in app.window.statusBar().currentMessage(), "nothing to fit, and that is stated"
    app.trigger("check_order")
    app.idle()
    assert "cross" in app.window.statusBar().currentMessage()
    # A horizon that cannot be fitted: the dialog tells, and the others go on.
    app.window.fitting.set_core("low", [(900, 900), (990, 900), (990, 990), (900, 990)])
    app.window.fitting.fit("low")
    app.qtbot.waitUntil(lambda: bool(app.failures), timeout=20_000)
    assert isinstance(app.failures.pop(), FitError)
    app.idle()
    assert app.document.stale("low")


def test_reports_of_a_site_are_not_those_of_the_next_one(app, small, tmp_path):
    app.window.files.open(small)
    app.idle()
    app.window.delivering.list_report(tmp_path / "report.pdf")
    reports = lambda: [row.text for row in app.window.panels.tree.items.all() if row.target[0] == "report"]  # noqa: E731
    assert reports() == ["report.pdf"]
    app.desktop.change_language("zh_CN")
    app.desktop.change_language("en")
    assert reports() == ["report.pdf"]
    app.window.files.open(small)
    app.idle()
    assert reports() == []


def test_a_project_that_is_dropped_with_tables_is_refused_with_advice(app, small):
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(file)) for file in (small, small.with_name("picks.csv"))])
    buttons, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    app.window.dropEvent(QDropEvent(QPointF(5, 5), Qt.DropAction.CopyAction, mime, buttons, keys))
    assert f"{small.name} is opened and not imported" in str(app.failures.pop())
    assert not app.document.is_open


def test_another_language_keeps_the_work(app, small):
    app.window.files.open(small)
    app.idle()
    app.desktop.session.push(RenameSite("Kept"))
    old = app.window
    app.desktop.change_language("zh_CN")
    app.idle()
    assert app.window is not old
    assert app.window.isVisible()
    assert not isValid(old)
    assert app.document.state.name == "Kept"
    assert "Kept" in app.window.windowTitle()
    assert app.desktop.session.stack.canUndo()
    undo = app.window.menus.undo
    assert translated(RenameSite("Kept").text) in undo.text()
    assert "Rename" not in undo.text()
    undo.trigger()
    assert app.document.state.name == "Small"
    assert not undo.isEnabled()
    app.window.menus.redo.trigger()
    assert "Kept" in undo.text()
    assert Preferences().language == "zh_CN"
    app.desktop.change_language("en")
    app.idle()


def test_a_language_or_unit_that_is_refused_is_not_shown_as_chosen(app):
    """An open survey would go with the window, so neither changes, and menu and preferences show what applies."""
    app.window.surveys.open()
    old, words = app.window, []
    app.window.statusBar().messageChanged.connect(words.append)
    next(action for action in app.window.actions_.languages.actions() if action.data() == "zh_CN").trigger()
    app.window.lengths_chosen.emit("ft")
    app.qtbot.waitUntil(lambda: words.count("Close the survey first: its window and its body would be lost.") >= 1)
    app.idle()
    assert app.window is old
    assert app.window.actions_.languages.checkedAction().data() == "en"
    dialog = PreferencesDialog(app.window.preferences)
    app.qtbot.addWidget(dialog)
    assert (dialog.language, dialog.lengths) == ("en", "m")
    app.window.surveys.close()


def choose_theme(window, theme):
    next(action for action in window.actions_.themes.actions() if action.data() == theme).trigger()


def test_a_theme_reaches_the_palette_and_is_remembered(app, qapp):
    choose_theme(app.window, "dark")
    assert is_dark(qapp.palette())
    assert Preferences().theme == "dark"
    choose_theme(app.window, "light")
    assert not is_dark(qapp.palette())


def test_leaving_asks_when_there_is_something_to_lose(app, small, monkeypatch):
    app.window.files.open(small)
    app.idle()
    app.desktop.session.push(RenameSite("Changed"))
    asked = []

    def answer(button):
        def run(box):
            asked.append(box.text())
            return button

        return run

    monkeypatch.setattr(QMessageBox, "exec", answer(QMessageBox.StandardButton.Cancel))
    app.window.close()
    assert asked == ["Save the changes to Changed?"]
    assert app.window.isVisible()
    # Save, then close: the window goes when the file is there.
    project = small.with_name("small.geofit")
    app.document.project_file = project
    monkeypatch.setattr(QMessageBox, "exec", answer(QMessageBox.StandardButton.Save))
    app.window.close()
    app.qtbot.waitUntil(lambda: not app.window.isVisible(), timeout=30_000)
    assert project.is_file()


def test_dropped_projects_open_and_other_files_are_imported(app, small, monkeypatch):
    imported = []
    app.window.panels.start.import_requested.disconnect()
    app.window.panels.start.import_requested.connect(imported.append)
    for file in (small.with_name("picks.csv"), small):
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(file))])
        event = QDropEvent(
            QPointF(5, 5), Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
        )
        app.window.dropEvent(event)
        app.idle()
    assert imported == [[small.with_name("picks.csv")]]
    assert app.document.state.name == "Small"


def test_the_log_hears_geofit_and_qt_but_not_the_chatter_of_others(app):
    logging.getLogger("geofit.anything").info("said by geofit")
    logging.getLogger("somebody").info("chatter")
    logging.getLogger("somebody").error("a failure")
    app.idle()
    text = app.window.panels.log.text.toPlainText()
    assert "said by geofit" in str(text)
    assert "a failure" in str(text)
    assert "chatter" not in str(text)


def test_the_error_dialog_says_what_to_do(qtbot):
    error = InputError(
        message("io.file-empty", "The file is empty"), message("test.text", "Choose another."), file="a.csv"
    )
    dialog = ErrorDialog("Open a.csv", error)
    qtbot.addWidget(dialog)
    assert "a.csv: The file is empty." in dialog.message.text()
    assert dialog.message.text().endswith("Choose another.")
    assert "InputError" in dialog.details
    mistake = ErrorDialog("", ZeroDivisionError("division by zero"))
    qtbot.addWidget(mistake)
    assert "mistake in geofit" in mistake.message.text()


def test_the_system_report_can_be_copied(qtbot, tmp_path):
    dialog = SystemReport()
    qtbot.addWidget(dialog)
    text = system_report()
    for word in ("geofit ", "Python ", "Qt ", "OpenGL: ", "vtk ", "Screen ", "Font: "):
        assert word in str(text)
    assert str(Path.home()) not in str(text)
    QGuiApplication.clipboard().setText(dialog.text.toPlainText())
    assert QGuiApplication.clipboard().text().startswith("geofit ")


def test_rows_not_used_are_listed(qtbot):
    issues = (
        ImportIssue(
            "b.csv",
            9,
            "z",
            "abc",
            "error",
            message("io.not-a-number", "This is not a number"),
            message("test.text", "Correct it."),
        ),
        ImportIssue("a.csv", 0, "", "", "note", message("test.text", "Taken as picks")),
        ImportIssue("b.csv", 0, "z", "", "warning", message("test.text", "All horizons have the same z")),
    )
    dialog = IssuesDialog(Site("", {}, issues=issues, counts=(TableCount("b.csv", 10, 9, 1),)))
    qtbot.addWidget(dialog)
    model = dialog.table.model()
    assert dialog.balance.text() == "Rows read: 10 = 9 used + 1 listed here."
    # Many rows would hide what is wrong with the whole file.
    assert [model.index(row, 0).data() for row in range(3)] == ["to check", "not used", "note"]
    row = [model.index(1, column).data() for column in range(7)]
    assert row == ["not used", "b.csv", "9", "z", "abc", "This is not a number", "Correct it."]


def test_shortcuts_are_listed_by_menu(app):
    dialog = ShortcutsDialog(app.window.menuBar())
    menus = [dialog.tree.topLevelItem(i).text(0) for i in range(dialog.tree.topLevelItemCount())]
    assert menus == ["File", "Edit", "View", "Horizon", "Tools", "Help"]
    dialog.deleteLater()


def test_unsaved_work_is_brought_back(app, small, tmp_path, monkeypatch):
    app.window.files.open(small)
    app.idle()
    app.window.fitting.fit("low")
    app.idle()
    app.desktop.session.push(RenameSite("Brought back"))
    before, state = app.document.surface("low"), app.document.state
    killed = app.killed(tmp_path / "killed")

    def choose(dialog):
        assert "Small" in dialog.list.item(0).text()
        assert "Rename the site to Brought back" in dialog.list.item(0).text()
        dialog.bring_back.click()
        return QDialog.DialogCode.Accepted

    monkeypatch.setattr(RecoveryDialog, "exec", choose)
    assert app.window.files.offer_recovery(killed)
    app.idle()
    assert app.document.state == state
    assert app.document.dirty
    after = app.document.surface("low")
    assert after is not before
    for new, old in zip(after.patches, before.patches, strict=True):
        assert (new.control == old.control).all()
    assert app.desktop.session.stack.undoText() == "Rename the site to Brought back"
    assert not list(killed.glob("*.journal"))
    assert len(list(app.desktop.journals.glob("*.journal"))) == 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kill -9 is for Linux and macOS")
def test_the_whole_application_killed_comes_back(small):
    rng = random.Random(4)
    script = Path(__file__).with_name("killed_window.py")
    for turn in range(WINDOW_KILLS):
        env = os.environ | {"XDG_STATE_HOME": os.environ["XDG_STATE_HOME"] + str(turn)}
        command = [sys.executable, str(script), str(small)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=env) as child:
            assert child.stdout is not None
            first = child.stdout.readline()
            time.sleep(rng.uniform(0.05, 0.6))
            child.send_signal(signal.SIGKILL)
            told = [line.split() for line in (first + child.stdout.read()).decode().splitlines()]
        told = [line for line in told if len(line) == 2 and len(line[1]) == 16]
        (session,) = unfinished(Path(env["XDG_STATE_HOME"]) / "geofit" / "geofit" / "sessions")
        states = [_digest(state) for state in session.states()]
        count, last = int(told[-1][0]), told[-1][1]
        # Each step is on the disk before it is told: the state is that of the last line, or of the step after it.
        undone = (count + 1) % 3 == 0 and states[-1] in [name for _, name in told]
        assert states[-1] == last or states[-2] == last or undone
        session.discard()


def _digest(state: State) -> str:
    return hashlib.sha256(json.dumps(state.to_data(), sort_keys=True).encode()).hexdigest()[:16]


def test_another_language_waits_for_a_survey_and_the_menu_says_which_there_is(app, tmp_path):
    def chosen():
        return [action.data() for action in app.window.actions_.languages.actions() if action.isChecked()]

    def choose(code):
        next(one for one in app.window.actions_.languages.actions() if one.data() == code).trigger()
        app.qtbot.wait(50)

    (tmp_path / "tube.csv").write_text("x,y,z,radius\n0,0,100,2\n20,0,100,2\n", encoding="utf-8")
    app.window.surveys.open(tmp_path / "tube.csv")
    dialog = app.window.surveys.dialog
    assert dialog.running
    choose("zh_CN")
    assert app.window.surveys.dialog is dialog
    assert app.desktop.preferences.language == "en"
    assert chosen() == ["en"]
    app.qtbot.waitUntil(lambda: not dialog.running, timeout=60_000)
    choose("zh_CN")
    assert app.window.surveys.dialog is dialog
    assert chosen() == ["en"]
    assert "Close the survey" in app.window.statusBar().currentMessage()
    dialog.close()
    choose("zh_CN")
    assert chosen() == ["zh_CN"]
    choose("en")
