"""examine: the prediction error away from the data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import FIT, arguments_checked, require_kind
from geofit.data.guard import guarded
from geofit.data.messages import Message, message
from geofit.data.prediction import LeftOut, Outlier, PredictionResult, SourceOffset, Suggestion, Uncertainty
from geofit.data.progress import Progress, tell
from geofit.data.threads import one_thread
from geofit.data.verdict import LEAST_INSIDE
from geofit.fitting.calibration import (
    Calibration,
    LeftOutPoints,
    calibrate,
    common_factor,
    share_inside,
    uncalibrated,
)
from geofit.fitting.deletion import LinearFit, linear_fit
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.model import Model
from geofit.fitting.outliers import LIMIT, find_outliers
from geofit.fitting.posterior import Posterior, noise_of_unused, posterior
from geofit.prediction.bands import Grid, PredictionError, grid_over, uncertainty_on
from geofit.prediction.crossval import Fold, about_the_hull, calibrated, cross_validation_folds, left_out, one_by_one
from geofit.prediction.drilling import suggest_holes
from geofit.prediction.offsets import source_offsets
from geofit.prediction.refits import in_half_the_gap, sections_by_refit
from geofit.prediction.small_sets import SMALL, Refits
from geofit.prediction.thinplate import thin_plate_inverse
from geofit.streaming.executors import Where

__all__ = ["MOST", "examine"]

Floats = NDArray[np.float64]

#: More points than these are left out one by one only: the covariance of all of them would not fit.
MOST = 4_000
#: Fits without the outliers found so far, at most.
ROUNDS = 2


@arguments_checked
def examine(
    surface: HorizonFit,
    progress: Progress | None = None,
    *,
    scheduler: str = "local",
    workers: int | None = 1,
    folder: Path | None = None,
) -> PredictionResult:
    """Examine a fit away from its data.

    Parameters
    ----------
    surface : HorizonFit
        A fit; of an imported surface nothing can be said, and the notes report it.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops.
    scheduler, workers : str, int
        Where fits without a fold are made, see :func:`geofit.streaming.executors.run_tasks`; by default here.
        Errors are the same to the last bit, standard deviations to rounding.
    folder : Path, optional
        Where the results of these fits are kept: an examination that was stopped goes on with the other folds.

    Returns
    -------
    PredictionResult
        Errors at holes, sections and blocks left out (no refit: :mod:`geofit.fitting.deletion`; of fewer than
        30 points by true refits: :mod:`geofit.prediction.small_sets`) beside the
        thin-plate spline and kriging on the same folds; standard deviation on a grid, held to those errors; the next
        holes; outliers; systematic offsets between kinds of points. Of a folded surface its inner sections are left
        out, by fits of the others with the covariance of all points; no other method has such a surface, and neither
        outliers nor offsets are looked for.

    Raises
    ------
    ArgumentError
        If ``surface`` is not a fit.
    Cancelled
        If ``progress`` returned False.
    SchedulerError
        If the scheduler is lost.

    Notes
    -----
    Leave-out errors without refits follow from the smoothing matrix: Wahba, Spline Models for Observational Data
    (1990), sec. 4.2. Suggested boreholes are chosen one by one so that each reduces the mean variance most.
    """
    require_kind("surface", surface, HorizonFit, FIT)
    model = surface.model
    if model is None:
        return _nothing(
            message(
                "prediction.nothing-to-leave-out",
                "'{name}' was not fitted here: no point can be left out of it",
                name=surface.name,
            )
        )
    with one_thread():
        notes: list[Message] = []

        def missing(reason: Message) -> None:
            notes.append(
                message("prediction.error-not-found", "the prediction error cannot be found: {reason}", reason=reason)
            )

        look = _examine_folded if model.problem.parametrization.parametric else _examine
        where = Where(scheduler, workers, folder)
        found = guarded(lambda: look(surface, model, progress, where), None, missing)
        return _nothing(notes[0]) if found is None else found


def _examine(surface: HorizonFit, model: Model, progress: Progress | None, where: Where) -> PredictionResult:
    notes: list[Message] = []
    tell(progress, "uncertainty", 0.0)
    given = posterior(model)
    grid = grid_over(surface)
    many = len(given.value) > MOST
    tell(progress, "cross-validation", 0.2)
    nothing: tuple[list[Fold], Calibration, tuple[Outlier, ...]] = ([], uncalibrated(), ())
    folds, calibration, outliers = guarded(
        lambda: _left_out(model, given, grid, progress, notes, where),
        nothing,
        lambda reason: notes.append(
            message(
                "prediction.band-not-calibrated",
                "no point was left out, the band is not calibrated: {reason}",
                reason=reason,
            )
        ),
    )
    if model.net.lines is not None:
        notes.append(
            message(
                "prediction.ruled-core-as-cubic",
                "the core is linear across its sections; its left-out errors are those of a cubic one",
            )
        )
    tell(progress, "other methods", 0.65)
    plate = guarded(
        lambda: None if many else thin_plate_inverse(given.plane),
        None,
        lambda reason: notes.append(
            message("prediction.no-method-compared", "no other method was compared: {reason}", reason=reason)
        ),
    )
    results = []
    for fold in folds:
        results.append(left_out(model, given, fold, calibration, plate, notes.append))
        beyond = about_the_hull(given, fold) if not many else None
        notes += [beyond] if beyond else []
        notes += _not_held(results[-1])
    if results and not any(np.isfinite(one.rms) for one in results):
        # With no misfit, the noise estimate is rounding error, and so would be the posterior standard deviation.
        notes.append(
            message(
                "prediction.no-error-known",
                "none of the {count} points can be predicted from the others, so the prediction error is unknown and "
                "no standard deviation is reported",
                count=len(given.value),
            ).with_severity("warning")
        )
        return PredictionResult(tuple(results), None, (), outliers, tuple(notes))
    tell(progress, "next holes", 0.8)
    suggestions, uncertainty = _between(grid, PredictionError(model, given, calibration), notes)
    offsets = _offsets(model, given, calibration, outliers, notes)
    tell(progress, "done", 1.0)
    return PredictionResult(tuple(results), uncertainty, suggestions, outliers, tuple(notes), offsets)


def _offsets(
    model: Model, given: Posterior, calibration: Calibration, outliers: Sequence[Outlier], notes: list[Message]
) -> tuple[SourceOffset, ...]:
    """Return the systematic offsets between kinds of points, and add a note on each."""
    none: tuple[SourceOffset, ...] = ()
    found = guarded(
        lambda: source_offsets(model, given, calibration, outliers),
        none,
        lambda reason: notes.append(
            message("prediction.sources-not-compared", "the sources were not compared: {reason}", reason=reason)
        ),
    )
    notes += [
        message(
            "prediction.source-off",
            "{offset}; check their datum, velocity or depths: the surface passes between the two kinds",
            offset=one.text,
        ).with_severity("warning")
        for one in found
    ]
    return found


def _examine_folded(surface: HorizonFit, model: Model, progress: Progress | None, where: Where) -> PredictionResult:
    """Examine a folded surface: it is not a height field, so its sections are left out by new fits."""
    tell(progress, "uncertainty", 0.0)
    given, grid = posterior(model), grid_over(surface)
    left, notes = sections_by_refit(surface, model, progress, where)
    plane = model.problem.parametrization.plane / model.net.unit
    nothing = LeftOutPoints(*(np.empty(0, kind) for kind in (int, float, float, float)))
    expected = PredictionError(model, given, uncalibrated())
    calibration = uncalibrated()
    if len(left.point):
        # Widened until it holds the sections left out too, as that of a height field holds the holes.
        near = in_half_the_gap(left, expected)
        calibration = calibrate(plane, near, nothing, left, grid.plane, expected.variance(grid.plane))
    else:
        notes.append(
            message(
                "prediction.fold-not-calibrated",
                "no section was left out: the standard deviation is what the fit expects, and is not calibrated",
            )
        )
    tell(progress, "next holes", 0.95)
    suggestions, uncertainty = _between(grid, PredictionError(model, given, calibration), notes)
    results = (_by_sections(model, left, calibration.at(plane)[left.point]),) if len(left.point) else ()
    for found in results:
        notes += _not_held(found)
    tell(progress, "done", 1.0)
    return PredictionResult(results, uncertainty, suggestions, (), tuple(notes))


def _by_sections(model: Model, left: LeftOutPoints, factor: Floats) -> LeftOut:
    """Return the cross-validation of a folded surface by its sections; no other method has such a surface."""
    section = model.problem.parametrization.section
    error, sd = (np.full(len(section), np.nan) for _ in range(2))
    variance = factor**2 * left.variance + left.noise
    error[left.point], sd[left.point] = left.error, np.sqrt(variance)
    group = np.zeros(len(section), section.dtype)
    group[left.point] = section[left.point]
    size = np.abs(left.error)
    return LeftOut(
        "section", len(np.unique(group[left.point])), group, error, sd, float(np.sqrt(np.mean(size**2))),
        float(size.mean()), float(left.error.mean()), float(size.max()), share_inside(left.error, variance),
        share_inside(left.error, left.variance + left.noise), {},
    )  # fmt: skip


def _between(
    grid: Grid, error_model: PredictionError, notes: list[Message]
) -> tuple[tuple[Suggestion, ...], Uncertainty | None]:
    """Return the next holes and the standard deviation between the points, with notes where there are none."""
    if not len(grid.plane):
        notes.append(
            message(
                "prediction.points-without-area", "the points have no area: there is no standard deviation between them"
            )
        )
        return (), None
    none: tuple[Suggestion, ...] = ()
    suggestions = guarded(
        lambda: suggest_holes(grid, error_model),
        none,
        lambda reason: notes.append(
            message("prediction.no-holes-suggested", "no holes are suggested: {reason}", reason=reason)
        ),
    )
    uncertainty = guarded(
        lambda: uncertainty_on(grid, error_model),
        None,
        lambda reason: notes.append(
            message(
                "prediction.standard-deviation-unknown", "the standard deviation is not known: {reason}", reason=reason
            )
        ),
    )
    return suggestions, uncertainty


def _left_out(
    model: Model, given: Posterior, grid: Grid, progress: Progress | None, notes: list[Message], where: Where
) -> tuple[list[Fold], Calibration, tuple[Outlier, ...]]:
    """Leave the points out, hold the standard deviation to their errors, and name those far from their neighbours."""
    many = len(given.value) > MOST
    if many:
        folds, calibration = one_by_one(model, given), uncalibrated()
        outliers: tuple[Outlier, ...] = ()
        notes.append(
            message(
                "prediction.too-many-points-for-groups",
                "{count} points are too many to leave out in groups: each is left out alone from the regional field, "
                "and no other method is compared",
                count=len(given.value),
            )
        )
    else:
        fit = linear_fit(model, given)
        judged = Refits(model, given, where) if len(given.value) < SMALL else fit
        folds = cross_validation_folds(model, judged)
        tell(progress, "calibration", 0.5)
        calibration = calibrated(
            judged, folds, grid.plane, PredictionError(model, given, uncalibrated()).variance(grid.plane)
        )
        outliers = tuple(
            replace(one, name=model.problem.points.describe(one.index))
            for one in _outliers(model, fit, calibration.at(given.plane))
        )
    return folds, calibration, outliers


def _outliers(model: Model, fit: LinearFit, factor: Floats) -> tuple[Outlier, ...]:
    """List the outliers, judged by a fit without those found so far: a blunder makes the field rough that judges it."""
    found = find_outliers(fit, factor)
    for _ in range(ROUNDS):
        out = np.array([outlier.index for outlier in found], np.int64)
        kept = model.problem.kept.copy()
        kept[out] = False
        if not len(out) or model.problem.split.inside[out].any():
            break
        clean = replace(model.problem, kept=kept).fit(kept, lambda stage, fraction: None)
        given = posterior(clean)
        without = linear_fit(clean, given)
        # Never narrower than the posterior: many points are near their neighbours, which says little of the far ones.
        common = max(common_factor(without, np.ones(len(given.value), bool)), 1.0)
        parametrization = model.problem.parametrization
        plane = parametrization.plane[out] / clean.net.unit
        error = parametrization.values[out] - given.height(plane)
        sd = np.sqrt(common**2 * given.variance(plane) + noise_of_unused(given, clean, out) ** 2)
        again = [Outlier(int(k), float(e), float(s), float(abs(e) / s)) for k, e, s in zip(out, error, sd, strict=True)]
        again = [outlier for outlier in again if outlier.ratio > LIMIT]
        more = find_outliers(without, np.full(len(given.value), common))
        found = tuple(sorted([*again, *more], key=lambda one: -one.ratio))
        if {one.index for one in found} == set(out.tolist()):
            break
    return found


def _not_held(found: LeftOut) -> list[Message]:
    if not np.isfinite(found.inside) or round(found.inside, 2) >= LEAST_INSIDE:
        return []
    return [
        message(
            "prediction.band-too-narrow",
            "only {share:.0%} of the points left out by {scheme} lie inside the 90 % band "
            "({raw:.0%} before calibration)",
            share=found.inside,
            scheme=found.scheme,
            raw=found.inside_raw,
        )
    ]


def _nothing(note: Message) -> PredictionResult:
    return PredictionResult((), None, (), (), (note,))
