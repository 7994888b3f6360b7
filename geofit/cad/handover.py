"""What the process that reads a CAD file hands back: a ``.npz`` without pickled objects.

It has arrays ``a0``, ``a1``, ... and ``meta``, JSON text that refers to them by number, or gives the reason why there
are none.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError, MissingDependencyError
from geofit.data.messages import Message, Untranslated, message
from geofit.implicit.mesh import TriangleMesh
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface
from geofit.surfaces.trimmed import TrimmedSurface

__all__ = ["load_result", "refused", "save_reason", "save_result"]


def save_reason(target: Path, **reasons: Message) -> None:
    """Write why no surface was read: ``reason``, with ``remedy`` where there is one, or the ``missing`` package."""
    _write(target, {key: _stored(reason) for key, reason in reasons.items()}, [])


def refused(source: Path, reason: Message) -> InputError:
    """Return the error of a file that cannot be read."""
    return InputError(
        reason,
        message("cad.export-step-from-cad", "Open it in a CAD program and export the surface as STEP again."),
        file=str(source),
    )


def save_result(target: Path, surfaces: Mapping[str, PatchSurface | TriangleMesh]) -> None:
    """Write surfaces, or that they have coordinates that are not finite."""
    arrays: list[NDArray[Any]] = []

    def kept(array: Any) -> int | None:
        """Return the number of an array in the file."""
        if array is None:
            return None
        arrays.append(np.asarray(array, dtype=np.float64))
        return len(arrays) - 1

    found: list[dict[str, Any]] = []
    for name, surface in surfaces.items():
        if isinstance(surface, TriangleMesh):
            found.append({"name": name, "vertices": kept(surface.vertices), "triangles": kept(surface.triangles)})
            continue
        patches = [
            {
                "name": patch.name,
                "degree": list(patch.degree),
                **{key: kept(getattr(patch, key)) for key in ("knots_u", "knots_v", "control", "weights")},
            }
            for patch in surface.patches
        ]
        loops = [[kept(loop) for loop in one] for one in surface.loops] if any(surface.loops) else None
        found.append(
            {"name": name, "frame": surface.frame, "origin": kept(surface.origin), "outline": kept(surface.outline)}
            | {"patches": patches, "loops": loops}
        )
    if not all(np.isfinite(array).all() for array in arrays):
        save_reason(target, reason=message("cad.not-finite", "The file has coordinates that are not finite numbers"))
        return
    _write(target, {"surfaces": found}, arrays)


def _stored(value: Any) -> Any:
    """Return what JSON can hold of a message and its parameters."""
    if isinstance(value, Message):
        params = {name: _stored(param) for name, param in value.params.items()}
        return {"code": value.code, "template": value.template, "params": params, "plural": value.plural}
    if isinstance(value, tuple):
        return [_stored(item) for item in value]
    if isinstance(value, Untranslated):
        return {"untranslated": str(value)}
    return value if isinstance(value, (str, int, float)) else str(value)


def _restored(value: Any) -> Any:
    """Return what :func:`_stored` made JSON of."""
    if isinstance(value, list):
        return tuple(_restored(item) for item in value)
    if isinstance(value, dict):
        if "untranslated" in value:
            return Untranslated(value["untranslated"])
        params = {name: _restored(param) for name, param in value["params"].items()}
        return Message(value["code"], value["template"], params, value["plural"])
    return value


def _write(target: Path, meta: Mapping[str, Any], arrays: Sequence[NDArray[Any]]) -> None:
    text = np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8)
    with target.open("wb") as stream:
        np.savez(stream, allow_pickle=False, meta=text, **{f"a{k}": array for k, array in enumerate(arrays)})


def load_result(result: Path, source: Path) -> dict[str, Any]:
    """Return the surfaces that were read from ``source``.

    Raises
    ------
    InputError
        If a reason was written in their place.
    MissingDependencyError
        If the reader needs an optional package.
    """
    with np.load(result, allow_pickle=False) as file:
        meta = json.loads(file["meta"].tobytes())
        arrays = {name: file[name] for name in file.files if name != "meta"}
    if "missing" in meta:
        raise MissingDependencyError(_restored(meta["missing"]))
    if "reason" in meta:
        if "remedy" in meta:
            raise InputError(_restored(meta["reason"]), _restored(meta["remedy"]), file=str(source))
        raise refused(source, _restored(meta["reason"]))

    def array(number: int | None) -> Any:
        return None if number is None else arrays[f"a{number}"]

    surfaces: dict[str, Any] = {}
    for one in meta["surfaces"]:
        if "vertices" in one:
            surfaces[one["name"]] = TriangleMesh(array(one["vertices"]), array(one["triangles"]).astype(np.int64))
            continue
        patches = tuple(
            Patch(
                patch["name"],
                (patch["degree"][0], patch["degree"][1]),
                *(array(patch[key]) for key in ("knots_u", "knots_v", "control", "weights")),
            )
            for patch in one["patches"]
        )
        given = patches, array(one["origin"]), one["name"], array(one["outline"]), one["frame"]
        surface = PatchSurface(*given)
        if one["loops"] is not None:
            loops = tuple(tuple(array(loop) for loop in loops) for loops in one["loops"])
            surface = TrimmedSurface(*given, trim_loops=loops)
        surfaces[surface.name] = surface
    return surfaces
