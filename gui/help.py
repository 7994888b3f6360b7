"""The Help menu, the preferences and the list of import problems: dialogs that are shown and gone."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QDialog, QMenuBar, QMessageBox, QWidget
from shiboken6 import isValid

from geofit import __version__
from geofit.data.site import Site
from geofit.gui.dialogs.help_page import HelpPage
from geofit.gui.dialogs.issues import IssuesDialog
from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.dialogs.shortcuts import ShortcutsDialog
from geofit.gui.dialogs.system_report import SystemReport
from geofit.gui.help_places import PAGES, PLACE_OF_DIALOG, PLACE_OF_PANEL, TUTORIAL
from geofit.gui.preferences import Preferences
from geofit.gui.view3d.mouse import Scheme

__all__ = ["Help"]

#: Property of dialogs in which F1 helps.
_ANSWERED = "geofit answered"


class Help(QObject):
    """Shows what explains."""

    def __init__(self, window: QWidget, panel: Callable[[], str]) -> None:
        """``panel()`` is the name of the panel that has the keyboard."""
        super().__init__(window)
        self._window, self._panel = window, panel
        self._page: HelpPage | None = None
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        app.focusChanged.connect(self._answer)

    def close(self) -> None:
        """Close the page, and answer no more."""
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        app.focusChanged.disconnect(self._answer)
        self._close_page()

    def tutorial(self) -> None:
        """Open the tutorial at its beginning."""
        self.page(TUTORIAL)

    def on_panel(self) -> None:
        """Open the place about the panel that has the keyboard."""
        self.page(PLACE_OF_PANEL.get(self._panel(), TUTORIAL))

    def page(self, place: str) -> None:
        """Open a page at a heading, or tell the way through the application in short."""
        if (PAGES / place.partition("#")[0]).is_file():
            # A child of the dialog in front, which would not let any other window be used.
            over = QApplication.activeModalWidget() or self._window
            if self._page is None or not isValid(self._page) or self._page.parentWidget() is not over:
                self._close_page()
                self._page = HelpPage(over)
            self._page.open_place(place)
            return
        self._box(
            self.tr("The geofit workflow"),
            self.tr(
                "<ol><li>Open the sample site, a project, or drop your tables on the "
                "window.</li><li>Choose a horizon in the project tree; its plan shows the dense core "
                "that is interpolated.</li><li>Press Fit (F5). The badge shows PASS when σ is below "
                "ε.</li><li>Go to the worst point (F8): its hole, file and row are shown. Exclude it, "
                "or edit the surface manually.</li><li>Examine away from the data (F6) to see the "
                "prediction error elsewhere.</li><li>Export STEP (Ctrl+E); write the report "
                "(Ctrl+R).</li></ol>"
            ),
        )

    def shortcuts(self, bar: QMenuBar) -> None:
        """List all keys."""
        ShortcutsDialog(bar).exec()

    def rock_volume(self) -> None:
        """Open a rock volume in a window of its own."""
        from geofit.gui.dialogs.rock_volume import RockVolumeDialog

        dialog = RockVolumeDialog(self._window)
        dialog.exec()
        # Else the window would keep it, with its volume, until the end.
        dialog.deleteLater()

    def system_report(self) -> None:
        """Show what the application runs on."""
        SystemReport(self._window).exec()

    def issues(self, site: Site) -> None:
        """List the rows that the readers did not use."""
        IssuesDialog(site, self._window).exec()

    def preferences(
        self,
        preferences: Preferences,
        set_theme: Callable[[str], object],
        set_language: Callable[[str], object],
        set_mouse: Callable[[Scheme], object],
        set_sizes: Callable[[float, float], object],
        set_lengths: Callable[[str], object],
    ) -> None:
        """Ask for theme, language, unit of lengths, sizes and mouse."""
        dialog = PreferencesDialog(preferences, self._window)
        if dialog.exec() == QDialog.DialogCode.Accepted:
            set_mouse(dialog.mouse)
            set_sizes(dialog.text_size, dialog.point_size)
            if dialog.theme != preferences.theme:
                set_theme(dialog.theme)
            if dialog.language != preferences.language:
                set_language(dialog.language)
            if dialog.lengths != preferences.lengths:
                set_lengths(dialog.lengths)

    def about(self) -> None:
        """Name the program, its version and its licence."""
        self._box(
            self.tr("About geofit"),
            self.tr(
                "<h3>geofit {version}</h3><p>NURBS surfaces of geological horizons: fitted, checked against a "
                "tolerance, stitched, written as STEP.</p><p>Apache-2.0. Windows by Qt (LGPL-3), 3D by VTK (BSD-3), "
                "solids by OpenCASCADE (LGPL-2.1 with exception).</p>"
            ).format(version=__version__),
        )

    def _answer(self) -> None:
        """Let F1 help in a dialog when it gets the keyboard: keys of the main window do not reach it.

        A dialog may belong to a panel or to another dialog, so that nobody else hears of all of them.
        """
        dialog = QApplication.activeWindow()
        if not isinstance(dialog, QDialog) or isinstance(dialog, HelpPage) or dialog.property(_ANSWERED):
            return
        over: QWidget | None = dialog
        while over is not None and over is not self._window:
            over = over.parentWidget()
        if over is None:
            return
        dialog.setProperty(_ANSWERED, True)
        place = PLACE_OF_DIALOG.get(type(dialog).__name__, TUTORIAL)
        QShortcut(QKeySequence("F1"), dialog).activated.connect(lambda: self.page(place))

    def _close_page(self) -> None:
        page, self._page = self._page, None
        if page is not None and isValid(page):  # it goes with the dialog that it was opened over
            page.close()
            page.deleteLater()

    def _box(self, title: str, text: str) -> None:
        over = QApplication.activeModalWidget() or self._window
        box = QMessageBox(QMessageBox.Icon.NoIcon, title, text, QMessageBox.StandardButton.Close, over)
        box.setIconPixmap(self._window.windowIcon().pixmap(48))
        box.exec()
