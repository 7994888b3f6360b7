"""Clouds of points in LAS, LAZ, Parquet and text tables, chunk by chunk: a file need not fit into the memory."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.site import ImportIssue
from geofit.io.columns import PICKS, Schema, plain_name
from geofit.io.digits import LEAST, lost_by_rounding
from geofit.io.extra import need
from geofit.io.journal import MOST, Journal
from geofit.io.rows import Rows, read_rows
from geofit.io.source import Source
from geofit.io.units import METRES, list_conversion, metres_of, unit_marked

__all__ = ["STREAMED", "Cloud", "is_cloud", "open_cloud"]

Floats = NDArray[np.float64]

#: Bytes from which on a text table is read as a cloud without being asked.
STREAMED = 512_000_000
#: Points, and bytes of text, that are read at a time.
CHUNK, PIECE = 1_000_000, 32_000_000


@dataclass(eq=False)
class Cloud:
    """A file of points that is read in chunks, each time from its beginning.

    ``total`` is the number of points where the file says it. After a reading of a text ``read`` and ``used`` count its
    rows, and ``issues`` lists those that are not used.
    """

    path: Path
    total: int | None
    columns: Mapping[str, str | int] = field(default_factory=dict)
    horizon: str | None = None
    sep: str | None = None
    decimal: str | None = None
    unit: str | None = None
    read: int = 0
    used: int = 0
    issues: list[ImportIssue] = field(default_factory=list)

    @property
    def key(self) -> str:
        """What changes when the file does, or how it is read."""
        found = self.path.stat()
        how = (sorted(self.columns.items()), self.horizon, self.sep, self.decimal, self.unit)
        return f"{self.path.resolve()} {found.st_size} {found.st_mtime_ns} {how}"

    def chunks(self) -> Iterator[Floats]:
        """Yield (m, 3) easting, northing, elevation in metres.

        Raises
        ------
        InputError
            If the file is damaged, or has no such columns.
        """
        match _form(self.path):
            case "las":
                yield from _in_metres(self, _las(self.path))
            case "parquet":
                yield from _parquet(self)
            case _:
                yield from _text(self)


def is_cloud(path: Path) -> bool:
    """Whether a file holds a cloud: LAS or LAZ of a scanner, Parquet, or a text table of half a gigabyte."""
    form = _form(path)
    if form == "text":
        return path.suffix.casefold() in (".csv", ".txt", ".xyz", ".tsv") and path.stat().st_size >= STREAMED
    return form != ""


@arguments_checked
def open_cloud(
    path: Path,
    columns: Mapping[str, str | int | None] | None = None,
    horizon: str | None = None,
    sep: str | None = None,
    decimal: str | None = None,
    unit: str | None = None,
) -> Cloud:
    """Return a file of points to be read in chunks.

    Parameters
    ----------
    path : Path
        LAS, LAZ, Parquet, or a text table.
    columns : mapping, optional
        Column of "x", "y", "z" (and "horizon", of a text): its header, or in a text its number from 1.
    horizon : str, optional
        The horizon to be read of a text that has several.
    sep, decimal : str, optional
        Separator and decimal mark of a text, where the guess is wrong.
    unit : str, optional
        Unit of all coordinates; else what the headers of a table mark, else metres.

    Returns
    -------
    Cloud
        The file, with the number of its points where it says it; ``chunks()`` reads it.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged.
    MissingDependencyError
        If laspy or pyarrow is needed and not installed (extra ``scale``).

    Notes
    -----
    Formats: ``docs/formats_in.md``, "Clouds of points".
    """
    Source(path=path, sep=sep, decimal=decimal)
    if unit is not None:
        metres_of(unit, path.name)
    if not path.is_file():
        Source(path=path).read()  # raises, and states why
    given = {role: column for role, column in (columns or {}).items() if column is not None}
    total = None
    match _form(path):
        case "las":
            with _opened_las(path) as reader:
                total = int(reader.header.point_count)
        case "parquet":
            total = int(_opened_parquet(path).metadata.num_rows)
    return Cloud(path, total, given, horizon, sep, decimal, unit)


def _form(path: Path) -> str:
    """Return "las", "parquet" or "text" as the first bytes say; empty for what is none of them."""
    try:
        with path.open("rb") as file:
            head = file.read(4)
    except OSError:
        return ""
    if head == b"LASF":
        return "las"
    return "parquet" if head == b"PAR1" else "text"


def _opened_las(path: Path) -> Any:
    laspy = need("laspy", "scale", message("io.reading-cloud", "Reading the cloud {file}", file=path.name))
    _require_records(path)
    try:
        return laspy.open(path)
    except Exception:  # laspy raises errors of its own, of struct and of lazrs
        raise _damaged(path) from None


def _require_records(path: Path) -> None:
    """Refuse a header that counts more records than the file has room for: laspy makes them all, without end."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(247).ljust(247, b"\0")
    length, points, records = struct.unpack_from("<HII", head, 94)
    start, extended = struct.unpack_from("<QI", head, 235) if head[25] >= 4 else (0, 0)
    if length + 54 * records > points or points > size or (extended and start + 60 * extended > size):
        raise _damaged(path)


