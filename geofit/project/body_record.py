"""Bodies of a document: what each is made from, and how it is drawn. Plain values that name a body to the last bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from geofit.bodies.settings import BodySettings
from geofit.data.site import COLOURS

__all__ = [
    "BodyProvenance",
    "BodyRecord",
    "BodySource",
    "BodyStyle",
    "ClosedMesh",
    "Intervals",
    "MorphFrame",
    "next_colour",
]

#: Colours of bodies in turn: those of horizons from the end, so that the first of both differ.
BODY_COLOURS = (COLOURS[5], COLOURS[4], COLOURS[6], COLOURS[3], COLOURS[1], COLOURS[2], COLOURS[0], COLOURS[7])


@dataclass(frozen=True)
class Intervals:
    """Logged intervals of ``codes``: of the open site, or of the site ``file`` (relative to the folder of the site)."""

    codes: tuple[str, ...]
    file: str = ""


@dataclass(frozen=True)
class ClosedMesh:
    """Closed triangles or a solid in ``file``, relative to the folder of the site."""

    file: str


@dataclass(frozen=True)
class MorphFrame:
    """A frame of a metamorphosis between bodies: interpolated geometry, not a record.

    ``ends`` made the bodies, in order; ``tau`` is the share of the way. The others are those of :func:`geofit.morph`.
    """

    ends: tuple[BodyProvenance, ...]
    names: tuple[str, ...]
    mode: str
    pace: str
    dates: tuple[str, ...]
    cells: int
    tau: float
    seeds: bool = False


BodySource = Intervals | ClosedMesh | MorphFrame


@dataclass(frozen=True)
class BodyProvenance:
    """What a body is made from: source and settings; ``given`` is a hash of the data that the source held then."""

    source: BodySource
    settings: BodySettings
    given: str = ""

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        return {"source": _source_data(self.source), "settings": asdict(self.settings), "given": self.given}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> BodyProvenance:
        """Return what :meth:`to_data` was called on."""
        return cls(_source_from(data["source"]), _settings_from(data["settings"]), str(data["given"]))


@dataclass(frozen=True)
class BodyStyle:
    """How a body is drawn: its colour, 0 (clear) to 1 (opaque), and whether it is drawn at all."""

    colour: str
    opacity: float = 1.0
    visible: bool = True


@dataclass(frozen=True)
class BodyRecord:
    """A body of a document."""

    provenance: BodyProvenance
    style: BodyStyle

    def to_data(self) -> dict[str, Any]:
        """Return numbers, words, lists and mappings only."""
        return {**self.provenance.to_data(), "style": asdict(self.style)}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> BodyRecord:
        """Return what :meth:`to_data` was called on."""
        return cls(BodyProvenance.from_data(data), BodyStyle(**data["style"]))


def next_colour(records: Mapping[str, BodyRecord]) -> str:
    """Return the first colour that no body has; with many bodies colours repeat."""
    taken = {record.style.colour for record in records.values()}
    free = [colour for colour in BODY_COLOURS if colour not in taken]
    return free[0] if free else BODY_COLOURS[len(records) % len(BODY_COLOURS)]


def _source_data(source: BodySource) -> dict[str, Any]:
    match source:
        case Intervals(codes, file):
            return {"kind": "intervals", "codes": list(codes), "file": file}
        case ClosedMesh(file):
            return {"kind": "mesh", "file": file}
        case MorphFrame():
            plain = {
                name: getattr(source, name) for name in ("names", "mode", "pace", "dates", "cells", "tau", "seeds")
            }
            return {"kind": "frame", **plain, "ends": [end.to_data() for end in source.ends]} | {
                "names": list(source.names),
                "dates": list(source.dates),
            }


def _source_from(data: Mapping[str, Any]) -> BodySource:
    match data["kind"]:
        case "intervals":
            return Intervals(tuple(str(code) for code in data["codes"]), str(data["file"]))
        case "mesh":
            return ClosedMesh(str(data["file"]))
        case "frame":
            ends = tuple(BodyProvenance.from_data(end) for end in data["ends"])
            names, dates = (tuple(map(str, data[key])) for key in ("names", "dates"))
            return MorphFrame(
                ends,
                names,
                data["mode"],
                data["pace"],
                dates,
                int(data["cells"]),
                float(data["tau"]),
                bool(data["seeds"]),
            )
    raise ValueError(f"unknown source of a body '{data['kind']}'")


def _settings_from(data: Mapping[str, Any]) -> BodySettings:
    # Lists of JSON become tuples again in BodySettings itself.
    return BodySettings(**data)
