"""Surfaces that are available, by the provenance that they were made from; old ones that nobody shows go first."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from geofit.data.prediction import PredictionResult
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.horizon_edits import renamed_provenance
from geofit.project.provenance import Provenance

__all__ = ["Shelf"]

#: Surfaces kept beyond those on show, for undoing at once, and the data points that they may have together.
SPARE, SPARE_POINTS = 24, 1_000_000


@dataclass(frozen=True, eq=False)
class _Result:
    surface: HorizonFit
    prediction: PredictionResult | None = None


class Shelf:
    """A store of results with a bound: what a provenance makes can always be made again."""

    def __init__(self) -> None:
        self._results: dict[Provenance, _Result] = {}

    def __len__(self) -> int:
        return len(self._results)

    def clear(self) -> None:
        """Forget everything."""
        self._results.clear()

    def put(self, provenance: Provenance, surface: HorizonFit, shown: Collection[Provenance]) -> None:
        """Keep the surface of a provenance; forget the oldest of those that are not shown."""
        former = self._results.pop(provenance, None)
        named = _named(surface, provenance.horizon)
        self._results[provenance] = _Result(named, None if former is None else former.prediction)
        spare = [one for one in self._results if one not in shown and one != provenance]
        while spare and (
            len(spare) > SPARE or sum(len(self._results[one].surface.points) for one in spare) > SPARE_POINTS
        ):
            del self._results[spare.pop(0)]

    def carry(self, former: Provenance, now: Provenance, surface: HorizonFit) -> None:
        """Keep a surface under another provenance, too, with what is known of it."""
        self._results.pop(now, None)
        self._results[now] = replace(self._results[former], surface=surface)

    def rename(self, old: str, new: str) -> None:
        """Call a horizon by its new name; what another one of that name had left is forgotten."""
        self._results = {
            renamed: replace(one, surface=_named(one.surface, renamed.horizon))
            for provenance, one in self._results.items()
            if provenance.horizon != new
            for renamed in (renamed_provenance(provenance, old, new),)
        }

    def surface(self, provenance: Provenance | None) -> HorizonFit | None:
        """Return the surface of a provenance, None if it is not available."""
        found = None if provenance is None else self._results.get(provenance)
        return None if found is None else found.surface

    def fits_of(self, horizon: str) -> tuple[Provenance, ...]:
        """Return what the surfaces of a horizon that are available were made from, the oldest first."""
        return tuple(one for one in self._results if one.horizon == horizon)

    def examined(self, provenance: Provenance, prediction: PredictionResult) -> None:
        """Keep what was found out about the surface away from its data."""
        if provenance in self._results:
            self._results[provenance] = replace(self._results[provenance], prediction=prediction)

    def prediction(self, provenance: Provenance | None) -> PredictionResult | None:
        """Return what is known about a surface away from its data, None if nobody looked."""
        found = None if provenance is None else self._results.get(provenance)
        return None if found is None else found.prediction


def _named(surface: HorizonFit, name: str) -> HorizonFit:
    return surface if surface.name == name else surface.with_(name=name)