def _opened_parquet(path: Path) -> Any:
    parquet = need("pyarrow.parquet", "scale", message("io.reading-cloud", "Reading the cloud {file}", file=path.name))
    try:
        return parquet.ParquetFile(path)
    except (OSError, ValueError):
        raise _damaged(path) from None


def _damaged(path: Path) -> InputError:
    return InputError(
        message("io.cloud-damaged", "The cloud is damaged, incomplete or of another format"),
        message("io.export-again", "Export it again."),
        file=path.name,
    )


def _las(path: Path) -> Iterator[Floats]:
    with _opened_las(path) as reader:
        chunks = reader.chunk_iterator(CHUNK)
        while True:
            try:
                points = next(chunks)
            except StopIteration:
                return
            except Exception:
                raise _damaged(path) from None
            yield np.column_stack([np.asarray(points[name], np.float64) for name in ("x", "y", "z")])


def _in_metres(cloud: Cloud, chunks: Iterator[Floats]) -> Iterator[Floats]:
    """Convert chunks from the stated unit; a scanner's file marks none."""
    if cloud.unit is None:
        yield from chunks
        return
    journal = Journal()
    list_conversion(cloud.unit, ("x", "y", "z"), cloud.path.name, journal)
    cloud.issues[:] = journal.issues
    metres = metres_of(cloud.unit, cloud.path.name)
    for chunk in chunks:
        yield chunk * metres


def _marked_metres(cloud: Cloud, headers: list[str]) -> Floats:
    """Return the metres of one unit of each column, stated or marked in its header; conversions are listed."""
    units = [cloud.unit or unit_marked(plain_name(header)[1]) or "m" for header in headers]
    journal = Journal()
    for unit in dict.fromkeys(units):
        roles = tuple(role for role, one in zip(("x", "y", "z"), units, strict=True) if one == unit)
        list_conversion(unit, roles, cloud.path.name, journal)
    cloud.issues[:] = journal.issues
    return np.array([METRES[unit_marked(unit) or "m"] for unit in units])


def _parquet(cloud: Cloud) -> Iterator[Floats]:
    file = _opened_parquet(cloud.path)
    names = file.schema_arrow.names
    spelled = {plain_name(name)[0]: name for name in reversed(names)}
    chosen = []
    for role in ("x", "y", "z"):
        stated = cloud.columns.get(role)
        found = stated if stated in names else next((spelled[w] for w in PICKS.required[role] if w in spelled), None)
        if found is None or (stated is not None and stated not in names):
            raise InputError(
                message(
                    "io.cloud-column-missing",
                    "No column for {role} was found; there are {names}",
                    role=role,
                    names=names,
                ),
                message("io.name-cloud-column", "Name it with --{role}.", role=role),
                file=cloud.path.name,
            )
        chosen.append(str(found))
    cloud.read = cloud.used = 0
    metres = _marked_metres(cloud, chosen)
    single = np.array([str(file.schema_arrow.field(name).type) == "float" for name in chosen[:2]])
    largest = np.zeros(2)
    try:
        for batch in file.iter_batches(CHUNK, columns=chosen):
            xyz = (
                np.column_stack([np.asarray(batch.column(name).to_numpy(False), np.float64) for name in chosen])
                * metres
            )
            finite = np.isfinite(xyz).all(axis=1)
            largest = np.maximum(largest, np.abs(xyz[finite, :2]).max(axis=0, initial=0.0))
            cloud.read, cloud.used = cloud.read + len(xyz), cloud.used + int(finite.sum())
            yield xyz if finite.all() else xyz[finite]
    except (OSError, ValueError, TypeError):
        raise _damaged(cloud.path) from None
    step = float(np.where(single, np.spacing((largest / metres[:2]).astype(np.float32)) * metres[:2], 0.0).max())
    if step > 2 * LEAST:
        journal = Journal(list(cloud.issues))
        journal.add("warning", cloud.path.name, *lost_by_rounding(step))
        cloud.issues[:] = journal.issues


