"""Sentences of the core in the user's language."""

from __future__ import annotations

import re

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

from geofit.report.language import EN, ZH, Language, tell
from geofit.words import Said

__all__ = ["SENTENCES", "bare", "speak", "spoken"]

#: Sentences that the windows' own model says (geofit.gui.document), for the translators.
SENTENCES = (
    QT_TRANSLATE_NOOP("Said", "Settings of {name}"),
    QT_TRANSLATE_NOOP("Said", "Core of {name}"),
    QT_TRANSLATE_NOOP("Said", "Exclude {file} row {row} from {name}"),
    QT_TRANSLATE_NOOP("Said", "Include {file} row {row} in {name}"),
    QT_TRANSLATE_NOOP("Said", "Fit {name}"),
    QT_TRANSLATE_NOOP("Said", "Move control point {i}, {j} of {patch} by {dz:+.3f} m ({name})"),
    QT_TRANSLATE_NOOP("Said", "Weight {weight:g} for control point {i}, {j} of {patch} ({name})"),
    QT_TRANSLATE_NOOP("Said", "Pull {name} to point {number}"),
    QT_TRANSLATE_NOOP("Said", "Push apart {names}"),
    QT_TRANSLATE_NOOP("Said", "Order of the horizons"),
    QT_TRANSLATE_NOOP("Said", "Rename the site to {name}"),
)

_language: Language = EN


def speak(code: str) -> None:
    """Choose the language of :func:`spoken`: "en" or "zh_CN"."""
    global _language
    _language = ZH if code.startswith("zh") else EN


def spoken(text: str) -> str:
    """Return a sentence of the core as it is shown; what nobody translated stays English."""
    if isinstance(text, Said) and text.template in SENTENCES:
        return QCoreApplication.translate("Said", text.template).format(**text.values)
    return tell(text, _language)


def bare(text: str) -> str:
    """Return the text of an action without the mark of its key and without dots.

    Examples
    --------
    >>> bare("Save &as…"), bare("另存为(&A)...")
    ('Save as', '另存为')
    """
    return re.sub(r"\(&\w\)|&", "", text).rstrip(".…")
