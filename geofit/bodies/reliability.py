"""How often a stated chance of lying inside comes true: judged on holes left out, whose logs state what is there.

A random field of one roughness says how sure a place is. Rock with dykes, or of thin intervals, is not such a field:
deep in a body one place in three may be of another code, and of a bedded formation the field is surer than its contacts
let expect. Each hole is therefore predicted from all others, and the chance is fitted to what it met: a logistic
calibration (Platt, in *Advances in Large Margin Classifiers*, 2000) with the normal distribution, and with shares of
ground that differ wherever the field puts them (the lapses of psychometric functions, Wichmann & Hill, Perception &
Psychophysics 63, 2001). A few holes say little: the prior is the field's own chance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["SHIFT", "Reliability", "SidesMet", "reliability_by"]

Floats = NDArray[np.float64]

#: The shift of the field's own chance, as fields of r^3 swell a little where data are few; found on planted bodies of
#: fifteen shapes (benchmarks/bodies.py).
SHIFT = 0.16
#: Prior: standard deviations of the logarithm of the steepness, of the shift, and of the logarithm of the distance at
#: which the calibration takes over; that distance in distances between holes; what a share of other rock costs. Chosen
#: on nine eggs crossed by dykes and 18 planted bodies; with a looser shift the chance at the surface varies more.
STEEPER, SHIFTED, FARTHER, USUAL_DISTANCE, COST = 1.0, 0.3, 1.0, 0.2, 3.0
#: Largest ratio of a value to its standard deviation that is looked at, and the least chance of an observation.
SUREST, LEAST = 30.0, 1e-5
#: Starts of the search: the prior, and a body full of other rock.
STARTS = ((0.0, 0.0, -4.0, -4.0), (-1.0, 0.0, -2.0, -1.0))
LIMITS = ((-3.0, 1.5), (-2.0, 2.0), (-9.0, 2.0), (-9.0, 2.0))


@dataclass(frozen=True)
class Reliability:
    """The chance of lying inside, from how many standard deviations inside the field puts a place.

    Far from all data it is ``strays + (1 - strays - gaps) * Phi(steepness * score - shift)``: ``strays`` is the share
    of inside ground far off the body, ``gaps`` that of outside ground deep in it. At the data themselves it is the
    field's own chance; over some ``distance`` (metres) it changes from the one to the other.
    """

    steepness: float = 1.0
    shift: float = SHIFT
    strays: float = 0.0
    gaps: float = 0.0
    distance: float = np.inf

    @property
    def usual(self) -> bool:
        """Whether it is the field's own chance everywhere."""
        return self.distance == np.inf

    def chance(self, score: Floats, away: Floats) -> Floats:
        """Return the chance (n,) of scores (n,), at so many metres (n,) from the nearest datum."""
        from scipy.special import ndtr

        share = self._share(away)
        change = ndtr(self.steepness**share * score - self._shifted(share))
        return np.asarray(share * self.strays + (1.0 - share * (self.strays + self.gaps)) * change)

    def score(self, chance: float, away: Floats) -> Floats:
        """Return the scores (n,) of one chance, at so many metres (n,) from the nearest datum."""
        from scipy.special import ndtri

        share = self._share(away)
        change = (chance - share * self.strays) / (1.0 - share * (self.strays + self.gaps))
        far = ndtri(np.clip(change, 1e-300, 1.0 - 1e-16))
        return np.asarray((far + self._shifted(share)) / self.steepness**share)

    def _share(self, away: Floats) -> Floats:
        return -np.expm1(-away / self.distance)

    def _shifted(self, share: Floats) -> Floats:
        return np.asarray(SHIFT + share * (self.shift - SHIFT))


@dataclass(frozen=True, eq=False)
class SidesMet:
    """Samples of holes left out: their scores, sides and distances from other holes' data; how many they count as."""

    score: Floats
    inside: NDArray[np.bool_]
    away: Floats
    stretches: int


def reliability_by(found: SidesMet, spacing: float) -> Reliability:
    """Return the most probable calibration, given samples of holes left out and the prior."""
    from scipy.optimize import minimize

    score = np.clip(found.score, -SUREST, SUREST)
    # Neighbours along a hole say the same: a stretch of one side counts once. All samples weigh the same, or ground
    # of short stretches would count for more than there is.
    weight = min(1.0, found.stretches / len(score))

    def made(x: Floats) -> Reliability:
        strays, gaps = 1.0 / (1.0 + np.exp(-x[2:4]))
        # Chance rises with the score.
        most = max(1.0, (strays + gaps) / 0.98)
        distance = spacing * USUAL_DISTANCE * np.exp(x[4])
        return Reliability(
            float(np.exp(x[0])), SHIFT + float(x[1]), float(strays / most), float(gaps / most), float(distance)
        )

    def cost(x: Floats) -> float:
        one = made(x)
        chance = np.clip(one.chance(score, found.away), LEAST, 1.0 - LEAST)
        seen = -weight * float(np.log(np.where(found.inside, chance, 1.0 - chance)).sum())
        prior = (x[:2] / (STEEPER, SHIFTED)) ** 2
        shares = COST * float(np.log1p(np.exp(x[2:4])).sum())
        return seen + float(prior.sum()) / 2 + shares + float(x[4] / FARTHER) ** 2 / 2

    tried = [minimize(cost, (*start, 0.0), method="L-BFGS-B", bounds=(*LIMITS, (-3.0, 3.0))) for start in STARTS]
    return made(min(tried, key=lambda one: float(one.fun)).x)
