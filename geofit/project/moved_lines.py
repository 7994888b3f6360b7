"""Points that stand on other lines of their files: what was made from them is the same, under another provenance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.provenance import ManualEdit, Part, Provenance, Row, SeparationEdit, find_rows, fingerprint

__all__ = ["MovedLines", "moved_lines", "on_points"]


@dataclass(frozen=True, eq=False)
class _Horizon:
    before: PointSet
    after: PointSet
    then: str
    now: str


class MovedLines:
    """The horizons and blocks whose data are the same in two sites but for the lines of their points."""

    def __init__(self, horizons: Mapping[str, _Horizon]) -> None:
        self._horizons = horizons

    def provenance(self, former: Provenance) -> Provenance | None:
        """Return a provenance as it is written now; None where something that it was made from has changed."""
        one = self._horizons.get(former.horizon)
        if one is None or one.then != former.given:
            return None
        found = find_rows(one.before, former.excluded)
        # The points are the same in the same order: manual edits that count them hold.
        excluded = tuple(sorted(Row.of(one.after, int(index)) for index in found))
        edits: list[ManualEdit | SeparationEdit] = []
        for edit in former.edits:
            if isinstance(edit, SeparationEdit):
                others = self._all(edit.others)
                if others is None:
                    return None
                edits.append(replace(edit, others=others))
            else:
                edits.append(edit)
        part = None if former.part is None else self.part(former.part)
        if (part is None) != (former.part is None):
            return None
        return replace(former, given=one.now, excluded=excluded, edits=tuple(edits), part=part)

    def part(self, former: Part) -> Part | None:
        """Return what a block is, as :meth:`provenance`."""
        whole, faults = self._horizons.get(former.horizon), self._all(former.faults)
        if whole is None or whole.then != former.given or faults is None:
            return None
        return replace(former, given=whole.now, faults=faults)

    def _all(self, former: tuple[Provenance, ...]) -> tuple[Provenance, ...] | None:
        found = tuple(now for one in former if (now := self.provenance(one)) is not None)
        return found if len(found) == len(former) else None


def moved_lines(before: Site, after: Site, blocks_before: Site, blocks_after: Site) -> MovedLines:
    """Find the horizons whose data are the same but for lines; ``blocks_...`` have blocks in the place of horizons."""
    old, new = {**before.horizons, **blocks_before.horizons}, {**after.horizons, **blocks_after.horizons}
    return MovedLines(
        {
            name: _Horizon(points, new[name], fingerprint(points, before), fingerprint(new[name], after))
            for name, points in old.items()
            if name in new and _without_lines(points, before) == _without_lines(new[name], after)
        }
    )


def on_points(surface: HorizonFit, points: PointSet) -> HorizonFit | None:
    """Return a surface with its points on other lines; None where they are other points."""
    if not np.array_equal(surface.points.xyz, points.xyz):
        return None
    model = surface.model
    if model is not None:
        model = replace(model, problem=replace(model.problem, points=points))
    return surface.with_(points=points, model=model)


def _without_lines(points: PointSet, site: Site) -> str:
    return fingerprint(points.with_(row=np.zeros(len(points), np.int64)), site)
