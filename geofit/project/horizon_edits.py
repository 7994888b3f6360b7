"""Horizons renamed, removed and merged after the import: the files stay as they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.project.body_record import BetweenHorizons, BodyProvenance, BodySource, MorphFrame
from geofit.project.provenance import Corners, Part, Provenance, SeparationEdit

__all__ = [
    "HorizonEdit",
    "as_read",
    "present_body",
    "present_name",
    "present_provenance",
    "renamed_body",
    "renamed_provenance",
    "renamed_source",
    "shaped",
]


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


def as_read(site: Site, edits: Iterable[HorizonEdit]) -> Site:
    """Return a site whose dips name horizons as its files do: a new name does not make other data."""
    if site.orientations is None:
        return site
    names: dict[str, str] = {}
    for edit in edits:
        if edit.kind == "renamed":
            names[edit.name] = names.pop(edit.names[0], edit.names[0])
    horizon = np.array([names.get(name, name) for name in site.orientations.horizon.tolist()], np.str_)
    return replace(site, orientations=replace(site.orientations, horizon=horizon))


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


def renamed_body(body: BodyProvenance, old: str, new: str) -> BodyProvenance:
    """Return the provenance of a body that calls a horizon by its new name, wherever it occurs."""
    return replace(body, source=renamed_source(body.source, old, new))


def renamed_source(source: BodySource, old: str, new: str) -> BodySource:
    """Return the source of a body that calls a horizon by its new name, wherever it occurs."""
    match source:
        case BetweenHorizons(upper, lower):
            return BetweenHorizons(new if upper == old else upper, new if lower == old else lower)
        case MorphFrame(ends=ends):
            return replace(source, ends=tuple(renamed_body(end, old, new) for end in ends))
    return source


def present_name(name: str, then: Sequence[HorizonEdit], now: Sequence[HorizonEdit]) -> str | None:
    """Return how a horizon is called after ``now`` that was called ``name`` after ``then``; None where it is gone.

    Examples
    --------
    >>> renamed = HorizonEdit("renamed", ("T2",), "base of T2")
    >>> present_name("T2", (), (renamed,))
    'base of T2'
    >>> present_name("base of T2", (renamed,), ())
    'T2'
    """
    for edit in _since(then, now):
        if name in edit.names:
            if edit.kind != "renamed":
                return None
            name = edit.name
    return name


def present_provenance(
    provenance: Provenance, then: Sequence[HorizonEdit], now: Sequence[HorizonEdit]
) -> Provenance | None:
    """Return a provenance that names horizons as they are called now; None where its own is gone."""
    for edit in _since(then, now):
        if edit.kind == "renamed":
            provenance = renamed_provenance(provenance, edit.names[0], edit.name)
        elif provenance.horizon in edit.names:
            return None
    return provenance


def present_body(body: BodyProvenance, then: Sequence[HorizonEdit], now: Sequence[HorizonEdit]) -> BodyProvenance:
    """Return the provenance of a body that names horizons as they are called now."""
    for edit in _since(then, now):
        if edit.kind == "renamed":
            body = renamed_body(body, edit.names[0], edit.name)
    return body


def _since(then: Sequence[HorizonEdit], now: Sequence[HorizonEdit]) -> Iterator[HorizonEdit]:
    """Return the edits that lead from one list of edits to another: some are taken back, the last first."""
    same = next((k for k, (a, b) in enumerate(zip(then, now, strict=False)) if a != b), min(len(then), len(now)))
    for edit in reversed(then[same:]):
        if edit.kind == "renamed":
            yield HorizonEdit("renamed", (edit.name,), edit.names[0])
        elif edit.kind == "merged":
            yield HorizonEdit("removed", (edit.name,))
    yield from now[same:]


def _renamed(names: Iterable[str], new: Mapping[str, str]) -> list[str]:
    return [name for one in names if (name := new.get(one, one))]
