"""From the results of a site to its accuracy report."""

from __future__ import annotations

import datetime
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import geofit
from geofit.data.accuracy import Check, Seam
from geofit.data.messages import EMPTY, Message
from geofit.data.points import PointSet
from geofit.data.prediction import LeftOut, PredictionResult
from geofit.data.site import ImportIssue, Section, Site, TableCount
from geofit.report.accuracy_report import (
    AccuracyReport,
    ChangeReport,
    CheckLine,
    ConflictLine,
    ContactLine,
    ContradictionLine,
    CutPlace,
    DipLine,
    FaultCutLine,
    FileCheck,
    GroupLine,
    HorizonReport,
    InputFile,
    LeftOutLine,
    MovedLine,
    OrderLine,
    OutlierLine,
    PartLine,
    PatchLine,
    PointLine,
    PredictionReport,
    RejectedRow,
    SeamLine,
    StorageLine,
    SuggestionLine,
)
from geofit.report.contour_plan import plan_sheet
from geofit.report.histogram import NOISE
from geofit.report.profile import Profile
from geofit.report.result import HorizonResult, sigma_of
from geofit.report.section_sheet import section_sheet

if TYPE_CHECKING:
    from geofit.site.order import Order
    from geofit.site.separate import Contradiction
    from geofit.site.states import Comparison
    from geofit.site.throw import FaultCut

__all__ = [
    "PICTURES",
    "accuracy_report",
    "change_report",
    "check_lines",
    "cut_of",
    "horizon_report",
    "inputs_of",
    "picture_name",
    "rejected_rows",
    "section_picture",
    "today",
    "versions",
]

#: What the pictures of a horizon show, in the order of the report.
PICTURES = ("plan", "view", "deviation", "residuals", "uncertainty", "dips", "change")
SITE_PICTURE = "site"
WORST = 20
_PROGRAMS = ("numpy", "scipy")


def picture_name(what: str, horizon: str) -> str:
    """Return the name by which a report speaks of a picture of a horizon."""
    return f"{what}/{horizon}"


def section_picture(section: Section) -> str:
    """Return the name by which a report speaks of the drawing of a section."""
    return f"section/{section.name}"


def cut_of(results: Sequence[HorizonResult], section: Section) -> dict[str, tuple[Profile, ...]]:
    """Return what a section cuts of each horizon."""
    return {result.name: tuple(result.profiles.get(section.name, ())) for result in results}


def today() -> str:
    """Return the date of a report that names none: SOURCE_DATE_EPOCH where it is set, else today; ISO 8601."""
    stamp = os.environ.get("SOURCE_DATE_EPOCH", "")
    if stamp.isdigit():
        return datetime.datetime.fromtimestamp(int(stamp), datetime.UTC).date().isoformat()
    return datetime.date.today().isoformat()


def accuracy_report(
    results: Sequence[HorizonResult],
    orders: Sequence[Order] | None = None,
    *,
    cuts: Sequence[FaultCut] = (),
    contradictions: Sequence[Contradiction] = (),
    failures: Mapping[str, Message] | None = None,
    date: str = "",
    sections: Sequence[Section] = (),
) -> AccuracyReport:
    """Gather the report of a site.

    Parameters
    ----------
    results : sequence of HorizonResult
        At least one; all of one site.
    orders : sequence of Order, optional
        What :func:`geofit.site.order.orders` found; None: not examined.
    cuts : sequence of FaultCut
        What faults displace, by :func:`geofit.site.throw.throws`.
    contradictions : sequence of Contradiction
        What :func:`geofit.site.separate.separate_horizons` could not resolve.
    failures : mapping of str to Message, optional
        Horizons that could not be fitted, and why.
    date : str
        ISO 8601; empty: :func:`today`.
    sections : sequence of Section
        Geological sections that the report shows; the results hold what they cut.
    """
    site = results[0].site
    severities = [issue.severity for issue in site.issues]
    return AccuracyReport(
        site=site.name,
        crs=site.crs,
        date=date or today(),
        horizons=tuple(horizon_report(result) for result in results),
        failures=dict(failures or {}),
        orders=None if orders is None else tuple(_order(order) for order in orders),
        contradictions=tuple(
            ContradictionLine(c.upper, c.lower, c.x, c.y, c.lack, c.above, c.below, c.text) for c in contradictions
        ),
        cuts=tuple(_cut(cut) for cut in cuts),
        inputs=inputs_of(site),
        issues={word: severities.count(word) for word in ("error", "warning", "note")},
        rejected=rejected_rows(site.issues),
        versions=versions(),
        picture=SITE_PICTURE,
        title=site.title,
        sections=tuple(section_sheet(one, site, cut_of(results, one), section_picture(one)) for one in sections),
    )


def rejected_rows(issues: Iterable[ImportIssue]) -> tuple[RejectedRow, ...]:
    """Return the errors and warnings of the readers."""
    return tuple(RejectedRow(**_issue(i)) for i in issues if i.severity in ("error", "warning"))


def _issue(issue: Any) -> dict[str, Any]:
    return {f: getattr(issue, f) for f in ("severity", "file", "row", "column", "value", "reason", "remedy")}


