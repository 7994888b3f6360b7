"""Departure of the surface from the regional trend where no point holds it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geofit.checks.lattice import PatchLattice, lattice_places
from geofit.checks.residual_tests import partly
from geofit.data.accuracy import Check
from geofit.data.long_arrays import blocks, left_rows
from geofit.data.messages import message
from geofit.surfaces.protocol import FittedSurface

__all__ = ["trend"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

#: How many times the largest departure of the points from their plane the surface may show away from them.
TIMES = 2.0
#: A place is away from the points beyond so many times their mean spacing.
AWAY = 2.0
#: Fewest points of a trend; of more than the most a part tells the plane, and how far away a place is.
FEWEST, MOST = 10, 20_000
ROUNDS = 10
#: Places that are asked at a time how far they are from the points.
PART = 256
#: Points whose extent across is below this share of that along lie in a line, and tell no slope across it.
LINE = 1e-3
#: Residuals beyond so many standard deviations (by the median) count less in the plane (Huber 1964).
HUBER = 1.5
NAMED = 20


def trend(surface: FittedSurface, parts: Sequence[PatchLattice], active: Bools) -> Check | None:
    """Hold the surface where no point is near against the robust plane of the points.

    Parameters
    ----------
    surface : FittedSurface
        The surface.
    parts : sequence of Lattice
        Its places.
    active : (n,) array of bool
        Points that conflicts left.

    Returns
    -------
    Check or None
        Largest departure from the plane (m) against twice the largest that the points show, or epsilon. None
        with fewer than ten points or all in a line, for a fold (it has no plane), and where no place is away from
        the points.
    """
    given = int(active.sum())
    if given < FEWEST or surface.frame == "sections":
        return None
    where, normal = lattice_places(parts)
    if not len(where):
        return None
    many = given > MOST
    chosen = np.sort(np.random.default_rng(0).choice(given, MOST, replace=False)) if many else np.arange(given)
    points = surface.points.xyz[left_rows(active, chosen)] - surface.origin
    axes = np.eye(3) if surface.frame == "map" else _plane_axes(points, normal)
    local, there = points @ axes.T, where @ axes.T
    centre, size = local[:, :2].mean(axis=0), np.maximum(np.ptp(local[:, :2], axis=0), 1e-9)
    along, across = np.linalg.svd(local[:, :2] - centre, compute_uv=False)
    if across <= LINE * along:
        return None
    spacing = float(np.sqrt(size.prod() / len(local)))
    design = _design((local[:, :2] - centre) / size)
    plane = _robust_plane(design, local[:, 2])
    # Over all points, as heights over the plane are linear in their coordinates.
    slope = plane[1:] / size
    off_plane = axes[2] - slope @ axes[:2]
    constant = slope @ centre - plane[0]
    shown = max(
        float(np.abs((xyz[some] - surface.origin) @ off_plane + constant).max(initial=0.0))
        for xyz, some in blocks(surface.points.xyz, active)
    )
    off = np.abs(there[:, 2] - _design((there[:, :2] - centre) / size) @ plane)
    limit = max(TIMES * shown, surface.settings.epsilon)
    worst = _worst_away(off, there[:, :2], cKDTree(local[:, :2]), AWAY * spacing, limit)
    if not len(worst):
        return None
    value = float(off[worst[0]])
    place = where[worst] + surface.origin
    figures = {"value": value, "shown": shown, "x": place[0, 0], "y": place[0, 1]}
    if value <= limit:
        text = message(
            "checks.surface-near-trend",
            "away from the points the surface departs from their plane by {value:.1f} m, the points themselves by "
            "{shown:.1f} m",
            **figures,
        )
        return Check("trend", True, value, limit, "m", partly(text, len(local), given))
    text = message(
        "checks.surface-runs-away",
        "the surface runs away where no point constrains it: {value:.1f} m from the regional "
        "trend at {x:.0f}, {y:.0f}, where the points depart from it by {shown:.1f} m at most; "
        "do not use it there without further points",
        **figures,
    )
    named = tuple((float(a), float(b), float(c)) for a, b, c in place[:NAMED])
    return Check("trend", False, value, limit, "m", partly(text, len(local), given), named)


def _worst_away(off: Floats, plan: Floats, points: cKDTree, reach: float, limit: float) -> Ints:
    """Return the places beyond ``reach`` of all points with the largest departures, the largest first.

    Those beyond the limit, up to ``NAMED``, or the one place that departs most; the search ends with them.
    """
    order = np.argsort(-off, kind="stable")
    found: list[Ints] = []
    for part in np.split(order, range(PART, len(order), PART)):
        away = part[points.query(plan[part])[0] > reach]
        found.append(away)
        worst = np.concatenate(found)
        if len(worst) and (off[part[-1]] <= limit or len(worst) >= NAMED):
            break
    return np.concatenate([worst[:1], worst[1:][off[worst[1:]] > limit]])[:NAMED]


def _plane_axes(points: Floats, normal: Floats) -> Floats:
    """Rows: two axes in the points' plane, and its normal; over the map where the surface is no steeper than 55."""
    mean = normal.mean(axis=0)
    if abs(mean[2]) > np.cos(np.radians(55.0)) * max(float(np.linalg.norm(mean)), 1e-300):
        return np.eye(3)
    return np.asarray(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2])


def _design(plan: Floats) -> Floats:
    return np.column_stack([np.ones(len(plan)), plan])


def _robust_plane(design: Floats, height: Floats) -> Floats:
    """Least squares reweighted by Huber's function."""
    weight = np.ones(len(height))
    for _ in range(ROUNDS):
        plane = np.linalg.lstsq(design * weight[:, None], height * weight, rcond=None)[0]
        off = np.abs(height - design @ plane)
        spread = max(1.4826 * float(np.median(off)), 1e-9)
        weight = np.sqrt(np.minimum(1.0, HUBER * spread / np.maximum(off, 1e-300)))
    return np.asarray(plane)
