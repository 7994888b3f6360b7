"""Fit a cloud of points that need not fit into the memory: passes over its blocks, each reduced to sums.

The steps are those of :func:`geofit.fit_horizon` for a cloud: conflicts are resolved, the frame chosen, and the
field fitted by the sums of its cells, all without a copy of the points. The surface is the same to rounding.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import LARGEST
from geofit.data.errors import FitError, PointsError
from geofit.data.files import folder_for
from geofit.data.given import arguments_checked
from geofit.data.long_arrays import LongArray, Rows, blocks, covariance, everywhere, without
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings
from geofit.data.threads import one_thread
from geofit.fitting.active_points import Data
from geofit.fitting.assemble import patches_of
from geofit.fitting.caps import cap_for
from geofit.fitting.field import FieldChoice, plane_trend
from geofit.fitting.parametrize import STEEP, direction_of, ends_at, plan_box
from geofit.fitting.request import study_area_of
from geofit.fitting.resolution import choose_field
from geofit.geometry.frame import Frame, map_frame, plane_axes
from geofit.streaming.coincident import coincident
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["CloudFit", "fit_cloud"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class CloudFit:
    """A surface fitted to a cloud; its residuals are those of :func:`geofit.streaming.residuals.measure`.

    Parameters
    ----------
    surface : PatchSurface
        The surface.
    settings : FitSettings
        Settings of the fit.
    n : int
        Number of points.
    coincident : (k,) array of int
        Points that were dropped to another one at the same place.
    field : Field
        Covariance and noise that the likelihood found.
    seconds : mapping
        Seconds of each stage.
    """

    surface: PatchSurface
    settings: FitSettings
    n: int
    coincident: Ints
    field: FieldChoice
    seconds: Mapping[str, float]

    def __repr__(self) -> str:
        return f"<CloudFit {self.surface.name}: {self.n} points, noise {self.field.noise:.3g} m>"


@arguments_checked
def fit_cloud(
    xyz: ArrayLike | LongArray,
    settings: FitSettings | None = None,
    boundary: ArrayLike | None = None,
    progress: Progress | None = None,
    *,
    name: str = "cloud",
    folder: Path | None = None,
) -> CloudFit:
    """Fit the surface of a cloud of points without holding a copy of them.

    Parameters
    ----------
    xyz : (n, 3) array_like or LongArray
        Easting, northing, elevation in metres; the points are approximated, none is met exactly.
    settings : FitSettings, optional
        Tolerances and choices; ``core`` and ``robust`` do not apply.
    boundary : (k, 2) array_like, optional
        Corners of the study area in map coordinates.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops the fit.
    name : str
        Name of the surface.
    folder : Path, optional
        Folder for temporary files, 24 bytes a point, created if missing; the system's own if not given.

    Returns
    -------
    CloudFit
        The surface, and the noise that the likelihood found.

    Raises
    ------
    PointsError
        If there are fewer than 16 points, or one is not finite.
    FitError
        If the cloud is steep and a frame over the map is asked for, or the system cannot be solved.
    Cancelled
        If ``progress`` returned False.

    Notes
    -----
    Of fewer points than a cloud has (200,000) :func:`geofit.fit_horizon` interpolates the dense core and brings
    single points within the tolerance; above, both give the same surface. Source: the regional field of
    :mod:`geofit.fitting.field`, by the sums of :mod:`geofit.splines.sums`.
    """
    settings = settings or FitSettings()
    rows: Rows = xyz if isinstance(xyz, LongArray) else np.asarray(xyz, np.float64)
    corners, scratch = study_area_of(boundary), None if folder is None else folder_for(folder)
    with one_thread(), tempfile.TemporaryDirectory(dir=scratch, prefix="cloud-") as temporary:
        return _fit_cloud(rows, settings, corners, progress, name, Path(temporary))


def _fit_cloud(
    xyz: Rows, settings: FitSettings, boundary: Floats | None, progress: Progress | None, name: str, folder: Path
) -> CloudFit:
    clock = _Clock(progress)
    low, high = _bounds(clock.listened(xyz, "bounds", 0.0, 0.1))
    frame = _frame(clock.listened(xyz, "frame", 0.1, 0.15), low, high, settings, boundary)
    local = LongArray((len(xyz), 3), lambda start, stop: frame.to_local(xyz[start:stop]))
    places = LongArray((len(xyz), 2), lambda start, stop: local[start:stop][:, :2])
    gone = coincident(clock.listened(places, "conflicts", 0.15, 0.35), settings.coincidence_distance, folder)
    kept = without(local, gone)
    data = _gather(clock.listened(kept, "field", 0.35, 0.95), frame, boundary)
    most = cap_for(settings, len(kept))
    field, space = choose_field(data, settings, most)
    start = data.smoothed(space, field)
    coefficients = start.coefficients + data.over_trend(space)
    patches = patches_of(space, coefficients, None, frame, data.unit)
    outline = boundary if boundary is not None and ends_at(boundary, frame.kind, xyz) else None
    surface = PatchSurface(patches, frame.origin, name, outline, frame.kind)
    clock.stop()
    tell(progress, "done", 1.0)
    return CloudFit(surface, settings, len(xyz), gone, field, clock.seconds)


class _Clock:
    """Seconds a stage, told to the listener while blocks are read."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.seconds: dict[str, float] = {}
        self._stage, self._since = "", time.perf_counter()

    def listened(self, rows: Rows, stage: str, low: float, high: float) -> LongArray:
        """Return rows that tell the listener how far a pass over them has come; here a stage begins."""
        self.stop()
        self._stage = stage

        def read(start: int, stop: int) -> Floats:
            tell(self.progress, stage, low + (high - low) * start / len(rows))
            return np.asarray(rows[start:stop])

        return LongArray(rows.shape, read)

    def stop(self) -> None:
        """End a stage."""
        now = time.perf_counter()
        if self._stage:
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + now - self._since
        self._since = now


