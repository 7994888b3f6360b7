"""The journal of a session: what was done, on the disk before the next thing is done.

::

    1f00c3a2 {"format": "geofit journal", "version": 2, "site_file": "...", "state": {...}, ...}
    9b2e5d10 {"do": {"kind": "settings", "horizon": "T2-T1", ...}}
    03c1d7ee {"do": {"kind": "exclude", "horizon": "T2-T1", ...}, "points": {"T2-T1": [...]}}
    00aa81cc {"undo": true}
    5d8f3b02 {"saved": "dam.geofit", "state": {...}, "digest": "..."}

Each line carries its checksum and is on the disk (fsync) before the command counts as done. A session that ends
removes its journal; one that is there and that no living process holds was cut off, and is replayed from its
first line up to the last whole one. A journal that a newer geofit wrote, or that makes no sense, is kept under another
name (``.unreadable``) and never looked at again. ``points`` is who excluded points are: their files may have changed
when the session is brought back.
"""

from __future__ import annotations

import json
import logging
import os
import sys
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, Any

from geofit.data.errors import InputError
from geofit.data.files import file_stems
from geofit.data.site import Site
from geofit.io.snapshot import read_snapshot, write_snapshot
from geofit.project.commands import Command, command_from
from geofit.project.named_points import NO_NAMES, Names, names_from, names_to_data
from geofit.project.saving import earlier_data, saved_data
from geofit.project.state import State

__all__ = ["SessionJournal", "Unfinished", "unfinished"]

FORMAT, VERSION = "geofit journal", 2
#: Version 1 had no points, no digests, and began with what the files hold.
_READ = (1, 2)
_SUFFIX, _KEPT = ".journal", ".unreadable"

_LOG = logging.getLogger(__name__)


class SessionJournal:
    """The journal of this session; ``folder`` is created if missing.

    ``saved`` is the state that the files hold, by default the one that the session begins with; ``digest`` is the
    SHA-256 of the project file.
    """

    def __init__(
        self,
        folder: Path,
        state: State,
        site_file: Path | None,
        project_file: Path | None,
        saved: State | None = None,
        digest: str = "",
        names: Names = NO_NAMES,
    ) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.path, self._stream = _new_file(folder)
        self._kept: list[Path] = []
        try:
            _hold(self._stream)
            self._write(
                {
                    "format": FORMAT,
                    "version": VERSION,
                    "site_file": None if site_file is None else str(site_file),
                    "project_file": None if project_file is None else str(project_file),
                    "digest": digest,
                    "state": state.to_data(),
                    "saved": None if saved is None or saved == state else saved.to_data(),
                    **_points(names),
                }
            )
            _sync_folder(folder)
        except OSError:
            self.end()
            raise

    def keep(self, name: str, site: Site) -> None:
        """Keep data of the site that a command replaces, until the session ends: undoing it needs them."""
        file = _data_file(self.path.parent, name)
        if not file.is_file():
            write_snapshot(site, file)
        self._kept.append(file)

    def done(self, command: Command, names: Names = NO_NAMES) -> None:
        """Write that a command was done; ``names`` are those of excluded points that the journal does not have yet."""
        self._write({"do": command.to_data(), **_points(names)})

    def undone(self, names: Names = NO_NAMES) -> None:
        """Write that the last command was undone."""
        self._write({"undo": True, **_points(names)})

    def redone(self, names: Names = NO_NAMES) -> None:
        """Write that the command undone last was done again."""
        self._write({"redo": True, **_points(names)})

    def restarted(self, state: State, names: Names = NO_NAMES) -> None:
        """Write that the session goes on from a state that is not one step of this journal away."""
        self._write({"base": state.to_data(), **_points(names)})

    def saved(self, project_file: Path, state: State, digest: str = "") -> None:
        """Write that the project file holds a state."""
        self._write({"saved": str(project_file), "state": state.to_data(), "digest": digest})

    def end(self) -> None:
        """End the session: nothing is to be recovered."""
        # What could not be written before cannot be written now: it is not wanted any more.
        with suppress(OSError):
            self._stream.close()
        for file in (self.path, *self._kept):
            with suppress(OSError):
                file.unlink(missing_ok=True)

    def _write(self, record: Mapping[str, Any]) -> None:
        # A path may have bytes that are not UTF-8: they come back as they are.
        text = json.dumps(record, ensure_ascii=False).encode("utf-8", "surrogatepass")
        self._stream.write(b"%08x " % zlib.crc32(text) + text + b"\n")
        self._stream.flush()
        os.fsync(self._stream.fileno())


