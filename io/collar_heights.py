"""Elevations of collars that contradict the ground or the collars around them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geofit.data.messages import message
from geofit.data.site import Ground
from geofit.io.rows import Rows

__all__ = ["check_heights"]

Floats = NDArray[np.float64]

#: A collar is off the ground by more than this many times the usual distance, and at least so many metres; all are off
#: where the median is.
GROUND_SPREAD, GROUND_LEAST = 8.0, 5.0
#: A collar is off its neighbours, of which so many are compared, if it lies outside their elevations by more than these
#: differ, this many times the usual difference per distance, and at least so many metres.
NEAR_SPREAD, NEAR_LEAST, NEAREST = 12.0, 20.0, 8
#: An elevation tilts the plane of the collars if it lies off it by more than so many times the usual distance; this
#: share of the elevations stays in any case.
TILTING, FEWEST = 8.0, 0.8
#: Where more than this share of the collars is off, one warning counts them.
FEW = 0.05


def check_heights(rows: Rows, x: Floats, y: Floats, z: Floats, ground: Ground | None) -> None:
    """Warn of collars far above or below the ground, or, where there is none, the collars around them."""
    used = np.flatnonzero(rows.ok)
    if ground is None and len(used) > 1 and not z[used].any():
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.collars-all-at-zero",
                "The elevation of all {count} collars is 0: depths become elevations below 0, and the relief of the "
                "ground becomes one of the horizons",
                count=len(used),
            ),
            message("io.give-elevations-or-ground", "Give the elevations, or leave them empty and name the [ground]."),
            column=_header(rows),
        )
    if ground is not None:
        height = z[used] - ground.elevation(x[used], y[used])
        on_grid = np.isfinite(height)
        _check_ground(rows, used[on_grid], height[on_grid])
    elif len(used) > NEAREST:
        plan = np.column_stack((x[used], y[used]))
        near = np.asarray(cKDTree(plan).query(plan, k=NEAREST + 1)[1])
        # A place that several holes share may find another one in place of itself.
        others = near[near != np.arange(len(used))[:, None]]
        if others.size == NEAREST * len(used):
            flat = z[used] - _plane(plan, z[used])
            others = others.reshape(-1, NEAREST)
            # One of them may be wrong itself.
            around = np.sort(flat[others], axis=1)[:, 1:-1]
            height = flat - np.clip(flat, around[:, 0], around[:, -1])
            distance = np.linalg.norm(plan[others] - plan[:, None], axis=2).mean(axis=1)
            steepness = np.median(np.abs(flat - np.median(flat[others], axis=1)) / np.maximum(distance, 1e-9))
            allowed = np.maximum(np.ptp(around, axis=1), NEAR_SPREAD * steepness * distance)
            _check_near(rows, used, height, np.maximum(allowed, NEAR_LEAST))


def _check_ground(rows: Rows, used: NDArray[np.intp], height: Floats) -> None:
    if not used.size:
        return
    middle = float(np.median(height))
    spread = _spread(height - middle)
    if len(used) > 3 and abs(middle) > max(GROUND_LEAST, 3.0 * spread):
        rows.journal.add(
            "warning",
            rows.file,
            message(
                "io.collars-off-ground",
                "The collars lie {height:+.1f} m from the ground in the median of {count}: elevations of the two may "
                "have different zeros or units",
                height=middle,
                count=len(used),
            ),
            message("io.check-height-datum", "Check the height datum and the unit of both."),
            column=_header(rows),
        )
    else:
        middle = 0.0
    for k in np.flatnonzero(np.abs(height - middle) > max(GROUND_SPREAD * spread, GROUND_LEAST)).tolist():
        rows.warn(
            int(used[k]),
            "z",
            message("io.collar-off-ground", "The collar lies {height:+.1f} m from the ground", height=height[k]),
            message(
                "io.check-elevation-of-collar",
                "Check its elevation and place; if the hole starts underground, nothing is wrong.",
            ),
        )


def _check_near(rows: Rows, used: NDArray[np.intp], height: Floats, allowed: Floats) -> None:
    off = np.flatnonzero(np.abs(height) > allowed)
    many = len(off) > max(3, FEW * len(used))
    for k in off[: 1 if many else None].tolist():
        reason = message(
            "io.collar-off-neighbours",
            "The collar lies {height:+.1f} m outside the elevations of the {count} nearest collars",
            height=height[k],
            count=NEAREST,
        )
        if many:
            reason = message(
                "io.collars-off-neighbours",
                "{off} of {total} collars lie far above or below the nearest ones, the first by {height:+.1f} m: some "
                "may have another unit or zero",
                off=len(off),
                total=len(used),
                height=height[k],
            )
        rows.warn(
            int(used[k]),
            "z",
            reason,
            message(
                "io.check-elevation-of-collar",
                "Check its elevation and place; if the hole starts underground, nothing is wrong.",
            ),
        )


def _plane(plan: Floats, z: Floats) -> Floats:
    """Return the plane through elevations at (n, 2) places: on a slope, the nearest collars of an outer one differ.

    Least squares, again and again without the elevations that lie so far off it that they tilt it, the farthest first.
    The least sum of absolute differences would follow a dense core alone, and find the holes around it off.
    """
    terms = np.column_stack((np.ones(len(plan)), plan - plan.mean(axis=0)))
    kept = np.ones(len(z), bool)
    while True:
        plane = np.asarray(terms @ np.linalg.lstsq(terms[kept], z[kept], rcond=None)[0])
        apart = np.abs(z - plane)
        far = kept & (apart > max(TILTING * _spread(apart[kept]), 0.5 * apart[kept].max()))
        if not far.any() or (kept & ~far).sum() < FEWEST * len(z):
            return plane
        kept &= ~far


def _spread(values: Floats) -> float:
    """Return the standard deviation of the most of them, whatever the others are."""
    return 1.4826 * float(np.median(np.abs(values)))


def _header(rows: Rows) -> str:
    return rows.table.header[rows.columns["z"]] if "z" in rows.columns else "z"
