"""From a site to the files that a run leaves: surfaces, one accuracy report, tables, pictures."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from geofit.data.errors import InputError
from geofit.data.files import file_stems, replacing
from geofit.data.guard import guarded
from geofit.data.languages import EN, Language
from geofit.data.messages import EMPTY, Message, message
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.report.result import HorizonResult

if TYPE_CHECKING:
    from geofit.checks.storage import Storage
    from geofit.data.prediction import OffData
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.report.accuracy_report import AccuracyReport
    from geofit.report.pictures import Pictures
    from geofit.site.fit_site import SiteFit
    from geofit.site.order import Order
    from geofit.site.separate import Contradiction
    from geofit.site.throw import FaultCut

__all__ = ["Delivery", "Form", "Reports", "deliver", "write_reports"]

Form = Literal["html", "pdf", "json"]
#: Share of the fits in a run's time.
FITS = 0.3


@dataclass(frozen=True, eq=False)
class Delivery:
    """What a run made: results in the order of the site; failures by horizon; warnings.

    A faulted horizon has a result for each block, and ``cuts`` between them; ``orders`` compares horizons of the site's
    order, and ``contradictions`` are what a repair could not mend.
    """

    out: Path
    results: tuple[HorizonResult, ...]
    failures: Mapping[str, Message]
    warnings: tuple[Message, ...]
    orders: tuple[Order, ...] = ()
    cuts: tuple[FaultCut, ...] = ()
    contradictions: tuple[Contradiction, ...] = ()

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
    apart: bool = False,
    bands: bool = False,
    scheduler: str | None = None,
    workers: int | None = None,
) -> Delivery:
    """Fit horizons of a site, examine them, and write everything that belongs to them.

    Each horizon, of a faulted one each block, leaves ``.step``, ``.png``, ``.json`` and ``_residuals.csv``; the site
    ``report.html``, ``report.json``, ``site.png``, ``import_issues.csv`` and, if asked for, ``report.pdf``.

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
    apart : bool
        Whether horizons of the site's order that cross are separated (:func:`geofit.separate_horizons`).
    bands : bool
        Whether ``_upper90.step`` and ``_lower90.step`` are written: the rock lies between them with 90 %.
    scheduler, workers : str, int, optional
        Where the horizons are fitted side by side; see :func:`geofit.fit_site`.

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
    from geofit.report.pictures import draw_site
    from geofit.site.fit_site import fit_site

    names = _chosen(site, horizons)
    if pdf and language.code == "zh":
        from geofit.report.fonts import pdf_fonts

        pdf_fonts(chinese=True)  # told before anything is fitted
    # Also when there is nothing to list: a file of an earlier run would mislead.
    _make(out)
    _write_issues(site, out, language)
    listen = _within(progress, 0.0, FITS)
    fits = fit_site(site, names, changes, listen, apart=apart, scheduler=scheduler, workers=workers)
    stems = file_stems(fits.surfaces)
    results: list[HorizonResult] = []
    images: dict[str, bytes] = {}
    failures, warnings = dict(fits.failures), list(fits.warnings)
    for i, (name, surface) in enumerate(fits.surfaces.items()):
        share = (1.0 - FITS) / len(fits.surfaces)
        part = _within(progress, FITS + i * share, FITS + (i + 1) * share, name)

        def failed(reason: Message, name: str = name) -> None:
            failures[name] = reason

        stem, seconds = out / stems[name], fits.seconds[name]
        made = guarded(partial(_written, surface, site, stem, part, language, seconds, bands), None, failed)
        if made is not None:
            results.append(made.result)
            images |= made.images
            warnings += made.warnings
    orders: tuple[Order, ...] = ()
    if results:
        tell(progress, "report", 1.0)
        compared, unordered = _orders(site, fits)
        orders = compared or ()
        report = accuracy_report(
            results, compared, cuts=fits.cuts, contradictions=fits.contradictions, failures=failures, date=date
        )
        font, whole = _font_warning(results), draw_site(results, language)
        for data in whole.images.values():
            with replacing(out / "site.png") as picture:
                picture.write_bytes(data)
        forms: tuple[Form, ...] = ("html", "json", "pdf") if pdf else ("html", "json")
        _write_report(report, whole, images, out, language, font, forms)
        warnings = [text for text in (font, *warnings, unordered, whole.missing) if text]
    return Delivery(out, tuple(results), failures, tuple(warnings), orders, fits.cuts, fits.contradictions)


@dataclass(frozen=True, eq=False)
class Reports:
    """What was written of a report, by form, what is to be told about it, and what it was made from."""

    files: Mapping[Form, Path]
    warnings: tuple[Message, ...]
    results: tuple[HorizonResult, ...]


