"""Logged boreholes as arrays and words, for the data of a site in one file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.labels import Labels
from geofit.data.logs import IntervalLog, LoggedHoles
from geofit.io.desurvey import WellPath

__all__ = ["logs_from", "pack_logs"]

Arrays = dict[str, NDArray[Any]]

_PATH = ("depth", "tangent", "xyz")
_ROWS = ("top", "base", "row")
_WORDS = ("hole", "code")


def pack_logs(campaigns: Sequence[LoggedHoles], arrays: Arrays) -> list[dict[str, Any]]:
    """Return the words of campaigns, and put their numbers into the arrays.

    All holes of a campaign are one array: thousands of small ones take long. A campaign with paths that are not of
    surveys, which a script may make, is left out.
    """
    packed = []
    for k, campaign in enumerate(campaigns):
        paths = [path for path in campaign.paths.values() if isinstance(path, WellPath)]
        if not paths or len(paths) < len(campaign.paths):
            continue
        for name in _PATH:
            arrays[f"boreholes{k}.{name}"] = np.concatenate(
                [np.empty((0,) if name == "depth" else (0, 3)), *(getattr(path, name) for path in paths)]
            )
        arrays[f"boreholes{k}.stations"] = np.array([len(path.depth) for path in paths], np.int64)
        arrays[f"boreholes{k}.straight"] = np.array([path.straight for path in paths], bool)
        arrays[f"boreholes{k}.end"] = np.array([campaign.ends[hole] for hole in campaign.paths], float)
        logs = [_log(f"boreholes{k}.log{j}", log, arrays) for j, log in enumerate(campaign.logs)]
        packed.append({"number": k, "holes": list(campaign.paths), "logs": logs})
    return packed


def logs_from(packed: Sequence[Mapping[str, Any]], arrays: Arrays) -> tuple[LoggedHoles, ...]:
    """Return what :func:`pack_logs` packed.

    Raises
    ------
    ValueError, KeyError
        If the arrays and words do not belong together.
    """
    found = []
    for one in packed:
        prefix, names = f"boreholes{one['number']}", one["holes"]
        ends = np.cumsum(arrays[f"{prefix}.stations"])[:-1]
        stations = [np.split(arrays[f"{prefix}.{name}"], ends) for name in _PATH]
        straight, depths = arrays[f"{prefix}.straight"].tolist(), arrays[f"{prefix}.end"].tolist()
        paths = {
            name: WellPath(depth, tangent, xyz, way)
            for name, depth, tangent, xyz, way in zip(names, *stations, straight, strict=True)
        }
        logs = tuple(_log_from(f"{prefix}.log{j}", log, arrays) for j, log in enumerate(one["logs"]))
        found.append(LoggedHoles(paths, dict(zip(names, depths, strict=True)), logs))
    return tuple(found)


def _log(prefix: str, log: IntervalLog, arrays: Arrays) -> dict[str, Any]:
    arrays |= {f"{prefix}.{name}": getattr(log, name) for name in _ROWS}
    if log.ended is not None:
        arrays[f"{prefix}.ended"] = log.ended
    words: dict[str, Any] = {"file": log.file}
    for name in _WORDS:
        labels = Labels.of(getattr(log, name).tolist())
        arrays[f"{prefix}.{name}"], words[name] = labels.codes, list(labels.table)
    return words


def _log_from(prefix: str, words: Mapping[str, Any], arrays: Arrays) -> IntervalLog:
    hole, code = (np.array(words[name], np.str_)[arrays[f"{prefix}.{name}"]] for name in _WORDS)
    top, base, row = (arrays[f"{prefix}.{name}"] for name in _ROWS)
    return IntervalLog(words["file"], hole, top, base, code, row, arrays.get(f"{prefix}.ended"))
