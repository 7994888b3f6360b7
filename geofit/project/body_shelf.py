"""Bodies that are available, by the provenance that they were made from; old ones that nobody shows go first."""

from __future__ import annotations

from collections.abc import Collection

from geofit.project.body_building import BodyResult
from geofit.project.body_record import BodyProvenance

__all__ = ["BodyShelf"]

#: Bodies kept beyond those on show, for undoing at once.
SPARE = 12


class BodyShelf:
    """A store with a bound: what a provenance makes can always be made again."""

    def __init__(self) -> None:
        self._results: dict[BodyProvenance, BodyResult] = {}

    def __len__(self) -> int:
        return len(self._results)

    def clear(self) -> None:
        """Forget everything."""
        self._results.clear()

    def put(self, provenance: BodyProvenance, result: BodyResult, shown: Collection[BodyProvenance]) -> None:
        """Keep the body of a provenance; forget the oldest of those that are not shown."""
        self._results.pop(provenance, None)
        self._results[provenance] = result
        spare = [one for one in self._results if one not in shown and one != provenance]
        for old in spare[: max(len(spare) - SPARE, 0)]:
            del self._results[old]

    def get(self, provenance: BodyProvenance) -> BodyResult | None:
        """Return the body of a provenance, None if it is not available."""
        return self._results.get(provenance)
