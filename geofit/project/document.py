"""The document: a site, the work on it, and the surfaces available. Plain Python; windows listen to its signals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.prediction import PredictionResult
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.body_building import BodyResult
from geofit.project.body_record import BodyProvenance, BodySource
from geofit.project.body_shelf import BodyShelf
from geofit.project.body_sources import given_of_logs
from geofit.project.building import Given, around, given_of
from geofit.project.fault_blocks import Blocks, site_with_blocks
from geofit.project.horizon_commands import MergeHorizons
from geofit.project.horizon_edits import renamed_body, renamed_provenance
from geofit.project.known_sources import KnownSources
from geofit.project.listing import Listing, listing
from geofit.project.moved_lines import on_points
from geofit.project.provenance import DocumentError, Provenance, Row, data_digest, find_rows, fingerprint, without_rows
from geofit.project.shelf import Shelf
from geofit.project.signal import Signal
from geofit.project.state import State
from geofit.site.states import Comparison

__all__ = ["Document", "Selection"]

_EMPTY = Site("", {})


@dataclass(frozen=True)
class Selection:
    """What is chosen in all windows: a horizon, and a row of its data or none."""

    horizon: str | None = None
    row: Row | None = None


class Document:
    """A site with the work on it.

    The state is changed by commands alone (:mod:`geofit.project.commands`). Surfaces belong to provenances: the
    state names which are wanted, the shelf has those that were made.

    Signals
    -------
    site_opened()
        Another site was opened, or none is open any more; ``site_changed`` follows.
    site_changed()
        The site is another one, or has other data or horizons: look at everything anew.
    settings_changed(horizon), points_changed(horizon), result_changed(horizon)
        Settings; rows that take part; the surface, its check or what is known away from the data.
    order_changed(), name_changed()
        The order of the horizons; the site's title.
    bodies_changed()
        A body came, went, has another name or style, became available, or its data were read again.
    selection_changed(selection)
        Another horizon or row was chosen.
    saved_changed()
        The project file, or whether it holds the present state.
    """

    def __init__(self) -> None:
        self._read = self._site = _EMPTY
        self.site_file: Path | None = None
        self.project_file: Path | None = None
        #: SHA-256 of the project file as it was read or written here: another window may have saved since.
        self.project_digest = ""
        self.selection = Selection()
        self.shelf, self.bodies, self.sources = Shelf(), BodyShelf(), KnownSources()
        self._state = self._saved = State()
        self._points: dict[tuple[str, frozenset[Row]], PointSet] = {}
        self._fingerprints: dict[str, str] = {}
        self._used = _EMPTY
        self._data: dict[str, Site] = {}
        self._logs: dict[str, str] = {}
        self._comparisons: dict[str, tuple[tuple[Provenance, Provenance], Comparison]] = {}
        self._judged: dict[str, tuple[HorizonFit, HorizonFit]] = {}
        self._listings: dict[str, tuple[tuple[object, object, object], Listing]] = {}
        self.site_opened: Signal[[]] = Signal()
        self.site_changed: Signal[[]] = Signal()
        self.settings_changed: Signal[[str]] = Signal()
        self.points_changed: Signal[[str]] = Signal()
        self.result_changed: Signal[[str]] = Signal()
        self.order_changed: Signal[[]] = Signal()
        self.name_changed: Signal[[]] = Signal()
        self.bodies_changed: Signal[[]] = Signal()
        self.selection_changed: Signal[[Selection]] = Signal()
        self.saved_changed: Signal[[]] = Signal()

    def open(
        self,
        site: Site,
        site_file: Path | None,
        state: State | None = None,
        project_file: Path | None = None,
        data: Iterable[Site] = (),
        saved: State | None = None,
        digest: str = "",
    ) -> None:
        """Begin with a site, and with the work that a project or a journal holds; ``data`` are its earlier data.

        ``saved`` is the state that the files hold, by default that work; ``digest`` is the project file's SHA-256.
        """
        self.site_file, self.project_file, self.project_digest = site_file, project_file, digest
        self.shelf.clear()
        self.bodies.clear()
        self.sources.clear()
        self._logs.clear()
        self._judged.clear()
        self._listings.clear()
        self._comparisons.clear()
        self._state = state or State.of_site(site)
        self._saved = saved or self._state
        self._data = {data_digest(one): one for one in (*data, site)}
        self._data.setdefault(self._state.data, site)
        self._take_data()
        worked_on = [name for name in self._state.order if name in self._state.provenances]
        self.selection = Selection(next(iter((*worked_on, *self._state.order)), None))
        self.site_opened.emit()
        self.site_changed.emit()
        self.saved_changed.emit()

    @property
    def folder(self) -> Path | None:
        """The folder of the project, or of the site before it was saved: where exports go unless told otherwise."""
        file = self.project_file or self.site_file
        return None if file is None else file.resolve().parent

    @property
    def site_folder(self) -> Path | None:
        """The folder that the files of bodies are named from; None where no site file is open."""
        return None if self.site_file is None else self.site_file.resolve().parent

    @property
    def is_open(self) -> bool:
        """Whether there is a site to work on; one for bodies alone has no horizons."""
        return self.site_file is not None or bool(self._site.horizons)

    @property
    def site(self) -> Site:
        """The site, blocks in the place of horizons that were split at their faults."""
        return self._site

    @property
    def read(self) -> Site:
        """The site as it was read, with the study area that was drawn: horizons that faults cut are whole."""
        return self._read

    def know(self, site: Site) -> None:
        """Keep data of the site for the states that name them."""
        self._data[data_digest(site)] = site

    def data(self, name: str) -> Site | None:
        """Return the data of the site that a state names, None if they are not known."""
        return self._data.get(name)

    def logs(self, data: str) -> str | None:
        """Return the hash of the borehole logs in the data that a state names, None if they are not known."""
        if data not in self._logs and data in self._data:
            self._logs[data] = given_of_logs(self._data[data].boreholes)
        return self._logs.get(data)

    def data_with_logs(self, given: str) -> Site | None:
        """Return known data of the site whose borehole logs have a hash, None if there are none."""
        return next((site for data, site in self._data.items() if self.logs(data) == given), None)

    @property
    def state(self) -> State:
        """What commands change."""
        return self._state

    @property
    def dirty(self) -> bool:
        """Whether there is something to save."""
        return self._state is not self._saved and self._state != self._saved

    @property
    def horizons(self) -> tuple[str, ...]:
        """Names of the horizons, the highest first."""
        return self._state.order

    def become(self, state: State) -> None:
        """Take another state, and tell what is different. For commands only."""
        former, was_dirty = self._state, self.dirty
        self._state = state
        if any(getattr(former, name) != getattr(state, name) for name in ("parts", "data", "area", "horizons")):
            self._take_data()
            if self.selection.horizon not in state.order:
                self.selection = Selection(self._nearest(self.selection.horizon))
            self.site_changed.emit()
        for name in state.settings:
            if former.settings.get(name) != state.settings[name]:
                self.settings_changed.emit(name)
            if former.excluded.get(name, frozenset()) != state.excluded.get(name, frozenset()):
                self.points_changed.emit(name)
            if former.provenances.get(name) != state.provenances.get(name):
                self.result_changed.emit(name)
        if former.bodies != state.bodies or list(former.bodies) != list(state.bodies):
            self.bodies_changed.emit()
        if former.order != state.order:
            self.order_changed.emit()
        if former.name != state.name:
            self.name_changed.emit()
        if was_dirty != self.dirty:
            self.saved_changed.emit()

    def saved(self, project_file: Path, state: State, digest: str = "") -> None:
        """Hear that ``state`` was written to a project file, which has that SHA-256."""
        self.project_file, self.project_digest, self._saved = project_file, digest, state
        self.saved_changed.emit()

    def points(self, name: str) -> PointSet:
        """Return the points of a horizon but those of excluded rows."""
        key = (name, self._state.excluded.get(name, frozenset()))
        if key not in self._points:
            self._points = {old: points for old, points in self._points.items() if old[0] != name}
            self._points[key] = without_rows(self._given(name), key[1])
        return self._points[key]

    def site_in_use(self) -> Site:
        """Return the site under its present name, with the points that take part, in the present order of the horizons.

        It is one object until one of these changes.
        """
        horizons = {name: self.points(name) for name in self.horizons}
        order = tuple(name for name in dict.fromkeys(map(self.whole, horizons)) if name in self.site.order)
        used = self._used
        same = used.name == self._state.name and used.order == order and list(used.horizons) == list(horizons)
        if not same or any(used.horizons[name] is not points for name, points in horizons.items()):
            self._used = replace(self.site, name=self._state.name, horizons=horizons, order=order)
        return self._used

    def settings(self, name: str) -> FitSettings:
        """Return the settings that the next fit of a horizon will have."""
        self._given(name)
        return self._state.settings[name]

    def provenance(self, name: str) -> Provenance:
        """Return from what the next fit of a horizon will be made."""
        excluded = tuple(sorted(self._state.excluded.get(name, ())))
        return Provenance(name, self.settings(name), self.given(name), excluded, part=self._state.parts.get(name))

    def given(self, name: str) -> str:
        """Return the fingerprint of the site for a horizon, or for the whole of one that was split."""
        if name not in self._fingerprints:
            points = self._given(name) if name in self._site.horizons else self._read.horizons.get(name)
            self._fingerprints[name] = "" if points is None else fingerprint(points, self._state.as_read(self._read))
        return self._fingerprints[name]

    def merging(self, names: Sequence[str], name: str) -> MergeHorizons:
        """Return the step that makes one horizon of several; rows that are excluded stay so."""
        whole = PointSet.concatenate([self._given(one) for one in names])
        rows, start = [], 0
        for one in names:
            out = find_rows(self._given(one), self._state.excluded.get(one, frozenset()))
            rows += [Row.of(whole, start + int(index)) for index in out]
            start += len(self._given(one))
        return MergeHorizons(tuple(names), name, tuple(sorted(rows)))

    def whole(self, name: str) -> str:
        """Return the horizon that a block is a part of; a horizon that was not split is its own whole."""
        part = self._state.parts.get(name)
        return name if part is None else part.horizon

    def faults(self, name: str) -> tuple[Provenance, ...]:
        """Return from what the faults are made that cut a horizon or the whole of a block, as they are now."""
        whole = self.whole(name)
        cutting = [fault for fault, cut in self._read.faults.items() if whole in cut and fault in self._state.settings]
        known = self._state.provenances
        return tuple(known[f] if f in known and not self.stale(f) else self.provenance(f) for f in cutting)

    def needs_split(self, name: str) -> bool:
        """Whether faults cut a horizon that was not split at them, or not as they are now."""
        faults, part = self.faults(name), self._state.parts.get(name)
        if part is None:
            return bool(faults)
        return part.faults != faults or part.given != self.given(part.horizon)

    def surface(self, name: str) -> HorizonFit | None:
        """Return the surface of a horizon; None if there is none, or if it is wanted but not made yet.

        It is judged by the control error that the horizon has now: that needs no other fit.
        """
        made = self.shelf.surface(self._state.provenances.get(name))
        if made is None or name not in self._state.settings:
            return made
        epsilon = self._state.settings[name].epsilon
        if made.settings.epsilon == epsilon:
            return made
        former, judged = self._judged.get(name, (None, None))
        if judged is None or former is not made or judged.settings.epsilon != epsilon:
            judged = made.judged_by(epsilon)
            self._judged[name] = (made, judged)
        return judged

    def listing(self, name: str) -> Listing:
        """Return all points of a horizon, excluded rows too, with what its surface says of each."""
        points, surface = self._given(name), self.surface(name)
        excluded = self._state.excluded.get(name, frozenset())
        key = (points, surface, excluded)
        known = self._listings.get(name)
        if known is None or any(a is not b for a, b in zip(known[0], key, strict=True)):
            known = self._listings[name] = (key, listing(points, excluded, surface))
        return known[1]

    def waiting(self, name: str) -> bool:
        """Whether a horizon's surface is wanted and not available: it may still be read or made."""
        provenance = self._state.provenances.get(name)
        return provenance is not None and self.shelf.surface(provenance) is None

    def surfaces(self) -> Mapping[str, HorizonFit]:
        """Return the surfaces available, the highest first."""
        found = {name: self.surface(name) for name in self.horizons}
        return {name: surface for name, surface in found.items() if surface is not None}

    def prediction(self, name: str) -> PredictionResult | None:
        """Return what is known about a surface away from its data."""
        return self.shelf.prediction(self._state.provenances.get(name))

    def put(self, provenance: Provenance, surface: HorizonFit) -> None:
        """Lay a surface on the shelf; it is shown as soon as the state has its provenance."""
        self.shelf.put(provenance, surface, set(self._state.provenances.values()))
        self._tell_of(provenance)

    def put_prediction(self, provenance: Provenance, prediction: PredictionResult) -> None:
        """Keep what was found out about a surface away from its data."""
        self.shelf.examined(provenance, prediction)
        self._tell_of(provenance)

    def rename_results(self, old: str, new: str) -> None:
        """Keep what was made under the new name of a horizon, before the state has it. For commands only."""
        self.shelf.rename(old, new)
        self.sources.rename(old, new)
        bodies = {
            record.provenance: renamed_body(record.provenance, old, new) for record in self._state.bodies.values()
        }
        for provenance, renamed in bodies.items():
            result = self.bodies.get(provenance)
            if result is not None and renamed != provenance:
                self.bodies.put(renamed, result, {*bodies, *bodies.values()})
        if old in self._comparisons:
            (before, now), found = self._comparisons.pop(old)
            pair = renamed_provenance(before, old, new), renamed_provenance(now, old, new)
            self._comparisons[new] = (pair, found)

    def carry_results(self, after: State, provenances: Mapping[Provenance, Provenance]) -> None:
        """Keep surfaces under other provenances, whose points have moved to other lines. For commands only.

        ``after`` is the state that will have them.
        """
        site = site_with_blocks(after.shaped(self._data.get(after.data, self._read)), after.parts)
        for former, now in provenances.items():
            surface, points = self.shelf.surface(former), site.horizons.get(now.horizon)
            if surface is None or points is None:
                continue
            moved = on_points(surface, without_rows(points, now.excluded))
            if moved is not None:
                self.shelf.carry(former, now, moved)
        self.sources.carry(provenances)

    def earlier(self, name: str) -> tuple[Provenance, Given, HorizonFit | None] | None:
        """Return what a horizon was before its data changed: from what it was made, and its surface if available."""
        earlier = self._state.earlier.get(name)
        site = None if earlier is None else self._data.get(earlier.data)
        if earlier is None or site is None:
            return None
        site = replace(self._state, area=earlier.area).shaped(site)
        return earlier.provenance, given_of(site, earlier.provenance), self.shelf.surface(earlier.provenance)

    def comparison(self, name: str) -> Comparison | None:
        """Return how a horizon moved since its data changed; None while its new surface was not compared."""
        known = self._comparisons.get(name)
        return known[1] if known is not None and known[0] == self.compared_pair(name) else None

    def compared_pair(self, name: str) -> tuple[Provenance, Provenance] | None:
        """Return from what the earlier and the present surface of a horizon were made, if both can be compared."""
        earlier, now = self._state.earlier.get(name), self._state.provenances.get(name)
        if earlier is None or now is None or now.given == earlier.provenance.given or self.surface(name) is None:
            return None
        return earlier.provenance, now

    def put_comparison(self, pair: tuple[Provenance, Provenance], found: Comparison) -> None:
        """Keep how a horizon moved from one surface to another."""
        name = pair[1].horizon
        self._comparisons[name] = (pair, found)
        self._tell_of(pair[1])

    def body(self, name: str) -> BodyResult | None:
        """Return a body of the state; None if it is wanted but not made yet."""
        record = self._state.bodies.get(name)
        return None if record is None else self.bodies.get(record.provenance)

    def made_bodies(self) -> Mapping[str, BodyResult]:
        """Return the bodies available, by name."""
        found = {name: self.body(name) for name in self._state.bodies}
        return {name: result for name, result in found.items() if result is not None}

    def put_body(self, provenance: BodyProvenance, result: BodyResult) -> None:
        """Lay a body on the shelf; it is shown as soon as the state has its provenance."""
        wanted = {record.provenance for record in self._state.bodies.values()}
        self.bodies.put(provenance, result, wanted)
        if provenance in wanted:
            self.bodies_changed.emit()

    def know_sources(self, given: Mapping[BodySource, str]) -> None:
        """Keep the hashes of the data that sources of bodies hold now; empty: they cannot be read."""
        for source, one in given.items():
            self.sources.read(source, one)
        self.bodies_changed.emit()

    def stale(self, name: str) -> bool:
        """Whether the surface was made from other settings, rows or files than the horizon has now."""
        provenance = self._state.provenances.get(name)
        if provenance is None:
            return False
        is_block = provenance.part is not None
        # The control error judges a surface and does not shape it: see surface().
        settings = replace(provenance.settings, epsilon=self._state.settings[name].epsilon)
        return replace(provenance, edits=(), settings=settings) != self.provenance(name) or (
            is_block and self.needs_split(name)
        )

    def missing(self) -> tuple[Provenance, ...]:
        """Return provenances whose surfaces are wanted, not available, and can be made from the site as it is."""
        return tuple(
            provenance
            for provenance in self._state.provenances.values()
            if self.shelf.surface(provenance) is None and self.holds(provenance)
        )

    def lost(self) -> tuple[str, ...]:
        """Return horizons whose surfaces are not available and cannot be made: the files have changed since."""
        return tuple(
            name
            for name, provenance in self._state.provenances.items()
            if self.shelf.surface(provenance) is None and not self.holds(provenance)
        )

    def holds(self, provenance: Provenance) -> bool:
        """Whether a surface can be made again as it was: the site has the data that the provenance was for."""
        return all(one.given == self.given(one.horizon) for one in provenance.ancestors())

    def given_for(self, *provenances: Provenance) -> Given:
        """Return all that surfaces are made from: of the site what the provenances name, and faults available."""
        named = [one for provenance in provenances for one in provenance.ancestors()]
        faults = [fault for one in named if one.part is not None for fault in one.part.faults]
        return self._give({one.horizon: self._given(one.horizon) for one in named}, faults)

    def inputs_for_blocks(self, whole: str) -> tuple[Given, tuple[int, ...]]:
        """Return what a horizon is split from, and the numbers of its points whose rows were excluded."""
        points, faults = self._read.horizons[whole], self.faults(whole)
        named = {one.horizon for fault in faults for one in fault.ancestors()}
        out = {
            index
            for name, rows in self._state.excluded.items()
            if self.whole(name) == whole
            for row in rows
            if (index := row.find(points)) is not None
        }
        return self._give({whole: points, **{name: self._given(name) for name in named}}, faults), tuple(sorted(out))

    def blocks(self, whole: str | None = None) -> Blocks:
        """Return the blocks whose surfaces are available: those of a horizon, or all."""
        surfaces = self.surfaces()
        found = {
            name: (part, surfaces[name].with_(model=None))
            for name, part in self._state.parts.items()
            if name in surfaces and whole in (None, part.horizon)
        }
        return Blocks(found, self.given_for(*(self._state.provenances[name] for name in found)))

    def select(self, horizon: str | None, row: Row | None = None) -> None:
        """Choose a horizon, and a row of its data."""
        chosen = Selection(horizon, row)
        if chosen != self.selection:
            self.selection = chosen
            self.selection_changed.emit(chosen)

    def _given(self, name: str) -> PointSet:
        horizons = self._site.horizons
        if name not in horizons:
            names = ", ".join(horizons) or message("data.none", "none")
            raise DocumentError(
                message(
                    "project.site-no-horizon",
                    "The site has no horizon '{name}'. It has {names}.",
                    name=name,
                    names=names,
                )
            )
        return horizons[name]

    def _give(self, horizons: Mapping[str, PointSet], faults: Iterable[Provenance]) -> Given:
        site = self._site
        reduced = around(site, horizons)
        # One that was read from a file has lost its last digits; the model behind the patches need not travel.
        made = {fault: one.with_(model=None) for fault in faults if (one := self.shelf.surface(fault)) and one.model}
        return Given(reduced, made)

    def _take_data(self) -> None:
        self._read = self._state.shaped(self._data.get(self._state.data, self._read))
        self._site = self._used = site_with_blocks(self._read, self._state.parts)
        self._points.clear()
        self._fingerprints.clear()

    def _nearest(self, former: str | None) -> str | None:
        """Return a block of the horizon that was chosen, or the whole of the block; else the highest horizon."""
        near = [
            name
            for name in self._state.order
            if former and (self.whole(name) == former or former.startswith(f"{name} ("))
        ]
        return next(iter((*near, *self._state.order)), None)

    def _tell_of(self, provenance: Provenance) -> None:
        if self._state.provenances.get(provenance.horizon) == provenance:
            self.result_changed.emit(provenance.horizon)
