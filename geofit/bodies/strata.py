"""Table of a body by stratum: how much of it lies between which horizons, m3, with the spread."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.cut import CuttingSurface, cut_body
from geofit.bodies.simulate import BodyVolumes, draws, volumes_of
from geofit.data.errors import SettingsError
from geofit.data.messages import Message, message

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["StratumVolume", "strata_table"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StratumVolume:
    """The part of a body in one stratum: ``upper`` and ``lower`` name the horizons that bound it, or are empty.

    ``pieces`` counts its closed pieces.
    """

    name: Message
    upper: str
    lower: str
    pieces: int
    volumes: BodyVolumes


def strata_table(
    body: BodyFit, horizons: Mapping[str, CuttingSurface], spacing: float | None = None
) -> tuple[StratumVolume, ...]:
    """Return the volume of a body in each stratum that it reaches, from the top down.

    Where horizons cross, a place belongs to the stratum below the lowest of those above it.

    Parameters
    ----------
    body : BodyFit
        The body.
    horizons : mapping of str to surface
        In any order: that of their mean elevations over the body counts.
    spacing : float, optional
        Of the body's triangles, see :meth:`BodyFit.triangulate`.

    Returns
    -------
    tuple of StratumVolume
        Their ``volumes.best`` add up to the volume of the body, to rounding: those of the pieces, all enlarged by the
        factor of :attr:`BodyFit.size` over flat triangles.

    Raises
    ------
    SettingsError
        If no horizon is given.
    FitError
        If a horizon does not reach all over the body.
    """
    if not horizons:
        raise SettingsError(message("bodies.strata-without-horizon", "A table of strata needs one horizon or more."))
    pieces = cut_body(body, horizons, spacing)
    x, y = (body.overview.vertices + body.origin)[:, :2].T
    height = {name: float(np.mean(surface.elevation(x, y))) for name, surface in horizons.items()}
    order = sorted(horizons, key=lambda name: -height[name])
    best, count = np.zeros(len(order) + 1), np.zeros(len(order) + 1, int)
    for piece in pieces:
        stratum = max((k for k, name in enumerate(order, 1) if piece.sides[name] == "below"), default=0)
        best[stratum] += piece.volume
        count[stratum] += 1
    share, size = best / best.sum(), body.size
    drawn = draws(body)
    stratum_of = np.zeros(len(drawn.places), int)
    for k, name in enumerate(order, 1):
        # A horizon may end beyond the body, within the reach of the draws: there its mean elevation counts.
        level = np.asarray(horizons[name].elevation(drawn.places[:, 0], drawn.places[:, 1]), float)
        level = np.where(np.isfinite(level), level, height[name])
        stratum_of[drawn.places[:, 2] < level] = k
    rows = []
    for k in range(len(order) + 1):
        change = drawn.changes[stratum_of == k].sum(axis=0)
        if count[k]:
            upper, lower = order[k - 1] if k else "", order[k] if k < len(order) else ""
            volumes = volumes_of(float(share[k]) * size.volume, change, float(share[k]) * size.volume_error)
            rows.append(StratumVolume(_label(upper, lower), upper, lower, int(count[k]), volumes))
    return tuple(rows)


def _label(upper: str, lower: str) -> Message:
    if upper and lower:
        return message("bodies.part-between-surfaces", "{upper} to {lower}", upper=upper, lower=lower)
    return (
        message("bodies.part-below-surface", "below {surface}", surface=upper)
        if upper
        else message("bodies.part-above-surface", "above {surface}", surface=lower)
    )
