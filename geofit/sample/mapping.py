"""Outcrop traces of the geological map and picks of seismic lines: the sparse periphery."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Ground
from geofit.sample.observations import Observations, errors_of
from geofit.sample.paths import zero_between
from geofit.sample.truth import CORE, MapTruth, PlaneTruth, horizon_truth, in_study_area, river, to_map, to_site
from geofit.sample.truth import ground as true_ground

__all__ = ["map_outcrops", "pick_lines"]

Floats = NDArray[np.float64]

#: The map and the seismic lines stop this far from the core, metres.
_CLEAR = 28.0
#: s of the seismic lines, which run across the valley.
_LINES = (62.0, 205.0, 350.0, 492.0, 640.0, 1322.0, 1450.0, 1592.0, 1735.0, 1878.0)


def _zero(value: Callable[[Floats], Floats], at: Floats) -> float | None:
    """Return the first zero of a function along ``at``, or None if its sign does not change."""
    sign = np.sign(value(at))
    change = np.flatnonzero(sign[:-1] * sign[1:] < 0)
    if not change.size:
        return None
    return zero_between(value, at[change[0]], at[change[0] + 1])


def _outside_core(s: Floats) -> NDArray[np.bool_]:
    return np.asarray((s < CORE[0] - _CLEAR) | (s > CORE[1] + _CLEAR))


def map_outcrops(horizon: str, spacing: float, ground: Ground, observations: Observations) -> Floats:
    """Return (n, 2) map vertices where a horizon comes to the ground outside the core, bank by bank.

    They are off by the noise of an outcrop: the horizon passes so far above or below the mapped ground.
    """
    rng = np.random.default_rng([43, *horizon.encode()])
    truth = horizon_truth(horizon)
    if isinstance(truth, PlaneTruth):
        candidates = _fault_outcrops(truth, spacing, ground, rng)
    else:
        assert isinstance(truth, MapTruth)
        candidates = [place for bank in (1.0, -1.0) for place in _contact_outcrops(truth, bank, spacing, ground, rng)]
    found = []
    for x, y in candidates:
        xyz = np.array([x, y, float(ground.elevation(np.array(x), np.array(y)))])
        s, _ = to_site(x, y)
        if _outside_core(s) and in_study_area(x, y) and observations.is_clear(horizon, xyz):
            observations.add(horizon, "outcrop", xyz)
            found.append((x, y))
    return np.array(found)


def _contact_outcrops(
    truth: MapTruth, bank: float, spacing: float, ground: Ground, rng: np.random.Generator
) -> list[tuple[float, float]]:
    away = np.arange(0.0, 640.0, 2.0)
    found = []
    for s in np.arange(20.0, 1990.0, spacing):
        s = s + rng.uniform(-0.25, 0.25) * spacing
        error = float(errors_of(rng, "outcrop", 1)[0])

        def above(d: Floats, s: float = s, error: float = error) -> Floats:
            x, y = to_map(np.full_like(d, s), river(np.array(s)) + bank * d)
            return np.asarray(ground.elevation(x, y) - truth.height(x, y) - error)

        d = _zero(above, away)
        if d is not None and above(away[:1])[0] < 0:
            x, y = to_map(np.array(s), river(np.array(s)) + bank * d)
            found.append((round(float(x), 2), round(float(y), 2)))
    return found


def _fault_outcrops(
    truth: PlaneTruth, spacing: float, ground: Ground, rng: np.random.Generator
) -> list[tuple[float, float]]:
    up = np.arange(-150.0, 250.0, 2.0)
    found = []
    for u in np.arange(-470.0, 480.0, spacing):
        u = u + rng.uniform(-0.25, 0.25) * spacing
        error = float(errors_of(rng, "outcrop", 1)[0])

        def above(v: Floats, u: float = u, error: float = error) -> Floats:
            xyz = truth.point(np.full_like(v, u), v, error)
            return np.asarray(xyz[:, 2] - ground.elevation(xyz[:, 0], xyz[:, 1]))

        v = _zero(above, up)
        if v is not None:
            x, y, _ = truth.point(np.array([u]), np.array([v]), error)[0]
            found.append((round(float(x), 2), round(float(y), 2)))
    return found


def pick_lines(horizon: str, n: int, observations: Observations) -> Floats:
    """Return (n, 3) picks of a horizon along the seismic lines outside the core."""
    rng = np.random.default_rng([44, *horizon.encode()])
    truth = horizon_truth(horizon)
    assert isinstance(truth, MapTruth)
    s, t = (grid.ravel() for grid in np.meshgrid(_LINES, np.arange(-640.0, 641.0, 4.0), indexing="ij"))
    x, y = to_map(s, t)
    rim = [in_study_area(*to_map(s + a, t + b)) for a in (-30.0, 30.0) for b in (-30.0, 30.0)]
    reached = np.all(rim, axis=0) & (truth.height(x, y) < true_ground(x, y) - 8.0)
    s, t = s[reached], t[reached]
    found: list[Floats] = []
    for i in range(n):
        for _ in range(300):
            k = int((i + rng.uniform(0.15, 0.85)) * len(s) / n)
            place = to_map(s[k] + rng.uniform(-18, 18), t[k] + rng.uniform(-2, 2))
            x, y = (np.round(c, 2) for c in place)
            z = truth.height(x, y) + errors_of(rng, "geophysics", 1)[0]
            xyz = np.array([x, y, np.round(z, 2)])
            if observations.is_clear(horizon, xyz):
                break
        else:
            raise AssertionError(f"No room for pick {i + 1} of {n} of {horizon}.")
        observations.add(horizon, "geophysics", xyz)
        found.append(xyz)
    return np.array(found)
