"""Typed rows of one table: a row is either used or listed, and every row is one of the two."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.labels import Labels
from geofit.data.legible import latin_letters, legible
from geofit.data.messages import EMPTY, Message, Untranslated, message, plural_message
from geofit.io.big_columns import BigColumn
from geofit.io.columns import GEOGRAPHIC, Schema, plain_name
from geofit.io.crs import WGS84, is_code, list_system, project_places, refuse_degrees
from geofit.io.formats import read_any_table
from geofit.io.guess import WORDS, find_columns
from geofit.io.journal import Journal, Severity
from geofit.io.no_data import is_no_data
from geofit.io.sniff import is_number
from geofit.io.source import Source, as_source
from geofit.io.tables import Table, parse_numbers
from geofit.io.units import ANGLES, DEGREES, LENGTHS, METRES, angle_factors, length_factors, with_unit

__all__ = ["Rows", "is_blank", "name_key", "read_rows"]

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Marks for a missing number, in lower case.
_NO_NUMBER = frozenset({
    "-", "--", "–", "—", "/", "?", "n/a", "n.a.", "na", "nan", "n.d.", "nd", "nil", "none", "null", "unknown",
    "k.a.", "unbekannt", "s.o.", "无", "不详",
})  # fmt: skip
#: Days as workbooks store them, and as spreadsheets in English, German or Chinese write them into text.
_DATE = re.compile(
    r"\d{4}-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d)?)?|\d{1,2}([./])\d{1,2}\1(?:19|20)\d\d|(?:19|20)\d\d/\d{1,2}/\d{1,2}"
    r"|\d{1,2}[-. ]{1,2}(?:jan|feb|mar|mär|mrz|apr|may|mai|jun|jul|aug|sept?|oct|okt|nov|dec|dez)\.?"
    r"(?:[- ]?\d\d(?:\d\d)?)?"
    r"|(?:\d{4}年)?\d{1,2}月\d{1,2}日",
    re.IGNORECASE,
)


class Rows:
    """The rows of a table under their roles.

    ``ok`` (n,) is True for rows that are still used; :meth:`reject` lists a row and takes it out.
    ``factors`` holds the metres, or degrees, of one unit of the columns that are in another one.
    """

    def __init__(self, table: Table, columns: dict[str, int], source: Source, journal: Journal) -> None:
        self.table, self.columns, self.source, self.journal = table, columns, source, journal
        self.factors = length_factors(table, columns, source, journal) | angle_factors(table, columns, journal)
        self.file = table.name
        self.line = table.lines
        self.ok: Mask = np.ones(len(table), dtype=bool)
        words = [j for role, j in columns.items() if role in WORDS]
        for column in table.columns[:1]:
            if isinstance(column, BigColumn):
                column.prepare([j for j in columns.values() if j not in words], words, table.decimal)

    def __len__(self) -> int:
        return len(self.table)

    def text(self, role: str, *, required: bool = True) -> list[str]:
        """Return the cells of a role without outer blanks; empty where there is no column."""
        labels = self.labels(role, required=required)
        return [labels.table[code] for code in labels.codes.tolist()]

    def labels(self, role: str, *, required: bool = True) -> Labels:
        """Return the cells of a role, as :meth:`text`, as codes."""
        if role not in self.columns:
            return Labels.same("", len(self))
        cells = self.table.columns[self.columns[role]]
        written = cells.labels() if isinstance(cells, BigColumn) else Labels.of(cells)
        found = written.renamed([_cleaned(cell) for cell in written.table])
        if required and "" in found.table:
            self._reject_empty(role, np.flatnonzero(found.codes == found.table.index("")).tolist())
        return found

    def holes(self, depth: Floats) -> list[str]:
        """Return the hole of each row of a log.

        If no name occurs twice, each hole is named in its first row alone, as in merged cells: a row without a name
        then belongs to the hole above if its ``depth`` (n,) exceeds the previous one. Other rows without a name are
        rejected.
        """
        names = self.text("hole", required=False)
        empty = [i for i, name in enumerate(names) if not name]
        once = len(set(names) - {""}) == len(names) - len(empty)
        filled = 0
        for i in empty if once else ():
            if i and names[i - 1] and depth[i] > depth[i - 1]:
                names[i] = names[i - 1]
                filled += 1
        if filled:
            reason = plural_message(
                "io.holes-from-above",
                "{count} row without a hole belongs to the hole above, whose depths it continues",
                "{count} rows without a hole belong to the holes above, whose depths they continue",
                count=filled,
            )
            remedy = message("io.repeat-hole-names", "To be sure, write the name of the hole in every row.")
            self.journal.add("warning", self.file, reason, remedy, column=self.table.header[self.columns["hole"]])
        self._reject_empty("hole", [i for i in empty if not names[i]])
        return names

    def numbers(self, role: str, *, required: bool = True, no_data: bool = False) -> Floats:
        """Return the numbers of a role; rows without a finite one are rejected, or nan where one is optional.

        A mark such as "n/a" is an empty cell where the number is optional. With ``no_data`` so are the usual numbers
        for "no value"; where one is required, they are rejected.
        """
        if role not in self.columns:
            return np.full(len(self), np.nan)
        cells = self.table.columns[self.columns[role]]
        values, bad = parse_numbers(cells, self.table.decimal)
        # One sentence for all rows: a column of words may have a million of them.
        empty, wrong = (
            message("io.cell-empty", "The {role} is empty", role=role),
            message("io.cell-not-a-number", "The {role} is not a finite number", role=role),
        )
        mark = self.table.decimal
        other = "." if mark == "," else ","
        remedy = message(
            "io.give-plain-number",
            "Give a number with the decimal mark '{mark}' and without thousands separators, in the unit of its column.",
            mark=mark,
        )
        mixed, one_mark = _mixed_marks(role, mark, other)
        for i in bad.tolist():
            if (number := self._with_unit(role, cells[i])) is not None:
                values[i] = number
            elif required and not cells[i].strip():
                self.reject(i, role, empty, message("io.complete-the-cell", "Complete the cell."))
            elif other in cells[i] and is_number(cells[i]):
                self.reject(i, role, mixed, one_mark)
            elif required or not is_blank(cells[i]):
                self.reject(i, role, wrong, remedy)
        if no_data and not required:
            values[is_no_data(values)] = np.nan
        elif no_data:
            unknown = message("io.cell-marks-no-data", "The {role} is a mark for 'no data'", role=role)
            for i in np.flatnonzero(is_no_data(values)).tolist():
                self.reject(
                    i, role, unknown, message("io.complete-cell-or-remove-row", "Complete the cell or remove the row.")
                )
        return values * self.factors[role] if role in self.factors else values

    def _with_unit(self, role: str, cell: str) -> float | None:
        """Return the number of a cell that states the unit of its column, in that unit; None if it does not."""
        found = with_unit(cell, self.table.decimal)
        if found is None:
            return None
        number, unit = found
        if role in LENGTHS:
            return number if METRES.get(unit) == self.factors.get(role, 1.0) else None
        return number if unit == DEGREES and role in ANGLES - self.factors.keys() else None

    def places(self) -> tuple[Floats, Floats]:
        """Return easting and northing (n,) in metres, projected where the source's system is not the wanted one.

        Raises
        ------
        InputError
            If a coordinate system is unknown, or counts in degrees and no other one is wanted.
        """
        x, y = self.numbers("x"), self.numbers("y")
        crs, target = self.source.crs or _degrees(self.table, self.columns), self.source.target
        if target is None and crs is not None and is_code(crs):
            refuse_degrees(crs, self.file)
            list_system(crs, x, y, self.file, self.journal)
        if not (is_code(crs) and is_code(target)) or crs is None or target is None:
            return x, y
        metres = "x" in self.factors or "y" in self.factors
        east, north = project_places(x, y, crs, target, self.file, metres=metres)
        lost = np.isnan(east) & np.isfinite(x) & np.isfinite(y)
        for i in np.flatnonzero(lost & self.ok).tolist():
            reason = message(
                "io.place-not-projectable",
                "The place cannot be projected from {crs} to {target}",
                crs=crs,
                target=target,
            )
            self.reject(i, "x", reason, message("io.correct-coordinates", "Correct the coordinates."))
        return east, north

    def reject(
        self, i: int, role: str, reason: Message, remedy: Message = EMPTY, *, severity: Severity = "error"
    ) -> None:
        """List row i and do not use it."""
        self.ok[i] = False
        self._list(severity, i, role, reason, remedy)

    def warn(
        self, i: int, role: str, reason: Message, remedy: Message = EMPTY, *, severity: Severity = "warning"
    ) -> None:
        """List row i but use it."""
        self._list(severity, i, role, reason, remedy)

    def require_known(self, role: str, names: Sequence[str], known: Iterable[str], where: str) -> list[str]:
        """Return the names as they are known, and reject the rows whose hole, adit or horizon is not.

        A name that differs from one known name only in case, leading zeros, blanks, hyphens or letters that look alike
        is that one, and is listed; ``where`` states what should name it.
        """
        present = list(known)
        lookup, hints = set(present), dict[str, Message]()
        if lookup.issuperset(names):
            return list(names)
        # The hole of a row that was refused is not another one.
        refused = {name_key(name): place for name, place in self.journal.refused.items()}
        meant = _meant({name for name in set(names) - lookup if name_key(name) not in refused}, lookup)
        self._list_meant(role, where, meant)
        names = [meant.get(name, name) for name in names]
        for i in np.flatnonzero(self.ok).tolist():
            name = names[i]
            if name in lookup:
                continue
            if name not in hints and (place := refused.get(name_key(name))):
                hints[name] = message(
                    "io.referred-row-not-used", "Its own row was not used ({place}): correct that first.", place=place
                )
            if name not in hints:
                near = get_close_matches(name, present, 1) if len(hints) < 20 else []
                hints[name] = (
                    message("io.did-you-mean", "Did you mean '{name}'?", name=Untranslated(near[0]))
                    if near
                    else message("io.add-name-to-list", "Add it to the {where}.", where=where)
                )
            self.reject(
                i,
                role,
                message(
                    "io.name-unknown",
                    "The {role} '{name}' is not in the {where}",
                    role=role,
                    name=Untranslated(name),
                    where=where,
                ),
                hints[name],
            )
        return list(names)

    def _list_meant(self, role: str, where: str, meant: Mapping[str, str]) -> None:
        """List names that are taken as known ones: a difference in case is small, another may be of two holes."""
        pairs = {name: f"{name} = {meant[name]}" for name in sorted(meant)}
        case = [name for name in pairs if name.casefold() == meant[name].casefold()]
        marks = [name for name in pairs if name not in case]
        remedy = message("io.rename-other-horizon", "If they are two, rename one.")
        column = self.table.header[self.columns[role]]
        if case:
            reason = message(
                "io.names-matched-by-case",
                "Names that differ only in case from those of the {where} are taken as these: {names}",
                where=where,
                names=", ".join(pairs[name] for name in case[:40]),
            )
            self.journal.add("note", self.file, reason, remedy, column=column)
        if marks:
            reason = message(
                "io.names-matched-by-marks",
                "Names ({count}) that differ only in leading zeros, blanks, hyphens or look-alike letters from those "
                "of the {where} are taken as these: {names}",
                count=len(marks),
                where=where,
                names=", ".join(pairs[name] for name in marks[:10]),
            )
            self.journal.add("warning", self.file, reason, remedy, column=column)

    def close(self) -> None:
        """Count the rows: those of the file that are not used are listed."""
        self.journal.count(self.file, self.table.read, self.table.read - int(self.ok.sum()))

    def release(self) -> None:
        """Let go of the cells: the text of a large file need not stay while its points are made."""
        self.table = replace(self.table, columns=())

    def require_any(self) -> None:
        """Refuse the table if none of its rows can be used, with the first row's reason.

        Raises
        ------
        InputError
            If no row is left.
        """
        if self.ok.any():
            return
        first = next(
            (issue for issue in self.journal.issues if issue.file == self.file and issue.severity == "error"),
            None,
        )
        raise InputError(
            message(
                "io.no-usable-row-because",
                "None of the rows can be used; row {row}: {reason}",
                row=first.row,
                reason=first.reason,
            )
            if first
            else message("io.no-usable-row", "None of the rows can be used"),
            first.remedy if first else EMPTY,
            file=self.file,
            column=first.column if first else None,
            value=first.value if first else None,
        )

    def _reject_empty(self, role: str, rows: Iterable[int]) -> None:
        empty = message("io.cell-empty", "The {role} is empty", role=role)
        for i in rows:
            self.reject(i, role, empty, message("io.complete-the-cell", "Complete the cell."))

    def _list(self, severity: Severity, i: int, role: str, reason: Message, remedy: Message) -> None:
        j = self.columns.get(role)
        self.journal.add(
            severity,
            self.file,
            reason,
            remedy,
            row=int(self.line[i]),
            column=self.table.header[j] if j is not None else role,
            value=self.table.columns[j][i].strip() if j is not None else "",
        )


def read_rows(source: Source | str | Path, schema: Schema, journal: Journal) -> Rows:
    """Read a table and find its columns."""
    source = as_source(source)
    table = read_any_table(source, journal, schema.name)
    if table.crs and not source.crs:
        source = replace(source, crs=table.crs)
    rows = Rows(table, find_columns(table, schema, source, journal), source, journal)
    for role in ("hole", "code", "horizon"):
        _warn_of_dates(rows, role)
    return rows


def _warn_of_dates(rows: Rows, role: str) -> None:
    """Warn of names that a spreadsheet turned into dates: such a hole or unit has lost its own name."""
    cells = rows.table.columns[rows.columns[role]] if role in rows.columns else ()
    if isinstance(cells, BigColumn):
        return
    dates = [i for i, cell in enumerate(cells) if cell[:1].isdigit() and _DATE.fullmatch(cell.strip())]
    if dates:
        names = dict.fromkeys(cells[i].strip() for i in dates)
        reason = message(
            "io.names-like-dates",
            "Names of the {role} that are dates: {names}; rows: {count}. A spreadsheet turns a name such as 3-12 "
            "into one",
            role=role,
            names=", ".join(list(names)[:10]),
            count=len(dates),
        )
        remedy = message("io.format-names-as-text", "Format the column as text, write these names again, and save it.")
        rows.warn(dates[0], role, reason, remedy)


def name_key(name: str) -> tuple[str, ...]:
    """Return what is the same for names that differ only in case, leading zeros, blanks, hyphens and underscores.

    Cyrillic letters that look alike are the same, too. Marks between two numbers separate them all the same. A program
    may have written the name 7 as the number 7.0.

    Examples
    --------
    >>> [name_key(name) for name in ("ZK-007", "zk 7", "7.0", "BH1-1", "BH11", "BH7*")]
    [('zk', '7'), ('zk', '7'), ('7',), ('bh', '1', '1'), ('bh', '11'), ('bh', '7', '*')]
    """
    whole = re.sub(r"^(\d+)\.0+$", r"\1", latin_letters(name))
    parts: list[str] = re.findall(r"[^\W\d_]+|\d+|[^\w\s-]", whole)
    return tuple((part.lstrip("0") or "0") if part.isdecimal() else part for part in parts)


def _meant(names: set[str], known: Iterable[str]) -> dict[str, str]:
    """Return the one known name that each name is likely to mean: but for its case, or else for its marks."""
    meant: dict[str, str] = {}
    for key in (str.casefold, name_key):
        alike: dict[object, list[str]] = {}
        for name in known:
            alike.setdefault(key(name), []).append(name)
        for name in names - meant.keys():
            if len(found := alike.get(key(name), [])) == 1:
                meant[name] = found[0]
    return meant


def is_blank(cell: str) -> bool:
    """Whether a cell of numbers holds none: it is empty, or a mark such as "n/a" or "-"."""
    text = cell.strip()
    return not text or text.casefold() in _NO_NUMBER


def _cleaned(cell: str) -> str:
    return cell.strip() if cell.isascii() else unicodedata.normalize("NFKC", legible(cell)).strip()


def _degrees(table: Table, columns: dict[str, int]) -> str | None:
    """Return the system of longitude and latitude where the columns of x and y are named so."""
    names = [plain_name(table.header[columns[role]])[0] for role in ("x", "y") if role in columns]
    return WGS84 if len(names) == 2 and all(name in GEOGRAPHIC for name in names) else None


def _mixed_marks(role: str, mark: str, other: str) -> tuple[Message, Message]:
    """Return why a number with the other decimal mark than that of its table is not used, and what to do."""
    marks = {"mark": Untranslated(mark), "other": Untranslated(other)}
    return message(
        "io.cell-of-other-decimal",
        "The {role} has the mark '{other}', but the decimal mark of this table is '{mark}': a cell such as "
        "1{other}234 could be two numbers",
        role=role,
        **marks,
    ), message(
        "io.write-one-decimal-mark",
        "Write all numbers with '{mark}' before the fraction and without thousands separators. If the decimal mark of "
        'the table is \'{other}\', state decimal = "{other}" in a site or mapping file, or --decimal "{other}" of '
        "geofit fit, check and export.",
        **marks,
    )
