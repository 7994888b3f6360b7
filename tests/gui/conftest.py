"""Real windows: a display of our own where there is none, settings in a temporary folder, nothing left behind."""

from __future__ import annotations

import gc
import os
import pickle
import shutil
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest
import virtual_screen

SAMPLE_DATA = Path(__file__).parents[2] / "sample_data"


def _display() -> str | None:
    """Return why no window can open here; where there is no display and Xvfb is installed, start it."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return virtual_screen.start("1600x1000") or virtual_screen.why_no_window()
    return virtual_screen.why_no_window()


_REASON = _display()


class _NoWindow(pytest.Module):
    """A file of tests that cannot run here: it is not imported, because some libraries abort the process then."""

    def collect(self):
        pytest.skip(_REASON, allow_module_level=True)


def pytest_pycollect_makemodule(module_path, parent):
    return None if _REASON is None else _NoWindow.from_parent(parent, path=module_path)


@pytest.fixture(scope="session")
def qapp_args():
    return ["geofit-test"]


@pytest.fixture(autouse=True)
def own_settings(tmp_path, monkeypatch):
    """Settings and journals of the application in a folder of the test."""
    from PySide6.QtCore import QCoreApplication, QSettings, QStandardPaths

    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))
    # Elsewhere the folders cannot be told by the environment.
    QStandardPaths.setTestModeEnabled(not sys.platform.startswith("linux"))
    QCoreApplication.setOrganizationName("geofit")
    QCoreApplication.setApplicationName("geofit-test")
    QSettings.setDefaultFormat(QSettings.Format.IniFormat)
    QSettings.setPath(QSettings.Format.IniFormat, QSettings.Scope.UserScope, str(tmp_path / "settings"))


@pytest.fixture(autouse=True)
def collected_here(request):
    """Collect garbage in the window's thread, as the application does."""
    if "qtbot" in request.fixturenames:
        from geofit.gui.garbage import collect_here

        collect_here(request.getfixturevalue("qapp"))


@pytest.fixture(autouse=True)
def held(request, monkeypatch):
    """Keep each widget alive until it is closed, as the application does; qtbot itself holds a weak reference."""
    if "qtbot" in request.fixturenames:
        qtbot, widgets = request.getfixturevalue("qtbot"), []
        add = qtbot.addWidget

        def hold(widget, **more):
            widgets.append(widget)
            add(widget, **more)

        monkeypatch.setattr(qtbot, "addWidget", hold)


@pytest.fixture(autouse=True)
def nothing_left(request):
    """No task and no thread of ours outlives its test, no window stays, no timer of a gone window runs."""
    before = set(threading.enumerate())
    yield
    if "qtbot" not in request.fixturenames:
        return
    from PySide6.QtCore import QCoreApplication, QEvent
    from PySide6.QtWidgets import QApplication

    from geofit.gui import worker

    # Idle processes stay for the next test: to start one takes a second.
    assert worker.finish_all(20, helpers=False), "a task did not end"
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    QCoreApplication.processEvents()
    shown = [widget for widget in QApplication.topLevelWidgets() if widget.isVisible()]
    assert not shown, f"still shown: {shown}"
    # Threads of the pool show in Python as dummies; they end by themselves when they idle.
    left = [t for t in set(threading.enumerate()) - before if not t.name.startswith("Dummy-")]
    assert not left, f"still running: {left}"


class Driver:
    """The whole application in a test: failures that a dialog would reports are kept in ``failures``."""

    def __init__(self, desktop, qtbot):
        self.desktop, self.qtbot = desktop, qtbot
        self.failures: list[Exception] = []

    @property
    def window(self):
        return self.desktop.window

    @property
    def document(self):
        return self.desktop.session.document

    def idle(self, seconds=120):
        """Wait until nothing runs and everything is shown."""
        for _ in range(2):
            self.qtbot.waitUntil(self.rests, timeout=1000 * seconds)
            self.qtbot.wait(20)
        assert not self.failures, self.failures

    def rests(self):
        """Whether nothing runs, and the view has what the document has."""
        return not self.window.activity.busy and not self.window.showing.drawing.busy

    def killed(self, folder):
        """Return a folder with the journals that a killed process leaves: nobody holds them."""
        return shutil.copytree(self.desktop.journals, folder)

    def trigger(self, name):
        """Choose an action of the menus."""
        action = self.window.actions_[name]
        assert action.isEnabled(), f"{name} is disabled"
        action.trigger()


