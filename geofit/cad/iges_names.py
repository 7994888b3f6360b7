"""Names of horizons in IGES, which knows ASCII only: as near to the real ones as that allows, no two alike."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

__all__ = ["iges_labels", "iges_names"]

#: What a horizon is called of whose name no character is left.
NAMELESS = "HORIZON"
#: Characters of an entity's label.
LABEL = 8


def iges_names(names: Iterable[str]) -> dict[str, str]:
    """Return the name of each horizon in an IGES file.

    Letters lose their accents, every other run of characters that is not ASCII becomes ``_``; what would be the name of
    another horizon gets a number.

    Examples
    --------
    >>> iges_names(["T2 top", "Höhe", "强风化", "中风化", "T2 上", "T2"])
    {'T2 top': 'T2 top', 'Höhe': 'Hohe', '强风化': 'HORIZON', '中风化': 'HORIZON-2', 'T2 上': 'T2-2', 'T2': 'T2'}
    """
    plain = {name: _ascii(name) or NAMELESS for name in names}
    # A name that is ASCII already stays.
    taken = {name for name, own in plain.items() if own == name}
    for name, own in plain.items():
        if own != name:
            plain[name] = _unlike(own, taken)
            taken.add(plain[name])
    return plain


def iges_labels(names: Iterable[str]) -> dict[str, str]:
    """Return the label of each horizon's faces: eight characters at most, no two horizons alike.

    Examples
    --------
    >>> list(iges_labels(["T1 top", "Weathered top", "Weathered base", "强风化", "中风化"]).values())
    ['T1_top', 'Weathere', 'Weathe-2', 'HORIZON', 'HORIZO-2']
    """
    labels: dict[str, str] = {}
    for name in names:
        short = re.sub(r"[^A-Za-z0-9_-]+", "_", _ascii(name))[:LABEL].strip("_") or NAMELESS
        labels[name] = _unlike(short, set(labels.values()), LABEL)
    return labels


def _ascii(name: str) -> str:
    letters = (letter for letter in unicodedata.normalize("NFKD", name) if not unicodedata.combining(letter))
    return re.sub(r"[^ -~]+", "_", "".join(letters)).strip("_ ")


def _unlike(name: str, taken: set[str], longest: int | None = None) -> str:
    """Return a name that is not taken, with a number if need be, at most so long."""
    unique, turn = name, 2
    while unique in taken:
        number = f"-{turn}"
        unique = (name if longest is None else name[: longest - len(number)]) + number
        turn += 1
    return unique
