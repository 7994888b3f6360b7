"""The control net of a horizon: its core skinned through the sections, its periphery approximated (sec. 3.2, 3.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from geofit.data.errors import ExactnessError
from geofit.data.messages import message
from geofit.fitting.field import FieldChoice
from geofit.fitting.model import Model, Problem
from geofit.fitting.robust import fit_robustly
from geofit.fitting.split import Split
from geofit.fitting.stages import Stages
from geofit.geometry.projection import project

__all__ = ["solve"]

#: Rounds of parameter correction for points between the sections of a folded surface.
CORRECTIONS = 4


def solve(problem: Problem, stage: Stages, sketched: Sequence[FieldChoice] = ()) -> Model:
    """Fit the control net of a horizon.

    A core that was found, not asked for, and that no control net can meet is approximated with the rest. Points between
    the sections of a folded surface are placed on it in turns with the fit.

    Parameters
    ----------
    problem : Problem
        The points, where they stand, and which of them are the core.
    stage : Stages
        Hears of the stages.
    sketched : sequence of FieldChoice
        What is known of these points' field: by :func:`geofit.fitting.sources.with_noise_of_sources`, or by a fit of
        more points.

    Raises
    ------
    ExactnessError
        If a core that was asked for cannot be met.
    """
    settings, parametrization = problem.settings, problem.parametrization
    placed = problem.kept & parametrization.parametrized
    try:
        model = problem.fit(placed, stage, sketched=sketched)
    except ExactnessError as error:
        # A fold has a core even if none is asked for.
        if settings.core not in ("auto", "none"):
            raise
        model = _without_core(problem, error).fit(placed, stage)
    if not parametrization.parametrized.all():
        model = _corrected(model, stage, sketched)
    if settings.robust and not parametrization.parametric:
        stage("robust", 0.7)
        model = fit_robustly(model, stage)
    return model


def _without_core(problem: Problem, error: ExactnessError) -> Problem:
    """Return the problem with all points approximated, and why."""
    reason = message(
        "fitting.core-given-up",
        "{reason}, but all points are approximated: {error}",
        reason=problem.split.reason,
        error=error.message,
    )
    nowhere = np.zeros(len(problem.points), bool)
    return replace(
        problem, split=Split(None, nowhere, reason.with_severity("warning"), lost=problem.settings.core == "auto")
    )


def _corrected(model: Model, stage: Stages, sketched: Sequence[FieldChoice]) -> Model:
    """Project the points between the sections on the surface, and fit again with the parameters found.

    The first of these fits chooses the field by all points; later ones keep it, for they move points but little.
    """
    between, chosen = ~model.problem.parametrization.parametrized, None
    for _ in range(CORRECTIONS):
        problem, parametrization = model.problem, model.problem.parametrization
        foot = project(model.patches(), parametrization.frame.turn_back(parametrization.values[between]))
        plane = parametrization.plane.copy()
        moved = np.abs(plane[between] - np.column_stack([foot.u, foot.v])).max()
        plane[between] = np.column_stack([foot.u, foot.v])
        problem = replace(problem, parametrization=parametrization.with_plane(plane))
        model = problem.fit(problem.kept, stage, chosen, sketched)
        chosen = (model.net.field, model.net.base)
        if moved < 1e-3:
            break
    return model
