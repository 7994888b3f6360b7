"""What is left in English of a text that is shown in Chinese."""

from __future__ import annotations

import re

from geofit.data.languages import ZH, translate

__all__ = ["english_left"]

#: Keys, file names and code: quoted, in brackets, or with a sign that prose does not have.
_TOKENS = re.compile(r"“[^”]*”|\[\[?\w+\]?\]|\{[^}]*\}|\S*[=_./]\S*")


def english_left(text: object) -> list[str]:
    """Return runs of two and more words with small letters, which Chinese readers would meet."""
    return re.findall(
        r"\b\w*[a-z]{2}[\w']*(?: [\w']*[a-z]{2}[\w']*)+", _TOKENS.sub("，", translate(text, ZH)), re.ASCII
    )
