"""``[report]`` of a site file: what the cover of the report says."""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from geofit.data.messages import message
from geofit.data.title_block import Revision, TitleBlock

if TYPE_CHECKING:
    from geofit.io.site_keys import Reader

__all__ = ["read_title_block"]

_WORDS = tuple(f.name for f in fields(TitleBlock) if f.name != "revisions")
_REVISION = tuple(f.name for f in fields(Revision))


def read_title_block(reader: Reader, top: Mapping[str, Any]) -> TitleBlock:
    """Return what ``[report]`` and ``[[report.revision]]`` state; an empty block where they are absent.

    Raises
    ------
    InputError
        If a key is unknown, or a value is not a text.
    """
    table = reader.get(top, "report", dict, "the site file") or {}
    where = "[report]"
    reader.keys(table, (*_WORDS, "revision"), where)
    words = {key: _text(reader, table, key, where) for key in _WORDS if key in table}
    return TitleBlock(**words, revisions=tuple(_revision(reader, row) for row in reader.tables(table, "revision")))


def _revision(reader: Reader, row: Mapping[str, Any]) -> Revision:
    where = "[[report.revision]]"
    reader.keys(row, _REVISION, where)
    reader.need(row, "mark", object, where, message("io.write-mark", 'Write mark = "A".'))
    return Revision(**{key: _text(reader, row, key, where) for key in _REVISION if key in row})


def _text(reader: Reader, table: Mapping[str, Any], key: str, where: str) -> str:
    """Return a text; a TOML date becomes ISO 8601, a number its digits."""
    value = table[key]
    if isinstance(value, datetime.date):
        return value.isoformat()[:10]
    if isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    return str(reader.get(table, key, str, where)).strip()
