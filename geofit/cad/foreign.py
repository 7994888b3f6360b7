"""CAD files of others, read by OpenCASCADE in a process of its own.

A damaged STEP, IGES or BREP file may end the process that reads it (a segmentation fault), eat all memory, or never
come to an end. So a child reads it, ``python -m geofit.cad.foreign``, under limits of time and memory, and leaves plain
arrays: whatever becomes of it, the caller gets surfaces or an :class:`~geofit.data.errors.InputError`.

The result is a ``.npz`` without pickled objects: arrays ``a0``, ``a1``, ... and ``meta``, JSON text that refers to
them by number.
"""

from __future__ import annotations

import importlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.imported import existing
from geofit.data.errors import GeofitError, InputError, MissingDependencyError
from geofit.data.legible import legible
from geofit.data.messages import Message, Untranslated, message
from geofit.implicit.mesh import TriangleMesh
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface
from geofit.surfaces.trimmed import TrimmedSurface

__all__ = ["read_in_child"]

#: What reads a file within the child, by the name on its command line.
READERS = {
    "step": ("geofit.cad.step", "step_surfaces"),
    "iges": ("geofit.cad.iges_brep", "iges_surfaces"),
    "brep": ("geofit.cad.iges_brep", "brep_surfaces"),
    "solid": ("geofit.cad.solid_mesh", "solid_meshes"),
}
#: Seconds of the processor that a child has, and more of them a megabyte of the file; by the clock it is three times.
SECONDS, SECONDS_MB, WAITING = 20.0, 20.0, 3.0
#: Bytes of address space that it has (the libraries alone map 1.5 GB), and more of them a byte of the file.
MEMORY, MEMORY_BYTE = 6_000_000_000, 200
#: What the end of a child by the limit of its time looks like.
_TOO_LONG = -int(getattr(signal, "SIGXCPU", 24))


def read_in_child(path: str | PathLike[str], reader: str) -> dict[str, Any]:
    """Read the surfaces, or the triangles of the solids, of a CAD file in a child process.

    Parameters
    ----------
    path : path
        The file.
    reader : {"step", "iges", "brep", "solid"}
        As what it is read.

    Raises
    ------
    InputError
        If the file does not exist or cannot be read, or if reading it ended the child, took too long or needed too
        much memory.
    """
    source = existing(path)
    size = source.stat().st_size
    seconds = SECONDS + SECONDS_MB * size / 1e6
    with tempfile.TemporaryDirectory(prefix="geofit-") as folder:
        result = Path(folder) / "result.npz"
        command = [sys.executable, "-P", "-m", "geofit.cad.foreign", reader, str(source), str(result)]
        command += [str(int(np.ceil(seconds))), str(MEMORY + MEMORY_BYTE * size)]
        try:
            ended = subprocess.run(
                command,
                timeout=WAITING * seconds,
                check=False,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
            ).returncode
        except subprocess.TimeoutExpired:
            ended = _TOO_LONG
        if ended == _TOO_LONG:
            raise _refused(
                source,
                message("cad.reading-too-long", "Reading the file takes longer than {seconds:.0f} s", seconds=seconds),
            )
        if ended != 0 or not result.is_file():
            raise _refused(
                source,
                message(
                    "cad.reading-crashed",
                    "The file is damaged: reading it ends OpenCASCADE (exit code {code})",
                    code=ended,
                ),
            )
        return _load(result, source)


def _refused(source: Path, reason: Message) -> InputError:
    return InputError(
        reason,
        message("cad.export-step-from-cad", "Open it in a CAD program and export the surface as STEP again."),
        file=str(source),
    )


def child(arguments: Sequence[str]) -> int:
    """Read one file within limits, and leave the surfaces, or why there are none, in a file."""
    reader, path, result, seconds, memory = arguments
    _limit(int(seconds), int(memory))
    module, function = READERS[reader]
    try:
        source = _readable(Path(path), Path(result).parent)
        _save(Path(result), getattr(importlib.import_module(module), function)(source))
    except InputError as error:
        _write(Path(result), {"reason": _stored(error.reason), "remedy": _stored(error.remedy)}, [])
    except GeofitError as error:
        key = "missing" if isinstance(error, MissingDependencyError) else "reason"
        _write(Path(result), {key: _stored(error.message)}, [])
    except MemoryError:
        reason = message("cad.too-much-memory", "Reading the file needs too much memory")
        _write(Path(result), {"reason": _stored(reason)}, [])
    except Exception as error:  # whatever OpenCASCADE raises about damaged geometry
        reason = message("cad.damaged", "The file is damaged ({kind})", kind=type(error).__name__)
        _write(Path(result), {"reason": _stored(reason)}, [])
    return 0


def _readable(path: Path, folder: Path) -> Path:
    """Return a name of the file that OpenCASCADE can open: it takes UTF-8 only, so others are copied."""
    if legible(str(path)) == str(path):
        return path
    copy = folder / f"{legible(path.stem)}{path.suffix}"
    shutil.copyfile(path, copy)
    return copy


def _limit(seconds: int, memory: int) -> None:
    """Have the system end this process when it is too long or too large; Windows has no such limits."""
    if sys.platform == "win32":
        return
    import resource

    for kind, most in ((resource.RLIMIT_CPU, seconds), (resource.RLIMIT_AS, memory), (resource.RLIMIT_CORE, 0)):
        soft, hard = resource.getrlimit(kind)
        limits = [most if limit == resource.RLIM_INFINITY else min(most, limit) for limit in (soft, hard)]
        resource.setrlimit(kind, (limits[0], limits[1]))


def _save(target: Path, surfaces: Mapping[str, PatchSurface | TriangleMesh]) -> None:
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
            {"name": name, "origin": kept(surface.origin), "outline": kept(surface.outline), "patches": patches}
            | {"loops": loops}
        )
    if not all(np.isfinite(array).all() for array in arrays):
        reason = message("cad.not-finite", "The file has coordinates that are not finite numbers")
        _write(target, {"reason": _stored(reason)}, [])
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


def _load(result: Path, source: Path) -> dict[str, Any]:
    with np.load(result, allow_pickle=False) as file:
        meta = json.loads(file["meta"].tobytes())
        arrays = {name: file[name] for name in file.files if name != "meta"}
    if "missing" in meta:
        raise MissingDependencyError(_restored(meta["missing"]))
    if "reason" in meta:
        if "remedy" in meta:
            raise InputError(_restored(meta["reason"]), _restored(meta["remedy"]), file=str(source))
        raise _refused(source, _restored(meta["reason"]))

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
        surface = PatchSurface(patches, array(one["origin"]), one["name"], array(one["outline"]))
        if one["loops"] is not None:
            loops = tuple(tuple(array(loop) for loop in loops) for loops in one["loops"])
            surface = TrimmedSurface(patches, surface.origin, surface.name, surface.outline, trim_loops=loops)
        surfaces[surface.name] = surface
    return surfaces


if __name__ == "__main__":
    sys.exit(child(sys.argv[1:]))
