"""Files that are whole or absent, and names that every file system takes."""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["file_stems", "replacing"]

_RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(1, 10))}
_LONGEST = 80


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary name beside ``path``; it becomes ``path`` only if the block ends without an error.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with replacing(Path(folder) / "a.txt") as part:
    ...         _ = part.write_text("whole", encoding="utf-8")
    ...     (Path(folder) / "a.txt").read_text(encoding="utf-8")
    'whole'
    """
    path = Path(path)
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def file_stems(names: Iterable[str]) -> dict[str, str]:
    """Return a file name (without ending) for each horizon, no two alike where case does not count.

    Letters of any script, digits, ``-``, ``_`` and inner dots stay; everything else becomes ``_``.

    Examples
    --------
    >>> file_stems(["T3/T2", "强风化下限", "t3_t2"])
    {'T3/T2': 'T3_T2', '强风化下限': '强风化下限', 't3_t2': 't3_t2-2'}
    """
    stems: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        stem = re.sub(r"[^\w.-]+", "_", unicodedata.normalize("NFC", name)).strip("._- ")[:_LONGEST]
        if not stem or stem.split(".")[0].casefold() in _RESERVED:
            stem = f"horizon_{stem}".rstrip("_")
        unique, turn = stem, 2
        while unique.casefold() in taken:
            unique, turn = f"{stem}-{turn}", turn + 1
        taken.add(unique.casefold())
        stems[name] = unique
    return stems
