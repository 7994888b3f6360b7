"""The application as a whole: Qt, preferences, the session, and the window on it."""

from __future__ import annotations

import gc
import logging
import signal
import sys
import threading
import traceback
from pathlib import Path
from types import TracebackType
from typing import cast

from PySide6.QtCore import QObject, QStandardPaths, Qt, QThread, QTimer

from geofit.data.lengths import LengthUnit
from geofit.data.messages import message
from geofit.gui.icons import application_icon
from geofit.gui.language import apply_language
from geofit.gui.lengths import show_lengths_in
from geofit.gui.main_window import MainWindow
from geofit.gui.panels.log import qt_to_logging
from geofit.gui.preferences import Preferences
from geofit.gui.session import Session
from geofit.gui.splash import Splash, application
from geofit.gui.theme import apply_theme, missing_chinese, set_font, set_text_size
from geofit.gui.translate import shown_error
from geofit.gui.view3d.opengl import require_opengl
from geofit.gui.worker import finish_all, warm
from geofit.project.building import get_ready

__all__ = ["Desktop"]

_LOG = logging.getLogger(__name__)


class Desktop(QObject):
    """Holds what lives as long as the application; ``window`` is made anew for another language or unit.

    Raises
    ------
    NoOpenGLError
        If no 3D view can be drawn on this machine.
    """

    def __init__(self) -> None:
        super().__init__()
        app = application()
        require_opengl()
        self.app = app
        app.setWindowIcon(application_icon())
        app.setDesktopFileName("geofit")
        self.preferences = Preferences()
        qt_to_logging()
        apply_theme(app, self.preferences.theme)
        set_font(app)
        # Before there is a window: panels are as large as their text when they are made.
        set_text_size(app, self.preferences.text_size)
        apply_language(self.preferences.language)
        show_lengths_in(self.preferences.lengths)
        app.styleHints().colorSchemeChanged.connect(self._follow_system)
        self.journals = (
            Path(QStandardPaths.writableLocation(QStandardPaths.StandardLocation.StateLocation)) / "sessions"
        )
        self.session = Session(self.journals, self)
        self._telling = False
        self.window = self._window()

    def run(self, file: Path | None = None, splash: Splash | None = None) -> int:
        """Show the window in place of a splash, offer what sessions that were cut off left, open a file.

        Returns the exit code.
        """
        sys.excepthook = self.hear_mistake
        threading.excepthook = self._hear_thread
        # Python handles Ctrl+C only while it runs; the garbage collector's timer wakes it twice a second.
        signal.signal(signal.SIGINT, lambda *_: self.window.close())
        # Modules loaded at start-up are never garbage; traversing them would take 0.2 s per full collection.
        gc.freeze()
        self.window.show()
        if splash is not None:
            splash.close_for(self.window)
        # Two: one fits while the other makes the triangles of what was fitted before.
        for _ in range(2):
            warm(get_ready)
        if missing_chinese():
            _LOG.warning(
                message(
                    "gui.log-no-chinese-font",
                    "No font on this machine has Chinese characters: they are shown as boxes. Install one "
                    "(Debian and Ubuntu: apt-get install fonts-noto-cjk) and start again.",
                )
            )
            self.window.panels.reveal("log")
        QTimer.singleShot(0, self, lambda: self._begin(file))
        code = self.app.exec()
        finish_all()
        self.session.end()
        return code

    def change_language(self, code: str) -> None:
        """Speak another language: the window is closed and made anew, the session goes on."""
        if code == self.preferences.language:
            return
        if self.window.busy:
            self.window.tell(self.tr("Wait for the task to end, then choose the language."))
            self.window.check_language()
            return
        if self._survey_open():
            self.window.check_language()
            return
        self.preferences.language = code
        apply_language(code)
        self.session.name_steps()
        self._renew()

    def change_lengths(self, unit: str) -> None:
        """Show lengths in another unit: every number of the window changes, so it is made anew."""
        if unit == self.preferences.lengths:
            return
        if self.window.busy:
            self.window.tell(self.tr("Wait for the task to end, then choose the unit."))
            return
        if self._survey_open():
            return
        self.preferences.lengths = cast("LengthUnit", unit)
        show_lengths_in(self.preferences.lengths)
        self._renew()

    def _survey_open(self) -> bool:
        """Tell of an open survey: its window, and what was made in it, would go with this one."""
        dialog = self.window.surveys.dialog
        if dialog is None:
            return False
        self.window.tell(self.tr("Close the survey first: its window and its body would be lost."))
        dialog.raise_()
        return True

    def _renew(self) -> None:
        old = self.window
        self.app.setQuitOnLastWindowClosed(False)
        old.leave_without_asking()
        self.window = self._window()
        self.window.take_over(old)
        self.window.show()
        self.app.setQuitOnLastWindowClosed(True)
        old.deleteLater()

    def _window(self) -> MainWindow:
        window = MainWindow(self.session, self.preferences)
        # Queued: the window that asks for another language is gone when its own event is over.
        window.language_chosen.connect(self.change_language, Qt.ConnectionType.QueuedConnection)
        window.lengths_chosen.connect(self.change_lengths, Qt.ConnectionType.QueuedConnection)
        return window

    def _begin(self, file: Path | None) -> None:
        if not self.window.files.offer_recovery(self.journals) and file is not None:
            self.window.files.open(file)

    def _follow_system(self) -> None:
        if self.preferences.theme == "system":
            apply_theme(self.app, "system")

    def _hear_thread(self, args: threading.ExceptHookArgs) -> None:
        if args.exc_value is not None:
            self.hear_mistake(args.exc_type, args.exc_value, args.exc_traceback)

    def hear_mistake(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        """Log an unforeseen error, and show one dialog for it."""
        if isinstance(error, KeyboardInterrupt) or not isinstance(error, Exception):
            self.window.leave_without_asking()
            return
        # A program without a console has no stderr: the log has the traceback, too.
        traceback.print_exception(kind, error, trace)
        _LOG.error(shown_error(error), exc_info=(kind, error, trace))
        # One dialog at a time, and in the window's thread: what fails whenever a panel is drawn fails behind it again.
        if not self._telling and QThread.currentThread() is self.thread():
            self._telling = True
            try:
                self.window.fail("", error)
            finally:
                self._telling = False