def horizon_report(result: HorizonResult) -> HorizonReport:
    """Gather everything that is said about one horizon."""
    surface, a, core = result.surface, result.accuracy, result.core
    d = np.abs(a.residuals)
    out, settings = d[~core], surface.settings
    points, storage = surface.points, result.storage
    groups = {"kind": a.by_kind, "section": a.by_section, "hole": a.by_hole, "patch": a.by_patch}
    shown = [what for what in PICTURES if _shown(what, result, out)]
    return HorizonReport(
        horizon=result.name,
        verdict=result.verdict.word,
        lamps=result.verdict.lamps,
        sound=result.sound,
        n_points=a.n,
        n_used=a.n - len(result.dropped),
        n_core=int(core.sum()),
        n_periphery=int((~core).sum()),
        sigma=a.sigma,
        epsilon=a.epsilon,
        max_abs=a.max_abs,
        mean=a.mean,
        core=_part(d[core], settings.interior_tolerance),
        periphery=_part(out, settings.interior_tolerance),
        over=dict(a.over),
        reason=surface.partition.reason if surface.partition is not None else EMPTY,
        notes=a.notes,
        groups=tuple(
            GroupLine(by, name, g.n, g.sigma, g.max_abs, g.mean)
            for by, rows in groups.items()
            for name, g in rows.items()
            if name
        ),
        worst=tuple(_point(result, i) for i in a.worst[:WORST]),
        seams=_seams(a.seams),
        checks=check_lines(a.checks),
        read_back=_file(result),
        prediction=None if result.prediction is None else _prediction(result, result.prediction),
        conflicts=tuple(
            ConflictLine(points.describe(c.kept), points.describe(c.dropped), c.difference, c.text) for c in a.conflicts
        ),
        patches=tuple(PatchLine(p.name, p.degree, (p.control.shape[0], p.control.shape[1])) for p in surface.patches),
        storage=StorageLine(
            surface.control_points,
            storage.tolerance if storage else None,
            storage.tin_points if storage else None,
            storage.grid_points if storage else None,
        ),
        settings=asdict(settings),
        fit={key: value for key, value in surface.diagnostics.items() if isinstance(value, bool | int | float | str)},
        pictures={what: picture_name(what, result.name) for what in shown},
        plan=plan_sheet(result),
        excluded=()
        if result.excluded is None
        else tuple(_excluded(result.excluded, i) for i in range(len(result.excluded))),
        edits=result.edits,
        change=None if result.change is None else change_report(result.change),
        dips=_dips(result),
        stale=result.stale,
    )


def _dips(result: HorizonResult) -> tuple[DipLine, ...]:
    """Return the dips that were measured on the horizon, in the order of their files."""
    measured = result.site.orientations
    if measured is None:
        return ()
    return tuple(
        DipLine(
            float(measured.xyz[one.index, 0]),
            float(measured.xyz[one.index, 1]),
            float(measured.xyz[one.index, 2]),
            one.azimuth,
            one.dip,
            one.surface_azimuth,
            one.surface_dip,
            one.angle,
            str(measured.file[one.index]),
            int(measured.row[one.index]),
        )
        for one in result.dips
    )


def change_report(found: Comparison) -> ChangeReport:
    """Return what is reported of how a horizon moved."""
    change, test = found.change, found.test
    return ChangeReport(
        epsilon=change.epsilon,
        mean=_finite(change.mean),
        rms=_finite(change.rms),
        largest=_finite(change.largest),
        x=_finite(change.place[0]),
        y=_finite(change.place[1]),
        area=change.area,
        share=_finite(change.share),
        areas=tuple(MovedLine(**asdict(one)) for one in change.areas),
        contacts=tuple(
            ContactLine(
                one.group, one.kind, one.x, one.y, one.z, _finite(one.predicted), _finite(one.low), _finite(one.high),
                _finite(one.residual), one.inside,
            )
            for one in test.contacts
        ),
        judged=len(test.judged),
        inside=_finite(test.share),
        residual_rms=_finite(test.rms),
        too_narrow=test.too_narrow,
        text=change.text,
        verdict=test.text,
    )  # fmt: skip


def _shown(what: str, result: HorizonResult, approximated: NDArray[np.float64]) -> bool:
    """Whether a picture has something to show: residuals where not every point is interpolated."""
    if what == "residuals":
        return bool(np.abs(approximated).max(initial=0.0) >= NOISE)
    if what == "change":
        return result.change is not None
    if what == "dips":
        return bool(result.dips)
    return what != "uncertainty" or _has_uncertainty(result.prediction)


def _has_uncertainty(prediction: PredictionResult | None) -> bool:
    return prediction is not None and prediction.uncertainty is not None


def _part(d: NDArray[np.float64], tolerance: float) -> PartLine:
    """Return the figures of some absolute residuals."""
    if not len(d):
        return PartLine(0, None, None, None)
    return PartLine(len(d), sigma_of(d), float(d.max()), float((d <= tolerance).mean()))


