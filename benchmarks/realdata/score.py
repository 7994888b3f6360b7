"""Error at points that a fit has not seen, beside scipy's thin plate and linear interpolation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import LinearNDInterpolator, RBFInterpolator

from geofit import FitSettings, GeofitError, PointSet, fit_horizon

from .sets import rectangle

__all__ = ["Errors", "Score", "folds", "left_out_errors", "linear", "one_a_place", "score", "thin_plate"]

FOLDS, SEED = 10, 2011


@dataclass(frozen=True)
class Score:
    """Root mean square and standard deviation of errors, metres."""

    rms: float
    std: float


@dataclass(frozen=True)
class Errors:
    """What the tools miss points by that they have not seen.

    ``ours``, ``plate`` and ``line`` are taken over the same ``common`` points: those where all three are
    defined. ``ours_all`` and ``plate_all`` hold all ``left_out`` points where geofit is defined (``defined``).
    """

    left_out: int
    common: int
    defined: int
    ours: Score
    plate: Score
    line: Score
    ours_all: Score
    plate_all: Score
    failures: tuple[str, ...] = ()


def score(error: np.ndarray) -> Score:
    """Return the figures of errors; nan without any."""
    if not len(error):
        return Score(np.nan, np.nan)
    return Score(float(np.sqrt(np.mean(error**2))), float(np.std(error)))


def folds(points: PointSet, count: int = FOLDS, seed: int = SEED) -> np.ndarray:
    """Return the fold of each point (n,): the points of one hole, or of one place, stay together."""
    places = np.unique(points.xyz[:, :2], axis=0, return_inverse=True)[1].reshape(-1)
    _, group = np.unique(np.where(points.hole != "", points.hole, places.astype(str)), return_inverse=True)
    shuffled = np.random.default_rng(seed).permutation(group.max() + 1) % count
    return shuffled[group]


def one_a_place(xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return one point a place (x, y), with the mean of its elevations."""
    xy, inverse, count = np.unique(xyz[:, :2], axis=0, return_inverse=True, return_counts=True)
    return xy, np.bincount(inverse.reshape(-1), xyz[:, 2]) / count


def thin_plate(xyz: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return scipy's exact thin-plate spline at (m, 2) places, in scaled coordinates, one point a place."""
    xy, z = one_a_place(xyz)
    centre, scale = xy.mean(axis=0), np.ptp(xy, axis=0).max()
    spline = RBFInterpolator((xy - centre) / scale, z, kernel="thin_plate_spline")
    return spline((places - centre) / scale)


def linear(xyz: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return scipy's linear interpolation at (m, 2) places, nan outside the points' hull."""
    xy, z = one_a_place(xyz)
    centre, scale = xy.mean(axis=0), np.ptp(xy, axis=0).max()
    return LinearNDInterpolator((xy - centre) / scale, z)((places - centre) / scale)


def left_out_errors(given: PointSet, left_out: PointSet | None, settings: FitSettings) -> Errors:
    """Fit the given points and score the ones left out; without any, by folds over the given points.

    The study area is the rectangle around all points, so that the surface is defined at every one.
    """
    if left_out is not None:
        area = rectangle(np.concatenate([given.xyz, left_out.xyz]))
        truth = left_out.xyz[:, 2]
        parts = [(given, left_out.xyz[:, :2], np.arange(len(left_out)))]
    else:
        area, fold, truth = rectangle(given.xyz), folds(given), given.xyz[:, 2]
        parts = [(given[fold != k], given.xyz[fold == k, :2], np.flatnonzero(fold == k)) for k in np.unique(fold)]
    ours, plate, line = (np.full(len(truth), np.nan) for _ in range(3))
    failures = []
    for seen, places, index in parts:
        plate[index], line[index] = thin_plate(seen.xyz, places), linear(seen.xyz, places)
        try:
            ours[index] = fit_horizon(seen, settings, area).elevation(*places.T)
        except GeofitError as error:
            failures.append(str(error))
    return _errors(ours - truth, plate - truth, line - truth, tuple(failures))


def _errors(ours: np.ndarray, plate: np.ndarray, line: np.ndarray, failures: tuple[str, ...]) -> Errors:
    defined = np.isfinite(ours)
    common = defined & np.isfinite(line)
    return Errors(
        len(ours),
        int(common.sum()),
        int(defined.sum()),
        score(ours[common]),
        score(plate[common]),
        score(line[common]),
        score(ours[defined]),
        score(plate[defined]),
        failures,
    )
