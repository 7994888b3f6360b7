"""Residuals that are not noise: one-sided patches, patterns in space, and tails that a few blunders make.

All three look at the approximated points only: a core's residuals are zero by construction. What they find is held
against the interior tolerance as well as against chance, since a pattern of millimetres is not a fault of a horizon.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import binom, ndtri

from geofit.data.accuracy import Check
from geofit.data.labels import Labels
from geofit.data.long_arrays import spread
from geofit.data.messages import Message, message

__all__ = ["by_label", "residual_checks"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Fewest points of a patch, and of a surface, that say something about a distribution.
FEW, FEWEST = 8, 20
#: More points than these are thinned: a tree of neighbours, and the normal plot's distribution, go no further.
MOST = 5_000
#: Share of the interior tolerance below which neither a bias nor a pattern matters.
SHARE = 0.1
#: How many standard errors are not chance: one false alarm in 30,000 (two sides).
BEYOND = 4.0
#: The same probability, for the sign test.
CHANCE = 6e-5
NEIGHBOURS = 6
#: Share of the normal plot's variance off its straight line that few points, or many, may show.
CROOKED = 0.1


def residual_checks(xyz_of: Callable[[Ints], Floats], d: Floats, patch: Labels, tolerance: float) -> list[Check]:
    """Test the residuals of the approximated points.

    Parameters
    ----------
    xyz_of : callable
        ``xyz_of(rows)`` returns some of the n points, metres, about a local origin.
    d : (n,) array
        Their signed distances from the surface, metres.
    patch : Labels
        The patch that each lies on.
    tolerance : float
        Interior tolerance, metres.

    Returns
    -------
    list of Check
        "bias", "clustering" and "normality"; ``passed`` is None where the points are too few to tell.
    """
    place = _thinned(len(d))
    checks = [_bias(d, patch, tolerance)]
    for test in (_clustering(xyz_of(place), d[place], tolerance), _normality(d[place], tolerance)):
        text = partly(test.text, len(place), len(d))
        checks.append(Check(test.name, test.passed, test.value, test.limit, test.unit, text))
    return checks


def partly(text: Message, part: int, n: int) -> Message:
    """Return a check's sentence with how many of ``n`` points it looked at, where these are not all."""
    return (
        text
        if part == n
        else message("checks.sample-examined", "{text}; {part} of {n} points examined", text=text, part=part, n=n)
    )


def by_label(d: Floats, labels: Labels) -> dict[str, Floats]:
    """Return the distances of each label, labels in the order of their first appearance, distances in theirs."""
    if len(labels.table) == 1:
        return {labels.table[0]: d} if len(d) else {}
    codes, first = np.unique(labels.codes, return_index=True)
    parts = np.split(d[np.argsort(labels.codes, kind="stable")], np.cumsum(np.bincount(labels.codes)[codes])[:-1])
    return {labels.table[codes[k]]: parts[k] for k in np.argsort(first)} if len(codes) else {}


def _thinned(n: int) -> NDArray[np.int64]:
    """All points, or a part drawn with a fixed seed: a regular step could fall on one line of a grid in each row."""
    if n <= MOST:
        return np.arange(n)
    return np.sort(np.random.default_rng(0).choice(n, MOST, replace=False))


def _bias(d: Floats, patch: Labels, tolerance: float) -> Check:
    """Whether a patch lies to one side of its points: Student's t and the sign test, held against the tolerance."""
    rows = {name: part for name, part in by_label(d, patch).items() if len(part) >= FEW}
    if not rows:
        text = message("checks.no-patch-to-judge", "not judged: no patch has {few} approximated points", few=FEW)
        return Check("bias", None, 0.0, SHARE * tolerance, "m", text)
    limits = {name: _bias_limit(part, tolerance) for name, part in rows.items()}
    name = max(rows, key=lambda one: abs(rows[one].mean()) / limits[one])
    mean, limit = float(rows[name].mean()), limits[name]
    passed = abs(mean) <= limit
    side = float(np.mean(rows[name] > 0 if mean > 0 else rows[name] < 0))
    if passed:
        text = message(
            "checks.no-bias",
            "no patch lies to one side of its points; largest mean {mean:+.3f} m, {patch}",
            mean=round(mean, 3) + 0.0,  # no -0.000
            patch=name,
        )
    elif mean > 0:
        text = message(
            "checks.bias-low",
            "a bias: the surface runs too low in patch {patch}, {share:.0%} of {n} approximated points lie above it, "
            "on average by {mean:.3f} m",
            patch=name,
            share=side,
            n=len(rows[name]),
            mean=mean,
        )
    else:
        text = message(
            "checks.bias-high",
            "a bias: the surface runs too high in patch {patch}, {share:.0%} of {n} approximated points lie below it, "
            "on average by {mean:.3f} m",
            patch=name,
            share=side,
            n=len(rows[name]),
            mean=-mean,
        )
    return Check("bias", passed, abs(mean), limit, "m", text)


def _bias_limit(d: Floats, tolerance: float) -> float:
    """Largest mean that chance or the tolerance explains; signs that no chance explains leave the tolerance alone."""
    n = len(d)
    fewer = min(int((d > 0).sum()), int((d < 0).sum()))
    chance = 2.0 * float(binom(n, np.arange(fewer + 1)).sum()) / 2.0**n if n <= 1000 else _normal_tail(n, fewer)
    error = spread(d) / np.sqrt(n - 1)
    # Student's t of few points has wider tails than the normal distribution.
    beyond = BEYOND * (1 + BEYOND**2 / (2 * n))
    return SHARE * tolerance if chance < CHANCE else max(SHARE * tolerance, beyond * error)


