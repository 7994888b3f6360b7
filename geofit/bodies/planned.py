"""A planned straight hole: where it will enter and leave a body, and how well that is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.active import farthest_apart
from geofit.bodies.posterior import SPREAD, BodyPosterior
from geofit.bodies.simulate import changes
from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.implicit.trace import Crossing, hole_crossings

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["PercentileBand", "PlannedHole", "hole_direction", "predict_hole"]

Floats = NDArray[np.float64]

#: Nodes along a planned hole, and those at which a simulation is drawn.
NODES = 400
KNOTS = 80
#: Places that differ from the fitted field by more than this many standard deviations keep their side.
FAR = 3.5
#: Gradients are looked at along the hole only; between two nodes they may be larger.
STEEPER = 1.5


@dataclass(frozen=True)
class PercentileBand:
    """Percentiles over the realizations, metres."""

    p10: float
    p50: float
    p90: float


@dataclass(frozen=True, eq=False)
class PlannedHole:
    """What a straight hole will meet.

    Parameters
    ----------
    collar, direction : (3,) arrays
        Where it begins, map coordinates, and its unit direction.
    length : float
        Metres.
    crossings : tuple of Crossing
        Depths at which it crosses the fitted body.
    probability : float
        That it meets the body at all.
    entry, exit : Band or None
        Depth of the first entry and of the last exit, over the realizations that it meets; None where it meets none.
        A hole that starts or ends in the body enters at 0 or leaves at its length.
    inside : Band
        Length in the body over all realizations, metres.
    """

    collar: Floats
    direction: Floats
    length: float
    crossings: tuple[Crossing, ...]
    probability: float
    entry: PercentileBand | None
    exit: PercentileBand | None
    inside: PercentileBand


@dataclass(frozen=True, eq=False)
class _Bounded:
    """A body's field in map coordinates, with a bound of its gradient that was measured along one hole."""

    body: BodyFit
    lipschitz: float

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        low, high = self.body.field.bounds
        return low + self.body.origin, high + self.body.origin

    def value(self, xyz: Floats) -> Floats:
        return self.body.value(xyz)

    def gradient(self, xyz: Floats) -> Floats:
        return self.body.gradient(xyz)


def predict_hole(
    body: BodyFit, collar: ArrayLike, *, azimuth: float = 0.0, dip: float = 90.0, length: float
) -> PlannedHole:
    """Predict where a straight hole will enter and leave a body.

    Parameters
    ----------
    body : BodyFit
        The body.
    collar : (3,) array_like
        Where the hole begins, map coordinates.
    azimuth, dip : float
        Direction in degrees, clockwise from grid north and below the horizontal.
    length : float
        Of the hole, metres.

    Returns
    -------
    PlannedHole
        With P10, P50 and P90 over ``settings.realizations`` conditional simulations along the hole.

    Raises
    ------
    SettingsError
        If the collar, an angle or the length cannot be used.
    """
    start = np.array(collar, float)
    if start.shape != (3,) or not np.isfinite([*start, azimuth, dip, length]).all() or length <= 0:
        raise SettingsError(
            message(
                "bodies.planned-hole-unusable",
                "A planned hole needs a collar x, y, z, finite angles and a length above 0 m, not {collar}, "
                "{azimuth}, {dip}, {length}.",
                collar=start.tolist(),
                azimuth=azimuth,
                dip=dip,
                length=length,
            )
        )
    way = hole_direction(azimuth, dip)
    depth = np.linspace(0.0, length, NODES)
    xyz = start + depth[:, None] * way
    slope = float(np.linalg.norm(body.gradient(xyz), axis=1).max())
    resolution = max(1e-3, length / 20_000)
    (crossings,) = hole_crossings(
        _Bounded(body, STEEPER * max(slope, 1.0)), [start], [way], length=length, resolution=resolution
    )
    drawn = body.value(xyz)[:, None] + _drawn(body, xyz)
    entry, leave, inside = [], [], []
    for column in drawn.T:
        ins, outs = _passages(depth, column)
        inside.append(float((outs - ins).sum()))
        if len(ins):
            entry.append(ins[0])
            leave.append(outs[-1])
    return PlannedHole(
        start,
        way,
        length,
        crossings,
        len(entry) / drawn.shape[1],
        _band(entry),
        _band(leave),
        PercentileBand(*np.quantile(inside, [0.1, 0.5, 0.9]).tolist()),
    )


def hole_direction(azimuth: float, dip: float) -> Floats:
    """Return the unit direction (3,) of a hole of this azimuth and dip, degrees."""
    turn, fall = np.radians([azimuth, dip])
    return np.array([np.sin(turn) * np.cos(fall), np.cos(turn) * np.cos(fall), -np.sin(fall)])


def _drawn(body: BodyFit, xyz: Floats) -> Floats:
    """Return what each realization adds to the field at (n, 3) places along a hole, (n, realizations)."""
    posterior = BodyPosterior(body)
    value, deviation = body.value(xyz), SPREAD * posterior.deviation(xyz)
    # Off the box, and beyond the reach of the data of a closed body, ground is outside in every realization.
    near = np.flatnonzero((np.abs(value) < FAR * deviation) & posterior.open_ground(xyz))
    change = np.zeros((len(xyz), body.settings.realizations))
    if len(near):
        fitted = body.field.frame.to_fit(xyz[near])
        knots = fitted[farthest_apart(fitted, min(KNOTS, len(near)))]
        change[near] = changes(body, posterior, knots, fitted, np.random.default_rng(body.settings.seed))
    return change


def _passages(depth: Floats, value: Floats) -> tuple[Floats, Floats]:
    """Return the depths (k,), (k,) at which a hole enters and leaves, by linear interpolation of values (n,)."""
    within = value < 0
    k = np.flatnonzero(within[1:] != within[:-1])
    at = depth[k] + (depth[k + 1] - depth[k]) * value[k] / (value[k] - value[k + 1])
    ends = np.concatenate([depth[:1][within[:1]], at, depth[-1:][within[-1:]]])
    return ends[::2], ends[1::2]


def _band(values: Sequence[float]) -> PercentileBand | None:
    return PercentileBand(*np.quantile(values, [0.1, 0.5, 0.9]).tolist()) if values else None
