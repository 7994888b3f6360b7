"""What the parsers of text, TOML and JSON report is wrong, in words for the reader of the file."""

from __future__ import annotations

import json
import re

from geofit.data.messages import Message, Untranslated, message

__all__ = ["parser_message"]


def parser_message(error: Exception) -> tuple[Message | str, int | None]:
    """Return what a parser says is wrong, and the line of the file where it reports it."""
    if isinstance(error, UnicodeDecodeError):
        return message("io.byte-not-a-character", "byte {place} belongs to no character", place=error.start + 1), None
    if isinstance(error, json.JSONDecodeError):
        return message(
            "io.json-breaks-off", "it is not JSON from character {number} on", number=error.colno
        ), error.lineno
    if isinstance(error, KeyError):
        return message("io.key-missing", "it has no '{key}'", key=Untranslated(error.args[0])), None
    if isinstance(error, (RecursionError, TypeError, AttributeError, OverflowError)):
        return message("io.value-of-other-type", "a value in it is not of the type that is needed"), None
    what, place = re.fullmatch(r"(.*?)(?: \(at (.*)\))?", str(error), re.DOTALL).groups()  # type: ignore[union-attr]
    line = re.match(r"line (\d+)", place or "")
    return what, int(line[1]) if line else None
