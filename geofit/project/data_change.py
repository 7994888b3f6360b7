"""From one state of a site's data to the next: which files changed, what came and went, what happens to the work."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from geofit.data.messages import Message, Untranslated, message, plural_message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.project.data_commands import ChangeData
from geofit.project.fault_blocks import site_with_blocks
from geofit.project.moved_lines import moved_lines
from geofit.project.named_points import Names, PointKey, carried_rows, excluded_names, point_keys, reopened, whole_of
from geofit.project.provenance import Earlier, Provenance, data_digest, fingerprint
from geofit.project.state import State

__all__ = ["Arrivals", "DataChange", "arrivals", "change_of_data", "changed_files", "on_other_data"]


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
        were corrected, are lost, as are manual edits: they belong to the earlier fit. Where nothing but lines has
        changed, surfaces and their edits stay.
    """
    data, after = data_digest(after), state.shaped(after)
    parts = {name: part for name, part in state.parts.items() if part.horizon in after.horizons}
    blocks_before, blocks_after = site_with_blocks(before, state.parts), site_with_blocks(after, parts)
    settings = {name: _settings(name, state, after, parts) for name in blocks_after.horizons}
    found = carried_rows(state, excluded_names(state, before), after)
    lost = list(found.lost)
    then, now = state.as_read(before), state.as_read(after)
    lines = moved_lines(then, now, blocks_before, blocks_after)
    parts = {name: lines.part(part) or part for name, part in parts.items()}
    carried: dict[str, Provenance] = {}
    earlier: dict[str, Earlier] = {}
    for name, provenance in state.provenances.items():
        whole = whole_of(state, name)
        if name not in settings:
            continue
        moved = lines.provenance(provenance)
        if moved is not None:
            if moved != provenance:
                carried[name] = moved
            continue
        same = fingerprint(before.horizons[whole], then) == fingerprint(after.horizons[whole], now)
        of_present_data = provenance.given == fingerprint(blocks_before.horizons[name], then)
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
    command = ChangeData(data, files, tuple(added), settings, parts, dict(found.excluded), earlier, carried)
    names = dict.fromkeys([*before.horizons, *after.horizons])
    empty = PointSet([])
    found_arrivals = tuple(
        arrivals(name, before.horizons.get(name, empty), after.horizons.get(name, empty)) for name in names
    )
    return DataChange(command, found_arrivals, sum(map(len, found.excluded.values())), tuple(lost))


def on_other_data(state: State, names: Names, site: Site) -> tuple[State, tuple[Message, ...]]:
    """Return a state that was stored, on a site whose files have changed since; and what of the work is lost.

    ``names`` are who the excluded points are (:func:`geofit.project.named_points.excluded_names`).
    """
    state, found = reopened(state, names, state.shaped(site), site.inputs)
    if not site.horizons:
        return replace(state, data=data_digest(site)), found.lost
    # Of the former data nothing is known but the names: horizons that are gone or new are all that is left to see.
    change = change_of_data(state, state.shaped(site), site, state.added)
    return change.command.on(state), (*found.lost, *change.lost)


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


def _settings(name: str, state: State, after: Site, parts: Mapping[str, object]) -> FitSettings:
    known = state.settings.get(name)
    return known if known is not None else after.settings.get(name, FitSettings())


def _counted(points: PointSet) -> Counter[PointKey]:
    return Counter(point_keys(points))
