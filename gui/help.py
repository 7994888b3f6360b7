"""The Help menu, the preferences and the list of import problems: dialogs that are shown and gone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, QUrl
from PySide6.QtGui import QDesktopServices, QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QDialog, QMenuBar, QMessageBox, QWidget

from geofit import __version__
from geofit.data.site import Site
from geofit.gui.dialogs.issues import IssuesDialog
from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.dialogs.shortcuts import ShortcutsDialog
from geofit.gui.dialogs.system_report import SystemReport
from geofit.gui.preferences import Preferences
from geofit.gui.view3d.mouse import Scheme

__all__ = ["Help"]

#: The pages in a checkout; an installed package has the short form of the tutorial below.
PAGES = Path(__file__).resolve().parents[1] / "docs"
#: Pages of dialogs, by their class; all others have the tutorial.
_PAGE_OF = {
    "ImportWizard": "formats_in", "IssuesDialog": "formats_in", "RockVolumeDialog": "formats_in",
    "SurveyDialog": "formats_in", "ExportDialog": "formats_out", "BodyStepDialog": "formats_out",
    "SectionSheetDialog": "formats_out", "PlanSheetDialog": "formats_out", "CompareDialog": "settings",
}  # fmt: skip


class Help(QObject):
    """Shows what explains."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window

    def answer(self, dialog: QDialog) -> None:
        """Let F1 open the page of a dialog, which the keys of the main window do not reach."""
        page = _PAGE_OF.get(type(dialog).__name__, "tutorial")
        QShortcut(QKeySequence("F1"), dialog).activated.connect(lambda: self.page(page))

    def tutorial(self) -> None:
        """Open the tutorial."""
        self.page("tutorial")

    def page(self, name: str) -> None:
        """Open a page, or tell the way through the application in short."""
        page = PAGES / f"{name}.md"
        if page.is_file():
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(page)))
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

    def _box(self, title: str, text: str) -> None:
        over = QApplication.activeModalWidget() or self._window
        box = QMessageBox(QMessageBox.Icon.NoIcon, title, text, QMessageBox.StandardButton.Close, over)
        box.setIconPixmap(self._window.windowIcon().pixmap(48))
        box.exec()
