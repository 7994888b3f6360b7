"""A metamorphosis between bodies of a document, as a window shows it: preview first, then full grid and table."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.bodies.settings import BodySettings
from geofit.data.messages import Message
from geofit.data.progress import Progress, tell
from geofit.project.body_building import BodyResult
from geofit.project.body_record import BodyProvenance, MorphFrame
from geofit.project.morph_run import MorphRun, run_morph

if TYPE_CHECKING:
    from geofit.morphing.body import MorphBody
    from geofit.morphing.sequence import Morph
    from geofit.morphing.table import Event, FrameRow

__all__ = [
    "FULL",
    "MorphView",
    "MorphWay",
    "export_frames",
    "finished",
    "frame_as_body",
    "frame_body",
    "previewed",
    "way_of",
]

#: Cells along the longest side: while a slider is dragged, and of the frames themselves.
PREVIEW, FULL = 96, 128
#: Frames of the curves.
FRAMES = 25


@dataclass(frozen=True)
class MorphWay:
    """How bodies are joined: ``ends`` made them, in order; the others are those of :func:`geofit.morph`."""

    ends: tuple[BodyProvenance, ...]
    names: tuple[str, ...]
    mode: str = "arrival"
    pace: str = "progress"
    dates: tuple[str, ...] = ()
    seeds: bool = False

    def frame(self, tau: float) -> MorphFrame:
        """Return the source of a frame as a body of its own."""
        return MorphFrame(self.ends, self.names, self.mode, self.pace, self.dates, FULL, tau, self.seeds)


@dataclass(frozen=True, eq=False)
class MorphView:
    """What a slider needs: a quick metamorphosis and its changes of topology; then full grid, notes and figures."""

    way: MorphWay
    preview: Morph
    events: tuple[Event, ...]
    full: Morph | None = None
    rows: tuple[FrameRow, ...] = ()
    notes: tuple[Message, ...] = ()


def way_of(way: MorphWay, cells: int) -> dict[str, Any]:
    """Return the keywords of :func:`geofit.morph`."""
    return {
        "mode": way.mode,
        "pace": way.pace,
        "dates": way.dates or None,
        "cells": cells,
        "seeds": way.seeds,
        "names": way.names,
    }


def previewed(way: MorphWay, shapes: Sequence[Any], *, progress: Progress) -> MorphView:
    """Return the preview: what is never reached is known before frames are made.

    Raises
    ------
    MorphError, SettingsError
        As :func:`geofit.morph`.
    """
    from geofit.morphing.morph import morph

    made = morph(*shapes, **way_of(way, PREVIEW), progress=progress)
    tell(progress, "topology", 0.9)
    return MorphView(way, made, made.events)


def finished(view: MorphView, shapes: Sequence[Any], *, progress: Progress) -> MorphView:
    """Return the same with the full grid, its notes and the figures of frames; errors as :func:`previewed`."""
    from geofit.morphing.morph import morph

    full = morph(*shapes, **way_of(view.way, FULL), progress=progress)
    return replace(view, full=full, rows=view.preview.table(FRAMES, progress), notes=full.notes)


def frame_body(full: Morph, tau: float, *, progress: Progress) -> MorphBody:
    """Return the frame on the full grid, its triangles made."""
    tell(progress, "frame", 0.1)
    body = full(tau)
    _ = body.overview  # here, not in the window
    return body


def frame_as_body(view: MorphView, tau: float, name: str, given: Sequence[str]) -> tuple[BodyProvenance, BodyResult]:
    """Return a frame as a body of the document; ``given`` are the hashes of the data of its ends."""
    assert view.full is not None
    body = replace(view.full(tau), name=name)
    digest = hashlib.sha256(" ".join(given).encode()).hexdigest()[:16]
    return BodyProvenance(view.way.frame(tau), BodySettings(), digest), BodyResult(body)


def export_frames(
    full: Morph, out: Path, name: str, frames: int, formats: Sequence[str], film: str | None, *, progress: Progress
) -> MorphRun:
    """Write frames, table and film; see :func:`geofit.project.morph_run.run_morph`."""
    return run_morph(full, out, frames=frames, name=name, formats=formats, film=film, progress=progress)
