"""fit_horizon: the paper's steps, in order."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.checks.check import CORE_LIMIT
from geofit.data.columns import refuse_far
from geofit.data.errors import ExactnessError, FitError, PointsError
from geofit.data.messages import Message, message, plural_message
from geofit.data.points import PointSet, look_like_degrees
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings
from geofit.data.threads import one_thread
from geofit.fitting.adjust import adjust
from geofit.fitting.conflicts import resolve_conflicts
from geofit.fitting.horizon_fit import HorizonFit, fit_of
from geofit.fitting.model import Model, Problem
from geofit.fitting.parametrize import Parametrization, parametrize
from geofit.fitting.partition import Split, split_all, split_auto, split_none, split_rectangle
from geofit.fitting.robust import fit_robustly
from geofit.geometry.area import fault_of_area
from geofit.geometry.projection import project

__all__ = ["fit_horizon"]

Floats = NDArray[np.float64]

#: Code of the note about a core's point that was let go.
TORN = "fitting.core-point-contradicts-neighbour"
#: Rounds of parameter correction for points between the sections of a folded surface.
CORRECTIONS = 4


@dataclass
class _Clock:
    """Seconds a stage, and the listener."""

    progress: Progress | None
    seconds: dict[str, float] = field(default_factory=dict)
    _stage: str = ""
    _since: float = 0.0

    def stage(self, name: str, fraction: float) -> None:
        now = time.perf_counter()
        if self._stage:
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + now - self._since
        self._stage, self._since = name, now
        tell(self.progress, name, fraction)


def fit_horizon(
    points: PointSet,
    settings: FitSettings | None = None,
    boundary: ArrayLike | None = None,
    progress: Progress | None = None,
    *,
    name: str = "horizon",
) -> HorizonFit:
    """Fit one horizon: interpolate its dense core, approximate its periphery, check the result.

    Parameters
    ----------
    points : PointSet
        All points of the horizon; coordinates in metres.
    settings : FitSettings, optional
        Tolerances and choices.
    boundary : (k, 2) array_like, optional
        Corners of the study area in map coordinates. Without it the surface covers the points' rectangle.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops the fit.
    name : str
        Name of the horizon.

    Returns
    -------
    HorizonFit
        Patches, partition and accuracy. ``surface.accuracy.passed`` shows whether sigma < epsilon.

    Raises
    ------
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
    settings = settings or FitSettings()
    corners = _require(points, boundary)
    # The banded systems are small: more threads cost more than they give, and change the last digits.
    with one_thread():
        return _fit_horizon(points, settings, corners, _Clock(progress), name)


def _fit_horizon(
    points: PointSet, settings: FitSettings, corners: Floats | None, clock: _Clock, name: str
) -> HorizonFit:
    clock.stage("conflicts", 0.0)
    parametrization = parametrize(points, settings, corners)
    place = parametrization.values if parametrization.parametric else parametrization.plane
    height = parametrization.values[:, 2] if parametrization.parametric else parametrization.values
    kept, conflicts = resolve_conflicts(points, place, height, settings.coincidence_distance)

    clock.stage("partition", 0.1)
    split = _partition(parametrization, settings, kept)
    problem = Problem(points, settings, corners, parametrization, split, kept, conflicts, name)

    clock.stage("fit", 0.2)
    try:
        model = problem.fit(kept & parametrization.parametrized, clock.stage)
    except ExactnessError as error:
        if settings.core != "auto":
            raise
        inside = np.zeros(len(points), bool)
        reason = message(
            "fit.points-approximated",
            "{reason}, but all points are approximated: {error}",
            reason=split.reason,
            error=error.message,
        )
        model = replace(problem, split=Split(None, inside, reason.with_severity("warning"), lost=True)).fit(
            kept & parametrization.parametrized, clock.stage
        )
    if not parametrization.parametrized.all():
        model = _corrected(model, clock)
    if settings.robust and not parametrization.parametric:
        clock.stage("robust", 0.7)
        model = fit_robustly(model, clock.stage)

    clock.stage("check", 0.8)
    surface = fit_of(model)

    clock.stage("adjust", 0.9)
    surface = _adjusted(model, surface)
    surface = _exact_or_not(surface)
    clock.stage("done", 1.0)
    return surface.with_(diagnostics={**surface.diagnostics, "seconds": dict(clock.seconds)})


