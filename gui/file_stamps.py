"""Whether a file is another one than before, seen without reading it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

__all__ = ["Stamp", "changed_since", "stamp", "stamps_of"]

#: Time of the last change and size of a file: unless these differ its hash need not be looked at. None: no file.
Stamp = tuple[int, int] | None


def stamp(file: Path) -> Stamp:
    """Return the stamp of a file."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def stamps_of(files: Iterable[Path]) -> dict[Path, Stamp]:
    """Return the stamp of each file."""
    return {file: stamp(file) for file in files}


def changed_since(stamps: Mapping[Path, Stamp]) -> list[Path]:
    """Return the files that were written since, of those with stamps."""
    return [file for file, before in stamps.items() if stamp(file) not in (before, None)]
