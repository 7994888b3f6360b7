"""Files that are whole or absent, and names that every file system takes."""

from __future__ import annotations

import errno
import os
import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any
from uuid import uuid4

from geofit.data.errors import InputError
from geofit.data.legible import legible
from geofit.data.messages import Message, message

__all__ = [
    "cannot_write",
    "file_stems",
    "folder_for",
    "inputs_kept",
    "is_file",
    "note_input",
    "refuse_inputs",
    "replacing",
    "report_unfinished_to",
    "spreadsheet_cell",
    "unfinished_file",
]

_RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in "123456789¹²³")}
#: Bytes of a stem in UTF-8: file systems take names of 255, with all that is added to a stem.
_LONGEST = 150
#: Files that the run in progress reads; None outside a run: a window may save what it opened.
_INPUTS: ContextVar[set[Path] | None] = ContextVar("inputs", default=None)
#: Called for each file that is begun and finished; usually empty.
_LISTENERS: list[Callable[[Path, bool], object]] = []


def report_unfinished_to(listener: Callable[[Path, bool], object]) -> None:
    """Call ``listener(path, True)`` for each file or folder that this process begins and will remove or rename.

    ``listener(path, False)`` follows when it is gone. A process that is ended from outside removes nothing: whoever
    ends it then knows what to remove.
    """
    _LISTENERS.append(listener)


@contextmanager
def unfinished_file(path: str | os.PathLike[str]) -> Iterator[None]:
    """Remove a file at the end of the block, however it ends; those of :func:`report_unfinished_to` hear of both.

    A folder is reported, too; whoever made it removes it.
    """
    for listener in _LISTENERS:
        listener(Path(path), True)
    try:
        yield
    finally:
        with suppress(OSError):
            Path(path).unlink(missing_ok=True)
        for listener in _LISTENERS:
            listener(Path(path), False)


@contextmanager
def inputs_kept(paths: Iterable[Path]) -> Iterator[None]:
    """Keep the inputs of a run from being replaced by its results: ``paths``, and all that is noted in the block."""
    token = _INPUTS.set(set(paths))
    try:
        yield
    finally:
        _INPUTS.reset(token)


def note_input(path: Path) -> None:
    """Note a file that is going to be read; outside :func:`inputs_kept` nothing is kept."""
    inputs = _INPUTS.get()
    if inputs is not None:
        inputs.add(path)


def refuse_inputs(paths: Iterable[Path]) -> None:
    """Refuse to write where an input of the run is, under whatever name.

    Raises
    ------
    InputError
        If one of the paths is a file that the run reads.
    """
    inputs = _INPUTS.get() or set()
    for path in paths:
        if inputs and _is_one(path, inputs):
            raise InputError(
                message("data.output-is-input", "The file is an input of this run, and a result would overwrite it"),
                message("data.name-another-output", "Name another file or folder for the results."),
                file=str(path),
            )