def write_reports(
    results: Sequence[HorizonResult],
    out: Path,
    progress: Progress | None = None,
    *,
    language: Language = EN,
    forms: Sequence[Form] = ("html", "json"),
    examined: bool = False,
    date: str = "",
    fits: SiteFit | None = None,
) -> Reports:
    """Write the accuracy report of surfaces that are there already; nothing else is written.

    A result without ``storage`` gets one, so that the report has the chapters of :func:`deliver`'s.

    Parameters
    ----------
    results : sequence of HorizonResult
        At least one; all of one site.
    out : Path
        Folder for the report; made if it is not there.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops.
    language : Language
        That of the report and its pictures.
    forms : sequence of {"html", "pdf", "json"}
        Which files are written.
    examined : bool
        Whether surfaces without ``offdata`` are examined off their data first.
    date : str
        ISO 8601; empty: SOURCE_DATE_EPOCH, else today.
    fits : SiteFit, optional
        Where some of the surfaces are blocks of faulted horizons: of which, and what the faults displace.

    Raises
    ------
    InputError
        If the folder cannot be made.
    MissingDependencyError
        If a PDF is to be in Chinese and the machine has no font for it.
    Cancelled
        If ``progress`` returned False; then nothing is written.
    """
    from geofit.prediction.examine import examine
    from geofit.report.gather import accuracy_report
    from geofit.report.pictures import Pictures, draw, draw_site
    from geofit.site.fit_site import SiteFit

    pictured = any(form != "json" for form in forms)
    if "pdf" in forms and language.code == "zh":
        from geofit.report.fonts import pdf_fonts

        pdf_fonts(chinese=True)
    _make(out)
    images: dict[str, bytes] = {}
    made = []
    warnings: list[Message] = []
    for i, result in enumerate(results):
        low, high = 0.9 * i / len(results), 0.9 * (i + 1) / len(results)
        part = _within(progress, low, high, result.name)
        part("examination", 0.0)
        if examined and result.offdata is None:
            result = replace(result, offdata=examine(result.surface, _within(progress, low, 0.6 * high + 0.4 * low)))
        if result.storage is None:
            storage, missing = _storage(result.surface)
            result = replace(result, storage=storage)
            warnings += missing
        if pictured:
            part("pictures", 0.6)
            images |= draw(result, language).images
        made.append(result)
    tell(progress, "report", 0.9)
    if fits is None:
        surfaces = {result.name: result.surface for result in made}
        fits = SiteFit(surfaces, {name: name for name in surfaces})
    orders, unordered = _orders(made[0].site, fits)
    report = accuracy_report(made, orders, cuts=fits.cuts, date=date)
    whole, font = draw_site(made, language) if pictured else Pictures({}, None, None), _font_warning(made)
    tell(progress, "report", 0.95)
    _write_report(report, whole, images, out, language, font, forms)
    files = {form: out / f"report.{form}" for form in forms}
    return Reports(files, tuple(text for text in (font, *warnings, unordered, whole.missing) if text), tuple(made))


def _within(progress: Progress | None, low: float, high: float, name: str = "") -> Progress:
    """Return a listener for a part that takes the whole run from one share to another."""

    def listen(stage: str | Message, fraction: float, /) -> None:
        tell(
            progress,
            message("run.stage-of", "{name}: {stage}", name=name, stage=stage) if name else stage,
            low + (high - low) * fraction,
        )

    return listen


@dataclass(frozen=True)
class _Made:
    """One surface with its files: result, pictures by name, and what is to be told."""

    result: HorizonResult
    images: Mapping[str, bytes]
    warnings: tuple[Message, ...]


def _written(
    surface: HorizonFit, site: Site, stem: Path, progress: Progress, language: Language, fit: float, bands: bool
) -> _Made:
    """Examine a surface, and write what belongs to it."""
    from geofit.cad.step import write_step
    from geofit.prediction.examine import examine
    from geofit.report.pictures import draw, write_picture
    from geofit.report.result import write_json
    from geofit.report.tables import write_residuals

    clock = _Clock(fit)
    offdata = examine(surface, _within(progress, 0.0, 0.45))
    clock.stop("examination")
    progress("STEP and read-back", 0.45)
    path = stem.with_name(stem.name + ".step")
    back = write_step({surface.name: surface}, path)[surface.name]
    warnings = _write_bands(surface, offdata, stem) if bands else ()
    clock.stop("STEP and read-back")
    progress("pictures", 0.7)
    storage, missing = _storage(surface)
    result = HorizonResult(surface, site, back, storage, path.stat().st_size, offdata=offdata)
    pictures = draw(result, language)
    write_picture(result, pictures, stem.with_name(stem.name + ".png"), language)
    clock.stop("pictures")
    result = replace(result, seconds=clock.seconds)
    write_residuals(result, stem.with_name(stem.name + "_residuals.csv"), language)
    write_json(result, stem.with_name(stem.name + ".json"))
    return _Made(result, pictures.images, (*warnings, *missing))


