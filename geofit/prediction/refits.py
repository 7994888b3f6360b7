"""Sections of a folded surface left out by new fits: the places of all other points change with each of them.

A section left out stands in a gap twice as wide as those of the surface itself. How errors grow with the gap is not
known: the points along the sections, which decide on the covariance, say little of the relief between them. A surface
without creases errs in half the gap by no more than half as much.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings
from geofit.data.threads import one_thread
from geofit.fitting.calibration import LeftOutPoints, uncalibrated
from geofit.fitting.field import FieldChoice
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.model import Model
from geofit.fitting.pipeline import posed
from geofit.fitting.posterior import posterior
from geofit.fitting.solve import solve
from geofit.fitting.stages import Stages
from geofit.prediction.bands import PredictionError
from geofit.prediction.folds import groups_of
from geofit.streaming.executors import Where

__all__ = ["in_half_the_gap", "sections_by_refit"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: More sections than these would take too long.
MOST_SECTIONS = 40


@dataclass(frozen=True, eq=False)
class RefitFold:
    """Points of a surface with the group that is left out, and how the others are fitted.

    ``known`` is the field of all points, ``unit`` what its lengths are measured by, metres.
    """

    points: PointSet
    group: Ints
    settings: FitSettings
    boundary: Floats | None
    name: str
    known: FieldChoice
    unit: float


def refit_without(fold: RefitFold) -> Floats | None:
    """Return what a fit without a group says of it, (2, k): signed distances from the surface, and their variances.

    The covariance of the field stays that of all points, as it does where points of a height field are left out
    (:mod:`geofit.fitting.deletion`); its noise and all else is found anew. None where the others have no surface.
    """
    rest, stage = np.setdiff1d(np.arange(len(fold.points)), fold.group), Stages(None)
    try:
        with one_thread():
            problem = posed(fold.points[rest], fold.settings, fold.boundary, stage, fold.name)
            model = solve(replace(problem, unit=fold.unit), stage, [fold.known])
            foot = model.patch_surface().project(fold.points.xyz[fold.group])
            expected = PredictionError(model, posterior(model), uncalibrated())
            return np.stack([foot.distance, expected.variance(np.column_stack([foot.u, foot.v]) / fold.unit)])
    except GeofitError:
        return None


def sections_by_refit(
    surface: HorizonFit, model: Model, progress: Progress | None, where: Where
) -> tuple[LeftOutPoints, list[Message]]:
    """Leave out each inner section of a folded surface, and measure its distance from the others' surface.

    The first and the last section are never left out: no surface reaches them without their points. ``where`` is where
    the fits without a section are made.
    """
    points, notes = surface.points, []
    inner = _sections(model)[1:-1]
    if len(inner) > MOST_SECTIONS:
        notes.append(
            message(
                "prediction.too-many-sections",
                "{count} sections are too many to leave out by new fits",
                count=len(inner),
            )
        )
        inner = []
    tell(progress, "cross-validation", 0.0)
    tasks = [
        RefitFold(
            points,
            group,
            surface.settings,
            model.problem.parametrization.boundary,
            surface.name,
            model.net.field,
            model.net.unit,
        )
        for group in inner
    ]
    found: list[tuple[Ints, Floats]] = []
    for done, (k, said) in enumerate(where.run(refit_without, tasks)):
        tell(progress, "cross-validation", 0.9 * (done + 1) / len(inner))
        if said is not None:
            found.append((inner[k], said))
    failed = len(inner) - len(found)
    if failed:
        notes.append(
            message(
                "prediction.sections-indispensable",
                "without {failed} of the sections no surface can be fitted",
                failed=failed,
            ).with_severity("warning")
        )
    found.sort(key=lambda one: int(one[0][0]))
    point = np.concatenate([np.empty(0, np.int64), *(group for group, _ in found)])
    error, variance = np.concatenate([np.empty((2, 0)), *(said for _, said in found)], axis=1)
    if found:
        notes.append(
            message(
                "prediction.errors-across-sections",
                "errors are distances from the surface through the other sections; the outermost two are not left out",
            )
        )
    noise = np.full(len(point), model.net.field.noise**2)
    return LeftOutPoints(point, error, variance, noise), notes


def in_half_the_gap(left: LeftOutPoints, error_model: PredictionError) -> LeftOutPoints:
    """Return half the errors of sections left out, with the variances halfway between each section and the next ones.

    What sections left out by :func:`sections_by_refit` say of the surface that was fitted to all of them.
    """
    model = error_model.model
    plane = model.problem.parametrization.plane / model.net.unit
    lines = np.array([np.median(plane[section, 0]) for section in _sections(model)])
    u, v = plane[left.point].T
    own = np.clip(np.abs(u[:, None] - lines).argmin(axis=1), 1, len(lines) - 2)
    sides = [error_model.variance(np.column_stack([(u + lines[own + step]) / 2, v])) for step in (-1, 1)]
    return replace(left, error=left.error / 2, variance=np.mean(sides, axis=0))


def _sections(model: Model) -> list[Ints]:
    """Return the points of each section, from the first section to the last."""
    parametrization = model.problem.parametrization
    groups = [group for group in groups_of(parametrization.section) if model.problem.kept[group].any()]
    return sorted(groups, key=lambda group: float(np.median(parametrization.plane[group, 0])))
