"""Why surfaces and bodies of a document are stale."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace

from geofit.data.site import Site
from geofit.data.stale import StaleCause
from geofit.project.body_building import BodyResult
from geofit.project.body_record import BetweenHorizons, BodyProvenance, Intervals, MorphFrame
from geofit.project.document import Document
from geofit.project.horizon_body import needed_horizons
from geofit.project.provenance import Provenance, Row

__all__ = ["dated_body", "stale_body_causes", "stale_causes"]


def stale_causes(document: Document, name: str) -> tuple[StaleCause, ...]:
    """Return what has changed since the surface of a horizon was fitted; nothing where it is not stale."""
    fitted = document.state.provenances.get(name)
    if fitted is None or not document.stale(name):
        return ()
    now = document.provenance(name)
    causes = [*_data(document, fitted, now), *_settings(fitted, now)]
    if fitted.excluded != now.excluded:
        then, today = set(fitted.excluded), set(now.excluded)
        causes.append(StaleCause("excluded", "", _rows(then - today), _rows(today - then)))
    if fitted.part != now.part or document.needs_split(name):
        before = () if fitted.part is None else fitted.part.faults
        cutting = document.faults(name)
        causes.append(StaleCause("faults", "", _names(before), _names(cutting)))
    return tuple(causes)


def stale_body_causes(document: Document, name: str) -> tuple[StaleCause, ...]:
    """Return what has changed since a body was made, as far as it was read; nothing where the body is not stale."""
    record = document.state.bodies.get(name)
    return () if record is None else tuple(dict.fromkeys(_body(document, record.provenance)))


def dated_body(document: Document, name: str) -> BodyResult | None:
    """Return a body with what has changed since it was made, for all that leaves the document; None without one."""
    result = document.body(name)
    return None if result is None else replace(result, stale=stale_body_causes(document, name))


def _body(document: Document, made: BodyProvenance) -> Iterator[StaleCause]:
    match made.source:
        case BetweenHorizons():
            yield from _between(document, made)
        case Intervals(file=""):
            yield from _logs(document, made)
        case MorphFrame(ends=ends, names=names):
            of_ends = [cause for end in ends for cause in _body(document, end)]
            yield from of_ends or _source(document, made, " – ".join(names))
        case source:
            yield from _source(document, made, source.file)


def _source(document: Document, made: BodyProvenance, name: str) -> Iterator[StaleCause]:
    now = document.sources.held(made.source)
    if now not in (None, made.given):
        yield StaleCause("source", name, made.given, now or None)


def _logs(document: Document, made: BodyProvenance) -> Iterator[StaleCause]:
    now = document.logs(document.state.data)
    if now in (None, made.given):
        return
    yield StaleCause("logs", "", made.given, now)
    # As for horizons: a project whose files changed while it was closed does not have the data of its fits.
    site = document.data_with_logs(made.given)
    if site is not None:
        yield from _files(site, document.site)


def _between(document: Document, made: BodyProvenance) -> Iterator[StaleCause]:
    """Compare the surfaces that a body lies between with those that the next fits of these horizons give."""
    now = {name: _surface_now(document, name) for name in sorted(needed_horizons(made.source))}
    known = document.sources.surfaces(made)
    if known is not None:
        then = _fingerprints(known, now)
    elif (again := _given_again(document, made, now)) is not None:
        # Only the body of both surfaces is known of the fit.
        then, now = dict.fromkeys(now, made.given), dict.fromkeys(now, again)
    else:
        then = _fingerprints(document.state.provenances, now)
    for name, fingerprint in now.items():
        if fingerprint != then[name]:
            yield StaleCause("horizon", name, then[name], fingerprint)


def _given_again(document: Document, made: BodyProvenance, now: Mapping[str, str | None]) -> str | None:
    """Return the hash of the body that the horizons of now gave when it was made again; None if it was not."""
    made_again = document.sources.closed(made.source)
    return next((given for given, horizons in made_again if _fingerprints(horizons, now) == now), None)


def _surface_now(document: Document, name: str) -> str | None:
    """Return the fingerprint of a horizon's surface, or of the next one where that is stale; None without one."""
    provenance = document.state.provenances.get(name) if name in document.horizons else None
    stale = provenance is not None and document.stale(name)
    return _fingerprint(document.provenance(name) if stale else provenance)


def _fingerprints(provenances: Mapping[str, Provenance], names: Mapping[str, str | None]) -> dict[str, str | None]:
    return {name: _fingerprint(provenances.get(name)) for name in names}


def _fingerprint(provenance: Provenance | None) -> str | None:
    """Return a hash of all that shapes a surface: its control error does not."""
    if provenance is None:
        return None
    shaping = replace(provenance, settings=replace(provenance.settings, epsilon=1.0))
    return hashlib.sha256(json.dumps(shaping.to_data(), sort_keys=True).encode()).hexdigest()[:16]


def _data(document: Document, fitted: Provenance, now: Provenance) -> Iterator[StaleCause]:
    if fitted.given == now.given:
        return
    yield StaleCause("data", "", fitted.given, now.given)
    earlier = document.state.earlier.get(fitted.horizon)
    # A project whose files changed while it was closed does not have the data of its fits.
    site = document.data(earlier.data) if earlier is not None and earlier.provenance.given == fitted.given else None
    if site is not None:
        yield from _files(site, document.site)


def _files(fitted: Site, now: Site) -> Iterator[StaleCause]:
    then, today = fitted.inputs, now.inputs
    for file in dict.fromkeys([*then, *today]):
        if then.get(file) != today.get(file):
            yield StaleCause("file", file, then.get(file), today.get(file))


def _settings(fitted: Provenance, now: Provenance) -> Iterator[StaleCause]:
    then, today = asdict(fitted.settings), asdict(now.settings)
    for key, value in then.items():
        # The control error judges a surface and does not shape it.
        if key != "epsilon" and value != today[key]:
            yield StaleCause("setting", key, value, today[key])


def _rows(rows: set[Row]) -> tuple[str, ...]:
    return tuple(f"{row.file}:{row.row}" for row in sorted(rows))


def _names(faults: tuple[Provenance, ...]) -> tuple[str, ...]:
    return tuple(fault.horizon for fault in faults)
