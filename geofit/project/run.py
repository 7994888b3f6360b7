"""From a site to the files that a run leaves: surfaces, one accuracy report, tables, pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Check
from geofit.data.errors import InputError
from geofit.data.files import folder_for, replacing
from geofit.data.guard import guarded
from geofit.data.languages import EN, Language
from geofit.data.messages import EMPTY, Message, message
from geofit.data.progress import Progress, tell
from geofit.data.site import Section, Site
from geofit.project.horizon_files import Made, section_profiles, storage_compared, write_horizon
from geofit.project.run_files import RunFiles, earlier_files, files_in, removed, run_files
from geofit.project.side_by_side import Crew, crew
from geofit.project.single_reports import BodyPart, write_body_part
from geofit.project.step_files import Signed
from geofit.report.result import HorizonResult
from geofit.streaming.executors import HERE, Where
from geofit.streaming.kept import clear_kept

if TYPE_CHECKING:
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.report.accuracy_report import AccuracyReport
    from geofit.report.pictures import Pictures
    from geofit.site.fit_site import SiteFit
    from geofit.site.order import Order
    from geofit.site.separate import Contradiction
    from geofit.site.throw import FaultCut

__all__ = ["Form", "Reports", "RunResult", "report_paths", "run_horizons", "write_reports"]

Form = Literal["html", "pdf", "json"]
#: Folder of a run's results in which fits are kept until all is written.
FITTED = "_fits"
#: Share of the fits in a run's time.
FITS = 0.3


@dataclass(frozen=True, eq=False)
class RunResult:
    """What a run made: results in the order of the site; failures by horizon; warnings.

    A faulted horizon has a result for each block, and ``cuts`` between them; ``orders`` compares horizons of the site's
    order, and ``contradictions`` are what the separation could not resolve. ``report`` is None if nothing could be
    fitted.
    """

    out: Path
    results: tuple[HorizonResult, ...]
    failures: Mapping[str, Message]
    warnings: tuple[Message, ...]
    orders: tuple[Order, ...] = ()
    cuts: tuple[FaultCut, ...] = ()
    contradictions: tuple[Contradiction, ...] = ()
    report: AccuracyReport | None = None
    bodies: tuple[BodyPart, ...] = ()

    @property
    def exit_code(self) -> int:
        """0: every sigma < epsilon; 1: some verdict FAIL; 2: a horizon could not be fitted."""
        if self.failures or not self.results:
            return 2
        passed = (*(result.accuracy.passed for result in self.results), *(body.passed for body in self.bodies))
        return 0 if all(passed) else 1


def run_horizons(
    site: Site,
    out: Path,
    horizons: Sequence[str] = (),
    changes: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    *,
    language: Language = EN,
    date: str = "",
    pdf: bool = False,
    separate: bool = False,
    bands: bool = False,
    scheduler: str | None = None,
    bodies: Sequence[str] = (),
    workers: int = 1,
    signed: Signed | None = None,
    hands: Crew | None = None,
    fitted: Callable[[HorizonFit], None] | None = None,
) -> RunResult:
    """Fit horizons of a site, examine them, and write everything that belongs to them.

    Each horizon, of a faulted one each block, leaves ``.step``, ``.png``, ``.json`` and ``_residuals.csv``; the site
    ``report.html``, ``report.json``, ``site.png``, ``import_issues.csv`` and, if asked for, ``report.pdf``. Files that
    an earlier run left of the same horizons, bodies and report are removed if a report was written; those of other
    horizons and bodies stay. A warning lists either.

    Parameters
    ----------
    site : Site
        What was read.
    out : Path
        Folder for the files; created if missing. Each file is whole or absent.
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
    separate : bool
        Whether horizons of the site's order that cross are separated (:func:`geofit.separate_horizons`).
    bands : bool
        Whether ``_upper90.step`` and ``_lower90.step`` are written: they bound the 90 % prediction band.
    scheduler : str, optional
        Where the horizons are fitted side by side, see :func:`geofit.fit_site`, and where the folds of their
        cross-validation that need fits are. None: one after another.
    bodies : sequence of str
        Codes of logged intervals, a body each: it is fitted, its files are written, and it has a chapter of the report.
    workers : int
        Processes that fit (with a scheduler), examine and draw horizons side by side; 1: none, all is done here. A
        script that asks for more needs the guard ``if __name__ == "__main__"``.
    signed : Signed, optional
        What the STEP files state, and whether they get a certificate; by default author and organisation of the site.
    hands : Crew, optional
        Processes that are at work already; by default the run starts its own ``workers``.
    fitted : callable, optional
        Called with each surface as soon as it is fitted and checked, long before it is examined.

    Raises
    ------
    InputError
        If the site has no such horizon, or a result would replace an input of the run.
    MissingDependencyError
        If the report is to be in Chinese and the machine has no font for it.
    Cancelled
        If ``progress`` returned False; the files of the horizons that were ready stay.
    """
    from geofit.site.fit_site import fit_site

    names = _chosen(site, horizons)
    if pdf and language.code == "zh":
        from geofit.report.fonts import pdf_fonts

        pdf_fonts(chinese=True)  # told before anything is fitted
    files = run_files(out, site.horizons, names, bodies)  # refused before anything is fitted
    before = files_in(folder_for(out))
    # Also when there is nothing to list: a file of an earlier run would mislead.
    _write_issues(site, out, language)
    with crew(min(workers, len(names))) if hands is None else nullcontext(hands) as ours:
        listen = _within(progress, 0.0, FITS)
        fits = fit_site(
            site, names, changes, listen, separate=separate, scheduler=scheduler, workers=workers, fitted=fitted,
            folder=out / FITTED,
        )  # fmt: skip
        # Horizons are examined side by side already; of one alone, and on other machines, the folds are.
        apart = scheduler is not None and (scheduler != "local" or len(fits.surfaces) == 1)
        where = Where(scheduler or "local", workers) if apart else HERE
        stated = signed or Signed(site.title.author, site.title.organisation)
        stated = stated.about(_corners(site, fits))
        files = run_files(out, site.horizons, names, bodies, fits.surfaces)
        others = _others_left(files, before)
        result = _write_results(site, fits, files, ours, progress, language, date, pdf, bands, where, stated, others)
    clear_kept(out / FITTED)
    stale, _ = earlier_files(files, before)
    return replace(result, warnings=(*result.warnings, *others, *_without_stale(result, stale)))


def _others_left(files: RunFiles, before: Mapping[str, tuple[int, int]]) -> list[Message]:
    """Name the files of horizons and bodies of an earlier run that are not part of this one."""
    _, others = earlier_files(files, before)
    text = message(
        "project.earlier-files-left",
        "The folder also contains files of an earlier run that are not part of this one: {names}",
        names=", ".join(others),
    )
    return [text] if others else []


def _without_stale(result: RunResult, stale: Sequence[str]) -> list[Message]:
    """Remove what contradicts the new report, and name it; without a new report nothing is removed."""
    gone = removed(result.out, stale) if result.report is not None else []
    left = [name for name in stale if name not in gone]
    texts = (
        message(
            "project.earlier-files-removed",
            "Removed files of an earlier run: {names}",
            names=", ".join(gone),
        ),
        message(
            "project.earlier-files-stale",
            "Outdated files of an earlier run: {names}",
            names=", ".join(left),
        ),
    )
    return [text for text, names in zip(texts, (gone, left), strict=True) if names]


def _without_dips(site: Site, fits: SiteFit) -> list[Message]:
    """Return a warning for each horizon whose dips are to be fitted and of which none is measured."""
    measured = set() if site.orientations is None else set(site.orientations.horizon.tolist())
    return [
        message(
            "project.no-dips-to-fit",
            "{name}: its dips are to be fitted, but none is measured on it: give them under [orientations], or with "
            "--orientations",
            name=name,
        )
        for name, surface in fits.surfaces.items()
        if surface.settings.dips == "fit" and not {name, name.rsplit(" (", 1)[0]} & measured
    ]


def _corners(site: Site, fits: SiteFit) -> list[NDArray[np.float64]]:
    """Return the lowest coordinates of the surfaces, and of the holes in which bodies are logged."""
    places = [surface.bounds[0] for surface in fits.surfaces.values()]
    return places + [hole.xyz.min(axis=0) for hole in site.holes if len(hole.xyz)] or [np.zeros(3)]


def _write_results(
    site: Site, fits: SiteFit, files: RunFiles, hands: Crew, progress: Progress | None, language: Language, date: str,
    pdf: bool, bands: bool, where: Where, signed: Signed, notes: Sequence[Message],
) -> RunResult:  # fmt: skip
    """Examine, draw and write what was fitted."""
    from geofit.report.gather import accuracy_report
    from geofit.report.pictures import draw_sections
    from geofit.report.profile import report_sections

    failures, warnings = dict(fits.failures), [*fits.warnings, *_without_dips(site, fits)]
    sections = report_sections(site, [surface.points for surface in fits.surfaces.values()]) if fits.surfaces else ()
    ordered, unordered = _orders(site, fits)
    orders = ordered or ()
    made, whole = _examined(
        site, fits, orders, files, hands, progress, language, bands, sections, failures, where, signed
    )
    results = [one.result for one in made]
    images = {name: picture for one in made for name, picture in one.images.items()}
    warnings += [text for one in made for text in one.warnings]
    parts = _bodies(site, fits, files, hands, progress, language, failures, signed)
    images |= {name: picture for part in parts for name, picture in part.images.items()}
    report: AccuracyReport | None = None
    if results:
        tell(progress, "report", 0.9)
        bare = [replace(result, surface=result.surface.with_(model=None)) for result in results]
        drawn = [hands.begin(partial(draw_sections, bare, (section,), language)) for section in sections]
        report = accuracy_report(
            results, ordered, cuts=fits.cuts, contradictions=fits.contradictions, failures=failures, date=date,
            sections=sections,
        )  # fmt: skip
        font = _font_warning(results)
        for section in drawn:
            images |= section()
        for data in whole.images.values():
            with replacing(files.folder / "site.png") as picture:
                picture.write_bytes(data)
        forms: tuple[Form, ...] = ("html", "json", "pdf") if pdf else ("html", "json")
        _write_report(report, whole, images, files.folder, language, font, forms, parts, notes)
        warnings = [text for text in (font, *warnings, unordered, whole.missing) if text]
    return RunResult(
        files.folder, tuple(results), failures, tuple(warnings), orders, fits.cuts, fits.contradictions, report,
        tuple(parts),
    )  # fmt: skip


def _bodies(
    site: Site, fits: SiteFit, files: RunFiles, hands: Crew, progress: Progress | None, language: Language,
    failures: dict[str, Message], signed: Signed,
) -> list[BodyPart]:  # fmt: skip
    """Fit the bodies of a report and write their files; note those that failed."""
    codes = list(files.bodies)
    surfaces = {name: surface.with_(model=None) for name, surface in fits.surfaces.items()}
    tasks = [
        partial(write_body_part, site, code, name, files.stem(name), surfaces, language.code, signed)
        for code, name in files.bodies.items()
    ]
    found: dict[int, BodyPart] = {}
    for i, made in hands.do(tasks, _within(progress, 0.9, 0.9), "bodies"):
        if isinstance(made, Message):
            failures[codes[i]] = made
        else:
            found[i] = made
    return [found[i] for i in sorted(found)]


def _examined(
    site: Site, fits: SiteFit, orders: Sequence[Order], files: RunFiles, hands: Crew, progress: Progress | None,
    language: Language, bands: bool, sections: Sequence[Section], failures: dict[str, Message], where: Where,
    signed: Signed,
) -> tuple[list[Made], Pictures]:  # fmt: skip
    """Examine every surface and write its files, and draw them together, side by side; note those that failed."""
    from geofit.report.pictures import Pictures, draw_site

    # What takes longest begins first: a folded surface is fitted anew without each of its sections.
    order = sorted(fits.surfaces, key=lambda name: (fits.surfaces[name].frame != "sections", -_size(fits, name)))
    tasks: list[Callable[[], Made | Message | Pictures]] = [
        partial(
            write_horizon, fits.surfaces[name], site, files.stem(name), language.code, fits.seconds[name], bands,
            sections, where, signed, fits.horizon[name], _checks(orders, name),
        )
        for name in order
    ]  # fmt: skip
    bare = [
        HorizonResult(surface.with_(model=None), site, horizon=fits.horizon[name])
        for name, surface in fits.surfaces.items()
    ]
    if bare:
        tasks.append(partial(draw_site, bare, language))
    found: dict[str, Made] = {}
    whole = Pictures({}, None, None)
    for i, made in hands.do(tasks, _within(progress, FITS, 0.9), "examination"):
        if isinstance(made, Pictures):
            whole = made
        elif isinstance(made, Message):
            failures[order[i]] = made
        else:
            # Here the surface still has all that its process did not send back.
            found[order[i]] = replace(made, result=replace(made.result, surface=fits.surfaces[order[i]], site=site))
    results = [found[name] for name in fits.surfaces if name in found]
    if found and len(found) < len(fits.surfaces):
        whole = draw_site([one.result for one in results], language)
    return results, whole


def _size(fits: SiteFit, name: str) -> int:
    return fits.surfaces[name].control_points


@dataclass(frozen=True, eq=False)
class Reports:
    """What was written of a report, by form, what is to be told about it, and what it was made from.

    ``orders`` states how its horizons lie to each other.
    """

    files: Mapping[Form, Path]
    warnings: tuple[Message, ...]
    results: tuple[HorizonResult, ...]
    orders: tuple[Order, ...] = ()


def report_paths(folder: Path, forms: Iterable[Form]) -> dict[Form, Path]:
    """Return the file of each form of a report in a folder."""
    return {form: folder / f"report.{form}" for form in forms}


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
    bodies: Sequence[BodyPart] = (),
    notes: Sequence[Message] = (),
) -> Reports:
    """Write the accuracy report of surfaces that are there already; nothing else is written.

    A result without ``storage`` gets one, so that the report has the chapters of :func:`run_horizons`'s.

    Parameters
    ----------
    results : sequence of HorizonResult
        At least one; all of one site.
    out : Path
        Folder for the report; created if missing.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops.
    language : Language
        That of the report and its pictures.
    forms : sequence of {"html", "pdf", "json"}
        Which files are written.
    examined : bool
        Whether surfaces without ``prediction`` are examined away from their data first.
    date : str
        ISO 8601; empty: SOURCE_DATE_EPOCH, else today.
    fits : SiteFit, optional
        Where some of the surfaces are blocks of faulted horizons: of which, and what the faults displace.
    bodies : sequence of BodyPart
        Chapters of bodies, in their order.
    notes : sequence of Message
        What else the reader must know, for the summary.

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
    from geofit.report.pictures import Pictures, draw_pictures, draw_sections, draw_site
    from geofit.report.profile import report_sections
    from geofit.site.fit_site import SiteFit

    pictured = any(form != "json" for form in forms)
    if "pdf" in forms and language.code == "zh":
        from geofit.report.fonts import pdf_fonts

        pdf_fonts(chinese=True)
    folder_for(out)
    images: dict[str, bytes] = {name: picture for part in bodies for name, picture in part.images.items()}
    made: list[HorizonResult] = []
    warnings: list[Message] = []
    sections = report_sections(results[0].site, [result.surface.points for result in results])
    for i, result in enumerate(results):
        low, high = 0.9 * i / len(results), 0.9 * (i + 1) / len(results)
        part = _within(progress, low, high, result.name)
        part("examination", 0.0)
        if examined and result.prediction is None:
            result = replace(result, prediction=examine(result.surface, _within(progress, low, 0.6 * high + 0.4 * low)))
        if result.storage is None:
            storage, missing = storage_compared(result.surface)
            result = replace(result, storage=storage)
            warnings += missing
        profiles, uncut = section_profiles(result, sections)
        result = replace(result, profiles=profiles)
        if fits is not None:
            result = replace(result, horizon=fits.horizon.get(result.name, ""))
        warnings += uncut
        if pictured:
            part("pictures", 0.6)
            images |= draw_pictures(result, language).images
        made.append(result)
    tell(progress, "report", 0.9)
    if fits is None:
        surfaces = {result.name: result.surface for result in made}
        fits = SiteFit(surfaces, {name: name for name in surfaces})
    orders, unordered = _orders(made[0].site, fits)
    made = [replace(one, orders=_checks(orders or (), one.name)) for one in made]
    report = accuracy_report(made, orders, cuts=fits.cuts, date=date, sections=sections)
    if pictured:
        images |= draw_sections(made, sections, language)
    whole, font = draw_site(made, language) if pictured else Pictures({}, None, None), _font_warning(made)
    tell(progress, "report", 0.95)
    _write_report(report, whole, images, out, language, font, forms, bodies, notes)
    return Reports(
        report_paths(out, forms),
        tuple(text for text in (font, *warnings, unordered, whole.missing) if text),
        tuple(made),
        orders or (),
    )


