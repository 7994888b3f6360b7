"""Theme and language."""

from __future__ import annotations

from PySide6.QtWidgets import QComboBox, QDialog, QDialogButtonBox, QFormLayout, QLabel, QWidget

from geofit.gui.language import LANGUAGES
from geofit.gui.preferences import Preferences
from geofit.gui.theme import missing_chinese

__all__ = ["PreferencesDialog"]


class PreferencesDialog(QDialog):
    """Asks for theme and language; ``theme`` and ``language`` hold what was chosen."""

    def __init__(self, preferences: Preferences, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Preferences"))
        self._theme, self._language = QComboBox(), QComboBox()
        for theme, text in (
            ("system", self.tr("As the system")),
            ("light", self.tr("Light")),
            ("dark", self.tr("Dark")),
        ):
            self._theme.addItem(text, theme)
        for code, text in LANGUAGES.items():
            self._language.addItem(text, code)
        self._theme.setCurrentIndex(self._theme.findData(preferences.theme))
        self._language.setCurrentIndex(self._language.findData(preferences.language))
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        form = QFormLayout(self)
        form.addRow(self.tr("&Theme"), self._theme)
        form.addRow(self.tr("&Language"), self._language)
        if missing_chinese():
            note = QLabel(
                self.tr(
                    "No font on this machine has Chinese characters: they would be boxes. Install one (Debian and "
                    "Ubuntu: apt-get install fonts-noto-cjk) and start again."
                )
            )
            note.setWordWrap(True)
            form.addRow(note)
        form.addRow(buttons)
        self.setMinimumWidth(360)

    @property
    def theme(self) -> str:
        """The chosen theme."""
        return str(self._theme.currentData())

    @property
    def language(self) -> str:
        """The chosen language's code."""
        return str(self._language.currentData())
