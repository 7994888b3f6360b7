"""The certificate of a STEP file: one page that says what an independent reader found in it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.data.accuracy import ReadBack
from geofit.data.languages import Language, translate
from geofit.data.stale import stale_warning
from geofit.report import digits
from geofit.report.chapter_head import verdict_badge
from geofit.report.document import (
    Block,
    Cell,
    Chapter,
    CheckMark,
    Column,
    Fields,
    Heading,
    Paragraph,
    ReportDocument,
    ReportTable,
    Signatures,
)
from geofit.report.gather import today, versions
from geofit.report.pdf import write_pdf

if TYPE_CHECKING:
    from geofit.cad.solid_read_back import SolidReadBack

__all__ = ["certificate", "write_certificate"]

#: Horizons that fit on the page with their checks; of more, the failed checks alone are listed.
MOST = 2
#: Failed checks that the page lists, the horizons in turn.
MOST_FAILED = 8
#: Rows of the table of horizons.
MOST_HORIZONS = 12


def certificate(
    file: Path,
    found: Mapping[str, ReadBack | SolidReadBack],
    epsilon: Mapping[str, float],
    t: Language,
    *,
    author: str = "",
    organisation: str = "",
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    date: str = "",
    stale: Collection[str] = (),
) -> ReportDocument:
    """Lay out the certificate of a file that was read back.

    Parameters
    ----------
    file : Path
        The file; its size and name are on the page.
    found : mapping of str to ReadBack or SolidReadBack
        What the reader found, by horizon or body.
    epsilon : mapping of str to float
        Control error of each, metres.
    t : Language
        That of the words.
    author, organisation : str
        Who answers for the file.
    offset : (3,) tuple of float
        What is added to the file's coordinates for those of the map, metres; zeros: the file is in map coordinates.
    date : str
        ISO 8601; empty: :func:`geofit.report.gather.today`.
    stale : collection of str
        Horizons whose surfaces were fitted to earlier data or settings.
    """
    day, known = date or today(), versions()
    passed, old = all(back.passed for back in found.values()), [name for name in found if name in stale]
    first = next(iter(found.values()))
    program = f"geofit {known['geofit']}"
    blocks: list[Block] = [
        Fields(
            (
                (t("File"), file.name),
                (t("Size"), digits.kilobytes(file.stat().st_size)),
                ("SHA-256", first.sha256[:32]),
                ("", first.sha256[32:]),
                (t("Format"), "ISO 10303-242 (AP242)"),
                *_coordinates(offset, t),
                (t("Issued by"), organisation),
                (t("Author"), author),
                (t("Program"), program),
                (t("Read back by"), f"OpenCASCADE {known.get('OpenCASCADE', '')}"),
                (t("Date"), day),
            )
        ),
        Heading(t("What the reader found")),
        Paragraph(
            t("PASS: every check of the file passed.") if passed else t("FAIL: see the failed checks below."),
            "plain" if passed else "warning",
        ),
        *([Paragraph(translate(stale_warning(old), t), "warning")] if old else []),
        _horizons(found, epsilon, t, old),
        *_checks(found, t),
        Paragraph(
            t(
                "The file was read by OpenCASCADE, and every data point was measured again against the surface in the "
                "file. The certificate holds for the file with this hash alone."
            )
            if isinstance(first, ReadBack)
            else t(
                "The file was read by OpenCASCADE, and the solids in it were compared with the body. The certificate "
                "holds for the file with this hash alone."
            ),
            "quiet",
        ),
        Signatures((t("Role"), t("Name"), t("Signature"), t("Date")), ((t("Prepared"), author), (t("Checked"), ""))),
    ]
    title = t("Certificate of a STEP file")
    badge = verdict_badge("PASS" if passed else "FAIL", t, stale=bool(old))
    page = Chapter(title, tuple(blocks), badge)
    return ReportDocument(title, file.name, file.name, day, t.html, f"{program} · {day}", (page,))


def write_certificate(
    path: Path,
    file: Path,
    found: Mapping[str, ReadBack | SolidReadBack],
    epsilon: Mapping[str, float],
    t: Language,
    *,
    author: str = "",
    organisation: str = "",
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    stale: Collection[str] = (),
) -> None:
    """Write the certificate of a file as PDF; parameters as :func:`certificate`.

    Raises
    ------
    MissingDependencyError
        If the certificate is in Chinese and the machine has no font for it.
    """
    page = certificate(file, found, epsilon, t, author=author, organisation=organisation, offset=offset, stale=stale)
    write_pdf(page, {}, path)


def _kind(found: Mapping[str, ReadBack | SolidReadBack], t: Language) -> str:
    """Head the column of names: a file holds horizons or bodies."""
    return t("Horizon") if isinstance(next(iter(found.values())), ReadBack) else t("Body")


def _coordinates(offset: tuple[float, float, float], t: Language) -> list[tuple[str, str]]:
    """Say in which coordinates the file is; all lengths are metres."""
    if not any(offset):
        return [(t("Coordinates"), t("map coordinates"))]
    easting, northing, elevation = (format(value, ".15g") for value in offset)
    return [
        (t("Coordinates"), t("local: map = file + offset")),
        (t("Offset"), f"E {easting}, N {northing}, Z {elevation} m"),
    ]


def _horizons(
    found: Mapping[str, ReadBack | SolidReadBack], epsilon: Mapping[str, float], t: Language, stale: Collection[str]
) -> ReportTable:
    columns = (
        Column(_kind(found, t), "wide"),
        Column(t("Result")),
        Column(t("Faces"), "number"),
        Column("σ, m", "number"),
        Column("ε, m", "number"),
        Column(t("Largest |d|, m"), "number"),
        Column(t("Checks"), "number"),
    )
    rows: list[tuple[Cell, ...]] = [
        (
            name,
            verdict_badge("PASS" if back.passed else "FAIL", t, stale=name in stale),
            str(back.faces),
            digits.metres(back.sigma),
            digits.given(epsilon[name]),
            digits.metres(back.max_abs),
            f"{sum(check.passed is True for check in back.checks)} / "
            f"{sum(check.passed is not None for check in back.checks)}",
        )
        for name, back in list(found.items())[:MOST_HORIZONS]
    ]
    if len(found) > MOST_HORIZONS:
        rows.append((t("and {count} more", count=len(found) - MOST_HORIZONS), *[""] * 6))
    return ReportTable(columns, tuple(rows), dense=True)


def _checks(found: Mapping[str, ReadBack | SolidReadBack], t: Language) -> list[Block]:
    """List every check of one or two horizons, or the failed ones of many."""
    few = len(found) <= MOST
    listed = [(name, check) for name, back in found.items() for check in back.checks if few or check.passed is False]
    if not few:
        listed = listed[:MOST_FAILED]
    if not listed:
        return [Paragraph(t("All checks of all horizons passed."))]
    words = {True: t("passed"), False: t("failed"), None: t("not applicable")}
    columns = (
        Column(_kind(found, t)),
        Column(t("Check"), "wide"),
        Column(t("Result")),
        Column(t("Found"), "number"),
        Column(t("Limit"), "number"),
    )
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            name,
            translate(check.name, t),
            CheckMark(check.passed, words[check.passed]),
            digits.measured(check.value, translate(check.unit, t)),
            digits.measured(check.limit, translate(check.unit, t)),
        )
        for name, check in listed
    )
    return [ReportTable(columns, rows, dense=True)]