def _is_one(path: Path, files: Iterable[Path]) -> bool:
    """Whether a path leads to one of some files: by a link, or in letters of another case where that does not count."""
    try:
        state = path.stat()
    except (OSError, ValueError):  # it is not there, or no file can have such a name
        return False
    for file in files:
        with suppress(OSError, ValueError):
            if os.path.samestat(state, file.stat()):
                return True
    return False


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary name beside ``path``; it becomes ``path`` only if the block ends without an error.

    Raises
    ------
    InputError
        If the system refuses to write the file (a full disk, no permission), with its name and the remedy; if
        the file is an input of the run (:func:`inputs_kept`); or if a device or a pipe has its name, which would be
        replaced.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with replacing(Path(folder) / "a.txt") as part:
    ...         _ = part.write_text("whole", encoding="utf-8")
    ...     (Path(folder) / "a.txt").read_text(encoding="utf-8")
    'whole'
    """
    # A link stays one: what it leads to is replaced.
    path = Path(os.path.realpath(path)) if os.path.islink(path) else Path(path)
    refuse_inputs([path])
    if os.path.exists(path) and not is_file(path) and not os.path.isdir(path):
        raise InputError(
            message("data.output-not-file", "It is a pipe or a device, not a file, and would be replaced"),
            message("data.name-another-output", "Name another file or folder for the results."),
            file=legible(str(path)),
        )
    # Short: the name of the file may be as long as the system allows.
    part = path.with_name(f".{uuid4().hex[:8]}.part{path.suffix}")
    try:
        with unfinished_file(part):
            yield part
            os.replace(part, path)
    except OSError as error:
        named = {str(name) for name in (error.filename, error.filename2) if name is not None}
        if error.errno is None or (named and str(part) not in named and str(path) not in named):
            raise  # another file's
        raise cannot_write(error, path) from None


def cannot_write(error: OSError, path: str | os.PathLike[str]) -> InputError:
    """Return an error of the system as one that names the file and what to do about it."""
    reason = message("data.file-not-written", "The file cannot be written: {error}", error=error.strerror or str(error))
    return InputError(reason, _remedy(error), file=legible(str(path)))


def folder_for(path: str | os.PathLike[str]) -> Path:
    """Create a folder for results if it is missing, and return it.

    Raises
    ------
    InputError
        If the system refuses, with the folder's name and the remedy.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = message(
            "data.folder-not-made", "The folder cannot be made: {error}", error=error.strerror or str(error)
        )
        raise InputError(reason, _remedy(error), file=legible(str(folder))) from None
    return folder


def _remedy(error: OSError) -> Message:
    match error.errno:
        case errno.ENOSPC | errno.EDQUOT | errno.EFBIG:
            return message("data.make-room-on-disk", "Make room on the disk, or name another folder.")
        case errno.ENOENT | errno.ENOTDIR:
            return message("data.make-or-name-folder", "Make the folder, or name another.")
        case errno.ENAMETOOLONG | errno.EINVAL | errno.EEXIST:
            return message("data.choose-another-name", "Choose another name.")
        case _:
            return message(
                "data.name-writable-folder",
                "Name a folder that you may write to, and close the file in other programs.",
            )


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


def file_stems(names: Iterable[str], endings: Iterable[str] = ("",), taken: Iterable[str] = ()) -> dict[str, str]:
    """Return a file name (without ending) for each horizon, no two alike where case does not count.

    Letters of any script, digits, ``-``, ``_`` and inner dots stay; everything else becomes ``_``. Names beyond 150
    bytes of UTF-8 are cut.

    Parameters
    ----------
    names : iterable of str
        The horizons.
    endings : iterable of str
        What is added to a stem: no stem with an ending is another one with an ending.
    taken : iterable of str
        Files that no stem with an ending may be.

    Examples
    --------
    >>> file_stems(["T3/T2", "强风化下限", "t3_t2"])
    {'T3/T2': 'T3_T2', '强风化下限': '强风化下限', 't3_t2': 't3_t2-2'}
    >>> file_stems(["A", "A_upper90", "report"], (".step", "_upper90.step", ".pdf"), ["report.pdf"])
    {'A': 'A', 'A_upper90': 'A_upper90-2', 'report': 'report-2'}
    """
    stems: dict[str, str] = {}
    endings, used = [ending.casefold() for ending in endings], {file.casefold() for file in taken}
    for name in dict.fromkeys(names):
        stem = re.sub(r"[^\w.-]+", "_", unicodedata.normalize("NFC", name)).strip("._- ")
        # A letter that the cut goes through is left out.
        stem = stem.encode()[:_LONGEST].decode(errors="ignore").rstrip("._- ")
        if not stem or stem.split(".")[0].casefold() in _RESERVED:
            stem = f"horizon_{stem}".rstrip("_")
        unique, turn = stem, 2
        while used & (files := {unique.casefold() + ending for ending in endings}):
            unique, turn = f"{stem}-{turn}", turn + 1
        used |= files
        stems[name] = unique
    return stems
