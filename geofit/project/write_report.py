"""write_report: the accuracy report of fits that a script has made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Literal, get_args

from geofit.data.errors import InputError, SettingsError
from geofit.data.given import FIT, arguments_checked, require_kind
from geofit.data.languages import language as language_of
from geofit.data.messages import Untranslated, message
from geofit.data.site import Site
from geofit.data.title_block import TitleBlock
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.run import Form, write_reports
from geofit.report.result import HorizonResult
from geofit.site.fit_site import SiteFit

__all__ = ["write_report"]


@arguments_checked
def write_report(
    fits: HorizonFit | SiteFit | Mapping[str, HorizonFit] | Sequence[HorizonFit],
    folder: str | PathLike[str],
    *,
    site: Site | None = None,
    title: TitleBlock | None = None,
    forms: Sequence[Literal["html", "pdf", "json"]] = ("html", "json"),
    language: Literal["en", "zh"] = "en",
    examined: bool = False,
) -> dict[Form, Path]:
    """Write the accuracy report of one or several fits.

    Parameters
    ----------
    fits : HorizonFit, SiteFit, or mapping or sequence of HorizonFit
        What :func:`geofit.fit_horizon`, :func:`geofit.judge` or :func:`geofit.fit_site` returned.
    folder : path
        Folder of ``report.html``, ``report.json`` and ``report.pdf``; created if missing.
    site : Site, optional
        The site of the fits: its title, study area, holes, sections and list of input files. Without it the report
        describes the points alone.
    title : TitleBlock, optional
        What the cover says: project, client, document number, status, author, revisions. By default the site's.
    forms : sequence of {"html", "pdf", "json"}
        Which files to write.
    language : {"en", "zh"}
        English or Chinese.
    examined : bool
        Whether to cross-validate the fits first (:func:`geofit.examine`), which takes longer than the fits.

    Returns
    -------
    dict of str to Path
        The file of each form.

    Raises
    ------
    ArgumentError
        If what is given is not a fit.
    SettingsError
        If a form is unknown.
    InputError
        If there is no fit, or the folder cannot be created.
    MissingDependencyError
        If a PDF is to be in Chinese and the machine has no font for it.

    Notes
    -----
    What the figures mean: ``docs/checks.md``. Lengths are in metres.
    """
    together = fits if isinstance(fits, SiteFit) else None
    match fits:
        case HorizonFit():
            given = [fits]
        case SiteFit():
            given = list(fits.surfaces.values())
        case Mapping():
            given = list(fits.values())
        case _:
            require_kind("fits", fits, Sequence, FIT)
            given = list(fits)
    for fit in given:
        require_kind("fits", fit, HorizonFit, FIT)
    for form in forms:
        if form not in get_args(Form):
            raise SettingsError(
                message(
                    "project.report-form-unknown",
                    "The report format '{form}' is unknown; choose {names}.",
                    form=Untranslated(form),
                    names=", ".join(get_args(Form)),
                )
            )
    if not given:
        raise InputError(
            message("project.nothing-to-report", "There is no fit to report"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(folder),
        )
    place = site or Site(name=", ".join(fit.name for fit in given), horizons={fit.name: fit.points for fit in given})
    if title is not None:
        place = replace(place, title=title)
    written = write_reports(
        [HorizonResult(fit, place) for fit in given],
        Path(folder),
        language=language_of(language),
        forms=forms,
        examined=examined,
        fits=together,
    )
    return dict(written.files)
