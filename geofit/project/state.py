"""Everything of a document that commands change: one frozen value, so that undoing is going back to the former one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.project.body_record import BodyRecord
from geofit.project.horizon_edits import HorizonEdit, as_read, shaped
from geofit.project.provenance import Corners, Earlier, Part, Provenance, Row, corners_from, data_digest, settings_from

__all__ = ["State"]


@dataclass(frozen=True)
class State:
    """The work on a site.

    ``name`` of the site; ``order`` of the horizons, the highest first; ``settings``, ``excluded`` rows and the
    ``provenances`` of the surfaces by horizon. ``parts`` names the blocks that are in the place of horizons that faults
    cut: each is a horizon like the others. ``data`` names the data of the site, ``added`` holds the tables of files
    that its site file does not name, as TOML; ``earlier`` is from what surfaces were made before the data changed,
    ``area`` the study area if one was drawn, ``horizons`` which of them were renamed, removed and merged. ``bodies``
    are closed bodies by their names.
    """

    name: str = ""
    order: tuple[str, ...] = ()
    settings: Mapping[str, FitSettings] = field(default_factory=dict)
    excluded: Mapping[str, frozenset[Row]] = field(default_factory=dict)
    provenances: Mapping[str, Provenance] = field(default_factory=dict)
    parts: Mapping[str, Part] = field(default_factory=dict)
    data: str = ""
    added: tuple[str, ...] = ()
    earlier: Mapping[str, Earlier] = field(default_factory=dict)
    area: Corners | None = None
    horizons: tuple[HorizonEdit, ...] = ()
    bodies: Mapping[str, BodyRecord] = field(default_factory=dict)

    def shaped(self, site: Site) -> Site:
        """Return a site that was read as it is worked on: with the study area and the horizons of this state."""
        return shaped(site, self.area, self.horizons)

    def as_read(self, site: Site) -> Site:
        """Return a shaped site whose dips name horizons as its files do: what fingerprints are of."""
        return as_read(site, self.horizons)

    @classmethod
    def of_site(cls, site: Site) -> State:
        """Return the work on a site that nobody has begun."""
        settings = {name: site.settings.get(name, FitSettings()) for name in site.horizons}
        return cls(site.name, _highest_first(site), settings, data=data_digest(site))

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        data: dict[str, Any] = {
            "name": self.name,
            "order": list(self.order),
            "settings": {name: asdict(settings) for name, settings in self.settings.items()},
            "excluded": {name: [asdict(row) for row in sorted(rows)] for name, rows in self.excluded.items()},
            "provenances": {name: provenance.to_data() for name, provenance in self.provenances.items()},
            "parts": {name: part.to_data() for name, part in self.parts.items()},
            "data": self.data,
            "added": list(self.added),
            "area": None if self.area is None else [list(corner) for corner in self.area],
            "horizons": [one.to_data() for one in self.horizons],
            "earlier": {name: one.to_data() for name, one in self.earlier.items()},
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
            data.get("data", ""),
            tuple(data.get("added", ())),
            {name: Earlier.from_data(one) for name, one in data.get("earlier", {}).items()},
            corners_from(data.get("area")),
            tuple(HorizonEdit.from_data(one) for one in data.get("horizons", ())),
            {name: BodyRecord.from_data(record) for name, record in data.get("bodies", {}).items()},
        )


def _highest_first(site: Site) -> tuple[str, ...]:
    """Return the horizons in the order of the files; those of the stated order change places among themselves."""
    stated = iter([name for name in site.order if name in site.horizons])
    return tuple(next(stated) if name in site.order else name for name in site.horizons)