def _corrected(model: Model, clock: _Clock) -> Model:
    """Project the points between the sections on the surface, and fit again with the parameters found."""
    between = ~model.problem.parametrization.parametrized
    for _ in range(CORRECTIONS):
        problem, parametrization = model.problem, model.problem.parametrization
        foot = project(model.patches(), parametrization.frame.turn_back(parametrization.values[between]))
        plane = parametrization.plane.copy()
        moved = np.abs(plane[between] - np.column_stack([foot.u, foot.v])).max()
        plane[between] = np.column_stack([foot.u, foot.v])
        model = replace(problem, parametrization=parametrization.with_plane(plane)).fit(problem.kept, clock.stage)
        if moved < 1e-3:
            break
    return model


def _adjusted(model: Model, surface: HorizonFit) -> HorizonFit:
    """Adjust locally until sigma is below epsilon or no step helps, and say which."""
    given = model.problem
    for step in range(given.settings.max_iterations + 1):
        accuracy = surface.accuracy
        assert accuracy is not None
        if accuracy.sigma < accuracy.epsilon:
            if step:
                surface = _with_note(
                    surface,
                    message(
                        "fit.local-adjustments-until-sigma",
                        "local adjustments until sigma came below epsilon: {step}",
                        step=step,
                    ),
                )
            break
        better = adjust(model.net, given.parametrization, given.kept & ~surface.core, accuracy.residuals)
        tried = None if better is None or step == given.settings.max_iterations else model.with_net(better)
        candidate = None if tried is None else fit_of(tried)
        if candidate is None or candidate.accuracy is None or candidate.accuracy.sigma > 0.99 * accuracy.sigma:
            words = message(
                "fit.sigma-stays-above-epsilon",
                "sigma stays above epsilon: no further local adjustment lowers it (made: {step})",
                step=step,
            )
            surface = _with_note(surface, words.with_severity("warning"))
            break
        assert tried is not None
        model, surface = tried, candidate
    return surface


def _exact_or_not(surface: HorizonFit) -> HorizonFit:
    """Call those points exact that the surface meets.

    It may miss some between the sections of a fold, and one of two that contradict each other.
    """
    model, accuracy = surface.model, surface.accuracy
    assert model is not None
    assert accuracy is not None
    missed = surface.core & (np.abs(accuracy.residuals) > CORE_LIMIT)
    torn = sum(note.code == TORN for note in accuracy.notes)
    if not missed.any() or not (model.problem.parametrization.parametric or missed.sum() <= torn):
        return surface
    split = model.problem.split
    reason = message(
        "fit.approximated-points",
        "{reason}; points that it does not meet, by up to {worst:.3g} m: {count}, which count as approximated",
        reason=split.reason,
        count=int(missed.sum()),
        worst=float(np.abs(accuracy.residuals[missed]).max()),
    )
    known = replace(model.problem, split=Split(split.core, split.inside & ~missed, reason))
    found = fit_of(replace(model, problem=known))
    assert found.accuracy is not None
    noted_before = tuple(note for note in accuracy.notes if note not in found.accuracy.notes)
    return found.with_(accuracy=replace(found.accuracy, notes=(*found.accuracy.notes, *noted_before)))


def _with_note(surface: HorizonFit, note: Message) -> HorizonFit:
    assert surface.accuracy is not None
    return surface.with_(accuracy=replace(surface.accuracy, notes=(*surface.accuracy.notes, note)))


