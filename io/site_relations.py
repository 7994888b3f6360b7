"""What a site file says of the whole site: the order of the strata, what each fault cuts, the project datum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from geofit.data.columns import LARGEST
from geofit.data.messages import Untranslated, message
from geofit.data.numbers import is_finite
from geofit.io.hints import nearest_name
from geofit.io.site_keys import Reader

__all__ = ["read_datum", "read_relations"]


def read_datum(reader: Reader, label: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """Return the project datum under ``[site]``: easting, northing, elevation, metres; None if there is none."""
    datum = reader.get(label, "datum", list, "[site]")
    if datum is None:
        return None
    if len(datum) != 3 or not all(is_finite(value) and abs(value) <= LARGEST for value in datum):
        raise reader.fail(
            message("io.datum-unusable", "The project datum is not three numbers"),
            message("io.write-datum", "Write easting, northing and elevation in metres: datum = [500000, 3100000, 0]."),
            "datum",
            datum,
        )
    return float(datum[0]), float(datum[1]), float(datum[2])


def read_relations(
    reader: Reader, top: Mapping[str, Any], label: Mapping[str, Any], horizons: list[str]
) -> tuple[tuple[str, ...], dict[str, tuple[str, ...]]]:
    """Return the order of strata, and which horizons each fault cuts."""
    order = _named(reader, label, "order", "[site]", horizons)
    table = reader.get(top, "faults", dict, "the site file") or {}
    _named(reader, {"faults": list(table)}, "faults", "the site file", horizons)
    faults = {fault: _named(reader, table, fault, "[faults]", horizons) for fault in table}
    for fault, cut in faults.items():
        if fault in cut:
            raise reader.fail(
                message("io.fault-cuts-itself", "The fault '{fault}' is listed as cutting itself", fault=fault),
                message("io.name-horizons-cuts", "Name the horizons that it cuts."),
                fault,
            )
        if fault in order:
            raise reader.fail(
                message(
                    "io.fault-in-order",
                    "The fault '{fault}' is listed in the order of strata",
                    fault=fault,
                ),
                message("io.take-out-of-order", "Remove it from the order."),
                "order",
            )
    return order, faults


def _named(reader: Reader, table: Mapping[str, Any], key: str, where: str, horizons: list[str]) -> tuple[str, ...]:
    """Return the list of horizons under a key; each must be known, and stand once."""
    names = reader.get(table, key, list, where) or []
    for name in names:
        if name not in horizons:
            raise reader.fail(
                message(
                    "io.key-names-unknown-horizon",
                    "{key} in {where} names '{name}', which is not a horizon",
                    key=Untranslated(key),
                    where=where,
                    name=name,
                ),
                nearest_name(
                    str(name),
                    horizons,
                    message("data.known-horizons", "The horizons are: {names}.", names=", ".join(horizons)),
                ),
                key,
                name,
            )
        if names.count(name) > 1:
            raise reader.fail(
                message(
                    "io.key-names-horizon-twice",
                    "{key} in {where} names '{name}' twice",
                    key=Untranslated(key),
                    where=where,
                    name=name,
                ),
                message("io.name-horizon-once", "Name each horizon once."),
                key,
            )
    return tuple(names)
