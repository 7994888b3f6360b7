"""Files that are whole or absent, and names that every file system takes."""

from __future__ import annotations

import errno
import os
import re
import unicodedata
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from uuid import uuid4

from geofit.data.errors import InputError
from geofit.data.legible import legible
from geofit.data.messages import message

__all__ = ["cannot_write", "file_stems", "is_file", "replacing", "spreadsheet_cell"]

_RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(1, 10))}
_LONGEST = 80


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary name beside ``path``; it becomes ``path`` only if the block ends without an error.

    Raises
    ------
    InputError
        If the system refuses to write the file (a full disk, no permission), with its name and the remedy.

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
    part = path.with_name(f".{path.stem}.{uuid4().hex[:8]}.part{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    except OSError as error:
        named = {str(name) for name in (error.filename, error.filename2) if name is not None}
        if error.errno is None or (named and str(part) not in named and str(path) not in named):
            raise  # another file's
        raise cannot_write(error, path) from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def cannot_write(error: OSError, path: str | os.PathLike[str]) -> InputError:
    """Return an error of the system as one that names the file and what to do about it."""
    match error.errno:
        case errno.ENOSPC | errno.EDQUOT | errno.EFBIG:
            remedy = message("data.make-room-on-disk", "Make room on the disk, or name another folder.")
        case errno.ENOENT | errno.ENOTDIR:
            remedy = message("data.make-or-name-folder", "Make the folder, or name another.")
        case errno.ENAMETOOLONG | errno.EINVAL:
            remedy = message("data.choose-another-name", "Choose another name.")
        case _:
            remedy = message(
                "data.name-writable-folder",
                "Name a folder that you may write to, and close the file in other programs.",
            )
    reason = message("data.file-not-written", "The file cannot be written: {error}", error=error.strerror or str(error))
    return InputError(reason, remedy, file=legible(str(path)))


def is_file(path: str | os.PathLike[str]) -> bool:
    """Whether there is an ordinary file: of a pipe or a device the end may never come, and NUL is in no name."""
    try:
        return Path(path).is_file()
    except (OSError, ValueError):
        return False


def spreadsheet_cell(cell: Any) -> Any:
    """Return a cell of a CSV file that no spreadsheet program takes for a formula.

    A name from a stranger's file may begin with one, which runs when the table is opened; numbers stay as they are.

    Examples
    --------
    >>> [spreadsheet_cell(cell) for cell in ("=1+1", "-3.5", "@a", "ZK1", -3.5)]
    ["'=1+1", '-3.5', "'@a", 'ZK1', -3.5]
    """
    if not isinstance(cell, str) or not cell.startswith(("=", "+", "-", "@", "\t", "\r")):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


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
