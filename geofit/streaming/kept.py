"""Results of tasks in a folder: what was ready when a run stopped is read again, and not computed.

A result belongs to its task by the SHA-256 of what was computed from what, and by which version. Files that did not
come from this user of this machine are not read: each is signed with a key that lies in the user's own folder (HMAC,
RFC 2104), as reading a pickled object may run any code.
"""

from __future__ import annotations

import hashlib
import hmac
import pickle
import secrets
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from geofit import __version__
from geofit.data.errors import InputError
from geofit.data.files import folder_for, replacing

__all__ = ["clear_kept", "keep", "kept", "kept_path"]

_ENDING = ".kept"
#: Bytes of the key and of a signature.
_SIZE = 32


def kept_path(folder: Path, work: Callable[..., Any], task: Any) -> Path:
    """Return the file of a task's result: another task, function or version has another one."""
    digest = hashlib.sha256(f"{__version__} {work.__module__}.{work.__qualname__} ".encode())
    digest.update(pickle.dumps(task, protocol=5))
    return folder / f"{digest.hexdigest()[:32]}{_ENDING}"


def keep(path: Path, result: Any) -> None:
    """Write a result.

    Raises
    ------
    InputError
        If the system refuses to write the file.
    """
    folder_for(path.parent)
    data = pickle.dumps(result, protocol=5)
    with replacing(path) as part:
        part.write_bytes(hmac.digest(_key(), data, "sha256") + data)


def kept(path: Path) -> tuple[bool, Any]:
    """Return whether the result is there, whole and of this user, and the result."""
    try:
        found = path.read_bytes()
    except OSError:
        return False, None
    signature, data = found[:_SIZE], found[_SIZE:]
    if not hmac.compare_digest(signature, hmac.digest(_key(), data, "sha256")):
        return False, None
    return True, pickle.loads(data)


def clear_kept(folder: Path) -> None:
    """Remove the results, and their folder if nothing else is in it."""
    with suppress(OSError):
        for path in folder.glob(f"*{_ENDING}"):
            path.unlink()
        folder.rmdir()


@cache
def _key() -> bytes:
    """Return the user's key, made at first; where it cannot be written, one that ends with this process."""
    from platformdirs import user_state_path

    path = user_state_path("geofit", appauthor=False) / "kept.key"
    with suppress(OSError, InputError):
        if not path.exists() or path.stat().st_size != _SIZE:
            folder_for(path.parent)
            with replacing(path) as part:
                part.touch(0o600)
                part.write_bytes(secrets.token_bytes(_SIZE))
        return path.read_bytes()
    return secrets.token_bytes(_SIZE)
