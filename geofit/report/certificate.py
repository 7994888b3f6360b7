"""The certificate of a STEP file: one page that says what an independent reader found in it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from geofit.data.accuracy import ReadBack
from geofit.data.languages import Language, translate
from geofit.report import digits
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
    VerdictMark,
)
from geofit.report.gather import today, versions
from geofit.report.pdf import write_pdf

__all__ = ["certificate", "write_certificate"]

#: Horizons that fit on the page with their checks; of more, the failed checks alone are listed.
MOST = 2
#: Failed checks that the page lists, the horizons in turn.
MOST_FAILED = 8
#: Rows of the table of horizons.
MOST_HORIZONS = 12


def certificate(
    file: Path,
    found: Mapping[str, ReadBack],
    epsilon: Mapping[str, float],
    t: Language,
    *,
    author: str = "",
    organisation: str = "",
    date: str = "",
) -> ReportDocument:
    """Lay out the certificate of a file that was read back.

    Parameters
    ----------
    file : Path
        The file; its size and name are on the page.
    found : mapping of str to ReadBack
        What the reader found, a horizon.
    epsilon : mapping of str to float
        Control error of each horizon, metres.
    t : Language
        That of the words.
    author, organisation : str
        Who answers for the file.
    date : str
        ISO 8601; empty: :func:`geofit.report.gather.today`.
    """
    day, known = date or today(), versions()
    passed = all(back.passed for back in found.values())
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
                (t("Organisation"), organisation),
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
        _horizons(found, epsilon, t),
        *_checks(found, t),
        Paragraph(
            t(
                "The file was read by OpenCASCADE, and every data point was measured again against the surface in the "
                "file. The certificate holds for the file with this hash alone."
            ),
            "quiet",
        ),
        Signatures((t("Role"), t("Name"), t("Signature"), t("Date")), ((t("Prepared"), author), (t("Checked"), ""))),
    ]
    title = t("Certificate of a STEP file")
    badge = VerdictMark(passed, t("PASS") if passed else t("FAIL"))
    page = Chapter(title, tuple(blocks), badge)
    return ReportDocument(title, file.name, file.name, day, t.html, f"{program} · {day}", (page,))


def write_certificate(
    path: Path,
    file: Path,
    found: Mapping[str, ReadBack],
    epsilon: Mapping[str, float],
    t: Language,
    *,
    author: str = "",
    organisation: str = "",
) -> None:
    """Write the certificate of a file as PDF; parameters as :func:`certificate`.

    Raises
    ------
    MissingDependencyError
        If the certificate is in Chinese and the machine has no font for it.
    """
    write_pdf(certificate(file, found, epsilon, t, author=author, organisation=organisation), {}, path)


def _horizons(found: Mapping[str, ReadBack], epsilon: Mapping[str, float], t: Language) -> ReportTable:
    columns = (
        Column(t("Horizon"), "wide"),
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
            VerdictMark(back.passed, t("PASS") if back.passed else t("FAIL")),
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


def _checks(found: Mapping[str, ReadBack], t: Language) -> list[Block]:
    """List every check of one or two horizons, or the failed ones of many."""
    few = len(found) <= MOST
    listed = [(name, check) for name, back in found.items() for check in back.checks if few or check.passed is False]
    if not few:
        listed = listed[:MOST_FAILED]
    if not listed:
        return [Paragraph(t("All checks of all horizons passed."))]
    words = {True: t("passed"), False: t("failed"), None: t("not applicable")}
    columns = (
        Column(t("Horizon")),
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
