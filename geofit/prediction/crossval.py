"""Cross-validation: holes, sections and blocks left out, beside what other methods say on the same folds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.guard import guarded
from geofit.data.messages import Message, message
from geofit.data.prediction import LeftOut, Scheme
from geofit.fitting.calibration import Calibration, calibrate, gathered, share_inside, variance_of
from geofit.fitting.deletion import LinearFit, Prediction
from geofit.fitting.model import Model
from geofit.fitting.posterior import Posterior
from geofit.fitting.sections import crossing_lines
from geofit.prediction.folds import beyond_hull, block_labels, groups_of, hole_labels
from geofit.prediction.kriging import krige_left_out
from geofit.prediction.small_sets import Refits
from geofit.prediction.thinplate import thin_plate_left_out

__all__ = ["BLOCK", "Fold", "about_the_hull", "calibrated", "cross_validation_folds", "left_out", "one_by_one"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Width of the blocks, in units of the spacing of the sparse points; and of those that only calibrate.
BLOCK, SMALL_BLOCK = 3.0, 1.5


@dataclass(frozen=True, eq=False)
class Fold:
    """One scheme: the (n,) label of each active point, the groups, and what the fit predicts without each."""

    scheme: Scheme
    label: NDArray[np.str_]
    groups: list[Ints]
    predicted: Prediction


def cross_validation_folds(model: Model, fit: LinearFit | Refits) -> list[Fold]:
    """Leave out every hole, every section and every block of a height field in turn.

    Where no section is named, and points lie on lines of two directions, those count whose lines the others predict
    worse: along the strike each line has a twin, and says nothing of the ground between the lines that cross it.
    """
    given = fit.posterior
    points = model.problem.points[given.kept]
    section = model.problem.parametrization.section[given.kept]
    lines = [section]
    if not (model.problem.points.section != "").any() and (section != "").any():
        lines.append(crossing_lines(points.xyz[:, :2], section))

    def fold(scheme: Scheme, label: NDArray[np.str_]) -> Fold | None:
        groups = groups_of(label)
        return Fold(scheme, label, groups, fit.without(groups)) if len(groups) >= 2 else None

    def error(one: Fold) -> float:
        rms = _rms(one.predicted.error)
        return rms if np.isfinite(rms) else -1.0

    sections = [one for one in (fold("section", label) for label in lines) if one is not None]
    worse = max(sections, key=error, default=None)
    every = (fold("hole", hole_labels(points)), worse, fold("block", block_labels(given.plane, BLOCK)))
    return [one for one in every if one is not None]


def one_by_one(model: Model, given: Posterior) -> list[Fold]:
    """Leave out point by point, of the field alone: what many points allow, e = r / (1 - h)."""
    held = 1 - given.leverage
    known = held > 1e-9
    safe = np.where(known, held, 1.0)
    error = np.where(known, given.residual / safe, np.nan)
    variance = np.where(known, given.noise**2 * given.leverage / given.weight / safe, np.nan)
    label = hole_labels(model.problem.points[given.kept].with_(hole="", section=""))
    return [Fold("hole", label, groups_of(label), Prediction(error, error, variance))]


def calibrated(fit: LinearFit | Refits, folds: list[Fold], places: Floats, variance: Floats) -> Calibration:
    """Hold the standard deviation to the errors of all schemes (:func:`geofit.fitting.calibration.calibrate`).

    ``places`` (k, 2) lie all over the surface, ``variance`` (k,) is what the fit expects there, m^2.
    """
    given = fit.posterior
    alone = fit.without([np.array([k]) for k in range(len(given.value))])
    small = fit.without(groups_of(block_labels(given.plane, SMALL_BLOCK)))

    def by(scheme: Scheme) -> list[Prediction]:
        return [fold.predicted for fold in folds if fold.scheme == scheme]

    near = gathered(given, [alone, small, *by("section")])
    blocks, holes = gathered(given, by("block")), gathered(given, by("hole"))
    return calibrate(given.plane, near, blocks, holes, places, variance)


def left_out(
    model: Model,
    given: Posterior,
    fold: Fold,
    calibration: Calibration,
    plate: Floats | None,
    report: Callable[[Message], object],
) -> LeftOut:
    """Return the figures of one scheme over all points of the horizon.

    Parameters
    ----------
    model : Model
        The fit.
    given : Posterior
        Its field.
    fold : Fold
        The scheme.
    calibration : Calibration
        Factors of the standard deviation.
    plate : (n, n) array or None
        Inverse of the thin-plate spline (:func:`geofit.prediction.thinplate.thin_plate_inverse`) with which it and
        kriging predict the same folds; None: no other method is compared.
    report : callable
        Called with the reason where another method fails; the figures do without it.
    """
    error = fold.predicted.error
    variance, noise = variance_of(fold.predicted), given.noise_variance
    widened = calibration.at(given.plane) ** 2 * variance + noise
    known = np.isfinite(error)
    others: dict[str, float] = {}
    if plate is not None and known.any():
        z = model.problem.parametrization.values[given.kept]
        methods: dict[str, Callable[[], Floats]] = {
            "thin plate": lambda: thin_plate_left_out(given.plane, z, fold.groups, plate),
            "kriging": lambda: krige_left_out(given.plane, z, fold.groups),
        }
        for method, predict in methods.items():

            def missing(reason: Message, method: str = method) -> None:
                report(
                    message(
                        "prediction.method-not-compared",
                        "{method} was not compared: {reason}",
                        method=method,
                        reason=reason,
                    )
                )

            estimate = guarded(predict, None, missing)
            if estimate is not None:
                others[method] = _rms((z - estimate)[known])
    count = len(model.problem.points)
    label = np.zeros(count, dtype=fold.label.dtype)
    label[given.kept[known]] = fold.label[known]
    return LeftOut(
        scheme=fold.scheme,
        groups=len(np.unique(fold.label[known])),
        group=label,
        error=_over_all(count, given.kept, error),
        sd=_over_all(count, given.kept, np.where(known, np.sqrt(widened), np.nan)),
        rms=_rms(error),
        mean_abs=_mean(np.abs(error)),
        bias=_mean(error),
        max_abs=float(np.abs(error[known]).max()) if known.any() else float("nan"),
        inside=share_inside(error, widened),
        inside_raw=share_inside(error, variance + noise),
        references=others,
    )


def about_the_hull(given: Posterior, fold: Fold) -> Message | None:
    """Say how much of the error comes from points beyond the hull of the others, where every method extrapolates."""
    beyond = beyond_hull(given.plane, fold.groups) & np.isfinite(fold.predicted.error)
    within = ~beyond & np.isfinite(fold.predicted.error)
    if not beyond.any() or not within.any():
        return None
    return message(
        "prediction.left-out-beyond-hull",
        "{beyond} of {total} points left out by {scheme} lie beyond the hull of the others, where every method "
        "extrapolates: error {outer:.3g} m there, {inner:.3g} m within",
        beyond=int(beyond.sum()),
        total=int(beyond.sum() + within.sum()),
        scheme=fold.scheme,
        outer=_rms(fold.predicted.error[beyond]),
        inner=_rms(fold.predicted.error[within]),
    )


def _over_all(count: int, kept: Ints, values: Floats) -> Floats:
    full = np.full(count, np.nan)
    full[kept] = values
    return full


def _rms(error: Floats) -> float:
    known = error[np.isfinite(error)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")


def _mean(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else float("nan")
