"""What the application remembers between sessions, by name and type; QSettings underneath."""

from __future__ import annotations

from pathlib import Path
from typing import cast

from PySide6.QtCore import QByteArray, QSettings

from geofit.data.lengths import LENGTH_UNITS, LengthUnit
from geofit.gui.language import LANGUAGES, system_language
from geofit.gui.theme import THEMES, Theme
from geofit.gui.view3d.mouse import SCHEMES, Scheme

__all__ = ["POINT_SIZES", "TEXT_SIZES", "Preferences"]

#: Files that the start page and the File menu offer again.
RECENT = 10


#: Sizes of text and of data points, as shares of the usual ones.
TEXT_SIZES = (0.85, 1.0, 1.15, 1.3, 1.5)
POINT_SIZES = (0.5, 0.75, 1.0, 1.5, 2.0)


class Preferences:
    """Theme, language, recent files, and where the docks stood."""

    def __init__(self) -> None:
        self._store = QSettings()

    @property
    def theme(self) -> Theme:
        """Light, dark or as the system has it."""
        stored = str(self._store.value("theme", "system"))
        return next((theme for theme in THEMES if theme == stored), "system")

    @theme.setter
    def theme(self, theme: Theme) -> None:
        self._store.setValue("theme", theme)

    @property
    def language(self) -> str:
        """Code of the windows' language."""
        stored = str(self._store.value("language", ""))
        return stored if stored in LANGUAGES else system_language()

    @language.setter
    def language(self, code: str) -> None:
        self._store.setValue("language", code)

    @property
    def mouse(self) -> Scheme:
        """What the buttons of the mouse do in the 3D view."""
        stored = str(self._store.value("mouse", "geofit"))
        return next((scheme for scheme in SCHEMES if scheme == stored), "geofit")

    @mouse.setter
    def mouse(self, scheme: Scheme) -> None:
        self._store.setValue("mouse", scheme)

    @property
    def text_size(self) -> float:
        """How many times larger than the system's the text is."""
        return self._share("text_size", TEXT_SIZES)

    @text_size.setter
    def text_size(self, share: float) -> None:
        self._store.setValue("text_size", share)

    @property
    def point_size(self) -> float:
        """How many times larger than usual data points are in the scene."""
        return self._share("point_size", POINT_SIZES)

    @point_size.setter
    def point_size(self, share: float) -> None:
        self._store.setValue("point_size", share)

    def _share(self, key: str, known: tuple[float, ...]) -> float:
        stored = str(self._store.value(key, 1.0))
        return next((share for share in known if str(share) == stored), 1.0)

    @property
    def lengths(self) -> LengthUnit:
        """Unit in which lengths are shown."""
        stored = str(self._store.value("lengths", "m"))
        return next((unit for unit in LENGTH_UNITS if unit == stored), "m")

    @lengths.setter
    def lengths(self, unit: LengthUnit) -> None:
        self._store.setValue("lengths", unit)

    @property
    def recent(self) -> tuple[Path, ...]:
        """Projects and site files that were opened last and are still there, the latest first."""
        stored = self._store.value("recent", [])
        names = [stored] if isinstance(stored, str) else list(cast("list[str]", stored or []))
        return tuple(path for path in map(Path, names) if path.is_file())

    def opened(self, path: Path) -> None:
        """Put a file first among the recent ones."""
        path = path.resolve()
        others = [one for one in self.recent if one != path]
        self._store.setValue("recent", [str(one) for one in (path, *others)][:RECENT])

    @property
    def folder(self) -> str:
        """Where the last file was opened or written."""
        return str(self._store.value("folder", ""))

    @folder.setter
    def folder(self, folder: str) -> None:
        self._store.setValue("folder", folder)

    @property
    def layout(self) -> tuple[QByteArray, QByteArray] | None:
        """Size of the main window and state of its docks."""
        geometry, state = self._store.value("geometry"), self._store.value("state")
        if isinstance(geometry, QByteArray) and isinstance(state, QByteArray):
            return geometry, state
        return None

    @layout.setter
    def layout(self, layout: tuple[QByteArray, QByteArray] | None) -> None:
        if layout is None:
            self._store.remove("geometry")
            self._store.remove("state")
        else:
            self._store.setValue("geometry", layout[0])
            self._store.setValue("state", layout[1])
