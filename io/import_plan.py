"""Files sorted by what they hold: the first half of an import, before anything is read as a site."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from geofit.data.errors import InputError
from geofit.data.legible import legible
from geofit.data.messages import EMPTY, Message, Untranslated, message
from geofit.data.site import ImportIssue, TableCount
from geofit.io.columns import GEOGRAPHIC, SCHEMAS, plain_name
from geofit.io.grid import load_ground
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping
from geofit.io.preview import TablePreview, preview_file
from geofit.io.rows import name_key, read_rows
from geofit.io.sections import load_lines
from geofit.io.source import Source

__all__ = ["ImportPlan", "TablePart", "campaigns", "complete", "look_at"]

#: Kinds of which a site has one table.
SINGLE = ("boundary", "ground", "adit path", "adit contacts")


@dataclass
class TablePart:
    """One table of one file, under the name that the site file uses; ``section`` is the line that it lies on."""

    name: str
    preview: TablePreview
    mapping: ColumnMapping
    source: Source
    section: str = ""


@dataclass
class ImportPlan:
    """The parts that are used by kind, what was set aside, and the files that were looked at."""

    parts: dict[str, list[TablePart]] = field(default_factory=dict)
    issues: list[ImportIssue] = field(default_factory=list)
    counts: list[TableCount] = field(default_factory=list)
    files: set[Path] = field(default_factory=set)

    def of(self, kind: str) -> list[TablePart]:
        """Return the tables of a kind, in the order of the files."""
        return self.parts.get(kind, [])

    def set_aside(
        self, name: str, read: int, reason: Message, remedy: Message, severity: Any = "error", **place: Any
    ) -> None:
        """List a table that is not used; all its rows count as listed."""
        place = {"row": 0, "column": "", "value": "", **place}
        self.issues.append(ImportIssue(file=name, severity=severity, reason=reason, remedy=remedy, **place))
        self.counts.append(TableCount(name, read, 0, read))

    def drop(self, error: InputError) -> bool:
        """Set the part that an error names aside, and list why its rows cannot be used; False if it names none."""
        for parts in self.parts.values():
            for part in parts:
                if error.file is not None and error.file == part.source.name:
                    parts.remove(part)
                    self.issues += [one for one in error.issues if one.file == error.file and one.severity == "error"]
                    self.set_aside(
                        part.source.name,
                        part.preview.read,
                        message("io.file-not-used", "The file is not used: {reason}", reason=error.reason),
                        error.remedy,
                        row=error.row or 0,
                        column=error.column or "",
                        value=error.value or "",
                    )
                    return True
        return False


def look_at(
    path: Path, folder: Path, mappings: Sequence[ColumnMapping], crs: str, plan: ImportPlan, unit: str | None = None
) -> None:
    """Preview a file and put its tables where they belong; ``unit`` is that of lengths whose mapping states none."""
    name = _relative(path, folder)
    if legible(name) != name:
        plan.set_aside(
            legible(name),
            0,
            message("io.file-name-not-utf8", "The name of the file is not UTF-8, and a site file cannot name it"),
            message("io.rename-file", "Rename the file."),
        )
        return
    absolute = Path(os.path.abspath(path))
    if absolute in plan.files:
        reason = message("io.file-read-once", "The file is given twice; it is read once")
        plan.issues.append(ImportIssue(name, 0, "", "", "note", reason))
        return
    plan.files.add(absolute)
    source = Source(path=path, name=name, target=crs or None)
    try:
        previews = preview_file(source, mappings)
    except InputError as error:
        place = {"row": error.row or 0, "column": error.column or "", "value": error.value or ""}
        plan.set_aside(name, 0, error.reason, error.remedy, **place)
        return
    for preview in previews:
        part_source = replace(source, table=preview.table)
        own = next((m for m in mappings if m.suits(name, preview.table, preview.kind or None)), None)
        mapping = replace(preview.mapping, file=name)
        if own is not None:
            mapping = replace(own, file=name, table=preview.table, columns={**mapping.columns, **own.columns})
        mapping = replace(mapping, unit=mapping.unit or unit)
        part = TablePart(name, preview, mapping, part_source)
        if preview.kind == "skip" and preview.issues:
            (issue,) = preview.issues
            plan.set_aside(part_source.name, preview.read, issue.reason, issue.remedy, issue.severity)
        elif preview.kind == "skip":
            reason = message("io.table-left-out", "The mapping leaves this table out")
            plan.set_aside(part_source.name, preview.read, reason, EMPTY, "note")
        elif preview.kind == "" and not preview.header:
            (issue,) = preview.issues
            plan.set_aside(
                part_source.name,
                0,
                issue.reason,
                issue.remedy,
                row=issue.row,
                column=issue.column,
                value=issue.value,
            )
        elif preview.kind == "":
            plan.set_aside(part_source.name, preview.read, *_not_recognised(preview))
        else:
            plan.parts.setdefault(preview.kind, []).append(part)


def _relative(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()


def _not_recognised(preview: TablePreview) -> tuple[Message, Message]:
    """Return why a table is of no kind, by the kind that it comes nearest to."""
    names = {plain_name(name)[0] for name in preview.header}
    nearest, best = "", 0.0
    missing: tuple[str, ...] = ()
    for kind in ("picks", "collar", "survey", "intervals", "section", "adit path", "adit contacts"):
        absent = tuple(role for role in SCHEMAS[kind].needed if not names & set(SCHEMAS[kind].required[role]))
        share = 1.0 - len(absent) / len(SCHEMAS[kind].needed)
        # Of two kinds of which as much is there, one that asks for more is likelier.
        if share > best or (share == best > 0 and len(SCHEMAS[kind].required) > len(SCHEMAS[nearest].required)):
            nearest, missing, best = kind, absent, share
    if names & GEOGRAPHIC and not preview.crs:
        return message(
            "io.file-in-degrees",
            "The file is not used: its places are longitude and latitude ({names})",
            names=tuple(Untranslated(name) for name in preview.header if plain_name(name)[0] in GEOGRAPHIC),
        ), message(
            "io.name-grid-with-crs",
            "Name the grid of the site, in metres, with --crs, such as EPSG:32650: they are projected to it.",
        )
    if best >= 0.5 and not missing:
        return message(
            "io.file-without-numbers",
            "The file is not used: it is most like the kind '{kind}', but too few of its cells are numbers with the "
            "decimal mark '{mark}'",
            kind=nearest,
            mark=preview.decimal,
        ), message("io.give-numbers-or-decimal", "Give plain numbers, or state decimal in a mapping file (--mapping).")
    if best >= 0.5:
        return message(
            "io.file-without-columns",
            "The file is not used: it is most like the kind '{kind}', but lacks {names}",
            kind=nearest,
            names=tuple(message("io.quoted-name", "'{name}'", name=Untranslated(role)) for role in missing),
        ), _REMEDY
    return message(
        "io.file-of-unknown-kind",
        "The file is not used: its columns ({names}) are of no known kind",
        names=", ".join(preview.header[:12]),
    ), _REMEDY


_REMEDY = message("io.name-kind-in-mapping", "Name its kind and columns in a mapping file (--mapping).")


def complete(plan: ImportPlan) -> None:
    """Set aside what a site has no place for: second boundaries, surveys and sections without a line."""
    plan.of("ground").sort(key=lambda part: not any(word in part.source.path.stem.casefold() for word in _GROUND))
    for kind in SINGLE:
        for part in plan.of(kind)[1:]:
            plan.parts[kind].remove(part)
            first = plan.of(kind)[0].source.name
            remedy = message("io.import-only-one", "Import one of them.")
            if kind == "ground":
                remedy = message(
                    "io.state-grid-in-mapping",
                    'If it is a horizon, state kind = "grid" in a mapping file (--mapping).',
                )
            reason = message("io.kind-taken-already", "The {kind} is taken from {file} already", kind=kind, file=first)
            plan.set_aside(part.source.name, _rows_of(part), reason, remedy)
    lacking = [
        ("survey", "collar"),
        ("intervals", "collar"),
        ("adit contacts", "adit path"),
    ]
    for kind, needed in lacking:
        if not plan.of(needed):
            for part in plan.parts.pop(kind, []):
                plan.set_aside(
                    part.source.name,
                    part.preview.read,
                    message(
                        "io.companion-table-missing", "The {kind} table has no {needed} table", kind=kind, needed=needed
                    ),
                    message("io.add-table", "Add the {needed} table.", needed=needed),
                )
    _place_sections(plan)


#: Words in the names of grids that are the ground.
_GROUND = ("ground", "dem", "dtm", "dgm", "topo", "terrain", "surface", "地面", "地形")


def _rows_of(part: TablePart) -> int:
    """Return the rows of a table, and those of a grid, which a preview does not read."""
    if part.preview.kind != "ground":
        return part.preview.read
    journal = Journal()
    try:
        load_ground(part.mapping.fill(part.source), journal)
    except InputError:
        return 0
    return journal.counts[0].read


def _place_sections(plan: ImportPlan) -> None:
    """Keep sections and drawings whose file is named like a section line; other drawings are of unknown place."""
    lines: set[str] = set()
    for part in plan.of("section lines"):
        try:
            lines |= set(load_lines(part.mapping.fill(part.source), Journal()))
        except InputError:
            continue  # listed when the site is read
    known = {line.casefold(): line for line in lines}
    placed: dict[str, str] = {}
    for kind in ("section", "drawing"):
        for part in list(plan.of(kind)):
            stem = part.source.path.stem
            part.section = known.get(stem.casefold(), "")
            if part.section in placed:
                reason = message(
                    "io.section-taken-already",
                    "Section '{name}' is taken from {file} already",
                    name=part.section,
                    file=placed[part.section],
                )
                remedy = message("io.import-only-one", "Import one of them.")
            elif not part.section:
                reason = message("io.section-without-line", "The section has no line in plan")
                remedy = message(
                    "io.add-section-table",
                    "Add a table section, x, y with the corners of section '{name}', or write [[section]] with its "
                    "line into the site file.",
                    name=stem,
                )
                if kind == "drawing":
                    a_map = message(
                        "io.state-map-kind",
                        'A map: state kind = "traces", "adit path" or "adit contacts" in a mapping file.',
                    )
                    remedy = message("io.column-pair", "{first} {second}", first=remedy, second=a_map)
            else:
                placed[part.section] = part.source.name
                continue
            plan.parts[kind].remove(part)
            plan.set_aside(part.source.name, part.preview.read, reason, remedy)


def campaigns(plan: ImportPlan) -> list[tuple[TablePart, TablePart | None, list[TablePart]]]:
    """Return each collar table with its survey and its interval tables: those that share most holes with it."""
    collars = plan.of("collar")
    surveys: dict[int, TablePart] = {}
    intervals: dict[int, list[TablePart]] = {}
    holes = [_holes(part, "collar") for part in collars] if len(collars) > 1 else [set[tuple[str, ...]]()]
    for kind in ("survey", "intervals"):
        for part in list(plan.of(kind)):
            own = _holes(part, kind) if len(collars) > 1 else set[tuple[str, ...]]()
            k = max(range(len(collars)), key=lambda k: len(own & holes[k]))
            _warn_of_others(plan, part, collars, [len(own & (other - holes[k])) for other in holes])
            if kind == "intervals":
                intervals.setdefault(k, []).append(part)
            elif k not in surveys:
                surveys[k] = part
            else:
                plan.parts[kind].remove(part)
                plan.set_aside(
                    part.source.name,
                    part.preview.read,
                    message(
                        "io.kind-taken-already",
                        "The {kind} is taken from {file} already",
                        kind=kind,
                        file=surveys[k].source.name,
                    ),
                    message("io.join-survey-tables", "Join the survey tables."),
                )
    return [(collar, surveys.get(k), intervals.get(k, [])) for k, collar in enumerate(collars)]


def _warn_of_others(plan: ImportPlan, part: TablePart, collars: Sequence[TablePart], counts: Sequence[int]) -> None:
    """Warn of a table whose holes are in several collar tables: it is read with one of these."""
    for collar, count in zip(collars, counts, strict=True):
        issue = ImportIssue(
            part.source.name,
            0,
            "",
            "",
            "warning",
            message(
                "io.holes-in-other-collars",
                "Holes of this table that are in {file} only, and are not read: {count}",
                file=Untranslated(collar.source.name),
                count=count,
            ),
            message("io.join-collar-tables", "Join the collar tables."),
        )
        if count and issue not in plan.issues:
            plan.issues.append(issue)


def _holes(part: TablePart, kind: str) -> set[tuple[str, ...]]:
    try:
        names = read_rows(part.mapping.fill(part.source), SCHEMAS[kind], Journal()).text("hole")
        return {name_key(name) for name in names}
    except InputError:
        return set()
