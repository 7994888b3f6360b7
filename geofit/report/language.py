"""The language of a report: English texts are their own keys, Chinese ones stand in a catalogue."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from geofit.data.errors import SettingsError
from geofit.data.messages import Said, Verbatim, said
from geofit.report.chinese import LABELS
from geofit.report.chinese_errors import REFUSED
from geofit.report.chinese_files import UNREADABLE
from geofit.report.chinese_io import LISTED
from geofit.report.chinese_said import SAID

__all__ = ["EN", "ZH", "Language", "language", "sentence", "tell"]


@dataclass(frozen=True)
class Language:
    """A language: its code ("en"), its code in HTML ("zh-CN") and its texts by the English ones.

    Called with an English template it returns the text in this language, values filled in. The template must be a
    literal, so that a test can find every one that the catalogue lacks.

    Examples
    --------
    >>> ZH("Horizons: {count}", count=5)
    '5 个层面'
    """

    code: str
    html: str
    texts: Mapping[str, str] = field(default_factory=dict, repr=False)

    def __call__(self, template: str, /, **values: Any) -> str:
        """Return a label or sentence of the report."""
        told = {name: tell(value, self) if isinstance(value, str) else value for name, value in values.items()}
        return self.texts.get(template, template).format(**told)


EN = Language("en", "en")
ZH = Language("zh", "zh-CN", {**UNREADABLE, **REFUSED, **LISTED, **SAID, **LABELS})


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
    raise SettingsError(said("The language is '{code}'; choose en or zh.", code=code))


def tell(text: str, language: Language) -> str:
    """Return a text of :func:`geofit.data.messages.said` or a word of the core (a kind, a patch) in a language.

    What the language does not have stays English, what is :class:`geofit.data.messages.Verbatim` as it is.
    """
    if isinstance(text, Verbatim):
        return str(text)
    template = language.texts.get(text.template if isinstance(text, Said) else text)
    if template is None:
        return str(text)
    if not isinstance(text, Said):
        return template
    return template.format(**{k: tell(v, language) if isinstance(v, str) else v for k, v in text.values.items()})


def sentence(text: str, language: Language) -> str:
    """Return a text as a sentence: told, a capital letter in front, a full stop behind."""
    told = tell(text, language).strip()
    if not told or told.endswith((".", "。", "!", "?")):
        return told[:1].upper() + told[1:]
    stop = "。" if unicodedata.east_asian_width(told[-1]) in "WF" else "."
    return told[:1].upper() + told[1:] + stop
