"""``geofit import``: files to a site file, the mapping of their columns, and the table of what was found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from geofit.data.errors import InputError
from geofit.data.files import folder_for, replacing
from geofit.data.languages import EN, Language, translate
from geofit.data.legible import legible
from geofit.data.logs import IntervalLog
from geofit.data.messages import Message, Untranslated, message
from geofit.data.progress import Progress, tell
from geofit.data.site import Ground, ImportIssue, Site, TableCount
from geofit.io.added_tables import tables_text
from geofit.io.boreholes import load_boreholes
from geofit.io.columns import SCHEMAS
from geofit.io.contact_rules import ContactRule, code_key
from geofit.io.contacts import load_rule
from geofit.io.grid import load_ground
from geofit.io.guess import taken_as, warn_of_depths
from geofit.io.import_plan import ImportPlan, TablePart, campaigns, complete, look_at
from geofit.io.journal import Journal
from geofit.io.mapping import ColumnMapping, save_mappings
from geofit.io.site_file import build_site
from geofit.io.source import Source
from geofit.io.units import metres_of
from geofit.project.import_tables import Tables, site_tables

__all__ = ["Import", "import_files", "issue_file_of", "mapping_file_of"]

#: Fewer contacts make no surface: the code gets no [[horizon]] unless it is asked for.
FEWEST_CONTACTS = 3


@dataclass(frozen=True, eq=False)
class Import:
    """What an import made.

    ``site`` is what the site file gives when it is read; ``issues`` and ``counts`` hold also the files that could
    not be used, all of whose rows are listed. ``read == used + listed`` for every file.
    """

    site: Site
    site_file: Path
    mapping_file: Path
    issue_file: Path
    issues: tuple[ImportIssue, ...]
    counts: tuple[TableCount, ...]

    @property
    def exit_code(self) -> int:
        """0 if there is a horizon to fit, 1 if the site has none yet, 2 if no row could be used."""
        if not any(count.used for count in self.counts):
            return 2
        return 0 if self.site.horizons else 1


def import_files(
    files: Sequence[str | Path],
    site_file: str | Path,
    *,
    mappings: Sequence[ColumnMapping] = (),
    crs: str = "",
    unit: str | None = None,
    base: Sequence[str] = (),
    top: Sequence[str] = (),
    progress: Progress | None = None,
    language: Language = EN,
) -> Import:
    """Recognise files, and write the site file, ``..._mapping.toml`` and ``..._issues.csv`` beside it.

    Parameters
    ----------
    files : sequence of path
        Tables, drawings, maps and grids of one site, in any order.
    site_file : path
        Where the site file is written.
    mappings : sequence of ColumnMapping
        How tables are read where a guess would be wrong.
    crs : str
        Coordinate system of the site; longitude and latitude are projected to it where it is a code.
    unit : str, optional
        Unit of all lengths of files whose mapping states none, instead of the one that their headers mark.
    base, top : sequence of str
        Codes whose base or top are horizons; without any, the base of each code that has three contacts.
    progress : callable, optional
        Called as ``progress(stage, fraction)``.
    language : Language
        What the base of a code is called, and the reasons in ``..._issues.csv``.

    Raises
    ------
    InputError
        If no file is given, the unit is unknown, or the site cannot be read; ``issues`` of the error are also in
        ``..._issues.csv``.
    MissingDependencyError
        If a format's package is not installed.
    """
    site_file = Path(site_file)
    if not files:
        raise InputError(
            message("project.no-file-given", "No file is given"),
            message("project.name-files", "Name the tables, drawings, maps and grids of the site."),
        )
    if legible(site_file.name) != site_file.name:
        raise InputError(
            message(
                "project.site-file-name-not-utf8",
                "The name of the site file is not UTF-8, and its mapping file cannot name it",
            ),
            message("data.choose-another-name", "Choose another name."),
            file=legible(str(site_file)),
        )
    if unit is not None:
        metres_of(unit)
    folder = folder_for(site_file.parent)
    mapping_file = mapping_file_of(site_file)
    plan = ImportPlan()
    for i, file in enumerate(files):
        tell(progress, "inspect files", 0.3 * i / len(files))
        look_at(Path(file), folder, mappings, crs, plan, unit)
    while True:
        complete(plan)
        horizons = _horizons(plan, site_file, mapping_file, crs, base, top, language)
        tables = site_tables(plan, _label(site_file, mapping_file, crs), horizons)
        tell(progress, "read the site", 0.6)
        try:
            site = _read(tables, plan, site_file)
            break
        except InputError as error:
            # The file is not at fault where it lacks a code that was asked for.
            if error.code in ("io.code-not-logged", "io.no-interval-usable") or not plan.drop(error):
                error.issues = (*error.issues, *plan.issues)
                raise
    _write(tables, plan, site_file, mapping_file)
    written = Journal()
    written.read(Source(path=site_file))
    site = replace(site, inputs={**written.inputs, **site.inputs})
    issues = (*site.issues, *plan.issues, *_guesses(plan))
    counts = (*site.counts, *plan.counts)
    issue_file = issue_file_of(site_file)
    from geofit.report.tables import write_issues

    write_issues(issues, issue_file, language)
    tell(progress, "imported", 1.0)
    return Import(site, site_file, mapping_file, issue_file, issues, counts)


def mapping_file_of(site_file: Path) -> Path:
    """Return where the import of a site writes how its tables are read."""
    return site_file.with_name(f"{site_file.stem}_mapping.toml")


def issue_file_of(site_file: Path) -> Path:
    """Return where the import of a site lists what it found."""
    return site_file.with_name(f"{site_file.stem}_issues.csv")


def _guesses(plan: ImportPlan) -> list[ImportIssue]:
    """Return a note for each guess that the mapping file now states."""
    notes = []
    for part in (part for parts in plan.parts.values() for part in parts):
        preview, name = part.preview, part.source.name
        others = tuple(
            message("project.kind-merit", "{kind} {merit:.2f}", kind=kind, merit=merit)
            for kind, merit in list(preview.kinds.items())[1:4]
        )
        reason = message(
            "project.kind-taken",
            "Taken as {kind}, confidence {confidence:.2f}",
            kind=preview.kind,
            confidence=preview.confidence,
        )
        if others:
            reason = message("project.table-alternatives", "{text}; else {others}", text=reason, others=others)
        notes.append(
            ImportIssue(
                name,
                0,
                "",
                "",
                "note",
                reason,
                message("project.state-kind-in-mapping", "State another kind in the mapping file."),
            )
        )
        for guess in preview.roles:
            if guess.stated:
                continue
            remedy = message("project.name-column-in-mapping", "Name another column in the mapping file.")
            severity: Literal["note", "warning"] = "warning" if guess.doubtful else "note"
            notes.append(ImportIssue(name, 0, guess.column, "", severity, taken_as(guess), remedy))
        guesses = {guess.role: guess for guess in preview.roles}
        if preview.kind == "picks" and "z" in guesses and not guesses["z"].stated:
            # The mapping states the columns from here on, so the reader itself no longer asks.
            depths = Journal()
            warn_of_depths(name, preview.header, guesses, depths)
            notes += depths.issues
    return notes


def _horizons(
    plan: ImportPlan,
    site_file: Path,
    mapping_file: Path,
    crs: str,
    base: Sequence[str],
    top: Sequence[str],
    language: Language,
) -> list[dict[str, Any]]:
    """Return the [[horizon]] tables: limits of codes, and, beside them, every name in the other files."""
    limits = _limits(plan, base, top)
    if not limits:
        return []
    # Beside a [[horizon]] only listed names are read, so those of the other files are asked for first.
    tables = site_tables(plan, _label(site_file, mapping_file, crs), [], boreholes=False)
    try:
        others = list(_read(tables, plan, site_file).horizons)
    except InputError:
        others = []  # the file at fault is dropped when the whole site is read
    named = {name.casefold() for name in others}
    for table in limits:
        # In the language that was asked for, unless another file uses the English name.
        english = str(table["name"])
        table["name"] = english if english.casefold() in named else translate(table["name"], language)
    limited = {table["name"].casefold() for table in limits}
    return limits + [{"name": name} for name in others if name.casefold() not in limited]


def _ground(plan: ImportPlan) -> Ground | None:
    for part in plan.of("ground")[:1]:
        try:
            return load_ground(part.mapping.fill(part.source), Journal())
        except InputError:
            return None  # listed when the site is read
    return None


def _limits(plan: ImportPlan, base: Sequence[str], top: Sequence[str]) -> list[dict[str, Any]]:
    """Return the limits that are asked for, or the base of each code with enough contacts, the highest first."""
    pairs = [*(("base", code) for code in base), *(("top", code) for code in top)]
    if pairs:
        return [{"name": _name(limit, code), limit: code} for limit, code in dict.fromkeys(pairs)]
    heights: dict[tuple[str, ...], list[float]] = {}
    few: dict[str, int] = {}
    ground = _ground(plan)
    for collar, survey, logs in campaigns(plan):
        try:
            found = load_boreholes(
                collar.mapping.fill(collar.source),
                survey.mapping.fill(survey.source) if survey else None,
                [log.mapping.fill(log.source) for log in logs],
                None,
                Journal(),
                ground=ground,
            )
        except InputError:
            continue  # listed when the site is read
        for codes in _spellings(found.logs, plan):
            points = load_rule(found, ContactRule(codes), Journal())
            heights.setdefault(codes, []).extend(points.xyz[:, 2].tolist())
    for codes, z in list(heights.items()):
        if len(z) < FEWEST_CONTACTS:
            few[codes[0]] = len(heights.pop(codes))
    if few:
        names = ", ".join(f"{code} ({count})" for code, count in sorted(few.items()))
        issue = ImportIssue(
            plan.of("intervals")[0].source.name,
            0,
            "",
            "",
            "note",
            message(
                "project.codes-without-horizon",
                "The base of {count} codes has fewer than {least} contacts and gives no horizon: {names}",
                count=len(few),
                least=FEWEST_CONTACTS,
                names=names,
            ),
            message(
                "project.add-horizon-to-site-file",
                "Add a [[horizon]] to the site file where needed (--base, --top).",
            ),
        )
        if issue not in plan.issues:
            plan.issues.append(issue)
    ordered = sorted(heights, key=lambda codes: (-float(np.mean(heights[codes])), codes))
    return [
        {"name": _name("base", codes[0]), "base": codes[0] if len(codes) == 1 else list(codes)} for codes in ordered
    ]


def _spellings(logs: Sequence[IntervalLog], plan: ImportPlan) -> list[tuple[str, ...]]:
    """Return the codes of logs, those of one :func:`code_key` together, the commonest first; the plan lists these."""
    counts = Counter(str(code) for log in logs for code in log.code)
    alike: dict[str, list[str]] = {}
    for code in counts:
        alike.setdefault(code_key(code), []).append(code)
    groups = [tuple(sorted(codes, key=lambda code: (-counts[code], code))) for codes in alike.values()]
    for codes in (codes for codes in groups if len(codes) > 1):
        issue = ImportIssue(
            logs[0].file,
            0,
            "",
            ", ".join(codes),
            "warning",
            message(
                "project.codes-differ-in-case",
                "Codes that differ only in case, marks or look-alike letters (Cyrillic) count as one bed: {names}",
                names=", ".join(f"{code} ({counts[code]})" for code in codes),
            ),
            message("project.split-codes-in-site-file", "If they are two horizons, give each its own [[horizon]]."),
        )
        if issue not in plan.issues:
            plan.issues.append(issue)
    return groups


def _name(limit: str, code: str) -> Message:
    if limit == "top":
        return message("project.top-of-stratum", "top of {code}", code=Untranslated(code))
    return message("project.base-of-stratum", "base of {code}", code=Untranslated(code))


def _label(site_file: Path, mapping_file: Path, crs: str) -> dict[str, Any]:
    """Return the [site] table."""
    return {"name": site_file.stem, **({"crs": crs} if crs else {}), "mapping": mapping_file.name}


def _parts(plan: ImportPlan) -> list[TablePart]:
    return [part for parts in plan.parts.values() for part in parts if part.preview.kind in SCHEMAS]


def _read(tables: Tables, plan: ImportPlan, site_file: Path) -> Site:
    """Read the site that the tables describe, before anything is written."""
    top: dict[str, Any] = {}
    for head, table in tables:
        if head.startswith("[["):
            top.setdefault(head.strip("[]"), []).append(table)
        else:
            top[head.strip("[]")] = table
    journal = Journal()
    with journal.handed_over():
        return build_site(top, site_file, journal, mappings=[part.mapping for part in _parts(plan)])


def _write(tables: Tables, plan: ImportPlan, site_file: Path, mapping_file: Path) -> None:
    """Write the mapping and the site file that refers to it."""
    parts = _parts(plan)
    remarks = {
        (i, guess.role): str(guess.reason) + (f", confidence {guess.confidence:.2f}" if not guess.stated else "")
        for i, part in enumerate(parts)
        for guess in part.preview.roles
    }
    save_mappings([part.mapping for part in parts], mapping_file, remarks)
    with replacing(site_file) as written:
        written.write_text(tables_text(tables), encoding="utf-8")
