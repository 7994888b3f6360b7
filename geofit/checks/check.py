"""The check before stitching: sigma against epsilon, and what sigma cannot see (paper, sec. 3.3; eq. 3)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.checks.lattice import lattices
from geofit.checks.oscillation import oscillation
from geofit.checks.outside import BEYOND, beyond_by, beyond_check, continued
from geofit.checks.residual_tests import by_label, residual_checks
from geofit.checks.selfcross import self_crossing
from geofit.checks.shape import shape_checks
from geofit.checks.trend import trend
from geofit.data.accuracy import Accuracy, Check, Conflict, Exceedance, Group, Seam
from geofit.data.allowance import accuracies, allowance, any_coarse
from geofit.data.guard import guarded
from geofit.data.labels import Labels
from geofit.data.long_arrays import blocks, left_rows
from geofit.data.messages import Message, message
from geofit.data.threads import alongside, one_thread
from geofit.geometry.projection import Projection, project
from geofit.geometry.seams import seams
from geofit.surfaces.protocol import FittedSurface

__all__ = ["check", "judged_by", "sigma"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Codes = NDArray[np.int32]
#: Checks, and why others were not made.
Examined = tuple[list[Check], list[Message]]

#: Limits that a sound surface keeps (METHOD, sec. 4 to 7).
CORE_LIMIT, GAP_LIMIT, ANGLE_LIMIT = 1e-6, 1e-6, 0.1
#: The check of a surface's elevations against those of its data.
RANGE = "elevation range"
#: The check whose limit depends on the control error.
TREND = "trend"
#: Points with the largest distances that are named.
WORST = 20
#: Points that are measured together: their nearest places take more memory than they do.
STEP = 1 << 17


def sigma(residuals: Floats) -> float:
    """Return sqrt(sum d_i^2 / (n - 1)), eq. 3; for one point its |d|.

    Examples
    --------
    >>> round(sigma(np.array([0.3, -0.4])), 12)
    0.5
    """
    if len(residuals) == 0:
        return 0.0
    squares = sum(float(np.square(part).sum()) for (part,) in blocks(residuals))
    return float(np.sqrt(squares / max(len(residuals) - 1, 1)))


def check(
    surface: FittedSurface,
    conflicts: Sequence[Conflict] = (),
    notes: Sequence[Message] = (),
    *,
    projection: Projection | None = None,
) -> Accuracy:
    """Measure every original point against the surface, and look at the surface itself.

    Parameters
    ----------
    surface : FittedSurface
        The fit; its ``core`` marks the points that it must meet exactly. Without patches (triangles of a file) the
        surface itself is not looked at.
    conflicts : sequence of Conflict
        Points that were dropped before the fit. Their residuals count in sigma like all others, and so do those of
        points outside the outline, which are measured to the surface as it continues there.
    notes : sequence of str
        What the fit has to say.
    projection : Projection, optional
        The points' nearest places where they are known already, or are not those of whole patches.
    """
    points, settings = surface.points, surface.settings
    active = np.ones(len(points), bool)
    active[[conflict.dropped for conflict in conflicts]] = False
    # The systems of a few points each are small: starting threads for them costs more than the work.
    with one_thread():
        d, codes, of_surface = _measured(surface, active, projection)
        patch = Labels(codes, tuple(one.name for one in surface.patches) or (surface.name,))
        joined = seams(surface.patches)
        exact = surface.core & active if len(surface.core) == len(d) else np.zeros(len(d), bool)
        at_points = _examined(
            (
                lambda: _lost_core(surface),
                lambda: _tolerance_checks(surface, d, exact),
                lambda: _seam_checks(surface, joined),
                lambda: _residual_checks(surface, d, patch, active & ~exact),
            )
        )
        between = of_surface()
    value = sigma(d)
    beyond = _beyond_surface(surface, d, value, projection)
    checks, missing = [*at_points[0], *beyond, *between[0]], [*at_points[1], *between[1]]
    over = {
        name: Exceedance(limit, _beyond(d, limit))
        for name, limit in (("interior_tolerance", settings.interior_tolerance), ("epsilon", settings.epsilon))
    }
    return Accuracy(
        n=len(d),
        sigma=value,
        epsilon=settings.epsilon,
        passed=value < settings.epsilon and not _runs_away(surface, checks),
        max_abs=_largest(d),
        mean=float(d.mean()) if len(d) else 0.0,
        residuals=d,
        patch=patch.words(),
        by_patch=_groups(d, patch),
        by_kind=_groups(d, points.labels["kind"]),
        by_hole=_groups(d, points.labels["hole"]),
        by_section=_groups(d, points.labels["section"]),
        over=over,
        worst=_worst(d),
        seams=joined,
        checks=tuple(checks),
        conflicts=tuple(conflicts),
        notes=(*notes, *missing),
    )


def judged_by(surface: FittedSurface, accuracy: Accuracy, epsilon: float) -> Accuracy:
    """Return a check with another control error: the surface and its residuals are the same.

    Parameters
    ----------
    surface : FittedSurface
        The surface of the check, with ``epsilon`` in its settings.
    accuracy : Accuracy
        Its check by the former control error.
    epsilon : float
        The control error, metres.
    """
    checks = tuple(_judged_by(surface, accuracy, one) for one in accuracy.checks)
    passed = accuracy.sigma < epsilon and not _runs_away(surface, checks)
    beyond = Exceedance(epsilon, _beyond(accuracy.residuals, epsilon))
    notes = tuple(note for note in accuracy.notes if not (passed and note.code == "fitting.sigma-above-epsilon"))
    return replace(
        accuracy, epsilon=epsilon, passed=passed, over={**accuracy.over, "epsilon": beyond}, checks=checks, notes=notes
    )


def _judged_by(surface: FittedSurface, accuracy: Accuracy, former: Check) -> Check:
    """Return a check as another control error has it."""
    if former.name == BEYOND:
        return beyond_by(former, accuracy.sigma, surface.settings.epsilon)
    return _trend_by(surface, accuracy, former) if former.name == TREND else former


def _trend_by(surface: FittedSurface, accuracy: Accuracy, former: Check) -> Check:
    """Return the trend's check, whose limit is epsilon at least; measured again where the limit was epsilon itself."""
    epsilon = surface.settings.epsilon
    if former.passed is None:
        return former
    if former.limit > accuracy.epsilon or epsilon >= former.limit:
        limit = max(epsilon, former.limit if former.limit > accuracy.epsilon else 0.0)
        return replace(former, limit=limit, passed=former.value <= limit)
    active = np.ones(accuracy.n, bool)
    active[[conflict.dropped for conflict in accuracy.conflicts]] = False
    return trend(surface, lattices(surface), active) or former


