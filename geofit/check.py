"""The check before stitching: sigma against epsilon, and what sigma cannot see (paper, sec. 3.3; eq. 3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geofit.accuracy import Accuracy, Check, Conflict, Group, Seam
from geofit.distance import project
from geofit.seams import seams
from geofit.surface import HorizonSurface

__all__ = ["check", "sigma"]

Floats = NDArray[np.float64]

#: Limits that a sound surface keeps (METHOD, sec. 4 to 7).
CORE_LIMIT, GAP_LIMIT, ANGLE_LIMIT = 1e-6, 1e-6, 0.1
#: How far beyond the range of the data an elevation may go, as a share of that range.
RANGE_SHARE = 0.5


def sigma(residuals: Floats) -> float:
    """Return sqrt(sum d_i^2 / (n - 1)), eq. 3; for one point its |d|.

    Examples
    --------
    >>> round(sigma(np.array([0.3, -0.4])), 12)
    0.5
    """
    if len(residuals) == 0:
        return 0.0
    return float(np.sqrt(np.square(residuals).sum() / max(len(residuals) - 1, 1)))


def check(surface: HorizonSurface, conflicts: Sequence[Conflict] = (), notes: Sequence[str] = ()) -> Accuracy:
    """Measure every original point against the surface, and look at the surface itself.

    Parameters
    ----------
    surface : HorizonSurface
        The fit; its ``core`` marks the points that it must meet exactly.
    conflicts : sequence of Conflict
        Points that gave way before the fit. Their residuals count in sigma like all others.
    notes : sequence of str
        What the fit has to say.
    """
    points, settings = surface.points, surface.settings
    projection = project(surface.patches, points.xyz - surface.origin)
    d = projection.distance
    names = np.array([patch.name for patch in surface.patches])
    patch = names[projection.patch] if len(d) else np.empty(0, dtype=names.dtype)
    found = seams(surface.patches)
    value = sigma(d)
    magnitude = np.abs(d)
    over = {
        f"interior tolerance {settings.interior_tolerance:g} m": int((magnitude > settings.interior_tolerance).sum()),
        f"epsilon {settings.epsilon:g} m": int((magnitude > settings.epsilon).sum()),
    }
    given_way = np.zeros(len(d), bool)
    given_way[[conflict.dropped for conflict in conflicts]] = True
    return Accuracy(
        n=len(d),
        sigma=value,
        epsilon=settings.epsilon,
        passed=value < settings.epsilon,
        max_abs=float(magnitude.max(initial=0.0)),
        mean=float(d.mean()) if len(d) else 0.0,
        residuals=d,
        patch=patch,
        by_patch=_groups(d, patch),
        by_kind=_groups(d, points.kind),
        by_hole=_groups(d, points.hole),
        by_section=_groups(d, points.section),
        over=over,
        worst=tuple(int(i) for i in np.argsort(-magnitude, kind="stable")[:20]),
        seams=found,
        checks=tuple(_checks(surface, d, found, ~given_way)),
        conflicts=tuple(conflicts),
        notes=tuple(notes),
    )


def _groups(d: Floats, labels: NDArray[np.str_]) -> dict[str, Group]:
    groups = {}
    for label in dict.fromkeys(labels.tolist()):
        if label:
            part = d[labels == label]
            groups[label] = Group(len(part), sigma(part), float(np.abs(part).max()), float(part.mean()))
    return groups


def _checks(surface: HorizonSurface, d: Floats, found: tuple[Seam, ...], honoured: NDArray[np.bool_]) -> list[Check]:
    settings = surface.settings
    checks = []
    exact = surface.core & honoured if len(surface.core) == len(d) else np.zeros(len(d), bool)
    if exact.any():
        worst = float(np.abs(d[exact]).max())
        checks.append(
            Check(
                "core",
                worst <= CORE_LIMIT,
                worst,
                CORE_LIMIT,
                "m",
                f"{exact.sum()} core points on the surface",
            )
        )
    loose = ~exact
    if loose.any():
        worst = float(np.abs(d[loose]).max())
        count = int((np.abs(d[loose]) > settings.interior_tolerance).sum())
        text = f"{count} of {loose.sum()} approximated points beyond the interior tolerance"
        checks.append(Check("interior tolerance", count == 0, worst, settings.interior_tolerance, "m", text))
    if found:
        gap = max(seam.gap for seam in found)
        limit = min(GAP_LIMIT, settings.boundary_tolerance)
        checks.append(Check("seam gap", gap <= limit, gap, limit, "m", f"largest gap of {len(found)} seams"))
        angle = max(seam.angle for seam in found)
        tangent = settings.seam == "tangent"
        text = "largest angle at a seam" if tangent else "largest angle at a seam (breaks are allowed)"
        checks.append(Check("seam angle", angle <= ANGLE_LIMIT if tangent else None, angle, ANGLE_LIMIT, "deg", text))
    checks += _shape_checks(surface)
    return checks


def _shape_checks(surface: HorizonSurface) -> list[Check]:
    """Folds and flipped normals, and elevations far outside the data's range, on a lattice of each patch."""
    low, high = np.inf, -np.inf
    normals = []
    for patch in surface.patches:
        u, v = np.meshgrid(_lattice(patch.knots_u), _lattice(patch.knots_v), indexing="ij")
        su, sv = patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1)
        lengths = np.linalg.norm(su, axis=-1) * np.linalg.norm(sv, axis=-1)
        normals.append((np.cross(su, sv) / np.maximum(lengths, 1e-300)[..., None]).reshape(-1, 3))
        z = patch.evaluate(u, v)[..., 2]
        low, high = min(low, float(z.min())), max(high, float(z.max()))
    normal = np.concatenate(normals)
    total = len(normal)
    turned = int((np.linalg.norm(normal, axis=1) < 1e-9).sum())
    if surface.fit.get("frame") != "sections":
        # A fold that is meant turns its normals; anywhere else all of them look to one side.
        upward = np.array([0.0, 0.0, 1.0]) if surface.fit.get("frame") == "map" else normal.mean(axis=0)
        turned += int((normal @ upward < 0).sum())
    checks = [Check("normals", turned == 0, turned, 0, "places", f"{turned} of {total} places folded or degenerate")]
    z = surface.points.xyz[:, 2] - surface.origin[2]
    if len(z) and np.ptp(z) > 0:
        beyond = max(float(z.min()) - low, high - float(z.max()), 0.0)
        limit = RANGE_SHARE * float(np.ptp(z))
        text = f"elevations reach {beyond:.1f} m beyond the data's range"
        checks.append(Check("elevation range", beyond <= limit, beyond, limit, "m", text))
    return checks


def _lattice(knots: Floats) -> Floats:
    """Return the ends and the middle of every span: no wiggle of one control point falls between them."""
    breaks = np.unique(knots)
    return np.sort(np.concatenate([breaks, (breaks[1:] + breaks[:-1]) / 2]))
