"""Sentences that can be told in another language: English text that remembers its template and its values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["Said", "said"]


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
