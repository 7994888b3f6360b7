"""Sentences that can be told in another language: English text that remembers its template and its values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from typing import Any

__all__ = ["Said", "Verbatim", "folded", "listed", "said"]


class Said(str):
    """An English sentence; ``template`` and ``values`` are what another language needs to say it anew."""

    __slots__ = ("template", "values")
    template: str
    values: Mapping[str, Any]

    def in_words(self, templates: Mapping[str, str]) -> str:
        """Return the sentence by another language's templates, values that are sentences included.

        A template that the other language does not have leaves the sentence in English.
        """
        other = templates.get(self.template)
        if other is None:
            return str(self)
        values = {k: v.in_words(templates) if isinstance(v, Said) else v for k, v in self.values.items()}
        return other.format(**values)


class Verbatim(str):
    """A word that is the same in every language: a column or key of a file, a name, also where it is one of ours."""

    __slots__ = ()


def said(template: str, **values: Any) -> Said:
    """Return ``template.format(**values)``; the template must be a literal, so that translations can be checked.

    Examples
    --------
    >>> text = said("{count} of {total} points", count=3, total=40)
    >>> str(text), text.in_words({"{count} of {total} points": "{total} 点中的 {count} 点"})
    ('3 of 40 points', '40 点中的 3 点')
    """
    text = Said(template.format(**values))
    text.template, text.values = template, values
    return text


def folded(text: str, most: int = 200) -> str:
    """Return a text of any length as one that a person can read: its beginning, and how long it is.

    Examples
    --------
    >>> folded("short"), folded("9" * 20_000_000, 5)
    ('short', '99999… (20000000 characters)')
    """
    return text if len(text) <= most else f"{text[:most]}… ({len(text)} characters)"


def listed(texts: Iterable[str]) -> str:
    """Return texts as a list with commas, empty if there is none; those that can be told in another language still can.

    Examples
    --------
    >>> listed([said("row {row}", row=2), said("row {row}", row=5)])
    'row 2, row 5'
    """
    texts = list(texts)
    return reduce(lambda a, b: said("{first}, {second}", first=a, second=b), texts) if texts else ""
