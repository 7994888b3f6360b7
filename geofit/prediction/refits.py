"""Sections of a folded surface left out by new fits: it is not a height field, and no linear algebra spares them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.prediction import LeftOut, PredictionResult
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.model import Model
from geofit.fitting.pipeline import fit_horizon
from geofit.prediction.folds import groups_of
from geofit.streaming.executors import HERE, Where

__all__ = ["sections_by_refit"]

#: More sections than these would take too long.
MOST_SECTIONS = 40


@dataclass(frozen=True, eq=False)
class RefitFold:
    """Points of a surface with the group that is left out, and how the others are fitted."""

    points: PointSet
    group: NDArray[np.int64]
    settings: FitSettings
    boundary: NDArray[np.float64] | None
    name: str


def refit_without(fold: RefitFold) -> NDArray[np.float64] | None:
    """Return the distances of a group from the surface of all others; None where these have none."""
    rest = np.setdiff1d(np.arange(len(fold.points)), fold.group)
    try:
        without = fit_horizon(fold.points[rest], fold.settings, fold.boundary, name=fold.name)
    except GeofitError:
        return None
    return without.distance(fold.points.xyz[fold.group])


def sections_by_refit(
    surface: HorizonFit, model: Model, progress: Progress | None, where: Where = HERE
) -> PredictionResult:
    """Leave out each inner section of a parametric surface, and measure its orthogonal distance from the rest's fit.

    The first and the last section are never left out: no surface reaches them without their points. ``where`` is where
    the fits without a section are made.
    """
    points, parametrization = surface.points, model.problem.parametrization
    groups = [group for group in groups_of(parametrization.section) if model.problem.kept[group].any()]
    groups.sort(key=lambda group: float(np.median(parametrization.plane[group, 0])))
    error = np.full(len(points), np.nan)
    label = np.zeros(len(points), dtype=parametrization.section.dtype)
    notes = [
        message(
            "prediction.folded-without-standard-deviation",
            "a folded surface has no standard deviation: only leaving out its sections is possible",
        )
    ]
    inner = groups[1:-1]
    if len(inner) > MOST_SECTIONS:
        notes.append(
            message(
                "prediction.too-many-sections",
                "{count} sections are too many to leave out by new fits",
                count=len(inner),
            )
        )
        inner = []
    failed = 0
    tell(progress, "cross-validation", 0.0)
    tasks = [RefitFold(points, group, surface.settings, model.problem.boundary, surface.name) for group in inner]
    for done, (k, distance) in enumerate(where.run(refit_without, tasks)):
        tell(progress, "cross-validation", (done + 1) / len(inner))
        if distance is None:
            failed += 1
            continue
        error[inner[k]] = distance
        label[inner[k]] = parametrization.section[inner[k]]
    tell(progress, "done", 1.0)
    if failed:
        notes.append(
            message(
                "prediction.sections-indispensable",
                "without {failed} of the sections no surface can be fitted",
                failed=failed,
            ).with_severity("warning")
        )
    known = error[np.isfinite(error)]
    if not len(known):
        return PredictionResult((), None, (), (), tuple(notes))
    notes.append(
        message(
            "prediction.errors-across-sections",
            "errors are distances from the surface through the other sections; the outermost two stay",
        )
    )
    found = LeftOut(
        scheme="section",
        groups=len(np.unique(label[label != ""])),
        group=label,
        error=error,
        sd=np.full(len(points), np.nan),
        rms=float(np.sqrt(np.mean(known**2))),
        mean_abs=float(np.abs(known).mean()),
        bias=float(known.mean()),
        max_abs=float(np.abs(known).max()),
        inside=float("nan"),
        inside_raw=float("nan"),
        references={},
    )
    return PredictionResult((found,), None, (), (), tuple(notes))
