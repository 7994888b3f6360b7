"""The likeliest field of each smoothness.

The likelihood may have one maximum where relief passes for noise and another one where it does not, so the search
begins at every start that is better than its neighbours. A smoother field begins at a rougher one of the same variance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from geofit.fitting.likelihood import UNSOLVABLE, Likelihood, Optimum
from geofit.fitting.optimum import BEHIND, EVERY, maximize

__all__ = ["ENOUGH", "as_smooth", "search", "starts"]

Floats = NDArray[np.float64]

#: Fewer points than these cannot tell noise from relief, nor one direction from another.
ENOUGH = 16
#: Starts of the search: kappa, and the frequency of the waves of which half counts as noise, per unit.
KAPPAS, WAVES = (0.04, 0.2, 1.0), (0.7, 2.0, 6.0)
#: The smoother field to try beside a rough one that is not far behind, and how many times shorter its first ranges are.
SMOOTHER, SHORTER = {3: 6}, (1.25, 2.5)
#: If a rougher field is the likeliest, the smoother one must beat it by this much, -2 log of the likelihood.
PLAINLY = 10.0


def search(likelihood: Callable[[int], Likelihood], degree: int, n: int, rho: float | None) -> list[Optimum]:
    """Return the likeliest field of each smoothness for n points on splines of a degree; of a given rho, if any."""
    few = n < ENOUGH
    alphas = {3: (2,) if few else (3, 2), 2: (2,)}.get(degree, (1,))
    free = [k for k in EVERY[: 2 if few else 4] if k != 1 or rho is None]
    found: list[Optimum] = []
    for alpha in alphas:
        judge, best = likelihood(alpha), math.inf if not found else found[0].value
        optima: list[Optimum] = []
        for start in starts(judge, rho):
            optima.append(maximize(judge, [start], free, min([best, *(one.value for one in optima)])))
        found.append(min(optima, key=lambda one: one.value))
    best = min(one.value for one in found)
    for rough in found[:]:
        if rough.alpha in SMOOTHER and rho is None and rough.value < min(best + BEHIND, UNSOLVABLE):
            judge = likelihood(SMOOTHER[rough.alpha])
            fields = [as_smooth(rough.kappa, rough.rho, rough.alpha, judge.alpha, shorter) for shorter in SHORTER]
            smoother = maximize(judge, [judge.parameters(*one, rough.stretch) for one in fields], free, best)
            if rough.value == best or smoother.value < best - PLAINLY:
                found.append(smoother)
    return found


def starts(judge: Likelihood, rho: float | None) -> Sequence[Floats]:
    """Return the starts that are better than those around them, (4,) parameters each, those far behind left out."""
    waves = WAVES if rho is None else WAVES[:1]
    places = [
        [judge.parameters(kappa, (kappa**2 + wave**2) ** -judge.alpha, (0.0, 0.0)) for wave in waves]
        for kappa in KAPPAS
    ]
    if rho is not None:
        for (place,) in places:
            place[1] = math.log(rho)
    values = np.array([[judge(place) for place in row] for row in places])
    lowest = sliding_window_view(np.pad(values, 1, constant_values=math.inf), (3, 3)).min(axis=(2, 3))
    chosen = np.argwhere((values == lowest) & (values <= values.min() + BEHIND))
    return [places[i][j] for i, j in chosen]


def as_smooth(kappa: float, rho: float, alpha: int, other: int, shorter: float = 1.0) -> tuple[float, float]:
    """Return kappa and rho for another exponent, the same variance and a correlation length `shorter` times shorter."""
    old, new = alpha - 1, other - 1
    found = shorter * kappa * math.sqrt(new / old)
    return found, rho * old * kappa ** (2 * old) / (new * found ** (2 * new))
