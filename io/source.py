"""A file to be read, and what the user says about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from geofit.data.errors import InputError
from geofit.data.files import is_file, note_input
from geofit.data.given import arguments_checked
from geofit.data.legible import legible
from geofit.data.messages import message

__all__ = ["Source", "as_source"]


@arguments_checked
@dataclass(frozen=True, kw_only=True)
class Source:
    """A table file with whatever the user overrules; what is ``None`` is guessed, and the guess is listed.

    Parameters
    ----------
    path : Path
        Where the file is.
    name : str
        How messages and points name it; by default the file's own name.
    encoding, sep, decimal : str, optional
        Text encoding, separator of cells ("space" or " " for runs of blanks, "tab"), decimal mark.
    columns : mapping of str to str or int
        Column of a role: its header, or its number counted from 1.
    table : str
        Sheet of a workbook, group of an AGS file, layer of a GeoPackage, where the file has several.
    unit : str, optional
        Unit of all lengths: "m", "ft", "ft-us" (survey foot), "km", "cm" or "mm".
    measure : {"depth", "elevation"}, optional
        Whether from, to (of intervals), z (of picks) or the horizons count downwards or are elevations.
    horizons : sequence of str or int
        Columns of which each holds one horizon, where a table has one row a hole or place.
    crs, target : str, optional
        Coordinate system of x and y, and the one that is wanted: where both are codes that differ, the places
        are projected (extra ``gis``).
    usual_unit : str, optional
        Unit of the columns that are not marked with one: that of the whole site.
    """

    path: Path
    name: str = ""
    encoding: str | None = None
    sep: str | None = None
    decimal: str | None = None
    columns: Mapping[str, str | int] = field(default_factory=dict)
    table: str = ""
    unit: str | None = None
    measure: str | None = None
    horizons: Sequence[str | int] = ()
    crs: str | None = None
    target: str | None = None
    usual_unit: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", Path(self.path))
        note_input(self.path)
        name = self.name or legible(self.path.name) or legible(str(self.path))
        mark = f" [{self.table}]" if self.table else ""
        object.__setattr__(self, "name", name if name.endswith(mark) else name + mark)
        words = {"tab": "\t", "space": " ", "comma": ",", "semicolon": ";", "\\t": "\t"}
        object.__setattr__(self, "sep", words.get(self.sep, self.sep) if self.sep is not None else None)
        if self.sep is not None and len(self.sep) != 1:
            raise InputError(
                message("io.separator-not-character", "The separator {sep!r} is not one character", sep=self.sep),
                message("io.give-separator", "Give one character, 'tab' or 'space'."),
                file=self.name,
            )
        if self.decimal not in (None, ".", ","):
            raise InputError(
                message("io.decimal-mark-unknown", "The decimal mark {decimal!r} is unknown", decimal=self.decimal),
                message("io.give-decimal-mark", "Give '.' or ','."),
                file=self.name,
            )
        if self.measure not in (None, "depth", "elevation"):
            raise InputError(
                message("io.measure-unknown", "The measure {measure!r} is unknown", measure=self.measure),
                message("io.give-measure", "Give 'depth' or 'elevation'."),
                file=self.name,
            )

    def read(self) -> bytes:
        """Return the bytes of the file."""
        try:
            if self.path.exists() and not is_file(self.path) and not self.path.is_dir():
                raise InputError(
                    message("io.not-a-file", "It is a pipe or a device, not a file"),
                    message("io.name-a-file", "Name a file."),
                    file=self.name,
                )
            return self.path.read_bytes()
        except ValueError:
            raise InputError(
                message("io.file-name-with-nul", "The name of the file has a NUL character"),
                message("io.name-a-file", "Name a file."),
                file=self.name.replace("\0", "?"),
            ) from None
        except FileNotFoundError:
            raise InputError(
                message("data.file-missing", "There is no such file"),
                message(
                    "io.path-searched",
                    "It was looked for at {path}; names in a site file are relative to the site file's folder.",
                    path=self.path,
                ),
                file=self.name,
            ) from None
        except OSError as error:
            raise InputError(
                message(
                    "io.file-not-opened",
                    "The file cannot be opened: {error}",
                    error=error.strerror or str(error),
                ),
                message("io.name-readable-file", "Name a file that you may read."),
                file=self.name,
            ) from None


def as_source(given: str | Path | Source) -> Source:
    """Return a path as a source of which everything is guessed."""
    return given if isinstance(given, Source) else Source(path=Path(given))
