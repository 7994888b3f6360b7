"""The contact of a [[horizon]] table: its codes, which limit, which bed, and what is too thin to count."""

from __future__ import annotations

from typing import Any, Literal

from geofit.data.errors import SettingsError
from geofit.data.messages import Message, message
from geofit.io.contact_rules import ContactRule, Limit
from geofit.io.site_keys import Reader

__all__ = ["read_rule"]


def read_rule(reader: Reader, table: dict[str, Any], where: Message) -> ContactRule | None:
    """Return the contact that a [[horizon]] table states; None where it names no code.

    Raises
    ------
    InputError
        If both limits are given, a value is of the wrong kind, or a key has no contact to belong to.
    """
    stated = [key for key in ("top", "base") if key in table]
    if len(stated) > 1:
        raise reader.fail(
            message("io.top-and-base", "{where} has both top and base", where=where),
            message("io.keep-one-limit", "Keep the one that is this horizon."),
            "base",
        )
    occurrence = reader.get(table, "occurrence", str, where)
    if occurrence not in (None, "first", "last"):
        raise reader.fail(
            message("io.occurrence-unknown", "{where}: the choice between several beds is not valid", where=where),
            message("io.write-occurrence", 'Write "first" or "last", counted from the collar down.'),
            "occurrence",
            occurrence,
        )
    thinner = reader.get(table, "thinner", float, where)
    if not stated:
        for key in ("occurrence", "thinner"):
            if key in table:
                raise reader.fail(
                    message("io.rule-without-code", "{where} states neither top nor base", where=where),
                    message("io.write-top-or-base", "Write top or base, or leave this key out."),
                    key,
                )
        return None
    value, limit = table[stated[0]], stated[0]
    codes = value if isinstance(value, list) else [reader.get(table, limit, str, where)]
    if not codes or not all(isinstance(code, str) and code for code in codes):
        raise reader.fail(
            message("io.codes-not-text", "{where}: the codes are not text", where=where),
            message("io.write-codes", 'Write base = "T2", or base = ["T2", "T2a"] for codes that count as one.'),
            limit,
        )
    chosen: Limit = "top" if limit == "top" else "base"
    which: Literal["first", "last"] | None = "first" if occurrence == "first" else "last" if occurrence else None
    try:
        return ContactRule(tuple(codes), chosen, which, thinner or 0.0)
    except SettingsError as error:
        raise reader.fail(
            message("io.key-and-error", "{where}: {error}", where=where, error=error),
            message("io.correct-site-file", "Correct it in the site file."),
            "thinner",
        ) from None
