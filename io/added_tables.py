"""Tables that are added to those of a site file: new files of a site that is open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.io.toml_file import parse_toml
from geofit.io.toml_text import toml_value

__all__ = ["tables_text", "with_tables"]

#: What a site has once: a second one has no place.
SINGLE = ("boundary", "ground", "adits")
#: Tables of a site file in order: each with its head, "[boundary]" or "[[picks]]".
Tables = Iterable[tuple[str, Mapping[str, Any]]]


def tables_text(tables: Tables) -> str:
    """Return tables as TOML, as a site file holds them."""
    lines = []
    for head, table in tables:
        lines += [head, *(f"{key} = {toml_value(value)}" for key, value in table.items()), ""]
    return "\n".join(lines)


def with_tables(site_file: bytes, added: Iterable[str], file: str) -> dict[str, Any]:
    """Return what a site file holds with more tables after its own.

    Parameters
    ----------
    site_file : bytes
        The site file.
    added : iterable of str
        Texts of :func:`tables_text`.
    file : str
        Name of the site file, for errors.

    Raises
    ------
    InputError
        If the file or a text is not valid TOML, or a text adds a second one of what a site has once.
    """
    see = message("io.see-site-file-page", "See docs/site_file.md.")
    merged = parse_toml(site_file, file, see)
    for text in added:
        tables = parse_toml(text.encode(), file, see)
        for key, value in tables.items():
            if key in SINGLE and key in merged:
                raise InputError(
                    message("io.key-taken", "The site has {key} already", key=Untranslated(key)),
                    message("io.replace-file-and-reload", "Replace its file, and reload the site."),
                    file=file,
                )
            if key in SINGLE:
                merged[key] = value
            else:
                merged[key] = [*_listed(merged.get(key, [])), *_listed(value)]
    return merged


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]
