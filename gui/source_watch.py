"""Files that bodies are made from: whether they have changed on the disk since they were read."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject

from geofit.gui.activity import Activity, Work
from geofit.gui.file_stamps import Stamp, stamp
from geofit.project.body_sources import data_now
from geofit.project.document import Document
from geofit.project.known_sources import FileSource, file_sources

__all__ = ["SourceWatch"]


class SourceWatch(QObject):
    """Reads the files of bodies again where they may have changed, and hands their hashes to the document."""

    def __init__(self, document: Document, activity: Activity, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._activity = document, activity
        #: Files of each source, a site file has several, with their stamps when they were read.
        self._read: dict[FileSource, dict[Path, Stamp]] = {}

    def look(self) -> None:
        """Look at the files of all bodies."""
        if self._changed():
            title = self.tr("Look at the data of bodies")
            self._activity.prepare(title, self._work, on_done=self._know, in_process=True)

    def forget(self) -> None:
        """Read everything anew at the next look: another site is open."""
        self._read.clear()

    def _changed(self) -> list[FileSource]:
        records = self._document.state.bodies.values()
        return [source for source in file_sources(records) if self._has_changed(source)]

    def _work(self) -> Work:
        folder, changed = self._document.site_folder, self._changed()
        return (data_now, (changed, folder)) if changed and folder is not None else None

    def _has_changed(self, source: FileSource) -> bool:
        known = self._read.get(source)
        return known is None or any(stamp(file) != former for file, former in known.items())

    def _know(self, found: dict[FileSource, tuple[str, tuple[Path, ...]]]) -> None:
        for source, (_, files) in found.items():
            self._read[source] = {file: stamp(file) for file in files}
        self._document.know_sources({source: given for source, (given, _) in found.items()})