def _normal_tail(n: int, fewer: int) -> float:
    from scipy.special import ndtr

    return float(2 * ndtr((2 * fewer + 1 - n) / np.sqrt(n)))


def _clustering(xyz: Floats, d: Floats, tolerance: float) -> Check:
    """Moran's I of the nearest neighbours in space, its variance under randomisation (Cliff & Ord 1981)."""
    n, name = len(d), "clustering"
    spread = float(d.std()) if n else 0.0
    if n < FEWEST or spread == 0:
        text = message(
            "checks.too-few-residuals",
            "not judged: too few approximated points, {n} where {few} are needed",
            n=n,
            few=FEWEST,
        )
        if n >= FEWEST:
            text = message("checks.residuals-equal", "not judged: all residuals are equal")
        return Check(name, None, 0.0, SHARE * tolerance, "m", text)
    z = (d - d.mean()) / spread
    near = np.asarray(cKDTree(xyz).query(xyz, k=NEIGHBOURS + 1, workers=-1)[1])
    own = near == np.arange(n)[:, None]
    # Where several points are coincident, the point itself need not come first.
    own[~own.any(axis=1), -1] = True
    near = near[~own].reshape(n, NEIGHBOURS)
    moran = float((z[:, None] * z[near]).mean())
    expected, error = _moran_moments(near, float((z**4).mean()))
    # I is the share of the variance that neighbours have in common: its root times the spread is the pattern.
    value = spread * np.sqrt(max(moran, 0.0))
    limit = max(SHARE * tolerance, spread * np.sqrt(max(expected + BEYOND * error, 0.0)))
    figures = {"moran": moran, "z": (moran - expected) / error}
    if value <= limit:
        text = message(
            "checks.residuals-independent",
            "neighbouring residuals are not correlated (Moran's I {moran:.2f}, z {z:.1f})",
            **figures,
        )
    else:
        text = message(
            "checks.residuals-correlated",
            "residuals of neighbours agree: a pattern of about {value:.2f} m that the surface does not follow "
            "(Moran's I {moran:.2f}, z {z:.1f}); add control points, or look for a source with a systematic offset",
            value=value,
            **figures,
        )
    return Check(name, bool(value <= limit), float(value), float(limit), "m", text)


def _moran_moments(near: NDArray[np.int64], fourth: float) -> tuple[float, float]:
    """Mean and standard deviation of Moran's I of a random arrangement; weights 1 / k for each of k neighbours."""
    n, k = near.shape
    ahead = (np.arange(n)[:, None] * n + near).ravel()
    back = (near * n + np.arange(n)[:, None]).ravel()
    s1 = n / k + float(np.isin(back, ahead).sum()) / k**2
    s2 = float(np.square(1 + np.bincount(near.ravel(), minlength=n) / k).sum())
    mean = -1.0 / (n - 1)
    first = n * ((n**2 - 3 * n + 3) * s1 - n * s2 + 3 * n**2)
    second = fourth * ((n**2 - n) * s1 - 2 * n * s2 + 6 * n**2)
    variance = (first - second) / ((n - 1) * (n - 2) * (n - 3) * n**2) - mean**2
    return mean, float(np.sqrt(max(variance, 1e-12)))


def _normality(d: Floats, tolerance: float) -> Check:
    """Shapiro-Francia: how straight the normal plot is, with Royston's (1993) distribution of it."""
    n, name = len(d), "normality"
    if n < FEWEST:
        text = message(
            "checks.too-few-residuals",
            "not judged: too few approximated points, {n} where {few} are needed",
            n=n,
            few=FEWEST,
        )
        return Check(name, None, 0.0, CROOKED, "", text)
    worst = float(np.abs(d).max())
    if worst <= tolerance:
        # The fit bends the surface until its points are within the tolerance, which cuts the tails off.
        text = message(
            "checks.residuals-within-tolerance",
            "not judged: no residual is beyond the interior tolerance, where the fit stops",
        )
        return Check(name, None, 0.0, CROOKED, "", text)
    quantile = ndtri((np.arange(1, n + 1) - 0.375) / (n + 0.25))
    ordered = np.sort(d) - d.mean()
    off = 1.0 - float(quantile @ ordered) ** 2 / float((quantile @ quantile) * (ordered @ ordered))
    loglog = np.log(np.log(n))
    mean = -1.2725 + 1.0521 * (loglog - np.log(n))
    spread = 1.0308 - 0.26758 * (loglog + 2.0 / np.log(n))
    limit = max(CROOKED, float(np.exp(mean + BEYOND * spread)))
    if off <= limit:
        text = message(
            "checks.residuals-normal",
            "the normal plot of the residuals is straight but for {off:.1%}",
            off=off,
        )
    elif np.mean(ordered**4) < 3.0 * np.mean(ordered**2) ** 2:
        # Shorter tails than a normal law has: what the tolerance cuts off, and nobody's blunder.
        text = message(
            "checks.residuals-at-tolerance",
            "not judged: most residuals lie at the interior tolerance, where the fit stops; this takes the normal "
            "plot {off:.0%} off its line",
            off=off,
        )
        return Check(name, None, off, limit, "", text)
    else:
        squares = np.sort(d**2)[::-1]
        few = max(n // 50, 1)
        text = message(
            "checks.residuals-not-normal",
            "the residuals are not noise: the normal plot departs from its line by {off:.0%}, with "
            "{share:.0%} of the sum of squares from {few} of {n} points; check the worst points first",
            off=off,
            few=few,
            n=n,
            share=float(squares[:few].sum() / squares.sum()),
        )
    return Check(name, off <= limit, off, limit, "", text)
