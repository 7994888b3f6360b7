"""The report that people read: one HTML file a horizon, one for the site. Offline, printable on A4."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import geofit
from geofit.files import replacing
from geofit.report.pictures import Pictures
from geofit.report.result import HorizonResult

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["write_report", "write_site_report"]

#: Holes and sections beyond this number are in the JSON only.
LONGEST_TABLE = 60
WORST = 20

_FIT_WORDS = {
    "control_points": "Control points",
    "energy": "Bending energy",
    "smoothing": "Smoothing",
    "iterations": "Iterations",
    "frame": "Frame",
    "order": "Derivative in the energy",
}


def write_report(result: HorizonResult, pictures: Pictures, path: Path, *, warning: str = "") -> None:
    """Write the report of one horizon.

    Parameters
    ----------
    result : HorizonResult
        What the report is about.
    pictures : Pictures
        Drawn by :func:`geofit.report.pictures.draw`.
    path : Path
        The HTML file.
    warning : str
        Something the reader must know about the report itself, a missing font for one.
    """
    surface, a = result.surface, result.accuracy
    d = np.abs(a.residuals)
    core = result.core
    groups = {"Patch": a.by_patch, "Kind of source": a.by_kind, "Section": a.by_section, "Hole": a.by_hole}
    page = _environment().get_template("report.html.j2").render(
        r=result,
        a=a,
        back=result.read_back,
        surface=surface,
        settings=surface.settings,
        setting_rows=asdict(surface.settings),
        points=surface.points,
        core_n=int(core.sum()),
        core_max=float(d[core].max()) if core.any() else None,
        share=float((d[~core] <= surface.settings.interior_tolerance).mean()) if (~core).any() else None,
        groups={name: _shown(rows) for name, rows in groups.items() if any(rows)},
        worst=a.worst[:WORST],
        pictures=pictures,
        fit_rows=_fit_rows(surface.fit),
        issues=_issue_counts(result),
        warning=warning,
        version=geofit.__version__,
    )  # fmt: skip
    with replacing(path) as part:
        part.write_text(page, encoding="utf-8")


def write_site_report(
    results: Sequence[HorizonResult],
    stems: Mapping[str, str],
    path: Path,
    *,
    picture: Path | None,
    warning: str = "",
) -> None:
    """Write the page that lists all horizons of a site and links to their reports."""
    image = ""
    if picture is not None and picture.exists():
        import base64

        image = "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode("ascii")
    page = _environment().get_template("site.html.j2").render(
        site=results[0].site,
        results=results,
        stems=stems,
        image=image,
        issues=_issue_counts(results[0]),
        warning=warning,
        version=geofit.__version__,
    )  # fmt: skip
    with replacing(path) as part:
        part.write_text(page, encoding="utf-8")


def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("geofit.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters |= {
        "m": metres,
        "size": _size,
        "count": _count,
        "value": lambda check: _measured(check.value, check.unit),
        "limit": lambda check: _measured(check.limit, check.unit),
    }
    return environment


def metres(value: float | None, digits: int = 3) -> str:
    """Write metres for a person: a dash for nothing, powers of ten below what the digits show, exact zero as 0.

    Examples
    --------
    >>> metres(0.1234), metres(-2.0, 1), metres(3e-9), metres(0.0), metres(None)
    ('0.123', '−2.0', '3e-9', '0', '–')
    """
    if value is None or not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    if abs(value) < 0.5 * 10.0**-digits:
        mantissa, exponent = f"{value:.0e}".split("e")
        text = f"{mantissa}e{int(exponent)}"
        return "−" + text[1:] if text.startswith("-") else text
    return f"{value:.{digits}f}".replace("-", "−")


def _measured(value: float, unit: str) -> str:
    """Write a check's value: metres and degrees with three digits, counts as they are."""
    if not np.isfinite(value):
        return "–"
    if unit in ("m", "deg"):
        return f"{metres(value)} {'m' if unit == 'm' else '°'}"
    return f"{value:g} {unit}".strip()


def _size(value: float) -> str:
    return f"{value / 1024:,.0f} kB".replace(",", " ")


def _count(value: float | None) -> str:
    return "–" if value is None else f"{value:,.0f}".replace(",", " ")


def _shown(rows: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Return the groups of a table, the largest residual first where there are too many."""
    named = [(name, group) for name, group in rows.items() if name]
    if len(named) <= LONGEST_TABLE:
        return named
    return sorted(named, key=lambda item: -item[1].max_abs)[:LONGEST_TABLE]


def _fit_rows(fit: Mapping[str, Any]) -> list[tuple[str, str]]:
    rows = []
    for key, value in fit.items():
        if isinstance(value, bool | int | str):
            rows.append((_FIT_WORDS.get(key, key.replace("_", " ").capitalize()), str(value)))
        elif isinstance(value, float):
            rows.append((_FIT_WORDS.get(key, key.replace("_", " ").capitalize()), f"{value:.4g}"))
    return rows


def _issue_counts(result: HorizonResult) -> dict[str, int]:
    severities = [issue.severity for issue in result.site.issues]
    return {word: severities.count(word) for word in ("error", "warning", "note")}
