"""Whether a file is another one than before, seen without reading it."""

from __future__ import annotations

from pathlib import Path

__all__ = ["Stamp", "stamp"]

#: Time of the last change and size of a file: unless these differ its hash need not be looked at. None: no file.
Stamp = tuple[int, int] | None


def stamp(file: Path) -> Stamp:
    """Return the stamp of a file."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
