"""fit_horizon: the paper's steps, in order."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from geofit.accuracy import Conflict
from geofit.adjust import adjust
from geofit.assemble import patches_of
from geofit.chart import Chart, choose_chart
from geofit.check import check
from geofit.conflicts import settle
from geofit.distance import project
from geofit.errors import FitError, PointsError
from geofit.net import Net, approximate_all, fit_with_core
from geofit.partition import Split, split_all, split_auto, split_none, split_rectangle
from geofit.points import PointSet
from geofit.progress import Progress, tell
from geofit.settings import FitSettings
from geofit.surface import HorizonSurface, Partition

__all__ = ["fit_horizon"]

Floats = NDArray[np.float64]

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
) -> HorizonSurface:
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
    HorizonSurface
        Patches, partition and accuracy. ``surface.accuracy.passed`` says whether sigma < epsilon.

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
    Li, Miao, Liu, Wang (2011), sec. 3.2 and 3.3. Stitching and export are separate: ``surface.to_shape()``,
    ``surface.write_step(path)``.
    """
    settings = settings or FitSettings()
    corners = _require(points, boundary)
    # The banded systems are small: more threads cost more than they give, and change the last digits.
    with threadpool_limits(limits=1):
        return _fit_horizon(points, settings, corners, _Clock(progress), name)


def _fit_horizon(
    points: PointSet, settings: FitSettings, corners: Floats | None, clock: _Clock, name: str
) -> HorizonSurface:
    clock.stage("conflicts", 0.0)
    chart = choose_chart(points, settings, corners)
    kept, conflicts = _settle(points, chart, settings)

    clock.stage("partition", 0.1)
    split = _partition(chart, settings, kept, len(points))

    clock.stage("fit", 0.2)
    net = _fit(points, chart, split, kept & chart.placed, settings, clock)
    if not chart.placed.all():
        chart, net = _correct(points, chart, split, kept, settings, clock, net)

    clock.stage("check", 0.8)
    surface = _surface(points, chart, split, kept, settings, net, corners, name)
    surface = _checked(surface, conflicts, chart, net, settings)

    clock.stage("adjust", 0.9)
    for _ in range(settings.max_iterations):
        assert surface.accuracy is not None
        if surface.accuracy.passed:
            break
        better = adjust(net, chart, kept & ~surface.core, surface.accuracy.residuals)
        if better is None:
            break
        net = better
        surface = _surface(points, chart, split, kept, settings, net, corners, name)
        surface = _checked(surface, conflicts, chart, net, settings)
    clock.stage("done", 1.0)
    return surface.with_(fit={**surface.fit, "seconds": dict(clock.seconds)})


def _require(points: PointSet, boundary: ArrayLike | None) -> Floats | None:
    if len(points) < 3:
        raise PointsError(
            f"{len(points)} point{'s' * (len(points) != 1)} given; at least 3 are needed to lay a surface. "
            "Check the horizon's name and the filters of the import."
        )
    if np.ptp(points.xyz[:, :2], axis=0).max() == 0 and np.ptp(points.xyz[:, 2]) == 0:
        raise PointsError(f"All {len(points)} points stand at one place; at least 3 places are needed.")
    if boundary is None:
        return None
    corners = np.asarray(boundary, float)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3 or not np.isfinite(corners).all():
        raise PointsError(
            f"The boundary has shape {corners.shape}; at least three finite (easting, northing) corners are needed."
        )
    return corners


def _settle(
    points: PointSet, chart: Chart, settings: FitSettings
) -> tuple[NDArray[np.bool_], tuple[Conflict, ...]]:
    place = chart.values if chart.parametric else chart.plane
    height = chart.values[:, 2] if chart.parametric else chart.values
    return settle(points, place, height, settings.conflict_distance)


