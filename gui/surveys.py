"""Surveys of passages: opened in a window of their own; on request their body becomes one of the open site."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QWidget

from geofit.data.files import file_stems
from geofit.gui.activity import Activity
from geofit.gui.bodies import Bodies
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.ordering import Ordering
from geofit.project.cave_run import CaveRun
from geofit.project.cave_view import passage_mesh
from geofit.project.document import Document
from geofit.project.known_sources import file_sources
from geofit.project.ordering import joined
from geofit.surfaces.protocol import HasElevation

__all__ = ["Surveys"]


class Surveys(QObject):
    """Opens surveys; ``reported(text)`` says in the status bar what was done. ``dialog`` is the open one, or None."""

    reported = Signal(str)

    def __init__(
        self, document: Document, activity: Activity, bodies: Bodies, ordering: Ordering, window: QWidget
    ) -> None:
        super().__init__(window)
        self._document, self._activity, self._bodies, self._window = document, activity, bodies, window
        self._ordering = ordering
        self.dialog: SurveyDialog | None = None

    def open(self, path: Path | None = None) -> None:
        """Open a survey in the dialog, or the dialog alone."""
        if self.dialog is None:
            dialog = SurveyDialog(self._horizons, lambda: self._document.is_open, self._window)
            dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            dialog.finished.connect(self._gone)
            dialog.add_requested.connect(self._add)
            self.dialog = dialog
            dialog.show()
        self.dialog.raise_()
        self.dialog.activateWindow()
        if path is not None and not self.dialog.running:
            self.dialog.read(path)
        elif path is not None:
            text = self.tr("{file} was not opened: another survey is being computed. Stop it, or wait.")
            self.reported.emit(text.format(file=path.name))

    def close(self) -> None:
        """Close the dialog that is open."""
        if self.dialog is not None:
            self.dialog.reject()

    def _horizons(self) -> dict[str, HasElevation]:
        """Return the strata: a steep fault or a fold has no height, and nothing lies above or below it."""
        # The model behind the patches need not travel to another process.
        surfaces = {name: surface.with_(model=None) for name, surface in self._ordering.strata().items()}
        return dict(joined(surfaces, self._document.state.parts))

    def _add(self, run: CaveRun) -> None:
        """Write the body beside the site, and take it as a body of closed triangles: one step that can be undone."""
        title = self.tr("Add the body of {name}").format(name=run.adjusted.survey.name)

        def added(written: Path) -> None:
            self._bodies.take_mesh(written)
            self.reported.emit(self.tr("Wrote {file}; its body is being added.").format(file=written.name))

        # The file is named when its turn comes: those of bodies that are being added are there by then.
        self._activity.prepare(title, lambda: (passage_mesh, (run, self._free_file(run))), on_done=added)

    def _free_file(self, run: CaveRun) -> Path:
        """Return a new file next to the site, with a name that no body is made from, even if that file is missing."""
        name = Path(run.adjusted.survey.name).stem
        folder, stem = self._document.folder or Path.cwd(), f"{file_stems([name])[name]}_passages"
        site = self._document.site_folder or folder
        used = {(site / source.file).resolve() for source in file_sources(self._document.state.bodies.values())}
        file, turn = folder / f"{stem}.ply", 2
        while file.exists() or file.resolve() in used:
            file, turn = folder / f"{stem}_{turn}.ply", turn + 1
        return file

    def _gone(self, _: int) -> None:
        self.dialog = None