@pytest.fixture(scope="session")
def freeze_modules():
    """Function that puts modules beyond the collector, as the application does: they are never garbage.

    A full collection, of which each window has one, would take 0.2 s for them. What a test loads first comes later.
    """
    loaded = 0

    def freeze():
        nonlocal loaded
        if len(sys.modules) > loaded + 50:
            gc.collect()
            gc.freeze()
            loaded = len(sys.modules)

    return freeze


@pytest.fixture
def app(qtbot, monkeypatch, qapp, freeze_modules):
    """The application with its window shown, in English; closed at the end without asking."""
    from PySide6.QtCore import QEvent

    from geofit.gui.desktop import Desktop
    from geofit.gui.main_window import MainWindow
    from geofit.gui.preferences import Preferences

    freeze_modules()
    Preferences().language = "en"
    desktop = Desktop()
    driver = Driver(desktop, qtbot)
    monkeypatch.setattr(MainWindow, "fail", lambda self, title, error: driver.failures.append(error))
    desktop.window.show()
    qtbot.waitExposed(desktop.window)
    yield driver
    window = desktop.window
    window.leave_without_asking()
    desktop.session.end()
    window.deleteLater()
    desktop.deleteLater()
    gc.collect()
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)


@pytest.fixture(scope="session")
def results_of_processes():
    """What tasks in processes have returned, pickled as a process returns it, by the name of their step."""
    return {}


@pytest.fixture
def once(monkeypatch, results_of_processes):
    """Context of a step whose tasks in processes run for the first test only; the application does all else again.

    For what is prepared and not tested: to fit a body takes seconds.
    """
    from geofit.gui import activity

    @contextmanager
    def context(step):
        known = results_of_processes.get(step)
        left, new = iter(known or ()), []

        def start(parent, function, *args, on_done, **more):
            if known is not None:
                result = next(left)
                return activity.run(parent, lambda *_, progress: pickle.loads(result), on_done=on_done, **more)

            def keep(result):
                new.append(pickle.dumps(result))
                on_done(result)

            return in_process(parent, function, *args, on_done=keep, **more)

        in_process = activity.run_in_process
        with monkeypatch.context() as patch:
            patch.setattr(activity, "run_in_process", start)
            yield
        if known is None:
            results_of_processes[step] = new

    return context


@pytest.fixture(scope="session")
def sample(tmp_path_factory):
    """The sample site's folder, copied: write_site() takes seconds for the same (see sample/test_sample.py)."""
    return shutil.copytree(SAMPLE_DATA, tmp_path_factory.mktemp("sample"), dirs_exist_ok=True)


@pytest.fixture
def write_report(app, monkeypatch):
    """Function that writes a report in one form from its dialog into a folder, and waits until it is written."""

    def write(dialog, folder, wanted):
        monkeypatch.setattr(dialog, "open_result", lambda: None)
        dialog.folder.setText(str(folder))
        dialog.examine.setChecked(False)
        for form, box in dialog.forms.items():
            box.setChecked(form == wanted)
        dialog.go.click()
        app.qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)

    return write


@pytest.fixture
def here(monkeypatch):
    """Run tasks in a thread: a process of its own takes seconds to start."""
    from geofit.gui.dialogs import task_dialog

    monkeypatch.setattr(task_dialog, "run_in_process", task_dialog.run)


@pytest.fixture
def rock_volume(qtbot):
    """The window of a rock volume."""
    from geofit.gui.dialogs.rock_volume import RockVolumeDialog

    dialog = RockVolumeDialog()
    qtbot.addWidget(dialog)
    dialog.show()
    qtbot.waitExposed(dialog)
    yield dialog
    dialog.close()
