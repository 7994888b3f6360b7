"""The tables of a site file, from files that were sorted by what they hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from geofit.io.columns import SCHEMAS
from geofit.io.import_plan import ImportPlan, TablePart, campaigns

__all__ = ["Tables", "site_tables"]

#: The tables of a site file in order: each with its head, "[site]" or "[[picks]]".
Tables = list[tuple[str, dict[str, Any]]]
#: Keys of a mapping that a table of a site file may state itself.
_STATED = ("encoding", "sep", "decimal", "unit", "measure", "crs")


def site_tables(
    plan: ImportPlan,
    label: Mapping[str, Any],
    horizons: Sequence[Mapping[str, Any]],
    *,
    boreholes: bool = True,
    stated: bool = False,
) -> Tables:
    """Return the tables of a site file, each with its head.

    ``label`` is its [site] table; without one there is none. ``stated``: each table says itself how it is read, because
    no mapping file does.
    """

    def as_value(part: TablePart) -> str | dict[str, Any]:
        keys = as_keys(part)
        return part.name if list(keys) == ["file"] else keys

    def as_keys(part: TablePart) -> dict[str, Any]:
        return _as_read(part) if stated else _named(part)

    blocks: Tables = [("[site]", dict(label))] if label else []
    for key in ("boundary", "ground"):
        blocks += [(f"[{key}]", as_keys(part)) for part in plan.of(key)[:1]]
    if boreholes:
        for collar, survey, intervals in campaigns(plan):
            table: dict[str, Any] = {"collar": as_value(collar)}
            if survey:
                table["survey"] = as_value(survey)
            if intervals:
                table["intervals"] = [as_value(part) for part in intervals]
            blocks.append(("[[boreholes]]", table))
    for part in plan.of("adit path")[:1]:
        table = {"path": as_value(part)}
        if contacts := plan.of("adit contacts"):
            table["contacts"] = as_value(contacts[0])
        blocks.append(("[adits]", table))
    blocks += [("[[section_lines]]", as_keys(part)) for part in plan.of("section lines")]
    for part in (*plan.of("section"), *plan.of("drawing")):
        blocks.append(("[[section]]", {"name": part.section, **as_keys(part)}))
    blocks += [("[[sections]]", as_keys(part)) for part in plan.of("sections")]
    blocks += [("[[traces]]", as_keys(part)) for part in plan.of("traces")]
    for part in plan.of("picks"):
        alone = "horizon" not in part.mapping.columns
        blocks.append(("[[picks]]", {**as_keys(part), **({"horizon": part.source.path.stem} if alone else {})}))
    blocks += [("[[horizon_columns]]", as_keys(part)) for part in plan.of("horizon columns")]
    blocks += [("[[grids]]", {**as_keys(part), "horizon": part.source.path.stem}) for part in plan.of("grid")]
    blocks += [("[[orientations]]", as_keys(part)) for part in plan.of("orientations")]
    blocks += [("[[horizon]]", dict(table)) for table in horizons]
    return blocks


def _named(part: TablePart) -> dict[str, Any]:
    """Return a part as keys of its own table; a grid or drawing, of which no mapping is written, with its unit."""
    keys = {"file": part.name, **({"table": part.preview.table} if part.preview.table else {})}
    if part.mapping.unit and part.preview.kind not in SCHEMAS:
        keys["unit"] = part.mapping.unit
    return keys


def _as_read(part: TablePart) -> dict[str, Any]:
    """Return a part as keys of its own table, with what its mapping states."""
    keys = {**_named(part), **{key: value for key in _STATED if (value := getattr(part.mapping, key)) is not None}}
    if part.mapping.horizons:
        keys["horizons"] = list(part.mapping.horizons)
    return {**keys, **({"columns": dict(part.mapping.columns)} if part.mapping.columns else {})}
