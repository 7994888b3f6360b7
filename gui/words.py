"""Sentences of the core in the user's language."""

from __future__ import annotations

import re
from dataclasses import replace

from PySide6.QtCore import QCoreApplication

from geofit.data.errors import GeofitError
from geofit.data.messages import Verbatim, said
from geofit.gui.sentences import SENTENCES
from geofit.report.language import EN, ZH, Language, tell

__all__ = ["bare", "failure", "speak", "spoken", "spoken_language"]

_language: Language = EN


def speak(code: str) -> None:
    """Choose the language of :func:`spoken`: "en" or "zh_CN", whose translations must be at hand."""
    global _language
    own = {text: QCoreApplication.translate("Said", text) for text in SENTENCES}
    texts = {text: told for text, told in own.items() if told != text}
    _language = replace(ZH, texts={**ZH.texts, **texts}) if code.startswith("zh") else EN


def spoken_language() -> Language:
    """Return the language of :func:`spoken`, for files that the windows write."""
    return _language


def spoken(text: str) -> str:
    """Return a sentence of the core as it is shown; what nobody translated stays English."""
    return tell(text, _language)


def failure(error: BaseException) -> str:
    """Return what an error says: geofit's own sentence, the system's with the file, or Python's with its kind."""
    if isinstance(error, GeofitError):
        return spoken(str(error))
    if isinstance(error, OSError) and error.strerror:
        reason = error.strerror
        return spoken(
            said("{place}: {sentence}", place=Verbatim(error.filename), sentence=reason) if error.filename else reason
        )
    return str(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}"


def bare(text: str) -> str:
    """Return the text of an action without the mark of its key and without dots.

    Examples
    --------
    >>> bare("Save &as…"), bare("另存为(&A)...")
    ('Save as', '另存为')
    """
    return re.sub(r"\(&\w\)|&", "", text).rstrip(".…")