def _bounds(xyz: Rows) -> tuple[Floats, Floats]:
    if xyz.ndim != 2 or xyz.shape[1] != 3 or len(xyz) < 16:
        raise PointsError(
            message(
                "streaming.cloud-wrong-shape",
                "The cloud has shape {shape}; at least 16 points, (n, 3), are needed.",
                shape=xyz.shape,
            )
        )
    low, high, start = np.full(3, np.inf), np.full(3, -np.inf), 0
    for (part,) in blocks(xyz):
        bad = np.flatnonzero(~np.isfinite(part).all(axis=1))
        if len(bad):
            raise PointsError(
                message(
                    "streaming.point-not-finite",
                    "The point at index {index} is not finite: {place}. Remove or complete it before fitting.",
                    index=start + int(bad[0]),
                    place=part[bad[0]].tolist(),
                )
            )
        low, high = np.minimum(low, part.min(axis=0)), np.maximum(high, part.max(axis=0))
        start += len(part)
    if max(np.abs(low).max(), np.abs(high).max()) > LARGEST or (low == high).all():
        raise PointsError(
            message(
                "streaming.cloud-extent-unusable",
                "The coordinates run from {low} to {high}; they must differ, and be at most {largest:.0e} m. Check the "
                "unit and the columns.",
                low=low.tolist(),
                high=high.tolist(),
                largest=LARGEST,
            )
        )
    return low, high


def _frame(xyz: Rows, low: Floats, high: Floats, settings: FitSettings, boundary: Floats | None) -> Frame:
    """Choose the frame as :func:`geofit.fitting.parametrize.parametrize` does where no sections are named."""
    ends = PointSet(np.array([low, high]))
    kind = settings.frame
    axes = plane_axes(covariance(xyz)[1]) if kind in ("auto", "best-plane") else np.eye(3)
    dip = math.degrees(math.acos(min(max(float(axes[2, 2]), -1.0), 1.0)))
    if kind == "sections":
        raise FitError(
            message(
                "streaming.cloud-without-sections",
                "frame='sections' needs named sections, which a cloud does not have. Choose 'map' or 'best-plane'.",
            )
        )
    if kind == "best-plane" or (kind == "auto" and dip >= STEEP):
        return Frame(map_frame(ends).origin, axes, "best-plane")
    return map_frame(ends, direction_of(np.empty(0, np.str_), xyz, boundary))


def _gather(local: LongArray, frame: Frame, boundary: Floats | None) -> Data:
    """Return the points in units about their trend, as :func:`geofit.fitting.active_points.gather_points` does."""
    extents = [np.min([part.min(axis=0) for (part,) in blocks(local)], axis=0)[:2]]
    extents.append(np.max([part.max(axis=0) for (part,) in blocks(local)], axis=0)[:2])
    if boundary is not None and frame.kind == "map":
        extents.extend(frame.plan(boundary))
    area = plan_box(np.array(extents))
    n = len(local)
    unit = math.sqrt((area[1] - area[0]) * (area[3] - area[2]) / n)
    plane = LongArray((n, 2), lambda start, stop: local[start:stop][:, :2] / unit)
    heights = LongArray((n,), lambda start, stop: local[start:stop][:, 2])
    trend = plane_trend(plane, heights, everywhere(1.0, n))

    def read(start: int, stop: int) -> Floats:
        part = local[start:stop]
        return np.asarray(part[:, 2] - (trend[0] + (part[:, :2] / unit) @ trend[1:]))

    value = LongArray((n,), read)
    scaled = (area[0] / unit, area[1] / unit, area[2] / unit, area[3] / unit)
    unknown = everywhere(math.nan, n)
    return Data(plane, value, unknown, everywhere(1.0, n), scaled, unit, trend)
