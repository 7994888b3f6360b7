"""Why surfaces of a document are stale."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from geofit.data.stale import StaleCause
from geofit.project.document import Document
from geofit.project.provenance import Provenance, Row

__all__ = ["stale_causes"]


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


def _data(document: Document, fitted: Provenance, now: Provenance) -> Iterator[StaleCause]:
    if fitted.given == now.given:
        return
    yield StaleCause("data", "", fitted.given, now.given)
    earlier = document.state.earlier.get(fitted.horizon)
    # A project whose files changed while it was closed does not have the data of its fits.
    site = document.data(earlier.data) if earlier is not None and earlier.provenance.given == fitted.given else None
    if site is not None:
        then, today = site.inputs, document.site.inputs
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
