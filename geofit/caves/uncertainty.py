"""How uncertain the volume of passages is: errors of measured walls, of missing ones, and of the shots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.caves.body import THIN, PassageBody, across
from geofit.caves.sweeps import swept_volumes
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message

__all__ = ["VolumeEstimate", "volume_estimate"]

Floats = NDArray[np.float64]

#: The 90 % quantile of the normal distribution.
_P90 = 1.2815515655446004


@dataclass(frozen=True)
class VolumeEstimate:
    """A volume with its standard deviation, cubic metres.

    Parameters
    ----------
    volume : float
        Volume of the body.
    walls, missing, survey : float
        Standard deviations by the measured walls, by those that were not measured, and by the lengths of the shots.
    """

    volume: float
    walls: float
    missing: float
    survey: float

    @property
    def sigma(self) -> float:
        """Standard deviation of the volume, the three causes together."""
        return float(np.sqrt(self.walls**2 + self.missing**2 + self.survey**2))

    @property
    def p10(self) -> float:
        """Volume that the true one exceeds with 90 %."""
        return max(self.volume - _P90 * self.sigma, 0.0)

    @property
    def p90(self) -> float:
        """Volume that the true one exceeds with 10 %."""
        return self.volume + _P90 * self.sigma


@arguments_checked
def volume_estimate(
    body: PassageBody,
    *,
    wall_error: float = 0.15,
    missing_error: float = 0.5,
    correlation: float = 0.5,
    spacing: float | None = None,
) -> VolumeEstimate:
    """Return the volume of passages and its uncertainty, by propagation of errors.

    Parameters
    ----------
    body : PassageBody
        The passages.
    wall_error : float
        Standard deviation of a measured wall distance, as a share of it.
    missing_error : float
        The same of a wall that was interpolated.
    correlation : float
        Correlation of the errors of two walls, 0 to 1: surveyors estimate all walls too near or too far.
    spacing : float, optional
        As in :meth:`PassageBody.volume`.

    Raises
    ------
    SettingsError
        If a share is below 0, or the correlation is not between 0 and 1.

    Notes
    -----
    The volume of each swept section is a polynomial of its walls, so derivatives by central differences are exact. They
    are scaled by the volume of the body over the sum of the sections, which counts overlaps once.
    """
    if wall_error < 0 or missing_error < 0 or not 0 <= correlation <= 1:
        raise SettingsError(
            message(
                "caves.errors-unusable",
                "Give errors of 0 or more as shares of the walls, and a correlation between 0 and 1.",
            )
        )
    sweeps, found, survey = body.sweeps, body.sections, body.adjusted.survey
    flat = np.hypot(sweeps.along[:, 0], sweeps.along[:, 1])

    def volumes(walls: Floats) -> Floats:
        return swept_volumes(sweeps.length, np.maximum(walls, THIN) if survey.across else across(walls, flat))

    step = 0.5 * THIN
    base = np.maximum(found.walls, 2 * THIN)
    effect = np.zeros(len(found.measured))
    for end in range(2):
        for wall in range(4):
            more, less = base.copy(), base.copy()
            more[:, end, wall] += step
            less[:, end, wall] -= step
            np.add.at(effect, found.source[:, end, wall], (volumes(more) - volumes(less)) / (2 * step))
    distance = np.zeros(len(found.measured))
    distance[found.source.ravel()] = found.walls.ravel()
    volume = body.volume(spacing)
    scale = volume / max(float(sweeps.volumes.sum()), 1e-12)
    spread = []
    for chosen, error in ((found.measured, wall_error), (~found.measured, missing_error)):
        single = effect[chosen] * distance[chosen] * error * scale
        spread.append(float(np.sqrt((1 - correlation) * (single**2).sum() + correlation * single.sum() ** 2)))
    covariance = body.adjusted.covariance[found.shot]
    lengths = np.sqrt(np.einsum("ki,kij,kj->k", sweeps.along, covariance, sweeps.along))
    lengths = np.where(survey.across, 0.0, lengths)
    by_length = float(np.sqrt(((sweeps.volumes / sweeps.length * lengths * scale) ** 2).sum()))
    return VolumeEstimate(volume, spread[0], spread[1], by_length)
