"""Results of tasks in a folder: what was ready when a run stopped is read again, and not computed.

A result belongs to its task by the SHA-256 of what was computed from what, and by which version.
"""

from __future__ import annotations

import hashlib
import pickle
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from geofit import __version__
from geofit.data.files import folder_for, replacing

__all__ = ["clear_kept", "keep_arrays", "kept_arrays", "kept_path"]

_ENDING = ".fold.npz"
_ONE = "one"


def kept_path(folder: Path, work: Callable[..., Any], task: Any) -> Path:
    """Return the file of a task's result: another task, function or version has another one."""
    digest = hashlib.sha256(f"{__version__} {work.__module__}.{work.__qualname__} ".encode())
    digest.update(pickle.dumps(task, protocol=5))
    return folder / f"{digest.hexdigest()[:32]}{_ENDING}"


def keep_arrays(path: Path, result: Any) -> None:
    """Write a result: an array, a tuple of arrays, or None.

    Raises
    ------
    InputError
        If the system refuses to write the file.
    TypeError
        If the result is anything else: it would be lost.
    """
    many = (result,) if isinstance(result, np.ndarray) else () if result is None else result
    if not isinstance(many, tuple) or not all(isinstance(one, np.ndarray) for one in many):
        raise TypeError(f"an array, a tuple of arrays or None can be kept, not {type(result).__name__}")
    folder_for(path.parent)
    arrays = {_ONE: result} if isinstance(result, np.ndarray) else {f"{k:03d}": one for k, one in enumerate(many)}
    with replacing(path) as part:
        np.savez(part, **arrays)


def kept_arrays(path: Path) -> tuple[bool, Any]:
    """Return whether the result is there, whole, and the result."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as found:
            arrays = {name: found[name] for name in sorted(found.files)}
    except (OSError, ValueError, zipfile.BadZipFile, EOFError):
        return False, None
    if _ONE in arrays:
        return True, arrays[_ONE]
    return True, tuple(arrays.values()) or None


def clear_kept(folder: Path) -> None:
    """Remove the results, and their folder if nothing else is in it."""
    with suppress(OSError):
        for path in folder.glob(f"*{_ENDING}"):
            path.unlink()
        folder.rmdir()
