"""One horizon's result: what the reports are made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geofit.checks.storage import Storage
from geofit.data.accuracy import Accuracy, Check, ReadBack
from geofit.data.messages import Message
from geofit.data.points import PointSet
from geofit.data.prediction import PredictionResult
from geofit.data.site import ImportIssue, Site
from geofit.data.stale import StaleCause
from geofit.data.verdict import Verdict, verdict_of
from geofit.fitting.horizon_fit import HorizonFit
from geofit.report.profile import Profile
from geofit.site.dips import DipDeviation, check_dips
from geofit.site.site_checks import measured_on
from geofit.site.states import Comparison

__all__ = ["HorizonResult", "sigma_of"]


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
    prediction : PredictionResult or None
        The surface away from its data; None: not examined.
    profiles : mapping of str to tuple of Profile
        What the sections of the report cut, by the section's name.
    excluded : PointSet or None
        Points that a person left out of the fit.
    edits : tuple of Message
        Changes by hand after the fit, in their order.
    orders : tuple of Check
        How the horizon lies to its neighbours (:meth:`geofit.site.order.Order.check`).
    change : Comparison or None
        How the horizon moved since its data changed; None: no earlier state is known.
    horizon : str
        Name of the horizon where the surface is one fault block of it; else empty or the surface's own.
    stale : tuple of StaleCause
        What has changed since the surface was fitted; empty: nothing.
    """

    surface: HorizonFit
    site: Site
    read_back: ReadBack | None = None
    storage: Storage | None = None
    step_bytes: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    prediction: PredictionResult | None = None
    profiles: Mapping[str, tuple[Profile, ...]] = field(default_factory=dict, repr=False)
    excluded: PointSet | None = None
    edits: tuple[Message, ...] = ()
    orders: tuple[Check, ...] = ()
    change: Comparison | None = None
    horizon: str = ""
    stale: tuple[StaleCause, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The verdict with its three lamps."""
        return verdict_of(self.accuracy, self.prediction, self.read_back, self.orders)

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

    @cached_property
    def dips(self) -> tuple[DipDeviation, ...]:
        """The dips that were measured on the horizon, of a fault block those within it, compared with its surface."""
        measured = self.site.orientations
        if self.horizon not in ("", self.name):
            measured = measured_on(measured, self.surface, self.horizon)
        return check_dips(self.surface, measured)[0]

    @property
    def core(self) -> NDArray[np.bool_]:
        """Which points are interpolated exactly, (n,)."""
        core = self.surface.core
        return core if len(core) == self.accuracy.n else np.zeros(self.accuracy.n, bool)

    @property
    def dropped(self) -> dict[int, Message]:
        """Points that were not fitted, and why (conflicts resolved by accuracy)."""
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


def sigma_of(d: NDArray[np.float64]) -> float | None:
    """Return sigma of eq. 3 over a part of the points, metres; None for less than two."""
    return float(np.sqrt((d**2).sum() / (len(d) - 1))) if len(d) > 1 else None
