"""One horizon's result: what the reports are made from, and its JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import geofit
from geofit.checks.storage import Storage
from geofit.data.accuracy import Accuracy, Check, ReadBack, Seam, plain
from geofit.data.files import replacing
from geofit.data.messages import Message
from geofit.data.points import PointSet
from geofit.data.prediction import OffData
from geofit.data.site import ImportIssue, Site
from geofit.data.verdict import Verdict, verdict_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.report.profile import Profile

__all__ = ["HorizonResult", "horizon_data", "sigma_of", "write_json"]


@dataclass(frozen=True, eq=False)
class HorizonResult:
    """A fitted and checked horizon with everything that its report says.

    Parameters
    ----------
    surface : HorizonFit
        With its accuracy.
    site : Site
        Where the points come from: holes, sections, issues, counts, hashes.
    read_back : ReadBack or None
        What the reader found in the STEP file; None if no file was written.
    storage : Storage or None
        Points that a TIN and a grid need for the same surface.
    step_bytes : int
        Size of the STEP file.
    seconds : mapping of str to float
        Time of each stage.
    offdata : OffData or None
        The surface away from its data; None: not examined.
    profiles : mapping of str to tuple of Profile
        What the sections of the report cut, by the section's name.
    excluded : PointSet or None
        Points that a person left out of the fit.
    edits : tuple of Message
        Changes by hand after the fit, in their order.
    orders : tuple of Check
        How the horizon lies to its neighbours (:meth:`geofit.site.order.Order.check`).
    """

    surface: HorizonFit
    site: Site
    read_back: ReadBack | None = None
    storage: Storage | None = None
    step_bytes: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    offdata: OffData | None = None
    profiles: Mapping[str, tuple[Profile, ...]] = field(default_factory=dict, repr=False)
    excluded: PointSet | None = None
    edits: tuple[Message, ...] = ()
    orders: tuple[Check, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The verdict with its three lamps."""
        return verdict_of(self.accuracy, self.offdata, self.read_back, self.orders)

    @property
    def name(self) -> str:
        """Name of the horizon."""
        return self.surface.name

    @property
    def accuracy(self) -> Accuracy:
        """The check of the surface; a surface without one is a mistake of the caller."""
        if self.surface.accuracy is None:
            raise ValueError(f"horizon '{self.name}' has not been checked; fit_horizon() does that.")
        return self.surface.accuracy

    @property
    def core(self) -> NDArray[np.bool_]:
        """Which points are interpolated exactly, (n,)."""
        core = self.surface.core
        return core if len(core) == self.accuracy.n else np.zeros(self.accuracy.n, bool)

    @property
    def dropped(self) -> dict[int, Message]:
        """Points that were not fitted, and why (conflicts settled by accuracy)."""
        return {int(c.dropped): c.text for c in self.accuracy.conflicts}

    @property
    def sound(self) -> bool:
        """Whether sigma < epsilon and no check failed, in memory and in the file."""
        a, back = self.accuracy, self.read_back
        return a.passed and all(c.passed is not False for c in a.checks) and (back is None or back.passed)

    @property
    def rejected(self) -> tuple[ImportIssue, ...]:
        """Rows that the readers did not use, of the files that this horizon's points come from."""
        files = set(self.surface.points.file.tolist())
        return tuple(i for i in self.site.issues if i.severity == "error" and i.file in files)


def horizon_data(result: HorizonResult) -> dict[str, Any]:
    """Return what ``<horizon>.json`` holds: numbers, words, lists and mappings only; nan becomes null."""
    surface, a, core = result.surface, result.accuracy, result.core
    points = surface.points
    d = np.abs(a.residuals)
    out, within = d[~core], d[~core] <= surface.settings.interior_tolerance
    partition = surface.partition
    data = {
        "horizon": surface.name,
        "n_points": a.n,
        "n_used": a.n - len(result.dropped),
        "n_core": int(core.sum()),
        "n_periphery": int((~core).sum()),
        "epsilon": a.epsilon,
        "sigma": a.sigma,
        "max_abs": a.max_abs,
        "mean": a.mean,
        "verdict": result.verdict.word,
        "lamps": {lamp.title.code: plain(lamp) for lamp in result.verdict.lamps},
        "sound": result.sound,
        "over": a.over,
        "core": {"n": int(core.sum()), "max_abs": d[core].max() if core.any() else None},
        "periphery": {
            "n": int((~core).sum()),
            "sigma": sigma_of(out),
            "max_abs": out.max() if len(out) else None,
            "share_within_interior_tolerance": within.mean() if len(out) else None,
        },
        "partition": partition,
        "by_patch": a.by_patch,
        "by_kind": a.by_kind,
        "by_hole": a.by_hole,
        "by_section": a.by_section,
        "worst": [{"index": i, "point": points.describe(i), "residual": a.residuals[i]} for i in a.worst],
        "seams": [_seam(s) for s in a.seams],
        "patches": [
            {"name": p.name, "degree": p.degree, "n_control": p.control.shape[0] * p.control.shape[1]}
            for p in surface.patches
        ],
        "checks": [{"name": c.name, "ok": c.passed, "detail": c.text} for c in a.checks],
        "conflicts": [
            {
                "kept": points.describe(c.kept),
                "dropped": points.describe(c.dropped),
                "difference": c.difference,
                "text": c.text,
            }
            for c in a.conflicts
        ],
        "rejected": result.rejected,
        "notes": a.notes,
        "read_back": _read_back(result.read_back),
        "storage": {
            "control_points": surface.control_points,
            "step_bytes": result.step_bytes,
            "tolerance": result.storage and result.storage.tolerance,
            "tin_points_equal_accuracy": result.storage and result.storage.tin_points,
            "grid_points_equal_accuracy": result.storage and result.storage.grid_points,
        },
        "fit": {key: value for key, value in surface.diagnostics.items() if key != "seconds"},
        "seconds": result.seconds,
        "inputs": [{"file": f, "sha256": h} for f, h in result.site.inputs.items()],
        "rows": result.site.counts,
        "settings": surface.settings,
        "crs": result.site.crs,
        "version": geofit.__version__,
    }
    return dict(plain(data))


def write_json(result: HorizonResult, path: Path) -> None:
    """Write the data of a horizon as JSON (UTF-8)."""
    with replacing(path) as part:
        part.write_text(json.dumps(horizon_data(result), ensure_ascii=False, indent=1) + "\n", encoding="utf-8")


def sigma_of(d: NDArray[np.float64]) -> float | None:
    """Return sigma of eq. 3 over a part of the points, metres; None for less than two."""
    return float(np.sqrt((d**2).sum() / (len(d) - 1))) if len(d) > 1 else None


def _seam(seam: Seam) -> dict[str, Any]:
    return {"a": seam.first, "b": seam.second, "max_gap": seam.gap, "max_angle_deg": seam.angle}


def _read_back(back: ReadBack | None) -> dict[str, Any] | None:
    if back is None:
        return None
    return {f.name: getattr(back, f.name) for f in fields(back)} | {
        "valid": back.brep_valid,
        "passed": back.passed,
        "seams": [_seam(s) for s in back.seams],
        "checks": [{"name": c.name, "ok": c.passed, "detail": c.text} for c in back.checks],
    }
