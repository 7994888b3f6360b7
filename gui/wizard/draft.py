"""What the wizard knows of each table before it is read as a site: plain data, no Qt."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from geofit.data.errors import GeofitError
from geofit.data.messages import EMPTY, Message
from geofit.data.progress import Progress, tell
from geofit.io.columns import HORIZON_COLUMNS, SCHEMAS
from geofit.io.guess import WORDS, RoleGuess, warn_of_depths
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping
from geofit.io.preview import TablePreview, preview_file, preview_table
from geofit.io.source import Source
from geofit.io.tables import parse_numbers
from geofit.io.units import with_unit

__all__ = ["Draft", "drafts_of", "free_name", "preview_again"]

#: Roles that several columns may have, by what their values are.
HORIZON_ROLES = {"elevation": "horizon elevation", "depth": "horizon depth"}

#: Kinds that have no columns to name.
PLAIN = ("ground", "grid", "drawing", "skip", "")


@dataclass(frozen=True, eq=False)
class Draft:
    """One table of one file, with what its rows are and which column holds which role.

    ``roles`` maps a role to the number of its column, counted from 0; ``changed`` marks what the user set.
    ``horizons`` are the columns that hold one horizon each, elevations or depths as ``source.measure`` says.
    ``source`` holds what is stated of encoding, separator, decimal mark and unit; None is found at reading. ``fault``
    states why the file cannot be read, in which case it is left out.
    """

    source: Source
    preview: TablePreview
    kind: str
    roles: Mapping[str, int] = field(default_factory=dict)
    horizons: tuple[int, ...] = ()
    changed: bool = False
    remembered: bool = False
    fault: Exception | None = None

    @property
    def title(self) -> str:
        """Name of the file, and of the table in it."""
        return self.source.name

    @property
    def used(self) -> bool:
        """Whether the table will be read."""
        return self.kind not in ("skip", "")

    @property
    def named_kind(self) -> bool:
        """Whether the kind has columns with roles."""
        return self.kind in SCHEMAS

    def possible(self) -> tuple[str, ...]:
        """Return the roles that a column of this kind can have, the required ones first."""
        schema = SCHEMAS.get(self.kind)
        several = HORIZON_ROLES.values() if schema is HORIZON_COLUMNS else ()
        return () if schema is None else (*schema.required, *several, *schema.optional)

    def missing(self, *, ground: bool = False) -> tuple[str, ...]:
        """Return the required roles that no column holds; a collar on a known ground needs no elevation."""
        schema = SCHEMAS.get(self.kind)
        if schema is None:
            return ()
        needed = schema.needed
        if ground and self.kind == "collar":
            needed = tuple(role for role in needed if role != "z")
        if schema is HORIZON_COLUMNS:
            needed += ("z",) if self.source.measure == "depth" else ()
            needed += () if self.horizons else (HORIZON_ROLES["elevation"],)
        return tuple(role for role in needed if role not in self.roles)

    def role_of(self, column: int) -> str:
        """Return the role of a column, "" if it has none."""
        if column in self.horizons:
            return HORIZON_ROLES[self.source.measure or "elevation"]
        return next((role for role, at in self.roles.items() if at == column), "")

    def confidence(self, role: str) -> float | None:
        """Return how sure the guess of a role is; None if it was said, not guessed."""
        guess = next((one for one in self.preview.roles if one.role == role), None)
        if guess is None or guess.stated or guess.index != self.roles.get(role):
            return None
        return guess.confidence

    def with_role(self, column: int, role: str) -> Draft:
        """Give a column a role (""; none); the column that had the role loses it, but for that of a horizon.

        All horizons of a table are elevations, or all are depths.
        """
        roles = {one: at for one, at in self.roles.items() if at != column and one != role}
        horizons = tuple(at for at in self.horizons if at != column)
        if measure := next((key for key, name in HORIZON_ROLES.items() if name == role), None):
            source = replace(self.source, measure=measure)
            return replace(self, source=source, roles=roles, horizons=tuple(sorted((*horizons, column))), changed=True)
        if role:
            roles[role] = column
        return replace(self, roles=roles, horizons=horizons, changed=True)

    @property
    def exchanged(self) -> bool:
        """Whether x and y of a Chinese table look like northing and easting.

        There X is mostly the northing, of seven digits; the easting has six, or eight with the zone before them.
        Elsewhere such figures may be feet.
        """
        if not any("\u4e00" <= letter <= "\u9fff" for name in self.preview.header for letter in name):
            return False
        x, y = (self._size(role) for role in ("x", "y"))
        return 1e6 <= x < 1e7 and (1e5 <= y < 1e6 or 1e7 <= y < 1e8)

    def with_exchanged_axes(self) -> Draft:
        """Take easting for northing, and northing for easting."""
        x, y = self.roles["x"], self.roles["y"]
        return replace(self, roles={**self.roles, "x": y, "y": x}, changed=True)

    def doubts(self) -> tuple[Message, ...]:
        """Return what the library warns of where an elevation is called a depth, or depths are left unread."""
        if self.kind != "picks" or "z" not in self.roles or self.source.measure is not None:
            return ()
        header, journal = self.preview.header, Journal()
        guessed = {(one.role, one.index): one for one in self.preview.roles}
        roles = {
            role: guessed.get((role, at)) or RoleGuess(role, at, header[at], 1.0, EMPTY, "stated")
            for role, at in self.roles.items()
        }
        warn_of_depths(self.source.name, header, roles, journal)
        return tuple(issue.reason for issue in journal.issues)

    def bad_cells(self) -> frozenset[tuple[int, int]]:
        """Return (row, column) of the shown cells that should hold a number and do not."""
        bad = set()
        for role, column in self.roles.items():
            if role in WORDS:
                continue
            cells = tuple(row[column] for row in self.preview.rows)
            _, wrong = parse_numbers(tuple(cell.strip() for cell in cells), self.preview.decimal)
            bad |= {
                (int(row), column)
                for row in wrong
                if (cells[int(row)].strip() or self._required(role))
                and with_unit(cells[int(row)], self.preview.decimal) is None
            }
        for column in self.horizons:
            cells = tuple(row[column].strip() for row in self.preview.rows)
            bad |= {(int(row), column) for row in parse_numbers(cells, self.preview.decimal)[1] if cells[int(row)]}
        return frozenset(bad)

    def _size(self, role: str) -> float:
        """Return the middle of the absolute values that are shown of a role, nan where there are none."""
        if role not in self.roles:
            return float("nan")
        cells = tuple(row[self.roles[role]].strip() for row in self.preview.rows)
        values, _ = parse_numbers(cells, self.preview.decimal)
        known = values[np.isfinite(values)]
        return float(np.median(np.abs(known))) if known.size else float("nan")

    def _required(self, role: str) -> bool:
        schema = SCHEMAS.get(self.kind)
        return schema is not None and role in schema.required

    @property
    def mapping(self) -> ColumnMapping:
        """The draft as a mapping for the import."""
        header = self.preview.header
        own = self.source

        def name(at: int) -> str | int:
            return header[at] if header.count(header[at]) == 1 else at + 1

        return ColumnMapping(
            file=own.path.name,
            kind=self.kind or "skip",
            columns={role: name(at) for role, at in self.roles.items()} if self.named_kind else {},
            table=self.preview.table,
            horizons=tuple(map(name, self.horizons)),
            encoding=own.encoding or self.preview.encoding or None,
            sep=own.sep or self.preview.sep or None,
            decimal=own.decimal or (self.preview.decimal if self.preview.sep else None),
            unit=own.unit,
            measure=own.measure,
        )


def drafts_of(
    files: Sequence[Path], remembered: Sequence[tuple[tuple[str, ...], ColumnMapping]], *, progress: Progress
) -> tuple[Draft, ...]:
    """Preview every table of some files; a header that was mapped before is mapped as it was then.

    A file that is missing, empty or damaged is left out, and its draft reports it.
    """
    drafts = []
    for k, file in enumerate(files):
        tell(progress, file.name, k / max(len(files), 1))
        try:
            drafts += [_recall(_draft(file, preview), remembered) for preview in preview_file(file)]
        except (GeofitError, OSError) as error:
            nothing = TablePreview(file.name, "", "skip", 1.0, {"skip": 1.0}, (), ())
            drafts.append(replace(_draft(file, nothing), fault=error))
    return tuple(drafts)


def preview_again(draft: Draft, source: Source, kind: str, *, progress: Progress) -> Draft:
    """Preview a table anew, as another kind or with another encoding, separator, decimal mark or unit."""
    tell(progress, source.name, 0.0)
    if kind in PLAIN:
        return replace(draft, source=source, kind=kind, roles={}, horizons=(), changed=True)
    same = kind == draft.kind
    found = _draft(source.path, preview_table(source, kind), source if same else replace(source, measure=None))
    horizons = draft.horizons if same and found.preview.header == draft.preview.header else ()
    return replace(found, kind=kind, horizons=horizons, changed=True)


def _draft(file: Path, preview: TablePreview, source: Source | None = None) -> Draft:
    source = source or Source(path=file, table=preview.table)
    return Draft(source, preview, preview.kind, {guess.role: guess.index for guess in preview.roles})


def _recall(draft: Draft, remembered: Iterable[tuple[tuple[str, ...], ColumnMapping]]) -> Draft:
    header = draft.preview.header
    for known, mapping in remembered:
        if known and known == header and mapping.kind in SCHEMAS:
            places = {role: header.index(name) for role, name in mapping.columns.items() if name in header}
            source = replace(draft.source, unit=mapping.unit, measure=mapping.measure)
            horizons = tuple(header.index(name) for name in mapping.horizons if name in header)
            return replace(draft, source=source, kind=mapping.kind, roles=places, horizons=horizons, remembered=True)
    return draft


def free_name(folder: Path) -> Path:
    """Return a site file's name in a folder that no file has yet."""
    for k in range(1, 10_000):
        path = folder / ("site.toml" if k == 1 else f"site-{k}.toml")
        if not path.exists():
            return path
    return folder / "site.toml"
