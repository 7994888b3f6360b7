"""CAD files of others, read by OpenCASCADE in a process of its own.

A damaged STEP, IGES or BREP file may end the process that reads it (a segmentation fault), eat all memory, or never
come to an end. So a child reads it, ``python -m geofit.cad.foreign``, under limits of time and memory, and leaves plain
arrays (:mod:`geofit.cad.handover`): whatever becomes of it, the caller gets surfaces or an
:class:`~geofit.data.errors.InputError`.
"""

from __future__ import annotations

import importlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from geofit.cad.handover import load_result, refused, save_reason, save_result
from geofit.cad.imported import existing
from geofit.data.errors import GeofitError, InputError, MissingDependencyError
from geofit.data.files import unfinished_file
from geofit.data.legible import legible
from geofit.data.messages import message

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
    with tempfile.TemporaryDirectory(prefix="geofit-") as folder, unfinished_file(folder):
        result = Path(folder) / "result.npz"
        command = [sys.executable, "-P", "-m", "geofit.cad.foreign", reader, str(source), str(result)]
        command += [str(int(np.ceil(seconds))), str(MEMORY + MEMORY_BYTE * size)]
        ended = _run(command, WAITING * seconds)
        if ended == _TOO_LONG:
            raise refused(
                source,
                message("cad.reading-too-long", "Reading the file takes longer than {seconds:.0f} s", seconds=seconds),
            )
        if ended != 0 or not result.is_file():
            raise refused(
                source,
                message(
                    "cad.reading-crashed",
                    "The file is damaged: OpenCASCADE crashes when it reads it (exit code {code})",
                    code=ended,
                ),
            )
        return load_result(result, source)


def _run(command: Sequence[str], seconds: float) -> int:
    """Run a child, which ends when this process does; return its exit code."""
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
    ) as process:
        try:
            return process.wait(seconds)
        except subprocess.TimeoutExpired:
            return _TOO_LONG
        finally:
            process.kill()


def _end_with_caller() -> None:
    """End this process once its caller has ended: no one is left to use the result or remove the folder."""

    def watch() -> None:
        # The caller writes nothing, and the system closes its end. Not sys.stdin: its lock would be held at the end.
        os.read(0, 1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def child(arguments: Sequence[str]) -> int:
    """Read one file within limits, and leave the surfaces, or why there are none, in a file."""
    reader, path, result, seconds, memory = arguments
    _limit(int(seconds), int(memory))
    module, function = READERS[reader]
    try:
        source = _readable(Path(path), Path(result).parent)
        save_result(Path(result), getattr(importlib.import_module(module), function)(source))
    except InputError as error:
        save_reason(Path(result), reason=error.reason, remedy=error.remedy)
    except GeofitError as error:
        key = "missing" if isinstance(error, MissingDependencyError) else "reason"
        save_reason(Path(result), **{key: error.message})
    except MemoryError:
        save_reason(Path(result), reason=message("cad.too-much-memory", "Reading the file needs too much memory"))
    except Exception as error:  # whatever OpenCASCADE raises about damaged geometry
        reason = message("cad.damaged", "The file is damaged ({kind})", kind=type(error).__name__)
        save_reason(Path(result), reason=reason)
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


if __name__ == "__main__":
    _end_with_caller()
    sys.exit(child(sys.argv[1:]))
