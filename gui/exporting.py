"""What leaves the application: STEP and other formats, reports, screenshots."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QWidget

from geofit.data.errors import GeofitError
from geofit.data.files import file_stems
from geofit.data.messages import Message, message
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.activity import Activity
from geofit.gui.preferences import Preferences
from geofit.gui.save_file import ask_save_file
from geofit.gui.showing import Showing
from geofit.gui.translate import translated
from geofit.gui.workspace import Workspace
from geofit.io.export.write import FORMATS, renamed, untrimmed
from geofit.project.document import Document
from geofit.project.export_task import export_surfaces
from geofit.project.interventions import interventions_of
from geofit.project.staleness import dated_body, stale_causes
from geofit.report.result import HorizonResult

__all__ = ["Delivering"]

_LOG = logging.getLogger(__name__)

#: Times the view's own size: an A4 page at 300 dots an inch from half a screen.
PRINT_SCALE = 3


class Delivering(QObject):
    """Exports, reports and pictures. ``reported(text)`` states what was written, ``refused(exception)`` why not."""

    reported = Signal(str)
    refused = Signal(object)

    def __init__(
        self,
        document: Document,
        activity: Activity,
        preferences: Preferences,
        workspace: Workspace,
        showing: Showing,
        window: QWidget,
    ) -> None:
        super().__init__(window)
        self._document, self._activity, self._preferences = document, activity, preferences
        self._panels, self._showing, self._window = workspace, showing, window
        self._reports: list[str] = []
        workspace.tree.report_chosen.connect(lambda path: QDesktopServices.openUrl(QUrl.fromLocalFile(path)))
        document.site_opened.connect(self._forget_reports)

    def close(self) -> None:
        """Listen no more; the document may live longer than the window."""
        self._document.site_opened.disconnect(self._forget_reports)

    def take_over(self, other: Delivering) -> None:
        """List the reports that another window has written."""
        self._reports = other._reports
        self._panels.tree.show_reports(self._reports)

    def export_step(self) -> None:
        """Ask for units and tolerance, write STEP and read it back."""
        from geofit.gui.dialogs.export_step import ExportDialog

        surfaces = self._surfaces()
        if surfaces:
            verdicts = {name: found for name in surfaces if (found := self._showing.verdict(name)) is not None}
            site, stale = self._document.site, [name for name in surfaces if self._document.stale(name)]
            dialog = ExportDialog(surfaces, self._window, verdicts, self._folder(), site.title, site.datum, stale)
            dialog.exec()
            if dialog.files:
                self._showing.show_exported(surfaces, dialog.files)
                self._written([file.path for file in dialog.files])

    def export_other(self) -> None:
        """Ask for a file; its ending is the format."""
        surfaces = self._surfaces()
        if not surfaces:
            return
        kinds = {
            f"{name} ({' '.join(f'*{ending}' for ending in FORMATS[name].endings)})": name
            for name in FORMATS
            if name != "step"
        }
        start = self._folder() / file_stems([self._document.state.name])[self._document.state.name]
        chosen = ask_save_file(self._window, self.tr("Export"), start, ";;".join(kinds))
        if chosen is not None:
            target, kind = chosen
            self.write(kinds[kind], target, surfaces)

    def write(self, to: str, target: Path, surfaces: Mapping[str, HorizonFit]) -> None:
        """Write surfaces in a format, with the points and holes that the format can hold."""
        site = self._document.site_in_use()
        options = {"points": dict(site.horizons), "holes": site.holes, "site": site.name, "crs": site.crs}
        # The patches are enough for every format; what stands behind them need not travel.
        bare = {name: surface.with_(model=None) for name, surface in surfaces.items()}
        title = self.tr("Export {name}").format(name=target.name)
        notes = [*untrimmed(bare, to), *renamed(bare, to)]

        def written(files: list[Path]) -> None:
            self._written(files, notes)

        self._activity.do(title, export_surfaces, bare, to, target, options, on_done=written, in_process=True)

    def section_sheet(self) -> None:
        """Ask for sections and a title block, and write the sections to scale."""
        from geofit.gui.dialogs.section_sheet import SectionSheetDialog
        from geofit.project.section_sheet import sheet_bodies

        self._showing.begin_section()
        if self._showing.line is None:
            return
        site, line = self._document.site_in_use(), np.asarray(self._showing.line, float)
        surfaces = self._document.surfaces()
        bodies = sheet_bodies(self._document)
        thickness, uncertain = self._showing.thickness, self._showing.uncertainties()
        stale = [name for name in surfaces if self._document.stale(name)]
        dialog = SectionSheetDialog(
            site, surfaces, line, thickness, uncertain, bodies, self._folder(), self._window, stale
        )
        dialog.exec()
        if dialog.files:
            self._written(list(dialog.files))

    def plan_sheet(self) -> None:
        """Ask for an interval and a title block, and write contour plans to scale."""
        from geofit.gui.dialogs.plan_sheet import PlanSheetDialog

        surfaces = self._surfaces()
        if surfaces:
            chosen = self._document.selection.horizon
            site, stale = self._document.site_in_use(), {name: stale_causes(self._document, name) for name in surfaces}
            dialog = PlanSheetDialog(site, surfaces, chosen, self._folder(), self._window, stale)
            dialog.exec()
            if dialog.files:
                self._written(list(dialog.files))

    def report(self) -> None:
        """Ask for language and format, and write the accuracy report."""
        from geofit.gui.dialogs.report import ReportDialog

        surfaces = self._surfaces()
        if surfaces:
            site, provenances = self._document.site_in_use(), dict(self._document.state.provenances)
            results = [self.result(name, surface) for name, surface in surfaces.items()]
            bodies = {
                name: body
                for name in self._document.state.bodies
                if (body := dated_body(self._document, name)) is not None
            }
            unfitted = [name for name in self._document.horizons if name not in surfaces]
            dialog = ReportDialog(
                site, results, self._window, self._document.blocks(), self._folder(), bodies, unfitted
            )
            dialog.written.connect(self.list_report)
            dialog.examined.connect(
                lambda name, prediction: self._document.put_prediction(provenances[name], prediction)
            )
            dialog.ordered.connect(lambda orders: self._showing.show_orders(orders, provenances))
            dialog.exec()

    def result(self, name: str, surface: HorizonFit) -> HorizonResult:
        """Return what a report says of a surface; of a STEP file only if one was written of this very surface."""
        site, prediction = self._document.site_in_use(), self._document.prediction(name)
        change = self._document.comparison(name)
        provenance = self._document.state.provenances.get(name)
        excluded, edits = (None, ()) if provenance is None else interventions_of(self._document.site, provenance)
        file = self._showing.file_of(name, surface)
        return HorizonResult(
            surface,
            site,
            None if file is None else file.read_back[name],
            step_bytes=0 if file is None else file.size,
            prediction=prediction,
            excluded=excluded,
            edits=edits,
            change=change,
            stale=stale_causes(self._document, name),
        )

    def list_report(self, path: object) -> None:
        """List a report in the project tree."""
        self._reports.append(str(path))
        _LOG.info(message("gui.log-file-written", "Wrote {file}", file=str(Path(str(path)).resolve())))
        self.reported.emit(self.tr("Wrote {names}.").format(names=Path(str(path)).resolve()))
        self._panels.tree.show_reports(self._reports)

    def _forget_reports(self) -> None:
        """Those of the former site are none of the next one."""
        self._reports = []
        self._panels.tree.show_reports(self._reports)

    def screenshot(self) -> None:
        """Ask for a file, and write the 3D view at print size."""
        chosen = ask_save_file(
            self._window, self.tr("Screenshot"), self._folder() / "screenshot.png", self.tr("Pictures (*.png)")
        )
        if chosen is not None:
            target = chosen[0]
            try:
                self._panels.view.screenshot(target, PRINT_SCALE)
            except (OSError, GeofitError) as error:
                self.refused.emit(error)
            else:
                self._written([target])

    def _surfaces(self) -> Mapping[str, HorizonFit]:
        surfaces = self._document.surfaces()
        if not surfaces:
            self.refused.emit(
                GeofitError(message("gui.no-surface-to-write", "There is no surface to write yet. Press Fit first."))
            )
        return surfaces

    def _folder(self) -> Path:
        """Return where files go unless somebody says otherwise: beside the project."""
        return self._document.folder or Path(self._preferences.folder)

    def _written(self, files: list[Path], notes: Sequence[Message] = ()) -> None:
        """Tell of files, and of what they have otherwise than the horizons."""
        names = ", ".join(str(file.resolve()) for file in files)
        self.reported.emit(" ".join([self.tr("Wrote {names}.").format(names=names), *map(translated, notes)]))
        for note in notes:
            _LOG.warning(note)
        for file in files:
            _LOG.info(message("gui.log-file-written", "Wrote {file}", file=str(file.resolve())))
