"""What the parsers of text, TOML and JSON say is wrong, split so that it can be translated."""

from __future__ import annotations

import json
import re

from geofit.data.messages import Message, message

__all__ = ["parser_message"]


def parser_message(error: Exception) -> tuple[Message | str, int | None]:
    """Return what a parser says is wrong, and the line of the file where it reports it."""
    if isinstance(error, UnicodeDecodeError):
        return message("io.byte-not-a-character", "byte {place} belongs to no character", place=error.start + 1), None
    if isinstance(error, json.JSONDecodeError):
        return error.msg, error.lineno
    what, place = re.fullmatch(r"(.*?)(?: \(at (.*)\))?", str(error), re.DOTALL).groups()  # type: ignore[union-attr]
    line = re.match(r"line (\d+)", place or "")
    return what, int(line[1]) if line else None
