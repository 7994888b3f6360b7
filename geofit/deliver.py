"""From a site to the files that a run leaves: surfaces, reports, tables, pictures."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from geofit.errors import Cancelled, GeofitError, InputError
from geofit.files import file_stems
from geofit.progress import Progress, tell
from geofit.report.result import HorizonResult
from geofit.site import Site

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
) -> Delivery:
    """Fit horizons of a site and write everything that belongs to them.

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

    Raises
    ------
    InputError
        If the site has no such horizon.
    Cancelled
        If ``progress`` returned False; the files of the horizons that were ready stay.
    """
    names = _chosen(site, horizons)
    stems = file_stems(names)
    # Also when there is nothing to list: a file of an earlier run would mislead.
    _make(out)
    _write_issues(site, out)
    results: list[HorizonResult] = []
    failures: dict[str, str] = {}
    warning = _font_warning(site, names)
    for i, name in enumerate(names):
        part = _Part(progress, name, i, len(names))
        try:
            results.append(_horizon(site, name, out / stems[name], changes or {}, part, warning))
        except Cancelled:
            raise
        except GeofitError as error:
            failures[name] = str(error)
    warnings = [warning] if warning else []
    if results:
        tell(progress, "site", 1.0)
        warnings += _site(results, stems, out, warning)
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


def _horizon(site: Site, name: str, stem: Path, changes: Mapping[str, Any], part: _Part, warning: str) -> HorizonResult:
    from geofit.io.step import write_step
    from geofit.pipeline import fit_horizon
    from geofit.report.html import write_report
    from geofit.report.pictures import draw, write_picture
    from geofit.report.result import write_json
    from geofit.report.tables import write_residuals
    from geofit.settings import FitSettings
    from geofit.storage import equal_accuracy

    settings = replace(site.settings.get(name, FitSettings()), **changes)
    clock = _Clock()
    surface = fit_horizon(site.horizons[name], settings, site.boundary, part.within(0.0, 0.5), name=name)
    clock.stop("fit")
    part.within(0.5, 0.5)("STEP and read-back", 0.0)
    path = stem.with_name(stem.name + ".step")
    back = write_step({name: surface}, path)[name]
    clock.stop("STEP and read-back")
    part.within(0.7, 0.7)("pictures", 0.0)
    storage = equal_accuracy(surface, settings.interior_tolerance)
    result = HorizonResult(surface, site, back, storage, path.stat().st_size)
    pictures = draw(result)
    clock.stop("pictures")
    part.within(0.95, 0.95)("report", 0.0)
    result = replace(result, seconds=clock.seconds)
    write_picture(result, pictures, stem.with_name(stem.name + ".png"))
    write_report(result, pictures, stem.with_name(stem.name + "_report.html"), warning=warning)
    write_residuals(result, stem.with_name(stem.name + "_residuals.csv"))
    write_json(result, stem.with_name(stem.name + ".json"))
    return result


class _Clock:
    """Seconds since the last stop, by name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._since = time.perf_counter()

    def stop(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name] = round(now - self._since, 3)
        self._since = now


def _site(results: Sequence[HorizonResult], stems: Mapping[str, str], out: Path, warning: str) -> list[str]:
    from geofit.report.html import write_site_report
    from geofit.report.pictures import write_site_picture

    picture = out / "site.png"
    missing = write_site_picture(results, picture)
    write_site_report(results, stems, out / "report.html", picture=None if missing else picture, warning=warning)
    return [missing] if missing else []


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
