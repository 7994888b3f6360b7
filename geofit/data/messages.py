"""Messages: a code, parameters and a severity; the sentence is formed where it is shown.

A message keeps its English template and its parameters. ``str(message)`` is English;
:func:`geofit.data.languages.translate` gives another language. Code compares ``message.code`` and ``message.params``,
never the text.

Templates are literals, so that Babel can extract them: ``pybabel extract -k message:2 -k plural_message:2,3``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from gettext import NullTranslations
from numbers import Integral
from string import Formatter
from typing import Any, Literal

from geofit.data.rounding import in_groups, rounded_metres
from geofit.data.terms import TERMS

__all__ = [
    "EMPTY",
    "ENGLISH",
    "Message",
    "Severity",
    "Untranslated",
    "folded",
    "gravest_first",
    "message",
    "plural_message",
    "render",
    "some_of",
]

Severity = Literal["info", "warning", "error"]

#: The catalogue of the source language: every template is its own translation.
ENGLISH = NullTranslations()

#: Parameters whose whole numbers name something or are as the user gave them, and are looked for as they are.
NAMING = frozenset({"code", "given", "index", "i", "j", "number", "page", "row", "seed", "value", "version", "vertex"})
_GRAVEST_FIRST = ("error", "warning", "info")
_ITEMS = "{first}, {second}"


class Untranslated(str):
    """A name that is the same in every language, such as a column or a borehole, even if it is also a term."""

    __slots__ = ()


@dataclass(frozen=True)
class Message:
    """A sentence with parameters that is formatted only when it is shown.

    Parameters
    ----------
    code : str
        Stable identifier, "room.subject-predicate": "data.points-not-finite" (docs/architecture.md).
    template : str
        English text with ``str.format`` fields; it is the key of the translations.
    params : mapping of str to object
        Values of the fields. Messages, and tuples of messages and strings, are translated with the sentence; a string
        is translated if it is one of :data:`geofit.data.terms.TERMS`, unless it is :class:`Untranslated`.
    plural : str or None
        English template for values of the parameter ``count`` other than 1.
    severity : {"info", "warning", "error"}
        How grave it is.
    """

    code: str
    template: str
    params: Mapping[str, Any] = field(default_factory=dict)
    plural: str | None = None
    severity: Severity = "info"

    def __str__(self) -> str:
        return str(render(self, ENGLISH))

    def __repr__(self) -> str:
        return f"<{self.code}: {self}>"

    def __format__(self, spec: str) -> str:
        return format(str(self), spec)

    def __bool__(self) -> bool:
        return bool(self.template)

    def __hash__(self) -> int:
        return hash((self.code, self.template))

    @property
    def is_sentence(self) -> bool:
        """Whether the English text brings its own full stop, in the template or in the parameter at its end."""
        last = list(Formatter().parse(self.template))[-1:]
        value = self.params.get(last[0][1]) if last and last[0][1] else None
        if isinstance(value, Message):
            return value.is_sentence
        return (value if isinstance(value, str) else self.template).endswith((".", "!", "?"))

    def with_severity(self, severity: Severity) -> Message:
        """Return the message with another severity."""
        return replace(self, severity=severity)

    def as_data(self) -> dict[str, Any]:
        """Return what JSON holds of it: code, severity, English text and parameters."""
        return {"code": self.code, "severity": self.severity, "text": str(self), "params": dict(self.params)}


#: No message; false where a condition is tested.
EMPTY = Message("", "")


def message(code: str, template: str, /, **params: Any) -> Message:
    """Return a message; ``code`` and ``template`` must be literals.

    Examples
    --------
    >>> found = message("data.points-selected", "{count} of {total} points", count=3, total=40)
    >>> str(found), found.code, found.params["count"]
    ('3 of 40 points', 'data.points-selected', 3)
    """
    return Message(code, template, _kept(params))


def plural_message(code: str, singular: str, plural: str, /, *, count: int, **params: Any) -> Message:
    """Return a message with a singular and a plural, selected by ``count``, which is a parameter of both templates.

    Examples
    --------
    >>> [str(plural_message("data.points-given", "{count} point", "{count} points", count=n)) for n in (1, 2)]
    ['1 point', '2 points']
    """
    return Message(code, singular, {"count": count, **_kept(params)}, plural)


def some_of(names: Sequence[str], most: int) -> tuple[str | Message, ...]:
    """Return names for a sentence: the first ``most``, and how many more there are.

    Examples
    --------
    >>> str(message("data.listed", "{names}", names=some_of(["T1", "T2", "T3", "T4"], 2)))
    'T1, T2 and 2 more'
    """
    if len(names) <= most:
        return tuple(names)
    more = message(
        "data.names-and-more", "{names} and {count} more", names=tuple(names[:most]), count=len(names) - most
    )
    return (more,)


def gravest_first(messages: Iterable[Message]) -> tuple[Message, ...]:
    """Return messages by severity: errors, warnings, information; equally grave ones in their order."""
    return tuple(sorted(messages, key=lambda one: _GRAVEST_FIRST.index(one.severity)))


def render(value: Any, catalogue: NullTranslations) -> Any:
    """Return a message, a term or a tuple of them as text of a catalogue; any other value unchanged."""
    if isinstance(value, Message):
        if not value.template:
            return ""
        if value.plural is None:
            template = catalogue.gettext(value.template)
        else:
            template = catalogue.ngettext(value.template, value.plural, int(value.params["count"]))
        # A text without parameters may show braces, as of a TOML table.
        fields = {name: _counted(name, render(param, catalogue)) for name, param in value.params.items()}
        if not fields:
            return template
        if not any(own in template for own in _OWN_FORMATS):
            with suppress(OverflowError, TypeError, ValueError):
                return template.format(**fields)
        return _FORMATTER.vformat(template, (), fields)
    if isinstance(value, tuple) and value and all(isinstance(item, (Message, str)) for item in value):
        return _joined([str(render(item, catalogue)) for item in value], catalogue)
    if isinstance(value, str):
        return catalogue.gettext(value) if value in TERMS and not isinstance(value, Untranslated) else str(value)
    return _Negative(value) if isinstance(value, float) and value < 0 else value


class _Negative(float):
    """A negative number: with a format it gets a minus sign; without one it stays as the user wrote it."""

    def __format__(self, spec: str) -> str:
        text = super().__format__(spec)
        return text.replace("-", "−", 1) if spec else text


def _counted(name: str, value: Any) -> Any:
    """Return a whole number as one that is written in groups, unless it names something; other values as they are."""
    if name in NAMING or isinstance(value, bool) or not isinstance(value, Integral):
        return value
    return _Counted(value)


class _Counted(int):
    """A whole number that is written in groups of three from five digits on; with a format it is as that says."""

    def __format__(self, spec: str) -> str:
        text = super().__format__(spec)
        return text if spec else in_groups(text)


class _Formatter(Formatter):
    """``str.format`` that knows two more formats.

    ``{sigma:length}`` has the digits that :func:`rounded_metres` chooses, ``{area:whole}`` none after the point, in
    groups.
    What a format does not fit (a word where a number was due) is shown as it was given.
    """

    def format_field(self, value: Any, format_spec: str) -> str:
        if format_spec == "length":
            return rounded_metres(value)
        try:
            if format_spec == "whole":
                return in_groups(str(super().format_field(value, ".0f")))
            text = str(super().format_field(value, format_spec))
            # A few significant digits of a large number need no power of ten: "260 m", not "2.6e+02 m".
            if format_spec != "g" and format_spec.endswith("g") and _POWER.fullmatch(text):
                sign, size = ("−", text[1:]) if value < 0 else ("", text)
                return in_groups(f"{sign}{float(size):.0f}")
            return text
        except (OverflowError, TypeError, ValueError):
            return folded(repr(value))


#: What ".2g" makes of a number with up to nine digits before the point.
_POWER = re.compile(r"[-−]?\d(?:\.\d+)?e\+0[1-8]")
_OWN_FORMATS = (":length}", ":whole}", "g}")
_FORMATTER = _Formatter()


def _joined(texts: list[str], catalogue: NullTranslations) -> str:
    """Return texts as a list with the commas of a language."""
    template = catalogue.gettext(_ITEMS)
    text = texts[0] if texts else ""
    for item in texts[1:]:
        text = template.format(first=text, second=item)
    return text


def folded(text: str, most: int = 200) -> str:
    """Return a text of any length as one that a person can read: its beginning, and how long it is.

    Examples
    --------
    >>> folded("short"), folded("9" * 20_000_000, 5)
    ('short', '99999… (20000000 characters)')
    """
    return text if len(text) <= most else f"{text[:most]}… ({len(text)} characters)"


def _kept(params: dict[str, Any]) -> dict[str, Any]:
    """Return parameters that can be stored and sent: errors become their messages."""
    kept = {}
    for name, value in params.items():
        if isinstance(value, BaseException):
            own = getattr(value, "message", None)
            value = own if isinstance(own, Message) else str(value)
        kept[name] = value
    return kept
