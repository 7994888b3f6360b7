"""What the wizard knows of each table before it is read as a site: plain data, no Qt."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from geofit.io.columns import SCHEMAS
from geofit.io.guess import WORDS
from geofit.io.mapping import ColumnMapping
from geofit.io.preview import TablePreview, preview_file, preview_table
from geofit.io.source import Source
from geofit.io.tables import parse_numbers
from geofit.progress import Progress, tell

__all__ = ["Draft", "drafts_of", "free_name", "read_again"]

#: Kinds that have no columns to name.
PLAIN = ("ground", "grid", "drawing", "skip", "")


@dataclass(frozen=True, eq=False)
class Draft:
    """One table of one file, with what its rows are and which column holds which role.

    ``roles`` maps a role to the number of its column, counted from 0; ``changed`` marks what the user said.
    ``source`` holds what is stated of encoding, separator, decimal mark and unit; None is found at reading.
    """

    source: Source
    preview: TablePreview
    kind: str
    roles: Mapping[str, int] = field(default_factory=dict)
    changed: bool = False
    remembered: bool = False

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
        return () if schema is None else (*schema.required, *schema.optional)

    def missing(self, *, ground: bool = False) -> tuple[str, ...]:
        """Return the required roles that no column holds; a collar on a known ground needs no elevation."""
        schema = SCHEMAS.get(self.kind)
        if schema is None:
            return ()
        spared = {"z"} if ground and self.kind == "collar" else set[str]()
        return tuple(role for role in schema.required if role not in self.roles and role not in spared)

    def role_of(self, column: int) -> str:
        """Return the role of a column, "" if it has none."""
        return next((role for role, at in self.roles.items() if at == column), "")

    def confidence(self, role: str) -> float | None:
        """Return how sure the guess of a role is; None if it was said, not guessed."""
        guess = next((one for one in self.preview.roles if one.role == role), None)
        if guess is None or guess.stated or guess.index != self.roles.get(role):
            return None
        return guess.confidence

    def with_role(self, column: int, role: str) -> Draft:
        """Give a column a role (""; none); the column that had the role loses it."""
        roles = {one: at for one, at in self.roles.items() if at != column and one != role}
        if role:
            roles[role] = column
        return replace(self, roles=roles, changed=True)

    def bad_cells(self) -> frozenset[tuple[int, int]]:
        """Return (row, column) of the shown cells that should hold a number and do not."""
        bad = set()
        for role, column in self.roles.items():
            if role in WORDS:
                continue
            cells = tuple(row[column] for row in self.preview.rows)
            _, wrong = parse_numbers(tuple(cell.strip() for cell in cells), self.preview.decimal)
            bad |= {(int(row), column) for row in wrong if cells[int(row)].strip() or self._required(role)}
        return frozenset(bad)

    def _required(self, role: str) -> bool:
        schema = SCHEMAS.get(self.kind)
        return schema is not None and role in schema.required

    @property
    def mapping(self) -> ColumnMapping:
        """The draft as a mapping for the import."""
        header = self.preview.header
        own = self.source
        return ColumnMapping(
            file=own.path.name,
            kind=self.kind or "skip",
            columns={role: header[at] if header.count(header[at]) == 1 else at + 1 for role, at in self.roles.items()}
            if self.named_kind
            else {},
            table=self.preview.table,
            encoding=own.encoding or self.preview.encoding or None,
            sep=own.sep or self.preview.sep or None,
            decimal=own.decimal or (self.preview.decimal if self.preview.sep else None),
            unit=own.unit,
        )


def drafts_of(
    files: Sequence[Path], remembered: Sequence[tuple[tuple[str, ...], ColumnMapping]], *, progress: Progress
) -> tuple[Draft, ...]:
    """Preview every table of some files; a header that was mapped before is mapped as it was then.

    Raises
    ------
    InputError
        If a file is missing, empty or damaged.
    """
    drafts = []
    for k, file in enumerate(files):
        tell(progress, file.name, k / max(len(files), 1))
        drafts += [_recall(_draft(file, preview), remembered) for preview in preview_file(file)]
    return tuple(drafts)


def read_again(draft: Draft, source: Source, kind: str, *, progress: Progress) -> Draft:
    """Preview a table anew, as another kind or with another encoding, separator, decimal mark or unit."""
    tell(progress, source.name, 0.0)
    if kind in PLAIN:
        return replace(draft, source=source, kind=kind, roles={}, changed=True)
    found = _draft(source.path, preview_table(source, kind), source)
    return replace(found, kind=kind, changed=True)


def _draft(file: Path, preview: TablePreview, source: Source | None = None) -> Draft:
    source = source or Source(path=file, table=preview.table)
    return Draft(source, preview, preview.kind, {guess.role: guess.index for guess in preview.roles})


def _recall(draft: Draft, remembered: Iterable[tuple[tuple[str, ...], ColumnMapping]]) -> Draft:
    header = draft.preview.header
    for known, mapping in remembered:
        if known and known == header and mapping.kind in SCHEMAS:
            places = {role: header.index(name) for role, name in mapping.columns.items() if name in header}
            source = replace(draft.source, unit=mapping.unit)
            return replace(draft, source=source, kind=mapping.kind, roles=places, remembered=True)
    return draft


def free_name(folder: Path) -> Path:
    """Return a site file's name in a folder that no file has yet."""
    for k in range(1, 10_000):
        path = folder / ("site.toml" if k == 1 else f"site-{k}.toml")
        if not path.exists():
            return path
    return folder / "site.toml"
