"""Boreholes that say most about a body: those that are expected to narrow its volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.planned import PlannedHole, hole_direction, predict_hole
from geofit.bodies.simulate import draws, volumes_of
from geofit.data.errors import SettingsError
from geofit.data.messages import message

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["SuggestedHole", "suggest_body_holes"]

Floats = NDArray[np.float64]

#: Candidates across the longer side of the body, and nodes along each.
CANDIDATES = 14
ALONG = 60


@dataclass(frozen=True, eq=False)
class SuggestedHole:
    """A hole that narrows the volume, and what it is predicted to meet.

    ``azimuth`` clockwise from grid north and ``dip`` below the horizontal are in degrees; ``sd_before`` and
    ``sd_after`` are standard deviations of the body's volume, m3, before and after this hole and those before it,
    without the numerical error of the volume, which no hole narrows.
    """

    hole: PlannedHole
    azimuth: float
    dip: float
    sd_before: float
    sd_after: float


def suggest_body_holes(
    body: BodyFit, count: int = 3, *, azimuth: float = 0.0, dip: float = 90.0
) -> tuple[SuggestedHole, ...]:
    """Choose the parallel holes that are expected to narrow the volume of a body most, one after the other.

    A candidate is taken to show how much of the body there is around it. Over the conditional simulations, a linear
    regression of the volume on that states how much of the volume's variance the hole would explain; what is left is
    given to the next one. Only holes that meet the fitted body are candidates: a hole that misses it shows little.

    Parameters
    ----------
    body : BodyFit
        The body.
    count : int
        Holes wanted.
    azimuth, dip : float
        Direction of the holes in degrees, clockwise from grid north and below the horizontal.

    Returns
    -------
    tuple of SuggestedHole
        Best first; fewer where nothing is in doubt. They begin at the near side of the box around the body.

    Raises
    ------
    SettingsError
        If ``count`` is below 1, or an angle is not finite.
    """
    if count < 1 or not np.isfinite([azimuth, dip]).all():
        raise SettingsError(
            message(
                "bodies.suggestion-unusable",
                "{count} holes of azimuth {azimuth} and dip {dip} cannot be suggested: give a count of 1 or more and "
                "finite angles.",
                count=count,
                azimuth=azimuth,
                dip=dip,
            )
        )
    drawn = draws(body)
    if not len(drawn.places):
        return ()
    axes = _axes(hole_direction(azimuth, dip))
    lower, upper = body.extent
    corners = np.stack(np.meshgrid(*zip(lower, upper, strict=True)), axis=-1).reshape(-1, 3) @ axes.T
    low, high = corners.min(axis=0), corners.max(axis=0)
    across = float((high - low)[:2].max()) / CANDIDATES
    cell = np.floor(((drawn.places - body.origin) @ axes[:2].T - low[:2]) / across).astype(int)
    tube, member = np.unique(cell, axis=0, return_inverse=True)
    shown = np.zeros((len(tube), drawn.changes.shape[1]))
    np.add.at(shown, member.ravel(), drawn.changes)
    lines = low[:2] + (tube + 0.5) * across
    depth = np.linspace(low[2], high[2], ALONG)
    places = np.concatenate([np.repeat(lines, ALONG, axis=0), np.tile(depth, len(tube))[:, None]], axis=1) @ axes
    meets = (body.field.value(places).reshape(-1, ALONG) < 0).any(axis=1)
    tube, shown = tube[meets], np.concatenate([shown[meets], shown[~meets].sum(axis=0, keepdims=True)])
    # In the measure of the volumes that are reported, whose middle is the fitted body.
    change = drawn.changes.sum(axis=0)
    spread = float(change.std())
    if spread > 0:
        shown *= float(volumes_of(body.size.volume, change).values.std()) / spread
    found = []
    for k, before, after in _greedy(shown, count):
        collar = np.append(low[:2] + (tube[k] + 0.5) * across, low[2]) @ axes + body.origin
        hole = predict_hole(body, collar, azimuth=azimuth, dip=dip, length=float(high[2] - low[2]))
        found.append(SuggestedHole(hole, azimuth, dip, before, after))
    return tuple(found)


def _axes(way: Floats) -> Floats:
    """Return three orthogonal unit axes (3, 3), the last one along the holes."""
    first = np.eye(3)[int(np.argmin(np.abs(way)))]
    first = first - (first @ way) * way
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(way, first), way])


def _greedy(shown: Floats, count: int) -> list[tuple[int, float, float]]:
    """Return which rows but the last explain most of the sum of all (n, realizations), its sd before and after each."""
    left = shown - shown.mean(axis=1, keepdims=True)
    volume = left.sum(axis=0)
    free = max(len(volume) - 1, 1)
    # Tubes that hardly vary say nothing, whatever little of theirs goes with the volume.
    least = 1e-4 * float((left**2).sum(axis=1).max(initial=0.0))
    found = []
    for _ in range(min(count, len(shown) - 1)):
        size = (left**2).sum(axis=1)
        gain = np.where(size > least, (left @ volume) ** 2 / np.maximum(size, 1e-300), 0.0)
        k = int(gain[:-1].argmax())
        if gain[k] <= 0:
            break
        before = float(np.sqrt(volume @ volume / free))
        unit = left[k] / np.sqrt(size[k])
        volume = volume - (volume @ unit) * unit
        left = left - np.outer(left @ unit, unit)
        found.append((k, before, float(np.sqrt(volume @ volume / free))))
    return found
