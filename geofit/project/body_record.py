"""Bodies of a document: what each is made from, and how it is drawn. Plain values that name a body to the last bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from geofit.bodies.settings import BodySettings
from geofit.data.site import COLOURS

__all__ = [
    "FITTED",
    "BetweenHorizons",
    "BodyProvenance",
    "BodyRecord",
    "BodySource",
    "BodyStyle",
    "ClosedMesh",
    "Intervals",
    "MorphFrame",
    "Outlines",
    "SurfacePicks",
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
class Outlines:
    """Closed outlines on sections in ``file``, relative to the folder of the site; ``layers`` empty: all of them."""

    file: str
    layers: tuple[str, ...] = ()


@dataclass(frozen=True)
class SurfacePicks:
    """Points on the body, with or without normals, in ``file``, relative to the folder of the site."""

    file: str


@dataclass(frozen=True)
class ClosedMesh:
    """Closed triangles or a solid in ``file``, relative to the folder of the site."""

    file: str


@dataclass(frozen=True)
class BetweenHorizons:
    """The body below the horizon ``upper`` and above the horizon ``lower``, or above one elevation in metres."""

    upper: str
    lower: str | float


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


BodySource = Intervals | Outlines | SurfacePicks | ClosedMesh | BetweenHorizons | MorphFrame
#: Sources that a body is fitted to, and judged by.
FITTED = (Intervals, Outlines, SurfacePicks)


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
        case Outlines(file, layers):
            return {"kind": "outlines", "file": file, "layers": list(layers)}
        case SurfacePicks(file):
            return {"kind": "points", "file": file}
        case ClosedMesh(file):
            return {"kind": "mesh", "file": file}
        case BetweenHorizons(upper, lower):
            return {"kind": "horizons", "upper": upper, "lower": lower}
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
        case "outlines":
            return Outlines(str(data["file"]), tuple(str(layer) for layer in data["layers"]))
        case "points":
            return SurfacePicks(str(data["file"]))
        case "mesh":
            return ClosedMesh(str(data["file"]))
        case "horizons":
            lower = data["lower"]
            return BetweenHorizons(str(data["upper"]), lower if isinstance(lower, str) else float(lower))
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
