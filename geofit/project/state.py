"""Everything of a document that commands change: one frozen value, so that undoing is going back to the former one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.project.body_record import BodyRecord
from geofit.project.provenance import Part, Provenance, Row, settings_from

__all__ = ["State"]


@dataclass(frozen=True)
class State:
    """The work on a site.

    ``name`` of the site; ``order`` of the horizons, the highest first; ``settings``, ``excluded`` rows and the
    ``provenances`` of the surfaces by horizon. ``parts`` names the blocks that are in the place of horizons that faults
    cut: each is a horizon like the others. ``bodies`` are closed bodies by their names.
    """

    name: str = ""
    order: tuple[str, ...] = ()
    settings: Mapping[str, FitSettings] = field(default_factory=dict)
    excluded: Mapping[str, frozenset[Row]] = field(default_factory=dict)
    provenances: Mapping[str, Provenance] = field(default_factory=dict)
    parts: Mapping[str, Part] = field(default_factory=dict)
    bodies: Mapping[str, BodyRecord] = field(default_factory=dict)

    @classmethod
    def of_site(cls, site: Site) -> State:
        """Return the work on a site that nobody has begun."""
        settings = {name: site.settings.get(name, FitSettings()) for name in site.horizons}
        return cls(site.name, tuple(site.horizons), settings)

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        data: dict[str, Any] = {
            "name": self.name,
            "order": list(self.order),
            "settings": {name: asdict(settings) for name, settings in self.settings.items()},
            "excluded": {name: [asdict(row) for row in sorted(rows)] for name, rows in self.excluded.items()},
            "provenances": {name: provenance.to_data() for name, provenance in self.provenances.items()},
            "parts": {name: part.to_data() for name, part in self.parts.items()},
        }
        if self.bodies:
            data["bodies"] = {name: record.to_data() for name, record in self.bodies.items()}
        return data

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> State:
        """Return what :meth:`to_data` was called on."""
        return cls(
            data["name"],
            tuple(data["order"]),
            {name: settings_from(settings) for name, settings in data["settings"].items()},
            {name: frozenset(Row(**row) for row in rows) for name, rows in data["excluded"].items()},
            {name: Provenance.from_data(provenance) for name, provenance in data["provenances"].items()},
            {name: Part.from_data(part) for name, part in data.get("parts", {}).items()},
            {name: BodyRecord.from_data(record) for name, record in data.get("bodies", {}).items()},
        )