def _point(result: HorizonResult, i: int) -> PointLine:
    points, a = result.surface.points, result.accuracy
    x, y, z = (float(value) for value in points.xyz[i])
    source = str(points.hole[i] or points.section[i])
    residual = float(a.residuals[i])
    return PointLine(
        str(points.file[i]), int(points.row[i]), str(points.kind[i]), source, x, y, z, str(a.patch[i]), residual
    )


def _excluded(points: PointSet, i: int) -> PointLine:
    x, y, z = (float(value) for value in points.xyz[i])
    source = str(points.hole[i] or points.section[i])
    return PointLine(str(points.file[i]), int(points.row[i]), str(points.kind[i]), source, x, y, z, "", None)


def _seams(seams: Sequence[Seam]) -> tuple[SeamLine, ...]:
    return tuple(SeamLine(s.first, s.second, float(s.gap), float(s.angle)) for s in seams)


def check_lines(checks: Sequence[Check]) -> tuple[CheckLine, ...]:
    """Return checks as a report lists them."""
    return tuple(
        CheckLine(
            c.name,
            None if c.passed is None else bool(c.passed),
            _finite(c.value),
            _finite(c.limit),
            c.unit,
            c.text,
            tuple((float(x), float(y), float(z)) for x, y, z in c.places),
        )
        for c in checks
    )


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None


def _file(result: HorizonResult) -> FileCheck | None:
    back = result.read_back
    if back is None:
        return None
    return FileCheck(
        back.file, back.sha256, result.step_bytes, back.faces, back.brep_valid, back.self_intersects, back.sigma,
        back.max_abs, _finite(back.core_max_abs), back.free_edges, back.outline_edges, back.edge_tolerance,
        check_lines(back.checks), _seams(back.seams),
    )  # fmt: skip


def _prediction(result: HorizonResult, found: PredictionResult) -> PredictionReport:
    field = found.uncertainty
    return PredictionReport(
        left_out=tuple(_left_out(scheme) for scheme in found.left_out),
        factor=_finite(field.factor) if field else None,
        sd_mean=_finite(field.mean) if field else None,
        sd_max=_finite(field.max) if field else None,
        suggestions=tuple(
            SuggestionLine(s.x, s.y, _finite(s.z), s.sd, s.mean_after, s.max_after) for s in found.suggestions
        ),
        outliers=tuple(OutlierLine(_point(result, o.index), o.error, o.sd, o.ratio) for o in found.outliers),
        notes=found.notes,
    )


def _left_out(scheme: LeftOut) -> LeftOutLine:
    return LeftOutLine(
        scheme.scheme, scheme.groups, int(np.isfinite(scheme.error).sum()), scheme.rms, scheme.mean_abs, scheme.bias,
        scheme.max_abs, _finite(scheme.inside), _finite(scheme.inside_raw),
        tuple((name, _finite(rms)) for name, rms in scheme.references.items()),
    )  # fmt: skip


def _order(order: Order) -> OrderLine:
    found = order.check()
    return OrderLine(
        order.upper, order.lower, found.passed, _finite(order.min), _finite(order.mean), order.crossed_area,
        order.crossed_volume, order.thinnest if order.crossings else None, _finite(order.volume),
        _finite(order.present), _finite(order.at_least), _finite(order.at_most), order.without, order.doubtful,
        found.text,
    )  # fmt: skip


def _cut(cut: FaultCut) -> FaultCutLine:
    rows = np.column_stack([cut.distance, cut.trace, cut.throw]).tolist()
    places = [
        CutPlace(distance, x, y, z, throw, _finite(heave))
        for (distance, x, y, z, throw), heave in zip(rows, cut.heave.tolist(), strict=True)
    ]
    throws = (float(cut.throw.min()), float(cut.throw.mean()), float(cut.throw.max()))
    length = float(cut.distance[-1])
    return FaultCutLine(cut.fault, cut.horizon, cut.up, cut.down, length, *throws, cut.text, tuple(places))


def inputs_of(site: Site) -> tuple[InputFile, ...]:
    """Return the files of a site with their hashes, and how many of their rows were used."""
    counts: dict[str, list[TableCount]] = {}
    for count in site.counts:
        counts.setdefault(count.file, []).append(count)

    def rows(file: str, what: str) -> int | None:
        # A drawing that holds adits and their contacts is read, and its rows are counted, once for each.
        return sum(getattr(one, what) for one in counts[file]) if file in counts else None

    return tuple(
        InputFile(file, site.inputs.get(file, ""), *(rows(file, what) for what in ("read", "used", "listed")))
        for file in dict.fromkeys([*site.inputs, *counts])
    )


@lru_cache(maxsize=1)
def versions() -> Mapping[str, str]:
    """Return the versions of the programs behind a result."""
    import platform

    found = [("geofit", geofit.__version__), ("Python", platform.python_version())]
    found += [(name, version(name)) for name in _PROGRAMS]
    try:
        # The wheel's version is OpenCASCADE's own, with the packager's digits behind.
        found.append(("OpenCASCADE", ".".join(version("cadquery-ocp").split(".")[:3])))
    except PackageNotFoundError:
        found.append(("OpenCASCADE", "not installed"))
    return dict(found)