@dataclass(frozen=True)
class Unfinished:
    """A session that was cut off.

    ``base`` is the state that it began with, ``commands`` what was done since and not undone, ``saved`` the state
    that the files hold, ``digest`` the SHA-256 of the project file that holds it, ``names`` who the excluded points of
    the last state are, and ``time`` that of the last line (seconds, as ``os.stat`` has it).
    """

    path: Path
    site_file: Path | None
    project_file: Path | None
    base: State
    commands: tuple[Command, ...]
    saved: State
    time: float
    digest: str = ""
    names: Names = field(default_factory=dict)

    def data(self) -> list[Site]:
        """Return the data of the site that states of the session name and that the journal, or its project, kept."""
        found = {}
        for state in self.states():
            for name in (state.data, *earlier_data(state)):
                with suppress(InputError):
                    found[name] = read_snapshot(_data_file(self.path.parent, name))
            if self.project_file is not None:
                found |= saved_data(state, self.project_file)
        return list(found.values())

    def at(self, site_file: Path) -> Unfinished:
        """Return the session with its site file, which was moved, where it is now.

        The project was moved with it if it is at the same place from there. Else it is to be saved: it names a site
        file that is not there, or is not there itself.
        """
        project = self._project_from(site_file)
        if project is not None:
            return replace(self, site_file=site_file, project_file=project)
        left = self.project_file if self.project_file is not None and self.project_file.is_file() else None
        return replace(
            self, site_file=site_file, project_file=left, saved=State(), digest="" if left is None else self.digest
        )

    def _project_from(self, site_file: Path) -> Path | None:
        if self.site_file is None or self.project_file is None:
            return None
        try:
            place = os.path.relpath(self.project_file, self.site_file.parent)
        except ValueError:  # on another drive of Windows
            return None
        project = Path(os.path.normpath(site_file.parent / place))
        return project if project.is_file() else None

    @property
    def final(self) -> State:
        """The state when it was cut off."""
        return list(self.states())[-1]

    def states(self) -> Iterator[State]:
        """Return the states after each command, the base first."""
        state = self.base
        yield state
        for command in self.commands:
            state = command.on(state)
            yield state

    def taken_over(self) -> None:
        """Remove the journal: another session goes on with it, and with the data that it kept."""
        self.path.unlink(missing_ok=True)

    def discard(self) -> None:
        """Remove the journal: the session is recovered, or nobody wants it."""
        self.path.unlink(missing_ok=True)
        for state in self.states():
            _data_file(self.path.parent, state.data).unlink(missing_ok=True)


def unfinished(folder: Path) -> list[Unfinished]:
    """Return the sessions that were cut off with something unsaved, the latest first; journals of others stay.

    One that cannot be read is renamed to ``NAME.unreadable``, and the log reports it.
    """
    found = []
    for path in folder.glob(f"*{_SUFFIX}"):
        try:
            with path.open("rb+") as stream:
                _hold(stream)
                data = stream.read()
        except OSError:
            continue  # another process has it open, or has just removed it
        try:
            session = _read(path, data)
            begun = session is not None and session.final != session.saved
        except Exception as error:  # any bytes may be there: the journals of other sessions are still to be told
            _set_aside(path, error)
            continue
        if session is not None and begun:
            found.append(session)
        else:
            path.unlink(missing_ok=True)
    return sorted(found, key=lambda session: -session.time)


def _set_aside(path: Path, error: Exception) -> None:
    kept = path.with_name(path.name + _KEPT)
    with suppress(OSError):
        os.replace(path, kept)
        _LOG.warning("The journal of a session cannot be read (%s); it is kept as %s", error, kept)


def _read(path: Path, data: bytes) -> Unfinished | None:
    """Return what a journal tells; None if nothing was done: the session was cut off within its first line.

    Any error states that a newer geofit wrote it, or that it is damaged.
    """
    if b"\n" not in data:
        return None
    records = _records(data)
    head = next(records, None)
    if head is None:
        raise ValueError("its first line is damaged")
    if head["format"] != FORMAT or head["version"] not in _READ:
        raise ValueError(f"it is a {head['format']} of version {head['version']}, this geofit reads up to {VERSION}")
    done: list[Command] = []
    undone: list[Command] = []
    project_file, digest = head["project_file"], head.get("digest", "")
    base = State.from_data(head["state"])
    saved = State.from_data(head["saved"]) if head.get("saved") else base
    names = names_from(head.get("points", {}))
    for record in records:
        for name, rows in names_from(record.get("points", {})).items():
            names.setdefault(name, {}).update(rows)
        if "do" in record:
            done.append(command_from(record["do"]))
            undone.clear()
        elif "undo" in record:
            undone.append(done.pop())
        elif "redo" in record:
            done.append(undone.pop())
        elif "base" in record:
            base = State.from_data(record["base"])
            done.clear()
            undone.clear()
        else:
            saved, project_file = State.from_data(record["state"]), record["saved"]
            digest = record.get("digest", "")
    return Unfinished(
        path,
        _path(head["site_file"]),
        _path(project_file),
        base,
        tuple(done),
        saved,
        path.stat().st_mtime,
        digest,
        names,
    )


def _points(names: Names) -> dict[str, Any]:
    return {"points": names_to_data(names)} if any(names.values()) else {}


def _records(data: bytes) -> Iterator[dict[str, Any]]:
    """Return the lines up to the first that is torn."""
    for line in data.split(b"\n")[:-1]:
        checksum, _, text = line.partition(b" ")
        if checksum != b"%08x" % zlib.crc32(text):
            return
        yield json.loads(text)


def _data_file(folder: Path, name: str) -> Path:
    return folder / "data" / f"{file_stems([name])[name]}.npz"


def _path(text: str | None) -> Path | None:
    return None if text is None else Path(text)


def _new_file(folder: Path) -> tuple[Path, IO[bytes]]:
    for turn in range(10_000):
        path = folder / f"session-{os.getpid()}-{turn}{_SUFFIX}"
        with suppress(FileExistsError):
            return path, path.open("xb")
    raise FileExistsError(f"{folder} is full of journals; remove the old ones.")


def _sync_folder(folder: Path) -> None:
    """Make the file's name as lasting as its contents; Windows does that by itself."""
    if sys.platform != "win32":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _hold(stream: IO[bytes]) -> None:
    """Mark a journal as that of a living process: OSError if another holds it. Any end of the process frees it."""
    if sys.platform == "win32":
        import msvcrt

        place = stream.tell()
        # Far beyond the end: on Windows a locked range cannot be read by others.
        stream.seek(1 << 30)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        stream.seek(place)
    else:
        import fcntl

        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
