"""Coincident points of a cloud: found strip by strip, resolved as the in-memory fit resolves them.

Two points nearer than a distance lie in one strip of the plan, or next to the border between two. Points are sent to
files of strips, those by a border to both; each file is small enough to be searched in memory.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.long_arrays import Rows, blocks
from geofit.fitting.conflicts import near_pairs

__all__ = ["coincident"]

Ints = NDArray[np.int64]

#: Points of a strip, on average.
STRIP = 2_000_000
_RECORD = np.dtype([("place", np.float64, 2), ("index", np.int64)])


def coincident(plane: Rows, distance: float, folder: Path) -> Ints:
    """Return the points to drop: of two nearer than a distance in plan, the later one; ascending.

    Parameters
    ----------
    plane : (n, 2)
        Places, metres.
    distance : float
        Largest distance of coincident points, metres.
    folder : Path
        Where the strips are kept while they are searched.
    """
    n = len(plane)
    low = np.min([part[:, 0].min() for (part,) in blocks(plane)])
    high = np.max([part[:, 0].max() for (part,) in blocks(plane)])
    count = max(1, min(int(np.ceil(n / STRIP)), 1000, int((high - low) / (16 * distance)) or 1))
    width = (high - low) / count or 1.0
    if count == 1:
        whole = np.concatenate([part for (part,) in blocks(plane)])
        return _later(np.asarray(near_pairs(whole, distance), np.int64))
    pairs = []
    with tempfile.TemporaryDirectory(dir=folder, prefix="strips-") as name:
        files = [(Path(name) / f"{k}").open("w+b") for k in range(count)]
        try:
            start = 0
            for (part,) in blocks(plane):
                records = np.empty(len(part), _RECORD)
                records["place"], records["index"] = part, np.arange(start, start + len(part))
                start += len(part)
                across = (part[:, 0] - low) / width
                own = np.clip(across.astype(np.int64), 0, count - 1)
                before = np.clip(((part[:, 0] - 1.01 * distance - low) / width).astype(np.int64), 0, count - 1)
                order = np.argsort(own, kind="stable")
                ends = np.searchsorted(own[order], np.arange(count + 1))
                for k in range(count):
                    records[order[ends[k] : ends[k + 1]]].tofile(files[k])
                twice = np.flatnonzero(before < own)
                for k in np.unique(before[twice]).tolist():
                    records[twice[before[twice] == k]].tofile(files[k])
            for file in files:
                file.seek(0)
                found = np.fromfile(file, _RECORD)
                if len(found) > 1:
                    near = near_pairs(np.ascontiguousarray(found["place"]), distance)
                    pairs.append(np.sort(found["index"][near], axis=1))
        finally:
            for file in files:
                file.close()
    both = np.unique(np.concatenate(pairs), axis=0) if pairs else np.empty((0, 2), np.int64)
    return _later(both)


def _later(pairs: Ints) -> Ints:
    """Go through the pairs by their first point: where both are there still, the second one is dropped.

    A byte a point, and few pairs at a time as Python's numbers: a cloud of 1e8 points has millions of pairs.
    """
    ids = np.unique(pairs)
    own = np.sort(np.searchsorted(ids, pairs), axis=1)
    own = own[np.lexsort((own[:, 1], own[:, 0]))]
    dropped = bytearray(len(ids))
    for (part,) in blocks(own):
        for first, second in part.tolist():
            if not dropped[first]:
                dropped[second] = 1
    gone: Ints = ids[np.frombuffer(dropped, bool)]
    return gone
