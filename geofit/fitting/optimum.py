"""The search for the parameters of the greatest restricted likelihood (:mod:`geofit.fitting.likelihood`).

All parameters are found together by Newton's method with the exact gradient and the average information in place of
the second derivatives (A. R. Gilmour, R. Thompson, B. R. Cullis, Biometrics 51, 1995, 1440-1450), within their bounds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geofit.fitting.likelihood import UNSOLVABLE, Likelihood, Optimum

__all__ = ["BEHIND", "EVERY", "maximize", "maximize_over_noise"]

Floats = NDArray[np.float64]

#: All parameters: the longest range, rho, and both parts of the stretch.
EVERY = (0, 1, 2, 3)
#: A search is given up this far behind a rival, -2 log of the likelihood, but not before so many steps, nor if so many
#: steps like the next one would catch up.
BEHIND, PATIENCE, PACE = 60.0, 2, 2.0
#: The gain, -2 log of the likelihood, that another step must promise; steps at most, and their longest.
SETTLED, STEPS, LONGEST = 0.1, 20, np.array([1.0, 4.0, 0.25, 0.25])
#: Added to the information, for log kappa once for each unit of nu. The information leaves out what the planes say, and
#: without it no step is bounded where the points say little.
MORE, MORE_OF_KAPPA = 0.1, 0.5
#: Rounds over the parameters for a step at most, and the change of one that ends them.
SWEEPS, STILL = 50, 1e-4
#: First step of log rho on another space, and the gain below which its search ends. A coarser limit would leave the
#: noise to chance where the likelihood is flat, and with it the weight of measured dips.
ASIDE, SURE = 0.75, 0.02
#: So many times the gain that a parabola promises are out of reach.
PLAINLY = 5.0


def maximize(likelihood: Likelihood, starts: Sequence[Floats], free: Sequence[int], rival: float = math.inf) -> Optimum:
    """Find the greatest likelihood from the best of several starts.

    Parameters
    ----------
    likelihood : Likelihood
        What is to be as great as possible; its values are -2 log, so small ones are sought.
    starts : sequence of (4,) arrays
        Parameters to begin with.
    free : sequence of int
        Parameters to vary; the others keep their start.
    rival : float
        Value of another smoothness: far behind it the search is given up.
    """
    at: Floats = min(starts, key=likelihood)
    value = likelihood(at)
    if value >= UNSOLVABLE:
        return likelihood.optimum(at)
    gradient, curvature = _derivatives(likelihood, at)
    for count in range(STEPS):
        step = _step(at, gradient, curvature, likelihood.bounds(), free)
        slope = float(gradient @ step)
        promised = -slope - float(step @ curvature @ step) / 2
        if promised < SETTLED or (count >= PATIENCE and value - rival > max(BEHIND, PACE * promised)):
            break
        part = _descent(likelihood, at, step, value, slope)
        if part == 0.0:
            break
        at = at + part * step
        gained, before, value = value - likelihood(at), gradient, likelihood(at)
        gradient, curvature = _derivatives(likelihood, at)
        if gained < promised / 2:
            curvature = _updated(curvature, part * step, gradient - before)
    return likelihood.optimum(at)


def maximize_over_noise(likelihood: Likelihood, start: Floats, needed: float = math.inf) -> Optimum:
    """Find the noise of the greatest likelihood, all other parameters being those of the start.

    On spaces of other spans the range is known by then: what changes is what counts as noise. The search ends where it
    plainly stays above the value that is ``needed``.
    """
    low, high = likelihood.bounds()[1]
    if likelihood(start) >= UNSOLVABLE:
        return likelihood.optimum(start)

    def at(log_rho: float) -> Floats:
        return np.array([start[0], log_rho, *start[2:]])

    def value(log_rho: float) -> float:
        return likelihood(at(log_rho))

    middle = float(start[1])
    sides = [max(middle - ASIDE, low), min(middle + ASIDE, high)]
    if value(sides[0]) >= value(middle):
        sides.reverse()
    # Downhill by ever longer steps while they gain, so that the middle is the least of three.
    behind, ahead = sides[1], sides[0]
    while value(ahead) < value(middle) - SURE and low < ahead < high:
        behind, middle, ahead = middle, ahead, min(max(ahead + 2 * (ahead - middle), low), high)
    for _ in range(STEPS):
        vertex, gain = _vertex((behind, middle, ahead), (value(behind), value(middle), value(ahead)))
        if gain < SURE or value(middle) - PLAINLY * gain > needed:
            break
        if value(vertex) < value(middle):
            behind, middle, ahead = middle, vertex, behind if (vertex - middle) * (behind - middle) > 0 else ahead
        elif (vertex - middle) * (behind - middle) > 0:
            behind = vertex
        else:
            ahead = vertex
    return likelihood.optimum(min((at(one) for one in (behind, middle, ahead)), key=likelihood))


def _derivatives(likelihood: Likelihood, at: Floats) -> tuple[Floats, Floats]:
    """Return the gradient, and the curvature of the quadratic model."""
    gradient, information = likelihood.derivatives(at)
    return gradient, information + np.diag([max(likelihood.alpha - 1, 1) * MORE_OF_KAPPA, MORE, MORE, MORE])


def _vertex(x: tuple[float, float, float], y: tuple[float, float, float]) -> tuple[float, float]:
    """Return where a parabola through three values has its vertex, and how far that lies below the middle value.

    Where that is not between the outer ones, the middle stays.
    """
    before, after = x[0] - x[1], x[2] - x[1]
    if before == 0.0 or after == 0.0:
        return x[1], 0.0
    left, right = (y[0] - y[1]) / before, (y[2] - y[1]) / after
    curvature = (right - left) / (after - before)
    if curvature <= 0:
        return x[1], 0.0
    by = -(left - curvature * before) / (2 * curvature)
    return (x[1] + by, curvature * by**2) if min(x) < x[1] + by < max(x) else (x[1], 0.0)


def _step(
    at: Floats,
    gradient: Floats,
    curvature: Floats,
    bounds: Sequence[tuple[float, float]],
    free: Sequence[int],
) -> Floats:
    """Return the step to the least of the quadratic model, within the bounds and no longer than the longest.

    One parameter after the other moves to its least, which converges within bounds as well.
    """
    low, high = np.array(bounds).T
    low, high = np.maximum(low - at, -LONGEST), np.minimum(high - at, LONGEST)
    step = np.zeros(4)
    for _ in range(SWEEPS):
        before = step.copy()
        for k in free:
            model = gradient[k] + curvature[k] @ step
            step[k] = min(max(step[k] - model / curvature[k, k], low[k]), high[k])
        if np.abs(step - before).max() < STILL:
            break
    return step


def _descent(likelihood: Likelihood, at: Floats, step: Floats, value: float, slope: float) -> float:
    """Return the part of a step that lowers the value; 0 where none does."""
    part = 1.0
    for _ in range(8):
        found = likelihood(at + part * step)
        if found < value:
            return part
        # The vertex of the parabola of both values and the slope.
        vertex = -slope * part**2 / (2 * (found - value - slope * part))
        part = min(max(vertex, 0.1 * part), 0.5 * part)
    return 0.0


def _updated(curvature: Floats, step: Floats, turned: Floats) -> Floats:
    """Return the curvature that explains how the gradient turned along a step (Broyden, Fletcher and others, 1970)."""
    along = float(step @ turned)
    # Where the value is not convex along the step, nothing is learned.
    if along <= 1e-8 * float(np.linalg.norm(step) * np.linalg.norm(turned)):
        return curvature
    seen = curvature @ step
    return np.asarray(curvature + np.outer(turned, turned) / along - np.outer(seen, seen) / float(step @ seen))
