"""The languages of messages, reports and windows: one gettext catalogue each, ``geofit/locale/LANGUAGE``."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from gettext import NullTranslations, translation
from pathlib import Path
from typing import Any

from geofit.data.errors import SettingsError
from geofit.data.messages import ENGLISH, Message, Untranslated, message, render

__all__ = ["EN", "ZH", "Language", "catalogue", "language", "sentence", "together", "translate"]

LOCALE = Path(__file__).resolve().parents[1] / "locale"


@cache
def catalogue(name: str) -> NullTranslations:
    """Return the catalogue of a folder of ``geofit/locale`` ("zh_CN"); English is the source itself."""
    return ENGLISH if name == "en" else translation("geofit", LOCALE, [name])


@dataclass(frozen=True)
class Language:
    """A language: its code ("zh"), its code in HTML ("zh-CN") and the folder of its catalogue ("zh_CN").

    Called with an English template it returns the text in this language with its values filled in. The template must
    be a literal, so that Babel can extract it.

    Examples
    --------
    >>> ZH("Horizon {name}", name="T1")
    '层面 T1'
    """

    code: str
    html: str
    folder: str

    @property
    def catalogue(self) -> NullTranslations:
        """The translations."""
        return catalogue(self.folder)

    def __call__(self, template: str, /, **values: Any) -> str:
        """Return a label or sentence of the report."""
        return translate(Message("", template, values), self)


EN = Language("en", "en", "en")
ZH = Language("zh", "zh-CN", "zh_CN")


def language(code: str) -> Language:
    """Return the language of a code.

    Raises
    ------
    SettingsError
        If there is none.
    """
    for known in (EN, ZH):
        if known.code == code:
            return known
    raise SettingsError(
        message("data.language-unknown", "The language is '{code}'; choose en or zh.", code=Untranslated(code))
    )


def translate(value: Message | str | BaseException, language: Language) -> str:
    """Return a message, the message of an error or a term (a kind, a patch) in a language.

    Parameters
    ----------
    value : Message, str or exception
        A string that is not a term of :data:`geofit.data.terms.TERMS` is returned as it is.
    language : Language
        What the language lacks stays English.
    """
    if isinstance(value, BaseException):
        value = getattr(value, "message", None) or str(value)
    return str(render(value, language.catalogue))


def sentence(value: Message | str, language: Language) -> str:
    """Return a message as a sentence in a language: a capital letter in front, a full stop behind."""
    text = translate(value, language).strip()
    if not text or text.endswith((".", "。", "!", "?")):
        return text[:1].upper() + text[1:]
    # Also behind a number or a unit at the end of a Chinese sentence.
    stop = "。" if any(unicodedata.east_asian_width(letter) in "WF" for letter in text) else "."
    return text[:1].upper() + text[1:] + stop


def together(sentences: Iterable[str], language: Language) -> str:
    """Return sentences as one text: with a space between them, in Chinese without.

    Examples
    --------
    >>> together(["One.", "", "Two."], EN), together(["一。", "二。"], ZH)
    ('One. Two.', '一。二。')
    """
    return ("" if language.code == "zh" else " ").join(text for text in sentences if text)
