"""Names as text that can be written: on Linux the bytes of a file's name need not be UTF-8."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TypeVar

__all__ = ["latin_letters", "legible", "legible_keys"]

T = TypeVar("T")

#: Lower case of the Cyrillic capitals that look like Latin ones, and these. Greek letters have a meaning in codes.
_LOOK_ALIKE = str.maketrans("авекмнорстухіјѕ", "abekmhopctyxijs")


def legible(name: str) -> str:
    r"""Return the name of a file as text that can be printed and written.

    On Linux the bytes of a name need not be UTF-8: archives from Windows bring names in GBK. Bytes that are not
    a character remain as their code, so that names that differ stay different: two holes are never one.

    Examples
    --------
    >>> legible("picks.csv"), legible(os.fsdecode("钻孔".encode("gbk")))
    ('picks.csv', '钻孔')
    >>> legible("ZK\ud800") == legible("ZK\ud801")
    False
    """
    if name.isascii():
        return name
    try:
        name.encode()
    except UnicodeEncodeError:
        try:
            return os.fsencode(name).decode("gb18030", "backslashreplace")
        except UnicodeEncodeError:  # a name that no file can have
            return name.encode("utf-8", "backslashreplace").decode()
    return name


def latin_letters(text: str) -> str:
    """Return lower case in which Cyrillic letters whose capitals look like Latin ones are these.

    A code that is typed on two keyboards looks the same in a table, and is two.

    Examples
    --------
    >>> latin_letters("Т2") == latin_letters("T2"), latin_letters("ZК-07"), latin_letters("глина")
    (True, 'zk-07', 'глиha')
    """
    folded = text.casefold()
    return folded if folded.isascii() else folded.translate(_LOOK_ALIKE)


def legible_keys(named: Mapping[str, T]) -> Mapping[str, T]:
    r"""Return what is given under legible names, in order; one that is taken already gets a number.

    Examples
    --------
    >>> legible_keys({"钻孔": 1, os.fsdecode("钻孔".encode("gbk")): 2})
    {'钻孔': 1, '钻孔 (2)': 2}
    """
    if all(legible(name) == name for name in named):
        return named
    taken = {name for name in named if legible(name) == name}
    result: dict[str, T] = {}
    for name, value in named.items():
        own = unlike = legible(name)
        turn = 2
        while own != name and unlike in taken:
            unlike, turn = f"{own} ({turn})", turn + 1
        taken.add(unlike)
        result[unlike] = value
    return result
