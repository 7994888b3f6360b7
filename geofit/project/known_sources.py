"""What is known of the sources of bodies now: the data in their files, and the surfaces that bodies lie between."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from geofit.project.body_record import (
    BetweenHorizons,
    BodyProvenance,
    BodyRecord,
    BodySource,
    ClosedMesh,
    Intervals,
    MorphFrame,
    Outlines,
    SurfacePicks,
)
from geofit.project.horizon_edits import renamed_body, renamed_provenance, renamed_source
from geofit.project.provenance import Provenance

__all__ = ["FileSource", "KnownSources", "file_sources"]

FileSource = Intervals | Outlines | SurfacePicks | ClosedMesh


class KnownSources:
    """A record of what was read or made last; whether a body is stale is decided by comparing with it."""

    def __init__(self) -> None:
        self._held: dict[BodySource, str] = {}
        self._surfaces: dict[BodyProvenance, Mapping[str, Provenance]] = {}

    def clear(self) -> None:
        """Forget everything."""
        self._held.clear()
        self._surfaces.clear()

    def read(self, source: BodySource, given: str) -> None:
        """Keep the hash of the data that a source holds now; empty: they cannot be read."""
        self._held[source] = given

    def made(self, body: BodyProvenance, horizons: Mapping[str, Provenance]) -> None:
        """Keep what a body was just made from: the data of its source, or the surfaces that it lies between."""
        if isinstance(body.source, BetweenHorizons):
            self._surfaces[body] = horizons
        else:
            self.read(body.source, body.given)

    def rename(self, old: str, new: str) -> None:
        """Call a horizon by its new name, too."""
        self._held |= {renamed_source(source, old, new): given for source, given in self._held.items()}
        self._surfaces |= {
            renamed_body(body, old, new): {
                new if name == old else name: renamed_provenance(one, old, new) for name, one in horizons.items()
            }
            for body, horizons in self._surfaces.items()
        }

    def carry(self, provenances: Mapping[Provenance, Provenance]) -> None:
        """Hear that surfaces are the same under other provenances."""
        for body, horizons in self._surfaces.items():
            self._surfaces[body] = {name: provenances.get(one, one) for name, one in horizons.items()}

    def held(self, source: BodySource) -> str | None:
        """Return the hash of the data that a source held when it was read last; None if it was not."""
        return self._held.get(source)

    def surfaces(self, body: BodyProvenance) -> Mapping[str, Provenance] | None:
        """Return from what the horizons were made between which a body was closed; None if that is not known."""
        return self._surfaces.get(body)

    def closed(self, source: BodySource) -> Iterator[tuple[str, Mapping[str, Provenance]]]:
        """Return the hashes of all bodies that were made of a source between horizons, each with those horizons."""
        return ((body.given, horizons) for body, horizons in self._surfaces.items() if body.source == source)


def file_sources(records: Iterable[BodyRecord]) -> dict[FileSource, None]:
    """Return the sources of bodies that are files of their own, each once; those of a metamorphosis included."""
    found: dict[FileSource, None] = {}
    waiting = [record.provenance for record in records]
    while waiting:
        source = waiting.pop(0).source
        if isinstance(source, MorphFrame):
            waiting += source.ends
        elif isinstance(source, FileSource) and source.file:
            found[source] = None
    return found
