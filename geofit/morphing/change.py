"""What was gained and lost between two surveys, how sure that is, and which parts of it can be told from error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from geofit.morphing.leg import Leg
    from geofit.morphing.sequence import Morph

__all__ = ["DAYS", "Change", "ChangedPart", "change", "change_sd"]

Floats = NDArray[np.float64]

#: Days of a year.
DAYS = 365.25
#: Standard deviations of the limit of detection: 95 % of errors are below.
DETECTED = 1.96
#: A node belongs to a changed part if this share of its cube changed.
LEAST = 0.01


@dataclass(frozen=True, eq=False)
class ChangedPart:
    """A connected part that was gained or lost.

    ``area`` (m2) is half of its surface: what it was gained or lost on. ``thickness`` is volume over area, metres;
    ``limit`` the volume (m3) that errors of the surveys alone reach in 1 of 20 cases, nan without their deviations.
    """

    kind: Literal["gain", "loss"]
    volume: float
    area: float
    centre: Floats
    limit: float

    @property
    def thickness(self) -> float:
        """Mean thickness, metres."""
        return self.volume / self.area if self.area > 0 else 0.0

    @property
    def detected(self) -> bool | None:
        """Whether the volume is beyond the limit; None without a limit."""
        return None if np.isnan(self.limit) else bool(self.volume > self.limit)


@dataclass(frozen=True, eq=False)
class Change:
    """Change of volume between two surveys, m3; ``rate`` in m3 a year, or over the whole leg without dates.

    Standard deviations assume the worst of surveys: an error that is the same all over a changed surface.
    """

    gain: float
    loss: float
    gain_sd: float
    loss_sd: float
    net_sd: float
    years: float
    parts: tuple[ChangedPart, ...]

    @property
    def net(self) -> float:
        """Gain less loss, m3."""
        return self.gain - self.loss

    @property
    def rate(self) -> float:
        """Net change a year, or over the leg without dates."""
        return self.net / self.years

    @property
    def rate_sd(self) -> float:
        """Standard deviation of the rate."""
        return self.net_sd / self.years


def change(morph: Morph, k: int) -> Change:
    """Return the change over leg k of a metamorphosis."""
    leg = morph.legs[k]
    spread = _thickness_sd(morph, k)
    gain, loss = leg.gain_and_loss(1.0)
    parts = [*_parts(leg, "gain", spread, morph.origin), *_parts(leg, "loss", spread, morph.origin)]
    areas = {kind: sum(part.area for part in parts if part.kind == kind) for kind in ("gain", "loss")}
    years = 1.0
    if morph.dates is not None:
        years = (morph.dates[k + 1] - morph.dates[k]).days / DAYS
    parts.sort(key=lambda part: -part.volume)
    net_sd = change_sd(morph, k, 1.0)
    return Change(gain, loss, spread * areas["gain"], spread * areas["loss"], net_sd, years, tuple(parts))


def change_sd(morph: Morph, k: int, s: float) -> float:
    """Return the standard deviation of V(s) - V(0) on leg k, m3; nan without those of the surveys.

    Each survey may be off along its normals by the same length all over: its volume then errs by that times its area.
    """
    if morph.sd is None:
        return float("nan")
    leg = morph.legs[k]
    return float(s * np.hypot(morph.sd[k] * leg.start.mesh.areas.sum(), morph.sd[k + 1] * leg.end.mesh.areas.sum()))


def _thickness_sd(morph: Morph, k: int) -> float:
    return float("nan") if morph.sd is None else float(np.hypot(morph.sd[k], morph.sd[k + 1]))


def _parts(leg: Leg, kind: Literal["gain", "loss"], spread: float, origin: Floats) -> list[ChangedPart]:
    from scipy.ndimage import label, maximum_filter

    lattice = leg.lattice
    more = leg.changed_fractions if kind == "gain" else -leg.changed_fractions
    numbers, count = label(more > LEAST, structure=np.ones((3, 3, 3)))
    volume = np.bincount(numbers.ravel(), np.maximum(more, 0).ravel(), count + 1) * lattice.spacing**3
    area = np.zeros(count + 1)
    wide = np.where(numbers > 0, numbers, maximum_filter(numbers, 3))
    for mesh in (leg.start.mesh, leg.end.mesh):
        # Half of both surfaces that bound a part: what it was gained or lost on.
        node = np.rint((mesh.corners.mean(axis=1) - lattice.origin) / lattice.spacing).astype(int)
        node = np.clip(node, 0, np.array(lattice.shape) - 1)
        area += np.bincount(wide[tuple(node.T)], mesh.areas, count + 1) / 2
    weights = [np.bincount(numbers.ravel(), minlength=count + 1)]
    weights += [
        np.bincount(numbers.ravel(), np.broadcast_to(np.reshape(axis, shape), lattice.shape).ravel(), count + 1)
        for axis, shape in zip(lattice.axes, ((-1, 1, 1), (1, -1, 1), (1, 1, -1)), strict=True)
    ]
    centre = np.stack(weights[1:], axis=1) / np.maximum(weights[0], 1)[:, None] + origin
    return [
        ChangedPart(kind, float(volume[n]), float(area[n]), centre[n], float(DETECTED * spread * area[n]))
        for n in range(1, count + 1)
    ]