@dataclass(frozen=True, kw_only=True)
class _Piece(Source):
    """Some lines of a text, under its header."""

    data: bytes = b""

    def read(self) -> bytes:
        """Return the lines."""
        return self.data


def _text(cloud: Cloud) -> Iterator[Floats]:
    """Read a text as :func:`geofit.io.picks.read_points` does, some lines at a time."""
    cloud.read = cloud.used = 0
    cloud.issues.clear()
    header, before = b"", 0
    with cloud.path.open("rb") as file:
        rest = b""
        while data := file.read(PIECE):
            data = rest + data
            end = data.rfind(b"\n") + 1
            if not end and len(data) < PIECE:
                rest = data
                continue
            piece, rest = (data[:end], data[end:]) if end else (data, b"")
            xyz, header = _rows(cloud, piece, header, before)
            before += piece.count(b"\n")
            yield xyz
        if rest.strip():
            yield _rows(cloud, rest + b"\n", header, before)[0]


def _rows(cloud: Cloud, piece: bytes, header: bytes, before: int) -> tuple[Floats, bytes]:
    """Return the points of some lines, and the header that the lines below them are read under."""
    source = _Piece(
        path=cloud.path,
        sep=cloud.sep,
        decimal=cloud.decimal,
        unit=cloud.unit,
        columns=dict(cloud.columns),
        data=header + piece,
    )
    journal = Journal()
    rows = read_rows(source, Schema("picks", PICKS.required, PICKS.optional), journal)
    if not header and rows.table.named and len(rows):
        # Everything above the first row: the lines below are read under the same header.
        lines = piece.split(b"\n", int(rows.line[0]) - 1)
        header = b"\n".join(lines[:-1]) + b"\n"
        shift = 0
    else:
        shift = before - header.count(b"\n")
    cloud.sep, cloud.decimal = rows.table.sep, rows.table.decimal
    x, y = rows.places()
    z = rows.numbers("z", no_data=True)
    _choose_horizon(cloud, rows)
    cloud.read += rows.table.read
    cloud.used += int(rows.ok.sum())
    found = [issue for issue in journal.issues if issue.severity == "error" or not before]
    room = MOST - len(cloud.issues)
    cloud.issues += [replace(issue, row=issue.row + shift if issue.row else 0) for issue in found[: max(room, 0)]]
    return np.column_stack([x, y, z])[rows.ok], header


def _choose_horizon(cloud: Cloud, rows: Rows) -> None:
    if "horizon" not in rows.columns:
        return
    labels = rows.labels("horizon")
    used = sorted({labels.table[code] for code in np.unique(labels.codes[rows.ok]).tolist()})
    if cloud.horizon is None:
        if len(used) > 1:
            raise InputError(
                message(
                    "io.cloud-of-several-horizons",
                    "The table has {count} horizons: {names}",
                    count=len(used),
                    names=used[:40],
                ),
                message("io.name-cloud-horizon", "Name the one to be fitted with --horizon."),
                file=cloud.path.name,
            )
        return
    wanted = labels.table.index(cloud.horizon) if cloud.horizon in labels.table else -1
    rows.ok &= labels.codes == wanted
