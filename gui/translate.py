"""Sentences of the core in the user's language."""

from __future__ import annotations

import re

from geofit.data.errors import GeofitError
from geofit.data.languages import EN, ZH, Language, translate
from geofit.data.messages import Message, Untranslated, message

__all__ = ["bare", "failure", "shown_error", "speak", "translated", "user_language"]

_language: Language = EN


def speak(code: str) -> None:
    """Choose the language of :func:`translated`: "en" or "zh_CN"."""
    global _language
    _language = ZH if code.startswith("zh") else EN


def user_language() -> Language:
    """Return the language of :func:`translated`, for files that the windows write."""
    return _language


def translated(text: Message | str | GeofitError) -> str:
    """Return a message, a term or the message of an error in the user's language."""
    return translate(text, _language)


def shown_error(error: BaseException) -> Message | str:
    """Return what an error says: geofit's own message, the system's with the file, or Python's with its kind."""
    if isinstance(error, GeofitError):
        return error.message
    if isinstance(error, OSError) and error.strerror:
        if not error.filename:
            return error.strerror
        return message(
            "data.sentence-at-place", "{place}: {sentence}", place=Untranslated(error.filename), sentence=error.strerror
        )
    return Untranslated(error if isinstance(error, OSError) else f"{type(error).__name__}: {error}")


def failure(error: BaseException) -> str:
    """Return what an error says in the user's language."""
    return translated(shown_error(error))


def bare(text: str) -> str:
    """Return the text of an action without the mark of its key and without dots.

    Examples
    --------
    >>> bare("Save &as…"), bare("另存为(&A)...")
    ('Save as', '另存为')
    """
    return re.sub(r"\(&\w\)|&", "", text).rstrip(".…")
