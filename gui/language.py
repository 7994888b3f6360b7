"""The language of the windows: translations that stand beside this module, and Qt's own for its buttons."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QLocale, QTranslator

from geofit.gui.words import speak

__all__ = ["LANGUAGES", "apply_language", "system_language"]

#: Codes, and each language's name in itself.
LANGUAGES = {"en": "English", "zh_CN": "简体中文"}
FOLDER = Path(__file__).with_name("translations")

_loaded: list[QTranslator] = []


def system_language() -> str:
    """Return the language of the system as far as there is a translation, English otherwise."""
    return "zh_CN" if QLocale.system().language() == QLocale.Language.Chinese else "en"


def apply_language(code: str) -> None:
    """Translate everything that is built from now on."""
    app = QCoreApplication.instance()
    while _loaded:
        QCoreApplication.removeTranslator(_loaded.pop())
    if code != "en":
        for name, folder in (
            (f"qtbase_{code}", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)),
            (f"geofit_{code}", str(FOLDER)),
        ):
            translator = QTranslator(app)
            if translator.load(name, folder):
                QCoreApplication.installTranslator(translator)
                _loaded.append(translator)
    speak(code)
    QLocale.setDefault(QLocale(QLocale.Language.Chinese) if code.startswith("zh") else QLocale(QLocale.Language.C))
