"""The prediction error of the real sets: holes left out by linear algebra, compared with thin plate and kriging."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan

from geofit import FitSettings, GeofitError, HorizonFit, PointSet, fit_horizon
from geofit.data.prediction import PredictionResult
from geofit.prediction.examine import examine

from .crps import FEWEST, no_worse, process_score, score_of
from .why import metres

__all__ = ["CLEARLY", "PREDICTION", "Off", "field_alone", "lost", "off_cells", "prediction", "summary", "why_lost"]

PREDICTION = (
    "set", "tolerance, m", "left out", "geofit, m", "thin plate, m", "kriging, m", "inside 90 %", "before", "factor",
    "outliers", "CRPS, m", "of a GP, m",
)  # fmt: skip
#: geofit counts as no worse than another method up to this many times its error.
CLEARLY = 1.02
#: Shares of left-out points inside the 90 % band between which the band counts as held.
HELD = (0.85, 0.95)


@dataclass(frozen=True)
class Off:
    """What leaving out hole by hole found; ``alone`` is the error of the regional field alone, where it was asked.

    ``raw`` and ``inside`` are the shares inside the 90 % band before and after it was held to the errors, ``factor``
    by how much that changed the standard deviation. ``crps`` and ``gp_crps`` score the predicted distribution and that
    of a dense Gaussian process (:mod:`realdata.crps`) where there are holes enough.
    """

    groups: int
    rms: float
    peers: tuple[tuple[str, float], ...]
    inside: float
    raw: float
    factor: float
    outliers: int
    core: int
    energy: str
    alone: float = nan
    alone_energy: str = ""
    notes: tuple[str, ...] = ()
    crps: float = nan
    gp_crps: float = nan

    @property
    def best(self) -> tuple[str, float]:
        """Name and error of the better of the other methods."""
        return min(self.peers, key=lambda peer: peer[1])


def prediction(surface: HorizonFit, found: PredictionResult | None) -> Off | None:
    """Take the figures of the page from an examination; None where there is nothing to show."""
    holes = next((one for one in found.left_out if one.scheme == "hole"), None) if found else None
    if found is None or holes is None:
        return None
    factor = found.uncertainty.factor if found.uncertainty else nan
    scored = holes.groups >= FEWEST
    return Off(
        holes.groups, holes.rms, tuple(holes.references.items()), holes.inside, holes.inside_raw, factor,
        len(found.outliers), int(surface.core.sum()), str(surface.diagnostics.get("energy", "")), notes=found.notes,
        crps=score_of(holes.error, holes.sd) if scored else nan,
        gp_crps=process_score(surface, holes) if scored else nan,
    )  # fmt: skip


def lost(off: Off) -> bool:
    """Return whether another method is clearly nearer to the holes left out."""
    return bool(off.peers) and off.rms > CLEARLY * off.best[1]


def field_alone(off: Off, points: PointSet, settings: FitSettings, boundary: object) -> Off:
    """Add the error of the regional field alone (no point pulled, no core) where another method is nearer."""
    if not lost(off):
        return off
    try:
        surface = fit_horizon(points, replace(settings, core="none", max_iterations=0), boundary)
    except GeofitError:
        return off
    alone = prediction(surface, examine(surface))
    return off if alone is None else replace(off, alone=alone.rms, alone_energy=alone.energy)


def off_cells(title: str, tolerance: float, off: Off) -> list[str]:
    """Return a row of the table."""
    peers = dict(off.peers)
    return [
        title, f"{tolerance:g}", str(off.groups), metres(off.rms),
        *(metres(peers[name]) if name in peers else "–" for name in ("thin plate", "kriging")),
        _percent(off.inside), _percent(off.raw), f"{off.factor:.2f}" if isfinite(off.factor) else "–",
        str(off.outliers), *(metres(one) if isfinite(one) else "–" for one in (off.crps, off.gp_crps)),
    ]  # fmt: skip


def why_lost(off: Off) -> str:
    """Say what does not hold, and what the field alone shows to be the reason; empty where all holds."""
    words = []
    if lost(off):
        name, best = off.best
        words.append(f"{off.rms / best:.2f} x the error of {name}; {_reason(off, best)}")
    if isfinite(off.gp_crps) and not no_worse(off.crps, off.gp_crps, CLEARLY):
        words.append(f"a CRPS {off.crps / off.gp_crps:.2f} x that of a Gaussian process")
    if isfinite(off.inside) and not HELD[0] <= round(off.inside, 2) <= HELD[1]:
        words.append(f"{_percent(off.inside)} of {off.groups} holes lie inside the 90 % band")
    return "; ".join(words)


def _reason(off: Off, best: float) -> str:
    if not isfinite(off.alone):
        return "the field alone could not be laid"
    exact = "keeping the core exact and each other point within its tolerance" if off.core else (
        "bringing each point within its tolerance"
    )  # fmt: skip
    if off.alone <= CLEARLY * best:
        return f"{exact} costs it; the field alone misses by {metres(off.alone)} m"
    if off.alone < 0.97 * off.rms:
        return f"{exact} costs part of it; the field alone misses by {metres(off.alone)} m, {off.alone / best:.2f} x"
    return (
        f"not for the tolerance: the field alone, energy '{off.alone_energy}', misses by {metres(off.alone)} m too; "
        "the likelihood chose an energy and a smoothing that predict these points less well"
    )


def summary(offs: Sequence[Off]) -> str:
    """Count on how many horizons geofit is no worse, and on how many the band holds."""
    judged = [off for off in offs if off.peers]
    won = sum(not lost(off) for off in judged)
    each = {
        name: sum(off.rms <= CLEARLY * dict(off.peers)[name] for off in judged) for name in ("thin plate", "kriging")
    }
    held = sum(HELD[0] <= round(off.inside, 2) <= HELD[1] for off in judged)
    scored = [off for off in offs if isfinite(off.gp_crps)]
    better = sum(no_worse(off.crps, off.gp_crps, CLEARLY) for off in scored)
    return (
        f"Of {len(judged)} lines, geofit's error is at most {CLEARLY:g} times that of the better of the two on {won}, "
        f"that of the thin plate on {each['thin plate']}, that of kriging on {each['kriging']}. On {held} the 90 % "
        "band holds 85 to 95 % of the holes left out. The continuous ranked probability score is at most "
        f"{CLEARLY:g} times that of a dense Gaussian process on {better} of the {len(scored)} lines with at least "
        f"{FEWEST} holes."
    )


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if isfinite(share) else "–"