def _groups(d: Floats, labels: Labels) -> dict[str, Group]:
    return {
        label: Group(len(part), sigma(part), _largest(part), float(part.mean()))
        for label, part in by_label(d, labels).items()
        if label
    }


def _measured(
    surface: FittedSurface, active: NDArray[np.bool_], projection: Projection | None
) -> tuple[Floats, Codes, Callable[[], Examined]]:
    """Return distances and patch numbers of a surface's points, and what returns the checks of the surface itself.

    Of many points the nearest places are not held, and those of a few are looked up again: so the surface itself is
    examined at the same time.
    """
    points, patches = surface.points, surface.patches

    def feet_of(rows: Ints | slice) -> Projection:
        return project(patches, points.xyz[rows] - surface.origin)

    if projection is not None or len(points) <= STEP:
        found = feet_of(slice(None)) if projection is None else projection
        of_surface = _surface_checks(surface, found.__getitem__, active)
        return found.distance, found.patch.astype(np.int32), lambda: _examined(of_surface)
    examined = alongside(lambda: _examined(_surface_checks(surface, feet_of, active)))
    d, codes = np.empty(len(points)), np.zeros(len(points), np.int32) if len(patches) > 1 else _zeros(len(points))
    for start in range(0, len(points), STEP):
        part = slice(start, start + STEP)
        found = feet_of(part)
        d[part] = found.distance
        if len(patches) > 1:
            codes[part] = found.patch
    return d, codes, examined


def _examined(examinations: Sequence[Callable[[], Sequence[Check]]]) -> Examined:
    """Return the checks that examinations make, and why others were not made."""
    checks: list[Check] = []
    missing: list[Message] = []
    for examine in examinations:
        checks += guarded(
            examine,
            (),
            lambda reason: missing.append(
                message("checks.check-not-made", "a check was not made: {reason}", reason=reason)
            ),
        )
    return checks, missing


def _zeros(n: int) -> Codes:
    """Return the code of the only patch for n points, held once."""
    return np.broadcast_to(np.int32(0), (n,))


def _largest(d: Floats) -> float:
    return float(max(d.max(), -d.min())) if len(d) else 0.0


def _beyond(d: Floats, limit: float) -> int:
    return sum(int((np.abs(part) > limit).sum()) for (part,) in blocks(d))


def _worst(d: Floats) -> tuple[int, ...]:
    """Return the points with the largest distances, the largest first, equal ones in their order."""
    rows, start = np.empty(0, np.int64), 0
    for (part,) in blocks(d):
        magnitude = np.abs(part)
        least = np.partition(magnitude, -WORST)[-WORST] if len(part) > WORST else 0.0
        some = np.flatnonzero(magnitude >= least)
        rows = np.concatenate([rows, start + some[np.argsort(-magnitude[some], kind="stable")[:WORST]]])
        start += len(part)
    return tuple(rows[np.argsort(-np.abs(d[rows]), kind="stable")[:WORST]].tolist())


def _beyond_surface(surface: FittedSurface, d: Floats, value: float, projection: Projection | None) -> list[Check]:
    """Count the points that the surface does not reach; the edge is looked at where the projection marks it."""
    edge = None if projection is None else projection.beyond
    out = continued(surface)
    beyond = out if edge is None else out | edge
    if edge is None and not out.any():
        return []
    at_edge = 0 if edge is None else int(edge.sum())
    within = sigma(d[~beyond])
    return [beyond_check(int(beyond.sum()) - at_edge, at_edge, len(d), value, within, surface.settings.epsilon)]


