"""A cloud of points on the disk, as plain doubles that are read block by block, with how far its reading has come.

Formats that are packed (LAZ, CSV) are read once; every later pass is over this file. What was written before a stop
stays: the reading goes on behind the last whole chunk.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import cannot_write, folder_for, replacing
from geofit.data.long_arrays import LongArray
from geofit.data.messages import message
from geofit.data.progress import Progress, tell

__all__ = ["Spool", "spooled"]

Floats = NDArray[np.float64]

_WIDTH = 3 * 8


@dataclass(frozen=True)
class Spool:
    """A file of (n, 3) doubles: easting, northing, elevation, metres."""

    path: Path
    n: int

    def xyz(self) -> LongArray:
        """Return the points, read when they are sliced."""
        return LongArray((self.n, 3), self._read)

    def _read(self, start: int, stop: int) -> Floats:
        stop = min(stop, self.n)
        values = np.fromfile(self.path, np.float64, 3 * (stop - start), offset=start * _WIDTH)
        return values.reshape(-1, 3)


def spooled(
    chunks: Iterable[Floats], folder: Path, key: str, total: int | None = None, progress: Progress | None = None
) -> Spool:
    """Write chunks of (m, 3) points to a folder, or go on where an earlier reading of the same source stopped.

    Parameters
    ----------
    chunks : iterable of (m, 3) arrays
        The source, from its beginning; the same one gives the same chunks.
    folder : Path
        Where ``points.f64`` and ``points.json`` are kept.
    key : str
        What the source is told by: its name, size and time of change.
    total : int, optional
        Number of points where the source says it, for the progress.
    progress : callable, optional
        Called as ``progress("read", fraction)``.

    Raises
    ------
    InputError
        If the disk is full, or nothing could be read.
    Cancelled
        If ``progress`` returned False; what was read stays.
    """
    folder_for(folder)
    path, state = folder / "points.f64", folder / "points.json"
    tag = hashlib.sha256(key.encode()).hexdigest()
    known = _state(state, tag)
    done, whole = int(known.get("n", 0)), bool(known.get("whole", False))
    if not path.exists() or path.stat().st_size < done * _WIDTH:
        done, whole = 0, False
    if whole:
        return Spool(path, done)
    seen = 0
    try:
        with path.open("r+b" if done else "wb") as file:
            file.truncate(done * _WIDTH)
            file.seek(done * _WIDTH)
            for chunk in chunks:
                seen += len(chunk)
                if seen > done:
                    np.ascontiguousarray(chunk[len(chunk) - (seen - done) :], np.float64).tofile(file)
                    file.flush()
                    done = seen
                    _keep(state, tag, done, whole=False)
                tell(progress, "read", min(seen / total, 1.0) if total else 0.5)
            os.fsync(file.fileno())
    except OSError as error:
        raise cannot_write(error, path) from None
    if not done:
        raise InputError(
            message("streaming.no-points", "The source holds no points"),
            message("streaming.check-columns", "Check the file and the names of its columns."),
        )
    _keep(state, tag, done, whole=True)
    return Spool(path, done)


def _state(path: Path, tag: str) -> dict[str, Any]:
    try:
        known = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return known if isinstance(known, dict) and known.get("source") == tag else {}


def _keep(path: Path, tag: str, n: int, *, whole: bool) -> None:
    with replacing(path) as part:
        part.write_text(json.dumps({"source": tag, "n": n, "whole": whole}), encoding="utf-8")
