"""From a site to the files that a run leaves: surfaces, one accuracy report, tables, pictures."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.errors import Cancelled, GeofitError, InputError, SettingsError
from geofit.files import file_stems, replacing
from geofit.progress import Progress, tell
from geofit.report.language import EN, Language
from geofit.report.result import HorizonResult
from geofit.site import Site

if TYPE_CHECKING:
    from geofit.order import Order
    from geofit.report.accuracy_report import AccuracyReport

__all__ = ["Delivery", "deliver"]


@dataclass(frozen=True, eq=False)
class Delivery:
    """What a run made: results in the order of the site; failures by horizon; warnings."""

    out: Path
    results: tuple[HorizonResult, ...]
    failures: Mapping[str, str]
    warnings: tuple[str, ...]

    @property
    def exit_code(self) -> int:
        """0: every sigma < epsilon; 1: some verdict FAIL; 2: a horizon could not be fitted."""
        if self.failures or not self.results:
            return 2
        return 0 if all(result.accuracy.passed for result in self.results) else 1


def deliver(
    site: Site,
    out: Path,
    horizons: Sequence[str] = (),
    changes: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    *,
    language: Language = EN,
    date: str = "",
    pdf: bool = False,
) -> Delivery:
    """Fit horizons of a site, examine them, and write everything that belongs to them.

    Each horizon leaves ``.step``, ``.png``, ``.json`` and ``_residuals.csv``; the site ``report.html``,
    ``report.json``, ``site.png``, ``import_issues.csv`` and, if asked for, ``report.pdf``.

    Parameters
    ----------
    site : Site
        What was read.
    out : Path
        Folder for the files; made if it is not there. Each file is whole or absent.
    horizons : sequence of str
        Names of the horizons; empty: all.
    changes : mapping
        Settings that take the place of the site's, by the names of :class:`geofit.FitSettings`.
    progress : callable, optional
        Called as ``progress("horizon: stage", fraction)``.
    language : Language
        That of the report and the pictures.
    date : str
        Date of the report, ISO 8601; empty: SOURCE_DATE_EPOCH, else today.
    pdf : bool
        Whether the report is written as PDF, too: about a second a horizon.

    Raises
    ------
    InputError
        If the site has no such horizon.
    MissingDependencyError
        If the report is to be in Chinese and the machine has no font for it.
    Cancelled
        If ``progress`` returned False; the files of the horizons that were ready stay.
    """
    from geofit.report.gather import accuracy_report

    names = _chosen(site, horizons)
    stems = file_stems(names)
    if pdf and language.code == "zh":
        from geofit.report.fonts import pdf_fonts

        pdf_fonts(chinese=True)  # told before anything is fitted
    # Also when there is nothing to list: a file of an earlier run would mislead.
    _make(out)
    _write_issues(site, out)
    results: list[HorizonResult] = []
    images: dict[str, bytes] = {}
    failures: dict[str, str] = {}
    warning = _font_warning(site, names)
    for i, name in enumerate(names):
        part = _Part(progress, name, i, len(names))
        try:
            result, pictures = _horizon(site, name, out / stems[name], changes or {}, part, language)
            results.append(result)
            images |= pictures
        except Cancelled:
            raise
        except GeofitError as error:
            failures[name] = str(error)
    warnings = [warning] if warning else []
    if results:
        tell(progress, "report", 1.0)
        compared, unordered = _orders(results)
        report = accuracy_report(results, compared, failures=failures, date=date)
        missing = _write_report(report, results, images, out, language, warning, pdf)
        warnings += [text for text in (unordered, missing) if text]
    return Delivery(out, tuple(results), failures, tuple(warnings))


@dataclass(frozen=True)
class _Part:
    """The share of one horizon in the whole run's progress."""

    progress: Progress | None
    name: str
    index: int
    count: int

    def within(self, low: float, high: float) -> Progress:
        """Return a listener for a stage that takes the run from one share of the horizon to another."""

        def listen(stage: str, fraction: float, /) -> None:
            share = low + (high - low) * fraction
            tell(self.progress, f"{self.name}: {stage}", (self.index + share) / self.count)

        return listen