def _storage(surface: HorizonFit) -> tuple[Storage | None, tuple[Message, ...]]:
    """Compare the storage of a surface with that of a TIN and a grid; say why where that fails."""
    from geofit.checks.storage import equal_accuracy

    missing: list[Message] = []
    found = guarded(
        lambda: equal_accuracy(surface, surface.settings.interior_tolerance),
        None,
        lambda reason: missing.append(
            message(
                "run.storage-not-compared",
                "{name}: its storage was not compared: {reason}",
                name=surface.name,
                reason=reason,
            )
        ),
    )
    return found, tuple(missing)


def _write_bands(surface: HorizonFit, offdata: OffData, stem: Path) -> tuple[Message, ...]:
    """Write the surfaces between which the rock lies with 90 %; return why there are none."""
    from geofit.cad.step import write_step
    from geofit.prediction.bands import band

    if offdata.uncertainty is None:
        return (
            message(
                "run.no-90-surfaces-standard",
                "{name}: no 90 % surfaces, its standard deviation is not known",
                name=surface.name,
            ),
        )
    for side, one in zip(("upper", "lower"), band(surface, offdata), strict=True):
        write_step({one.name: one}, stem.with_name(f"{stem.name}_{side}90.step"))
    return ()


class _Clock:
    """Seconds since the last stop, by name."""

    def __init__(self, fit: float) -> None:
        self.seconds: dict[str, float] = {"fit": round(fit, 3)}
        self._since = time.perf_counter()

    def stop(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name] = round(now - self._since, 3)
        self._since = now


def _orders(site: Site, fits: SiteFit) -> tuple[tuple[Order, ...] | None, Message]:
    """Compare the horizons of the site's order that were fitted; None and the reason where that is not possible."""
    from geofit.site.fit_site import compare

    if site.order and len([name for name in site.order if name in fits.horizon.values()]) < 2:
        return None, EMPTY
    missing: list[Message] = []
    compared = guarded(
        lambda: compare(site, fits),
        None,
        lambda reason: missing.append(
            message(
                "run.order-horizons-not-examined",
                "The order of the horizons was not examined: {reason}",
                reason=reason,
            )
        ),
    )
    return compared, missing[0] if missing else EMPTY


def _write_report(
    report: AccuracyReport,
    whole: Pictures,
    images: Mapping[str, bytes],
    out: Path,
    language: Language,
    warning: Message,
    forms: Sequence[Form],
) -> None:
    """Write the report in its forms; ``whole`` shows the site, ``images`` its horizons."""
    from geofit.report.accuracy_report import write_json
    from geofit.report.chapters import document
    from geofit.report.html import write_html
    from geofit.report.pdf import write_pdf

    pages = document(report, language, missing_picture=whole.missing, warning=warning)
    pictures = {**images, **whole.images}
    if "json" in forms:
        write_json(report, out / "report.json")
    if "html" in forms:
        write_html(pages, pictures, out / "report.html")
    if "pdf" in forms:
        write_pdf(pages, pictures, out / "report.pdf")


def _write_issues(site: Site, out: Path, language: Language) -> None:
    from geofit.report.tables import write_issues

    write_issues(site.issues, out / "import_issues.csv", language)


def _font_warning(results: Sequence[HorizonResult]) -> Message:
    from geofit.report.fonts import missing_font

    kinds = {str(kind) for result in results for kind in set(result.surface.points.kind.tolist())}
    return missing_font([results[0].site.name, *(result.name for result in results), *kinds]) or EMPTY


def _chosen(site: Site, horizons: Sequence[str]) -> list[str]:
    unknown = [name for name in horizons if name not in site.horizons]
    if unknown:
        raise InputError(
            message("run.no-horizon", "There is no horizon '{name}'", name=unknown[0]),
            message("run.known-horizons", "The horizons are: {names}.", names=", ".join(site.horizons)),
            file=site.name,
        )
    return [name for name in site.horizons if not horizons or name in horizons]


def _make(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            message("run.folder-cannot", "The folder cannot be made: {error}", error=error.strerror or str(error)),
            message("run.name-other-folder", "Name another one with --out."),
            file=str(out),
        ) from None
