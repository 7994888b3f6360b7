"""Horizons renamed, removed and merged after the import: the files stay as they are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.project.provenance import Corners, Part, Provenance, SeparationEdit

__all__ = ["HorizonEdit", "renamed_provenance", "shaped"]


@dataclass(frozen=True)
class HorizonEdit:
    """One change: ``names`` are "renamed" (one) or "merged" (several) to ``name``, or "removed"."""

    kind: Literal["renamed", "merged", "removed"]
    names: tuple[str, ...]
    name: str = ""

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        return {"what": self.kind, "names": list(self.names), "name": self.name}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> HorizonEdit:
        """Return what :meth:`to_data` was called on."""
        return cls(data["what"], tuple(data["names"]), data["name"])

    def on(self, site: Site) -> Site:
        """Return the site after the change; names that it does not have are passed over."""
        there = [name for name in self.names if name in site.horizons]
        if not there:
            return site
        new = dict.fromkeys(there, self.name) if self.kind != "removed" else dict.fromkeys(there, "")
        horizons: dict[str, PointSet] = {}
        for name, points in site.horizons.items():
            if name not in new:
                horizons[name] = points
            elif new[name] and self.name not in horizons:
                horizons[self.name] = PointSet.concatenate([site.horizons[one] for one in there])
        settings = {name: one for name, one in site.settings.items() if name not in new}
        if self.name and there[0] in site.settings:
            settings[self.name] = site.settings[there[0]]
        return replace(
            site,
            horizons=horizons,
            settings=settings,
            order=tuple(dict.fromkeys(_renamed(site.order, new))),
            faults={
                name: tuple(dict.fromkeys(_renamed(cut, new)))
                for fault, cut in site.faults.items()
                if (name := new.get(fault, fault))
            },
            orientations=None
            if site.orientations is None
            else replace(
                site.orientations,
                horizon=np.array([new.get(name, name) for name in site.orientations.horizon.tolist()], np.str_),
            ),
        )


def shaped(site: Site, area: Corners | None, edits: Iterable[HorizonEdit]) -> Site:
    """Return a site as it is worked on: with the study area that was drawn, and its horizons as they are called."""
    for edit in edits:
        site = edit.on(site)
    return site if area is None else replace(site, boundary=np.array(area))


def renamed_provenance(provenance: Provenance, old: str, new: str) -> Provenance:
    """Return a provenance that calls a horizon by its new name, wherever it occurs."""

    def name(one: str) -> str:
        return new if one == old else one

    def part(one: Part) -> Part:
        faults = tuple(renamed_provenance(fault, old, new) for fault in one.faults)
        return replace(one, horizon=name(one.horizon), faults=faults)

    edits = tuple(
        replace(
            edit,
            sequence=tuple(map(name, edit.sequence)),
            others=tuple(renamed_provenance(other, old, new) for other in edit.others),
        )
        if isinstance(edit, SeparationEdit)
        else edit
        for edit in provenance.edits
    )
    return replace(
        provenance,
        horizon=name(provenance.horizon),
        edits=edits,
        part=None if provenance.part is None else part(provenance.part),
    )


def _renamed(names: Iterable[str], new: Mapping[str, str]) -> list[str]:
    return [name for one in names if (name := new.get(one, one))]
