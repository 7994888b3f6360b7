"""The language of the windows: geofit's catalogue for messages and widgets, and Qt's own for its buttons."""

from __future__ import annotations

from gettext import NullTranslations

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QLocale, QObject, QTranslator

from geofit.data.languages import catalogue
from geofit.gui.translate import speak

__all__ = ["LANGUAGES", "apply_language", "system_language"]

#: Codes, and each language's name in itself.
LANGUAGES = {"en": "English", "zh_CN": "简体中文"}

_loaded: list[QTranslator] = []


def system_language() -> str:
    """Return the language of the system as far as there is a translation, English otherwise."""
    return "zh_CN" if QLocale.system().language() == QLocale.Language.Chinese else "en"


class CatalogueTranslator(QTranslator):
    """Lets ``tr()`` of widgets read geofit's gettext catalogue.

    A text that means two things has a context: the disambiguation of ``tr()``, or the context of
    ``QT_TRANSLATE_NOOP``.
    """

    def __init__(self, texts: NullTranslations, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._texts = texts

    def isEmpty(self) -> bool:  # noqa: N802
        """Tell Qt that there are translations."""
        return False

    def translate(self, context: str, text: str, disambiguation: str | None = None, n: int = -1) -> str:
        """Return a text in the language; what the catalogue lacks stays English."""
        for name in (disambiguation, context):
            if name and (found := self._texts.pgettext(name, text)) != text:
                return found
        return self._texts.gettext(text) if text else text


def apply_language(code: str) -> None:
    """Translate everything that is built from now on."""
    app = QCoreApplication.instance()
    while _loaded:
        QCoreApplication.removeTranslator(_loaded.pop())
    if code != "en":
        # Qt asks the last one first: its own words come from its own file, all others from geofit's catalogue.
        own = CatalogueTranslator(catalogue(code), app)
        qt = QTranslator(app)
        found = qt.load(f"qtbase_{code}", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath))
        for translator in (own, *([qt] if found else [])):
            QCoreApplication.installTranslator(translator)
            _loaded.append(translator)
    speak(code)
    QLocale.setDefault(QLocale(QLocale.Language.Chinese) if code.startswith("zh") else QLocale(QLocale.Language.C))
