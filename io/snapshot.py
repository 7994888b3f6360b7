"""The data of a site as one file, so that an earlier state of it can be looked at again.

A zip archive of NumPy arrays, and ``site.json`` with the words. It holds what surfaces are fitted to and what pictures
show: points, study area, ground, dips, holes with their logs and section lines; not what the readers found.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError, InputError
from geofit.data.files import replacing
from geofit.data.labels import Labels
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.site import Ground, Hole, Orientations, Section, Site
from geofit.io.snapshot_logs import logs_from, pack_logs

__all__ = ["read_snapshot", "write_snapshot"]

FORMAT, VERSION = "geofit snapshot", 1
_WORDS = "site.json"
_NUMBERS = ("xyz", "accuracy", "row")
Arrays = dict[str, NDArray[Any]]


def write_snapshot(site: Site, path: Path) -> None:
    """Write the data of a site: the same site gives the same bytes.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    arrays: Arrays = {}
    words = {
        "boreholes": pack_logs(site.boreholes, arrays),
        "format": FORMAT, "version": VERSION, "name": site.name, "crs": site.crs, "datum": site.datum,
        "inputs": dict(site.inputs),
        "order": list(site.order), "faults": {fault: list(cut) for fault, cut in site.faults.items()},
        "horizons": [_points(f"horizon{k}", name, points, arrays)
                     for k, (name, points) in enumerate(site.horizons.items())],
        "holes": [{"name": hole.name, "kind": hole.kind} for hole in site.holes],
        "sections": [section.name for section in site.sections],
    }  # fmt: skip
    for k, hole in enumerate(site.holes):
        arrays |= {f"hole{k}.depth": hole.depth, f"hole{k}.xyz": hole.xyz}
    for k, section in enumerate(site.sections):
        arrays[f"section{k}.line"] = section.line
    if site.boundary is not None:
        arrays["boundary"] = np.asarray(site.boundary)
    for name, group in (("ground", site.ground), ("orientations", site.orientations)):
        if group is not None:
            arrays |= {f"{name}.{f.name}": getattr(group, f.name) for f in fields(group)}
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        # Without a date of their own members are of 1980: the bytes do not depend on the day.
        text = json.dumps(words, ensure_ascii=False).encode("utf-8", "surrogatepass")
        archive.writestr(zipfile.ZipInfo(_WORDS), text, zipfile.ZIP_DEFLATED)
        for name, array in arrays.items():
            with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as stream:
                np.lib.format.write_array(stream, np.ascontiguousarray(array), allow_pickle=False)


def read_snapshot(path: Path) -> Site:
    """Read what :func:`write_snapshot` wrote.

    Raises
    ------
    InputError
        If the file is absent, damaged, or of a newer version.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            words = json.loads(archive.read(_WORDS).decode("utf-8", "surrogatepass"))
            if words["format"] != FORMAT or words["version"] > VERSION:
                raise ValueError(f"it is a {words['format']} of version {words['version']}")
            arrays: Arrays = {}
            for name in archive.namelist():
                if name.endswith(".npy"):
                    with archive.open(name) as stream:
                        arrays[name.removesuffix(".npy")] = np.lib.format.read_array(stream, allow_pickle=False)
        return _site(words, arrays)
    except (OSError, ValueError, LookupError, TypeError, AttributeError, GeofitError, zipfile.BadZipFile):
        raise InputError(
            message("io.snapshot-unreadable", "The earlier data are damaged or incomplete"),
            message("io.keep-snapshot", "Without this file the earlier state cannot be compared."),
            file=str(path),
        ) from None


def _points(prefix: str, name: str, points: PointSet, arrays: Arrays) -> dict[str, Any]:
    arrays |= {f"{prefix}.{column}": getattr(points, column) for column in _NUMBERS}
    arrays |= {f"{prefix}.{word}": labels.codes for word, labels in points.labels.items()}
    return {"name": name, "tables": {word: list(labels.table) for word, labels in points.labels.items()}}


def _site(words: dict[str, Any], arrays: Arrays) -> Site:
    horizons = {}
    for k, one in enumerate(words["horizons"]):
        columns: dict[str, Any] = {column: arrays[f"horizon{k}.{column}"] for column in _NUMBERS}
        for word, table in one["tables"].items():
            codes = arrays[f"horizon{k}.{word}"]
            if len(codes) and not 0 <= codes.min() <= codes.max() < len(table):
                raise ValueError(f"a code of '{word}' is not in its table")
            columns[word] = Labels(codes, tuple(table))
        horizons[one["name"]] = PointSet(**columns)
    return Site(
        name=words["name"],
        horizons=horizons,
        boundary=arrays.get("boundary"),
        ground=_group(Ground, "ground", arrays),
        holes=tuple(
            Hole(hole["name"], hole["kind"], arrays[f"hole{k}.depth"], arrays[f"hole{k}.xyz"])
            for k, hole in enumerate(words["holes"])
        ),
        sections=tuple(Section(name, arrays[f"section{k}.line"]) for k, name in enumerate(words["sections"])),
        crs=words["crs"],
        datum=tuple(words["datum"]) if words.get("datum") else None,
        inputs=words["inputs"],
        orientations=_group(Orientations, "orientations", arrays),
        order=tuple(words["order"]),
        faults={fault: tuple(cut) for fault, cut in words["faults"].items()},
        boreholes=logs_from(words.get("boreholes", ()), arrays),
    )


def _group(kind: Any, name: str, arrays: Arrays) -> Any:
    if f"{name}.{fields(kind)[0].name}" not in arrays:
        return None
    return kind(**{f.name: arrays[f"{name}.{f.name}"] for f in fields(kind)})
