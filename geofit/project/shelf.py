"""Surfaces that are at hand, by the recipe that they were made from; old ones that nobody shows go first."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from geofit.data.prediction import OffData
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.provenance import Recipe

__all__ = ["Shelf"]

#: Surfaces kept beyond those on show, for undoing at once, and the data points that they may have together.
SPARE, SPARE_POINTS = 24, 1_000_000


@dataclass(frozen=True, eq=False)
class _Result:
    surface: HorizonFit
    offdata: OffData | None = None


class Shelf:
    """A store of results with a bound: what a recipe makes can always be made again."""

    def __init__(self) -> None:
        self._results: dict[Recipe, _Result] = {}

    def __len__(self) -> int:
        return len(self._results)

    def clear(self) -> None:
        """Forget everything."""
        self._results.clear()

    def put(self, recipe: Recipe, surface: HorizonFit, shown: Collection[Recipe]) -> None:
        """Keep the surface of a recipe; forget the oldest of those that are not shown."""
        former = self._results.pop(recipe, None)
        self._results[recipe] = _Result(surface, None if former is None else former.offdata)
        spare = [one for one in self._results if one not in shown and one != recipe]
        while spare and (
            len(spare) > SPARE or sum(len(self._results[one].surface.points) for one in spare) > SPARE_POINTS
        ):
            del self._results[spare.pop(0)]

    def surface(self, recipe: Recipe | None) -> HorizonFit | None:
        """Return the surface of a recipe, None if it is not at hand."""
        found = None if recipe is None else self._results.get(recipe)
        return None if found is None else found.surface

    def examined(self, recipe: Recipe, offdata: OffData) -> None:
        """Keep what was found out about the surface off its data."""
        if recipe in self._results:
            self._results[recipe] = replace(self._results[recipe], offdata=offdata)

    def offdata(self, recipe: Recipe | None) -> OffData | None:
        """Return what is known about a surface off its data, None if nobody looked."""
        found = None if recipe is None else self._results.get(recipe)
        return None if found is None else found.offdata