def _horizon(
    site: Site, name: str, stem: Path, changes: Mapping[str, Any], part: _Part, language: Language
) -> tuple[HorizonResult, Mapping[str, bytes]]:
    from geofit.examine import examine
    from geofit.io.step import write_step
    from geofit.pipeline import fit_horizon
    from geofit.report.pictures import draw, write_picture
    from geofit.report.result import write_json
    from geofit.report.tables import write_residuals
    from geofit.settings import FitSettings
    from geofit.storage import equal_accuracy

    settings = replace(site.settings.get(name, FitSettings()), **changes)
    clock = _Clock()
    surface = fit_horizon(site.horizons[name], settings, site.boundary, part.within(0.0, 0.3), name=name)
    clock.stop("fit")
    offdata = examine(surface, part.within(0.3, 0.6))
    clock.stop("examination")
    part.within(0.6, 0.6)("STEP and read-back", 0.0)
    path = stem.with_name(stem.name + ".step")
    back = write_step({name: surface}, path)[name]
    clock.stop("STEP and read-back")
    part.within(0.75, 0.75)("pictures", 0.0)
    storage = equal_accuracy(surface, settings.interior_tolerance)
    result = HorizonResult(surface, site, back, storage, path.stat().st_size, offdata=offdata)
    pictures = draw(result, language)
    write_picture(result, pictures, stem.with_name(stem.name + ".png"), language)
    clock.stop("pictures")
    result = replace(result, seconds=clock.seconds)
    write_residuals(result, stem.with_name(stem.name + "_residuals.csv"))
    write_json(result, stem.with_name(stem.name + ".json"))
    return result, pictures.images


class _Clock:
    """Seconds since the last stop, by name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._since = time.perf_counter()

    def stop(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name] = round(now - self._since, 3)
        self._since = now


def _orders(results: Sequence[HorizonResult]) -> tuple[tuple[Order, ...] | None, str]:
    """Compare the horizons of the site's order that were fitted; None and the reason where that is not possible."""
    from geofit.order import orders

    site = results[0].site
    surfaces = {result.name: result.surface for result in results}
    sequence = [name for name in site.order if name in surfaces]
    if site.order and len(sequence) < 2:
        return None, ""
    try:
        return orders(surfaces, sequence, site.ground), ""
    except SettingsError as error:
        return None, f"The order of the horizons was not examined: {error}"


def _write_report(
    report: AccuracyReport,
    results: Sequence[HorizonResult],
    images: Mapping[str, bytes],
    out: Path,
    language: Language,
    warning: str,
    pdf: bool,
) -> str:
    """Write the report in its forms; return why there are no pictures in space, or an empty text."""
    from geofit.report.accuracy_report import write_json
    from geofit.report.chapters import document
    from geofit.report.html import write_html
    from geofit.report.pictures import draw_site

    whole = draw_site(results, language)
    pages = document(report, language, missing_picture=whole.missing, warning=warning)
    pictures = {**images, **whole.images}
    for data in whole.images.values():
        with replacing(out / "site.png") as part:
            part.write_bytes(data)
    write_json(report, out / "report.json")
    write_html(pages, pictures, out / "report.html")
    if pdf:
        from geofit.report.pdf import write_pdf

        write_pdf(pages, pictures, out / "report.pdf")
    return whole.missing


def _write_issues(site: Site, out: Path) -> None:
    from geofit.report.tables import write_issues

    write_issues(site.issues, out / "import_issues.csv")


def _font_warning(site: Site, names: Iterable[str]) -> str:
    from geofit.report.fonts import missing_font

    kinds = {str(kind) for name in names for kind in set(site.horizons[name].kind.tolist())}
    return missing_font([site.name, *names, *kinds]) or ""


def _chosen(site: Site, horizons: Sequence[str]) -> list[str]:
    unknown = [name for name in horizons if name not in site.horizons]
    if unknown:
        raise InputError(
            f"There is no horizon '{unknown[0]}'",
            f"The horizons are: {', '.join(site.horizons)}.",
            file=site.name,
        )
    return [name for name in site.horizons if not horizons or name in horizons]


def _make(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"The folder cannot be made: {error.strerror or error}",
            "Name another one with --out.",
            file=str(out),
        ) from None