def _require(points: PointSet, boundary: ArrayLike | None) -> Floats | None:
    if len(points) < 3:
        given = plural_message("fit.given-points", "{count} point given", "{count} points given", count=len(points))
        text = message(
            "fit.least-needed-lay-surface",
            "{given}; at least 3 are needed to fit a surface. Check the horizon's name and the filters of the import.",
            given=given,
        )
        raise PointsError(text)
    if all(np.ptp(axis) == 0 for axis in points.xyz.T):
        raise PointsError(
            message(
                "fit.points-stand-place-least",
                "All {count} points are at one location; at least 3 locations are needed.",
                count=len(points),
            )
        )
    refuse_far(points.xyz)
    if look_like_degrees(points.xyz):
        raise PointsError(
            message(
                "fit.degrees",
                "The points look like longitude and latitude in degrees (the first: {x:.6g}, {y:.6g}); easting and "
                "northing in metres are needed. Project them to the grid of the site (geofit fit --crs EPSG:..., or "
                "crs in the site file).",
                x=points.xyz[0, 0],
                y=points.xyz[0, 1],
            )
        )
    if boundary is None:
        return None
    try:
        corners = np.asarray(boundary, float)
    except (TypeError, ValueError, OverflowError):
        raise PointsError(
            message(
                "fit.no-corners",
                "The boundary is not a list of corners; at least three pairs of easting and northing are needed.",
            )
        ) from None
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3 or not np.isfinite(corners).all():
        text = message(
            "fit.boundary-shape-least-three",
            "The boundary has shape {shape}; at least three finite (easting, northing) corners are needed.",
            shape=corners.shape,
        )
        raise PointsError(text)
    refuse_far(corners)
    fault = fault_of_area(corners)
    if fault is not None:
        raise PointsError(
            message(
                "fit.study-area", "{fault}. List the corners in order around the study area, each once.", fault=fault
            )
        )
    low, high = corners.min(axis=0), corners.max(axis=0)
    off = np.maximum(low - points.xyz[:, :2], points.xyz[:, :2] - high).max(axis=1).min()
    if off > max(np.hypot(*(high - low)), np.hypot(*np.ptp(points.xyz[:, :2], axis=0))):
        text = message(
            "fit.points-off-area",
            "All points lie off the study area, the nearest by {off:.6g} m. Check the coordinates of both, and the "
            "order of easting and northing.",
            off=float(off),
        )
        raise PointsError(text)
    return corners


def _partition(parametrization: Parametrization, settings: FitSettings, kept: NDArray[np.bool_]) -> Split:
    """Split the points that are active; one that were dropped is in no core."""
    plane = parametrization.plane[kept]
    if parametrization.parametric:
        found = split_all(
            plane,
            parametrization.area,
            message("fit.section-curves-span-whole", "the section curves span the whole surface"),
        )
    elif settings.core == "all":
        found = split_all(
            plane,
            parametrization.area,
            message("fit.core-every-point-interpolated", "core='all': every point is interpolated"),
        )
    elif settings.core == "none":
        found = split_none(plane, message("fit.core-none-every-point", "core='none': every point is approximated"))
    elif settings.core == "auto":
        found = split_auto(plane, parametrization.area, parametrization.section[kept] != "")
    elif parametrization.frame.kind != "map":
        text = message(
            "fit.core-polygon-map-coordinates",
            "core is a polygon of map coordinates, but the surface is fitted in the frame '{frame}'. Choose "
            "core='auto', 'all' or 'none', or frame='map'.",
            frame=parametrization.frame.kind,
        )
        raise FitError(text)
    else:
        corners = parametrization.frame.plan(np.array(settings.core))
        low = np.maximum(corners.min(axis=0), (parametrization.area[0], parametrization.area[2]))
        high = np.minimum(corners.max(axis=0), (parametrization.area[1], parametrization.area[3]))
        if (high <= low).any():
            raise FitError(
                message(
                    "fit.core-polygon-lies-outside",
                    "The core's polygon lies outside the study area. Check its coordinates and their order.",
                )
            )
        rectangle = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
        found = split_rectangle(
            plane, rectangle, parametrization.area, message("fit.core-polygon-drawn", "the core's polygon as drawn")
        )
    inside = np.zeros(len(kept), bool)
    inside[kept] = found.inside
    return Split(found.core, inside, found.reason)
