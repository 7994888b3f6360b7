"""Theme, language, unit of lengths, size of text and points, and what the mouse does in the 3D view."""

from __future__ import annotations

from typing import cast

from PySide6.QtWidgets import QComboBox, QDialog, QDialogButtonBox, QFormLayout, QLabel, QWidget

from geofit.data.lengths import LengthUnit
from geofit.gui.language import LANGUAGES
from geofit.gui.preferences import POINT_SIZES, TEXT_SIZES, Preferences
from geofit.gui.theme import missing_chinese
from geofit.gui.view3d.mouse import Scheme

__all__ = ["PreferencesDialog"]


class PreferencesDialog(QDialog):
    """Asks for theme, language, unit, sizes and mouse; the properties hold what was chosen."""

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
        self.mouse_box, self._mouse_words = QComboBox(), QLabel()
        for scheme, text in (
            ("geofit", self.tr("geofit")),
            ("cad", self.tr("CAD")),
            ("leapfrog", self.tr("Leapfrog")),
            ("paraview", self.tr("ParaView")),
        ):
            self.mouse_box.addItem(text, scheme)
        self.mouse_box.setCurrentIndex(self.mouse_box.findData(preferences.mouse))
        self._mouse_words.setWordWrap(True)
        self.mouse_box.currentIndexChanged.connect(self._explain)
        self._text, self._points = QComboBox(), QComboBox()
        for box, known, now in (
            (self._text, TEXT_SIZES, preferences.text_size), (self._points, POINT_SIZES, preferences.point_size)
        ):  # fmt: skip
            for share in known:
                box.addItem(self.tr("{percent} %").format(percent=f"{100 * share:.0f}"), share)
            box.setCurrentIndex(box.findData(now))
        self.lengths_box = QComboBox()
        for unit, text in (
            ("m", self.tr("metres")),
            ("ft", self.tr("feet (0.3048 m)")),
            ("ft-us", self.tr("US survey feet (1200/3937 m)")),
        ):
            self.lengths_box.addItem(text, unit)
        self.lengths_box.setCurrentIndex(self.lengths_box.findData(preferences.lengths))
        self.lengths_box.setToolTip(
            self.tr(
                "Unit of lengths in tables, axes, verdicts and figures of the windows. What is entered, files and "
                "reports stay in metres."
            )
        )
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        form = QFormLayout(self)
        form.addRow(self.tr("&Theme"), self._theme)
        form.addRow(self.tr("&Language"), self._language)
        form.addRow(self.tr("L&engths in"), self.lengths_box)
        form.addRow(self.tr("Te&xt size"), self._text)
        form.addRow(self.tr("&Points in 3D"), self._points)
        form.addRow(self.tr("&Mouse in 3D"), self.mouse_box)
        form.addRow("", self._mouse_words)
        self._explain()
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

    def _explain(self, *_: object) -> None:
        words = {
            "geofit": self.tr("Left rotates; Shift + left, middle or right pans; the wheel zooms."),
            "cad": self.tr("Middle pans, Shift + middle rotates, the wheel zooms, left only selects."),
            "leapfrog": self.tr("Left rotates, right zooms, middle or Shift + left pans."),
            "paraview": self.tr("Left rotates, middle pans, right zooms."),
        }
        self._mouse_words.setText(words[self.mouse])

    @property
    def mouse(self) -> Scheme:
        """The chosen scheme of the mouse."""
        return cast("Scheme", self.mouse_box.currentData())

    @property
    def lengths(self) -> LengthUnit:
        """The chosen unit of lengths."""
        return cast("LengthUnit", self.lengths_box.currentData())

    @property
    def text_size(self) -> float:
        """The chosen size of text, as a share of the system's."""
        return float(self._text.currentData())

    @property
    def point_size(self) -> float:
        """The chosen size of data points, as a share of the usual one."""
        return float(self._points.currentData())

    @property
    def theme(self) -> str:
        """The chosen theme."""
        return str(self._theme.currentData())

    @property
    def language(self) -> str:
        """The chosen language's code."""
        return str(self._language.currentData())