def _within(progress: Progress | None, low: float, high: float, name: str = "") -> Progress:
    """Return a listener for a part that takes the whole run from one share to another."""

    def listen(stage: str | Message, fraction: float, /) -> None:
        tell(
            progress,
            message("data.stage-of-name", "{name}: {stage}", name=name, stage=stage) if name else stage,
            low + (high - low) * fraction,
        )

    return listen


def _orders(site: Site, fits: SiteFit) -> tuple[tuple[Order, ...] | None, Message]:
    """Compare the horizons of the site's order that were fitted; None and the reason where that is not possible."""
    from geofit.project.ordering import order_not_examined
    from geofit.site.fit_site import compare_in_order

    if site.order and len([name for name in site.order if name in fits.horizon.values()]) < 2:
        return None, EMPTY
    missing: list[Message] = []
    compared = guarded(
        lambda: compare_in_order(site, fits),
        None,
        lambda reason: missing.append(order_not_examined(reason)),
    )
    return compared, missing[0] if missing else EMPTY


def _checks(orders: Sequence[Order], name: str) -> tuple[Check, ...]:
    """Return how a horizon, of a faulted one a block, lies to others: part of the verdict."""
    return tuple(order.check() for order in orders if name in (order.upper, order.lower))


def _write_report(
    report: AccuracyReport,
    whole: Pictures,
    images: Mapping[str, bytes],
    out: Path,
    language: Language,
    warning: Message,
    forms: Sequence[Form],
    bodies: Sequence[BodyPart] = (),
    notes: Sequence[Message] = (),
) -> None:
    """Write the report in its forms; ``whole`` shows the site, ``images`` its horizons."""
    from geofit.report.chapters import document
    from geofit.report.html import write_html
    from geofit.report.schema import report_document, write_json

    chapters, stale = [part.chapter for part in bodies], [part.name for part in bodies if part.stale]
    pages = document(
        report, language, missing_picture=whole.missing, warning=warning, bodies=chapters,
        body_rows=[part.row for part in bodies], stale_bodies=stale, notes=notes,
    )  # fmt: skip
    pictures = {**images, **whole.images}
    if "json" in forms:
        write_json(report_document(report), out / "report.json")
    if "html" in forms:
        write_html(pages, pictures, out / "report.html")
    if "pdf" in forms:
        from geofit.report.pdf import write_pdf

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
            message("data.horizon-unknown", "There is no horizon '{name}'", name=unknown[0]),
            message("data.known-horizons", "The horizons are: {names}.", names=", ".join(site.horizons)),
            file=site.name,
        )
    return [name for name in site.horizons if not horizons or name in horizons]