def _partition(chart: Chart, settings: FitSettings, kept: NDArray[np.bool_], n: int) -> Split:
    """Split the points that are honoured; one that gave way is in no core."""
    plane = chart.plane[kept]
    if chart.parametric:
        found = split_all(plane, chart.area, "the section curves span the whole surface")
    elif settings.core == "all":
        found = split_all(plane, chart.area, "core='all': every point is interpolated")
    elif settings.core == "none":
        found = split_none(plane, "core='none': every point is approximated")
    elif settings.core == "auto":
        found = split_auto(plane, chart.area)
    elif chart.frame.kind != "map":
        raise FitError(
            f"core is a polygon of map coordinates, but the surface is fitted in the frame '{chart.frame.kind}'. "
            "Choose core='auto', 'all' or 'none', or frame='map'."
        )
    else:
        corners = chart.frame.plan(np.array(settings.core))
        low = np.maximum(corners.min(axis=0), (chart.area[0], chart.area[2]))
        high = np.minimum(corners.max(axis=0), (chart.area[1], chart.area[3]))
        if (high <= low).any():
            raise FitError("The core's polygon lies outside the study area. Check its coordinates and their order.")
        rectangle = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
        found = split_rectangle(plane, rectangle, chart.area, "the core's polygon as drawn")
    inside = np.zeros(n, bool)
    inside[kept] = found.inside
    return Split(found.core, inside, found.reason)


def _fit(
    points: PointSet, chart: Chart, split: Split, kept: NDArray[np.bool_], settings: FitSettings, clock: _Clock
) -> Net:
    if split.core is None:
        return approximate_all(points, chart, kept, settings, clock.stage)
    return fit_with_core(points, chart, split, kept, settings, clock.stage)


def _correct(
    points: PointSet,
    chart: Chart,
    split: Split,
    kept: NDArray[np.bool_],
    settings: FitSettings,
    clock: _Clock,
    net: Net,
) -> tuple[Chart, Net]:
    """Project the points between the sections on the surface, and fit again with the parameters found."""
    between = ~chart.placed
    for _ in range(CORRECTIONS):
        patches = patches_of(net.space, net.coefficients, None, chart.frame, net.unit, None, True)
        foot = project(patches, chart.frame.turn_back(chart.values[between]))
        plane = chart.plane.copy()
        moved = np.abs(plane[between] - np.column_stack([foot.u, foot.v])).max(initial=0.0)
        plane[between] = np.column_stack([foot.u, foot.v])
        chart = chart.with_plane(plane)
        net = _fit(points, chart, split, kept, settings, clock)
        if moved < 1e-3:
            break
    return chart, net


def _surface(
    points: PointSet,
    chart: Chart,
    split: Split,
    kept: NDArray[np.bool_],
    settings: FitSettings,
    net: Net,
    boundary: Floats | None,
    name: str,
) -> HorizonSurface:
    patches = patches_of(
        net.space, net.coefficients, net.core, chart.frame, net.unit, net.lines, split.core is not None
    )
    outline = boundary if chart.frame.kind == "map" else None
    surface = HorizonSurface(
        patches=patches,
        origin=chart.frame.origin,
        points=points,
        settings=settings,
        name=name,
        outline=outline,
        partition=_described(split, chart, kept),
        core=split.inside & kept,
        fit=_figures(chart, net),
    )
    return surface.with_(fit={**surface.fit, "control_points": surface.control_points})


def _described(split: Split, chart: Chart, kept: NDArray[np.bool_]) -> Partition:
    corners = None
    if split.core is not None and not chart.parametric:
        u0, u1, v0, v1 = split.core
        local = np.array([[u0, v0, 0], [u1, v0, 0], [u1, v1, 0], [u0, v1, 0]])
        xyz = chart.frame.turn_back(local) + chart.frame.origin
        corners = tuple((float(x), float(y)) for x, y in xyz[:, :2])
    inside = int((split.inside & kept).sum())
    return Partition(corners, inside, len(kept) - inside, split.reason)


def _figures(chart: Chart, net: Net) -> dict[str, Any]:
    return {
        "frame": chart.frame.kind,
        "energy": net.field.energy,
        "smoothing": net.field.smoothing,
        "noise": net.field.noise,
        "spacing": net.unit,
        "rounds": net.rounds,
    }


def _checked(
    surface: HorizonSurface,
    conflicts: tuple[Conflict, ...],
    chart: Chart,
    net: Net,
    settings: FitSettings,
) -> HorizonSurface:
    accuracy = check(surface, conflicts, (*chart.notes, *net.notes))
    return replace(surface, accuracy=accuracy)
