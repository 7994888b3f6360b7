"""From one state of a site's data to the next: which files changed, what came and went, what happens to the work."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from geofit.data.messages import Message, Untranslated, message, plural_message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.project.data_commands import ChangeData
from geofit.project.fault_blocks import site_with_blocks
from geofit.project.provenance import Earlier, Row, data_digest, fingerprint, turns
from geofit.project.state import State

__all__ = ["Arrivals", "DataChange", "arrivals", "carried_rows", "change_of_data", "changed_files"]

#: Decimals to which two readings of one contact agree, metres.
DECIMALS = 3
_Key = tuple[str, str, str, tuple[float, ...]]


@dataclass(frozen=True)
class Arrivals:
    """Points of a horizon that came, were corrected (same hole, other place) and went, counted, and the new holes."""

    horizon: str
    new: int
    corrected: int
    gone: int
    holes: tuple[str, ...]

    @property
    def any(self) -> bool:
        """Whether there is anything."""
        return bool(self.new or self.corrected or self.gone)

    @property
    def text(self) -> Message:
        """The counts as a sentence."""
        return message(
            "project.arrivals", "{name}: {new} new, {corrected} corrected, {gone} gone",
            name=Untranslated(self.horizon), new=self.new, corrected=self.corrected, gone=self.gone,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class DataChange:
    """A change of data: the command that makes it, what came and went, and what of the work is lost.

    ``carried`` counts excluded rows that stay excluded; ``lost`` lists what does not survive.
    """

    command: ChangeData
    arrivals: tuple[Arrivals, ...]
    carried: int
    lost: tuple[Message, ...]

    @property
    def nothing(self) -> bool:
        """Whether the data are the same, but for their files."""
        return not any(one.any for one in self.arrivals) and not self.lost


def changed_files(site: Site, folder: Path) -> dict[str, str]:
    """Return the files of a site that are "changed" or "missing" since it was read, by the names in its site file."""
    found = {}
    for name, expected in site.inputs.items():
        file = folder / name
        if not file.is_file():
            found[name] = "missing"
        elif hashlib.sha256(file.read_bytes()).hexdigest() != expected:
            found[name] = "changed"
    return found


def change_of_data(state: State, before: Site, after: Site, added: Iterable[str] = ()) -> DataChange:
    """Return the step from one state of the data to the next.

    Parameters
    ----------
    state : State
        The present work.
    before, after : Site
        The site as it is worked on (:meth:`~geofit.project.state.State.shaped`), and as it is read now; horizons
        whole, not in blocks.
    added : iterable of str
        All tables that were read in addition to the site file's, as TOML.

    Returns
    -------
    DataChange
        Excluded rows follow their points to other lines of their file; those whose points are not there any more, or
        were corrected, are lost, as are manual edits: they belong to the earlier fit.
    """
    data, after = data_digest(after), state.shaped(after)
    parts = {name: part for name, part in state.parts.items() if part.horizon in after.horizons}
    blocks_before, blocks_after = site_with_blocks(before, state.parts), site_with_blocks(after, parts)
    settings = {name: _settings(name, state, after, parts) for name in blocks_after.horizons}
    excluded: dict[str, tuple[Row, ...]] = {}
    lost: list[Message] = []
    for name, rows in state.excluded.items():
        whole = state.parts[name].horizon if name in state.parts else name
        points = after.horizons.get(whole)
        if points is None:
            continue
        found, gone = carried_rows(sorted(rows), before.horizons[whole], points)
        excluded[name] = found
        lost += [
            message(
                "project.exclusion-lost",
                "{name}: {file} row {row} is no longer excluded: its point is gone or was corrected",
                name=Untranslated(name), file=Untranslated(row.file), row=row.row,
            )
            for row in gone
        ]  # fmt: skip
    earlier: dict[str, Earlier] = {}
    for name, provenance in state.provenances.items():
        whole = state.parts[name].horizon if name in state.parts else name
        if name not in settings:
            continue
        same = fingerprint(before.horizons[whole], before) == fingerprint(after.horizons[whole], after)
        of_present_data = provenance.given == fingerprint(blocks_before.horizons[name], before)
        if not same and of_present_data:
            earlier[name] = Earlier(state.data, provenance, state.area)
        if not same and provenance.edits:
            lost.append(
                plural_message(
                    "project.edits-of-earlier-fit",
                    "{name}: {count} manual edit belongs to the earlier fit; a new fit does not have it",
                    "{name}: {count} manual edits belong to the earlier fit; a new fit does not have them",
                    count=len(provenance.edits),
                    name=Untranslated(name),
                )
            )
    gone_names = [name for name in state.order if name not in settings]
    lost += [message("project.horizon-gone", "{name}: the new data contain no point of it", name=Untranslated(name))
             for name in gone_names]  # fmt: skip
    files = tuple(name for name, digest in after.inputs.items() if before.inputs.get(name) != digest)
    command = ChangeData(data, files, tuple(added), settings, parts, excluded, earlier)
    names = dict.fromkeys([*before.horizons, *after.horizons])
    empty = PointSet([])
    found_arrivals = tuple(
        arrivals(name, before.horizons.get(name, empty), after.horizons.get(name, empty)) for name in names
    )
    return DataChange(command, found_arrivals, sum(map(len, excluded.values())), tuple(lost))


def arrivals(horizon: str, before: PointSet, after: PointSet) -> Arrivals:
    """Count the points that came, were corrected and went."""
    old, new = _counted(before), _counted(after)
    came = [key for key, count in new.items() for _ in range(count - old.get(key, 0))]
    went = [key for key, count in old.items() for _ in range(count - new.get(key, 0))]
    holes_before = {hole for hole in before.hole.tolist() if hole}
    went_holes = [key[1] for key in went if key[1]]
    corrected = 0
    for key in came:
        if key[1] and key[1] in went_holes:
            went_holes.remove(key[1])
            corrected += 1
    holes = dict.fromkeys(key[1] for key in came if key[1] and key[1] not in holes_before)
    return Arrivals(horizon, len(came) - corrected, corrected, len(went) - corrected, tuple(holes))


def carried_rows(rows: Iterable[Row], before: PointSet, after: PointSet) -> tuple[tuple[Row, ...], tuple[Row, ...]]:
    """Return rows as they are called now, and those whose points are gone or were corrected.

    A point is found again by its file, kind, hole, section and place; of several at one location by their order.
    """
    places: dict[tuple[str, _Key], list[int]] = {}
    for index, key in enumerate(_keys(after)):
        places.setdefault((str(after.file[index]), key), []).append(index)
    keys, turn = _keys(before), turns(after)
    found: list[Row] = []
    lost: list[Row] = []
    for row in rows:
        at = row.find(before)
        same = [] if at is None else places.get((row.file, keys[at]), [])
        rank = 0 if at is None else sum(keys[k] == keys[at] and before.file[k] == row.file for k in range(at))
        if rank < len(same):
            index = same[rank]
            found.append(Row(str(after.file[index]), int(after.row[index]), int(turn[index])))
        else:
            lost.append(row)
    return tuple(sorted(found)), tuple(lost)


def _settings(name: str, state: State, after: Site, parts: Mapping[str, object]) -> FitSettings:
    known = state.settings.get(name)
    return known if known is not None else after.settings.get(name, FitSettings())


def _keys(points: PointSet) -> list[_Key]:
    places = points.xyz.round(DECIMALS).tolist()
    return [
        (kind, hole, section, tuple(place))
        for kind, hole, section, place in zip(
            points.kind.tolist(), points.hole.tolist(), points.section.tolist(), places, strict=True
        )
    ]


def _counted(points: PointSet) -> dict[_Key, int]:
    found: dict[_Key, int] = {}
    for key in _keys(points):
        found[key] = found.get(key, 0) + 1
    return found