def _runs_away(surface: FittedSurface, checks: Sequence[Check]) -> bool:
    """Whether a fit runs far beyond its data, which no sigma shows; a surface of a file may reach beyond the points."""
    return surface.frame != "" and any(one.passed is False for one in checks if one.name == RANGE)


def _lost_core(surface: FittedSurface) -> list[Check]:
    """Warn of a dense core whose points are approximated."""
    if surface.partition is None or not surface.partition.lost:
        return []
    text = message(
        "checks.core-not-interpolated",
        "the dense core is not interpolated: {reason}",
        reason=surface.partition.reason,
    )
    return [Check("core", False, 1.0, 0.0, "", text)]


def _tolerance_checks(surface: FittedSurface, d: Floats, exact: NDArray[np.bool_]) -> list[Check]:
    """Check whether the core's points are on the surface, and the other ones within the interior tolerance."""
    checks, tolerance = [], surface.settings.interior_tolerance
    if exact.any():
        worst = float(np.abs(d[exact]).max())
        text = message("checks.core-points-on-surface", "core points on the surface: {count}", count=int(exact.sum()))
        checks.append(Check("core", worst <= CORE_LIMIT, worst, CORE_LIMIT, "m", text))
    loose = ~exact
    if loose.any():
        apart = d[loose] if exact.any() else d
        worst = _largest(apart)
        figures = {"count": _beyond(apart, tolerance), "total": len(apart)}
        text = message(
            "checks.points-beyond-tolerance",
            "{count} of {total} points beyond the interior tolerance",
            **figures,
        )
        if surface.partition is not None:
            text = message(
                "checks.approximated-beyond-tolerance",
                "{count} of {total} approximated points beyond the interior tolerance",
                **figures,
            )
        limit = surface.diagnostics.get("noise_limit", tolerance)
        accuracy = accuracies(surface.points, surface.diagnostics.get("sources", {}))
        stated = figures["count"] > 0 and any_coarse(accuracy, tolerance)
        if stated:
            stated = bool((np.abs(apart) <= allowance(accuracy[loose], tolerance, limit)).all())
        noisy = not stated and figures["count"] > 0 and tolerance < worst <= limit
        if stated:
            text = message(
                "checks.beyond-tolerance-as-stated",
                "{count} of {total} points beyond the interior tolerance, as their accuracy (stated, or found for "
                "their kind) predicts",
                **figures,
            )
        if noisy:
            noise = float(surface.diagnostics["noise"])
            text = message(
                "checks.approximated-beyond-tolerance-as-noise",
                "{count} of {total} approximated points beyond the interior tolerance, as noise of {noise:.3g} m "
                "predicts",
                noise=noise,
                **figures,
            )
        within = figures["count"] == 0 or noisy or stated
        checks.append(Check("interior tolerance", within, worst, tolerance, "m", text))
    return checks


def _seam_checks(surface: FittedSurface, found: tuple[Seam, ...]) -> list[Check]:
    if not found:
        return []
    gap, angle = max(seam.gap for seam in found), max(seam.angle for seam in found)
    limit = min(GAP_LIMIT, surface.settings.boundary_tolerance)
    tangent = surface.settings.seam == "tangent"
    gaps = message("checks.largest-seam-gap", "largest gap of the seams ({count})", count=len(found))
    angles = (
        message("checks.largest-seam-angle", "largest angle at a seam")
        if tangent
        else message("checks.largest-seam-angle-breaks-allowed", "largest angle at a seam (breaks are allowed)")
    )
    return [
        Check("seam gap", gap <= limit, gap, limit, "m", gaps),
        Check("seam angle", angle <= ANGLE_LIMIT if tangent else None, angle, ANGLE_LIMIT, "deg", angles),
    ]


def _residual_checks(surface: FittedSurface, d: Floats, patch: Labels, loose: NDArray[np.bool_]) -> list[Check]:
    """Test the residuals of the approximated points: a core's are zero by construction."""
    if not loose.any():
        return []
    if not loose.all():
        patch, d = patch[loose], d[loose]

    def places(rows: Ints) -> Floats:
        return np.asarray(surface.points.xyz[left_rows(loose, rows)] - surface.origin)

    return residual_checks(places, d, patch, surface.settings.interior_tolerance)


def _surface_checks(
    surface: FittedSurface, feet_of: Callable[[Ints], Projection], active: NDArray[np.bool_]
) -> tuple[Callable[[], Sequence[Check]], ...]:
    """Return what looks at the surface itself, at and between its points."""
    if not surface.patches:
        return ()
    parts = lattices(surface)

    def asked(found: Check | None) -> Sequence[Check]:
        return () if found is None else (found,)

    return (
        lambda: shape_checks(surface, parts),
        lambda: asked(self_crossing(surface, parts)),
        lambda: asked(oscillation(surface, parts, feet_of, active)),
        lambda: asked(trend(surface, parts, active)),
    )
