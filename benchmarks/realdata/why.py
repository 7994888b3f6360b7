"""Why geofit misses points left out by more than the thin plate does: found by trying, not by guessing."""

from __future__ import annotations

from dataclasses import dataclass, replace

from geofit import FitSettings, PointSet, fit_horizon

from .score import Errors, left_out_errors

__all__ = ["Trial", "try_out", "why", "worse"]

#: A larger error than this many times the thin plate's needs an explanation.
CLEARLY = 1.02


@dataclass(frozen=True)
class Trial:
    """Errors of the regional field alone, no point pulled and none interpolated, at its smoothing and beside it."""

    field: Errors
    stiffer: Errors
    softer: Errors
    energy: str
    frame: str


def worse(errors: Errors) -> tuple[bool, bool]:
    """Return whether geofit is clearly worse among the points compared, and over all points left out."""
    return (
        errors.ours.rms > CLEARLY * errors.plate.rms,
        errors.ours_all.rms > CLEARLY * errors.plate_all.rms,
    )


def try_out(given: PointSet, left_out: PointSet | None, settings: FitSettings) -> Trial:
    """Score the regional field alone with its own smoothing, with ten times it, and with a tenth."""
    alone = replace(settings, core="none", max_iterations=0)
    figures = fit_horizon(given, alone).diagnostics
    scored = [left_out_errors(given, left_out, alone)]
    for factor in (10.0, 0.1):
        scored.append(left_out_errors(given, left_out, replace(alone, smoothing=factor * figures["smoothing"])))
    return Trial(*scored, str(figures["energy"]), str(figures["frame"]))


def why(errors: Errors, trial: Trial) -> str:
    """Return one sentence: what the trial shows to be at fault."""
    inside, _ = worse(errors)

    def of(tried: Errors) -> float:
        return tried.ours.rms if inside else tried.ours_all.rms

    plate, ours = (errors.plate.rms, errors.ours.rms) if inside else (errors.plate_all.rms, errors.ours_all.rms)
    where = "" if inside else "only beyond the hull of the given points, where every surface is extrapolated: "
    field, stiffer, softer = of(trial.field), of(trial.stiffer), of(trial.softer)
    if trial.frame == "best-plane":
        return (
            f"{where}the points dip so steeply that the surface lies over its best plane: what it keeps small is the "
            "distance across it, which the error in elevation exceeds many times."
        )
    if field <= CLEARLY * plate:
        return (
            f"{where}bringing each point within its tolerance (or onto the core) costs it; the regional field alone, "
            f"which does neither, misses by {metres(field)} m."
        )
    if field < 0.9 * ours:
        return (
            f"{where}bringing each point within its tolerance (or onto the core) costs part of it; the regional field "
            f"alone misses by {metres(field)} m."
        )
    if min(stiffer, softer) < 0.97 * min(field, ours):
        times, chosen = ("ten times", "little") if stiffer < softer else ("a tenth of", "much")
        return (
            f"{where}the likelihood smooths too {chosen} for these points: the regional field with {times} its "
            f"smoothing would miss by {metres(min(stiffer, softer))} m."
        )
    tried = (
        f"{where}no smoothing helps (the regional field misses by {metres(field)} m, with ten times its smoothing by "
        f"{metres(stiffer)} m, with a tenth by {metres(softer)} m): "
    )
    if trial.energy == "plate":
        return (
            f"{tried}its energy is the thin plate's, but taken over the study area alone instead of the whole plane, "
            "and on a net of control points instead of one function a point."
        )
    return f"{tried}the energy '{trial.energy}' itself suits these points less than the thin plate's."


def metres(value: float) -> str:
    """Return about three significant digits, down to a tenth of a millimetre."""
    return (
        f"{value:.4f}"
        if value < 0.1
        else f"{value:.2f}"
        if value < 10
        else f"{value:.1f}"
        if value < 100
        else f"{value:.0f}"
    )
