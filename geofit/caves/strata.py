"""Passages cut by horizons: metres and cubic metres in each stratum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.caves.body import PassageBody
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.surfaces.protocol import HasElevation

__all__ = ["Stratum", "strata"]

Floats = NDArray[np.float64]

#: Shots are cut into pieces of this length to find horizons, metres; within a piece a crossing is linear.
_PIECE = 0.5


@dataclass(frozen=True)
class Stratum:
    """What lies between two horizons.

    Parameters
    ----------
    top, base : str
        Names of the horizons above and below; empty above the first and below the last. Both are empty for the part
        where a horizon has no height.
    known : bool
        False for that part.
    length : float
        Metres of passage, by the shots that count.
    volume : float
        Cubic metres.
    """

    top: str
    base: str
    known: bool
    length: float
    volume: float


@arguments_checked
def strata(
    body: PassageBody, horizons: Mapping[str, HasElevation], *, spacing: float | None = None
) -> tuple[Stratum, ...]:
    """Return length and volume of passages in each stratum; they add up to those of the body.

    Parameters
    ----------
    body : PassageBody
        The passages.
    horizons : mapping of str to HasElevation
        Surfaces from the top down. Where one lies above an earlier one, it is taken at the height of that one.
    spacing : float, optional
        As in :meth:`PassageBody.volume`.

    Returns
    -------
    tuple of Stratum
        One more than horizons, from the top down, and last the part where a horizon has no height.

    Raises
    ------
    SettingsError
        If no horizon is given.
    """
    if not horizons:
        raise SettingsError(
            message("caves.no-horizon", "No horizon to cut with; give at least one, from top to bottom.")
        )
    found = body.columns(spacing)
    heights = _heights(horizons, found.x, found.y)
    known = np.isfinite(heights).all(axis=0)
    cut = np.clip(heights[:, known], found.low[known], found.high[known])
    edges = np.vstack([found.high[known], cut, found.low[known]])
    volume = ((edges[:-1] - edges[1:]) * found.share[known]).sum(axis=1) * found.spacing**2
    lost = float((found.share * (found.high - found.low))[~known].sum() * found.spacing**2)
    length, lost_length = _lengths(body, horizons)
    names = ["", *horizons, ""]
    return (
        *(
            Stratum(top, base, True, float(metres), float(cubic))
            for top, base, metres, cubic in zip(names[:-1], names[1:], length, volume, strict=True)
        ),
        Stratum("", "", False, lost_length, lost),
    )


def _heights(horizons: Mapping[str, HasElevation], x: Floats, y: Floats) -> Floats:
    """Return the heights (k, n) of the horizons, none above the one before it."""
    heights = np.stack([np.broadcast_to(np.asarray(h.elevation(x, y), float), x.shape) for h in horizons.values()])
    return np.asarray(np.minimum.accumulate(heights, axis=0))


def _lengths(body: PassageBody, horizons: Mapping[str, HasElevation]) -> tuple[Floats, float]:
    """Return the metres of passage in each stratum, and where a horizon has no height."""
    sweeps = body.sweeps
    counted = np.flatnonzero(body.adjusted.survey.counted[body.sections.shot])
    pieces = np.ceil(sweeps.length[counted] / _PIECE).astype(int)
    shot = np.repeat(counted, pieces)
    number = np.arange(len(shot)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    share = 1.0 / np.repeat(pieces, pieces)
    length = sweeps.length[shot] * share

    def above(t: Floats) -> Floats:
        xyz = sweeps.origin[shot] + (t * sweeps.length[shot])[:, None] * sweeps.along[shot]
        return xyz[:, 2] - _heights(horizons, xyz[:, 0], xyz[:, 1])

    a, b = above(number * share), above((number + 1) * share)
    known = np.isfinite(a).all(axis=0) & np.isfinite(b).all(axis=0)
    a, b = a[:, known], b[:, known]
    # Share of a piece above a horizon: where the signs differ, up to the zero of the line between the ends.
    over = np.where(a > 0, a, 0.0) + np.where(b > 0, b, 0.0)
    total = np.abs(a) + np.abs(b)
    part = np.where(total > 0, over / np.where(total > 0, total, 1.0), 0.0)
    part = np.vstack([np.zeros(part.shape[1]), part, np.ones(part.shape[1])])
    return np.diff(part, axis=0) @ length[known], float(length[~known].sum())
