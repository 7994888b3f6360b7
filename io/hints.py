"""What a person may have meant: the remedy for a name that is not known."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from geofit.data.messages import Message, Untranslated, message

__all__ = ["nearest_name"]


def nearest_name(wanted: str, known: Iterable[str], all_of_them: Message, cutoff: float = 0.6) -> Message:
    """Return a remedy: the nearest of the known names where one comes near, then the sentence that names them all."""
    near = get_close_matches(wanted, list(known), 1, cutoff)
    if not near:
        return all_of_them
    return message(
        "io.column-pair",
        "{first} {second}",
        first=message("io.did-you-mean", "Did you mean '{name}'?", name=Untranslated(near[0])),
        second=all_of_them,
    )
