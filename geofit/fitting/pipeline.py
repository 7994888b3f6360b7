"""fit_horizon: the paper's steps, in order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.given import arguments_checked
from geofit.data.legible import legible
from geofit.data.points import PointSet
from geofit.data.progress import Progress
from geofit.data.settings import FitSettings
from geofit.data.site import Orientations
from geofit.data.threads import one_thread
from geofit.fitting.adjust import adjust_locally
from geofit.fitting.conflicts import note_lost_places, resolve_conflicts
from geofit.fitting.exactness import exact_or_not
from geofit.fitting.horizon_fit import HorizonFit, fit_of
from geofit.fitting.model import Problem
from geofit.fitting.parametrize import parametrize
from geofit.fitting.partition import partition
from geofit.fitting.request import require
from geofit.fitting.slopes import slopes_of
from geofit.fitting.solve import solve
from geofit.fitting.sources import with_noise_of_sources
from geofit.fitting.stages import Stages

__all__ = ["fit_horizon", "posed"]

Floats = NDArray[np.float64]


@arguments_checked
def fit_horizon(
    points: PointSet,
    settings: FitSettings | None = None,
    boundary: ArrayLike | None = None,
    progress: Progress | None = None,
    *,
    name: str = "horizon",
    orientations: Orientations | None = None,
) -> HorizonFit:
    """Fit one horizon: interpolate its dense core, approximate its periphery, check the result.

    Parameters
    ----------
    points : PointSet
        All points of the horizon; coordinates in metres.
    settings : FitSettings, optional
        Tolerances and choices.
    boundary : (k, 2) array_like, optional
        Corners of the study area in map coordinates. Without it the surface covers the points' rectangle: along the
        map's axes, the sections, or a tilted strip of points.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops the fit.
    name : str
        Name of the horizon.
    orientations : Orientations, optional
        Dips measured at the site. Those that name the horizon are data of the fit where ``settings.dips`` is "fit".

    Returns
    -------
    HorizonFit
        Patches, partition and accuracy. ``surface.accuracy.passed`` shows whether sigma < epsilon.

    Raises
    ------
    ArgumentError
        If ``points`` or ``settings`` are of another type.
    PointsError
        If fewer than three points are given.
    FitError
        If the points cannot be fitted in the way that was asked for.
    Cancelled
        If ``progress`` returned False.

    Notes
    -----
    Li, Miao, Liu, Wang (2011), sec. 3.2 and 3.3. Stitching and export are separate: ``fit.to_cadquery()``,
    ``fit.write_step(path)``.
    """
    settings = FitSettings() if settings is None else settings
    corners = require(points, boundary)
    stage = Stages(progress)
    # The banded systems are small: more threads cost more than they give, and change the last digits.
    with one_thread():
        problem, sketched = with_noise_of_sources(posed(points, settings, corners, stage, legible(name), orientations))
        model = solve(problem, stage, sketched)
        stage("check", 0.8)
        surface = fit_of(model)
        stage("adjust", 0.9)
        surface = exact_or_not(adjust_locally(model, surface))
        stage("done", 1.0)
    return surface.with_(diagnostics={**surface.diagnostics, "seconds": dict(stage.seconds)})


def posed(
    points: PointSet,
    settings: FitSettings,
    corners: Floats | None,
    stage: Stages,
    name: str,
    orientations: Orientations | None = None,
) -> Problem:
    """Return what there is to solve: the points parametrized, without conflicts, and parted into core and periphery."""
    stage("conflicts", 0.0)
    parametrization = parametrize(points, settings, corners)
    places, distance = parametrization.places, settings.coincidence_distance
    kept, conflicts = resolve_conflicts(points, places, parametrization.heights, distance)
    lost = note_lost_places(conflicts, places, distance)
    stage("partition", 0.1)
    split = partition(parametrization, settings, kept)
    stage("fit", 0.2)
    slopes, notes = slopes_of(orientations, name, parametrization, settings)
    parametrization = replace(parametrization, notes=(*parametrization.notes, *lost, *notes))
    return Problem(points, settings, parametrization, split, kept, conflicts, name, slopes=slopes)
