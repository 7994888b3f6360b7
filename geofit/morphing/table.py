"""The table of a metamorphosis and the events of its topology."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from typing import TYPE_CHECKING

import numpy as np

from geofit.data.progress import Progress, tell
from geofit.morphing.change import DAYS, change_sd

if TYPE_CHECKING:
    from geofit.morphing.sequence import Morph

__all__ = ["Event", "FrameRow", "events", "rows"]

#: Steps of a leg between which an event is looked for, and halvings that place it.
LOOKED, HALVINGS = 32, 8


@dataclass(frozen=True)
class FrameRow:
    """One frame: volumes in m3, area in m2.

    ``components`` counts separate parts; cavities within them are not counted. ``gain`` and ``loss`` count from the
    first survey of its leg, ``net`` is their difference, ``rate`` that over the years since then (over tau without
    dates), nan at a survey. ``sd`` is the standard deviation of ``net``, nan without those of the surveys. ``drift`` is
    the volume outside the corridor between the surveys.
    """

    tau: float
    date: date | None
    s: float
    volume: float
    area: float
    euler: int
    components: int
    gain: float
    loss: float
    net: float
    sd: float
    rate: float
    drift: float
    interpolated: bool


@dataclass(frozen=True)
class Event:
    """A change of topology at ``tau``: separate parts and Euler number before and after.

    A cavity is not counted: one that closes or opens changes the Euler number by 2.
    """

    tau: float
    date: date | None
    s: float
    components: tuple[int, int]
    euler: tuple[int, int]


def rows(morph: Morph, n: int, progress: Progress | None = None) -> tuple[FrameRow, ...]:
    """Return a row for each of n frames at equal steps of tau."""
    found = []
    for count, tau in enumerate(morph.steps(n).tolist()):
        tell(progress, "table", count / n)
        body = morph(tau)
        k, s = morph.place(tau)
        leg = morph.legs[k]
        gain, loss = leg.gain_and_loss(s) if s > 0 else (0.0, 0.0)
        net = gain - loss
        passed = tau - morph.knots[k]
        if morph.dates is not None:
            passed *= (morph.dates[-1] - morph.dates[0]).days / DAYS
        found.append(
            FrameRow(
                tau, body.date, s, body.volume, body.area, body.euler, body.components, gain, loss, net,
                change_sd(morph, k, s), float(net / passed) if passed > 0 else float("nan"), leg.drift(s),
                body.interpolated,
            )
        )  # fmt: skip
    return tuple(found)


def events(morph: Morph) -> tuple[Event, ...]:
    """Return the changes of parts and Euler number in the order of tau, placed by halving."""
    found = []
    for k, leg in enumerate(morph.legs):
        look = leg.topology
        shares = np.linspace(0, 1, LOOKED + 1)
        seen = [look(s) for s in shares.tolist()]
        for i in range(LOOKED):
            if seen[i] == seen[i + 1]:
                continue
            low, high, before, after = shares[i], shares[i + 1], seen[i], seen[i + 1]
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                if (between := look(middle)) == before:
                    low = middle
                else:
                    high, after = middle, between
            s = float((low + high) / 2)
            tau = morph.tau_at(k, s)
            found.append(Event(tau, morph.date_of(tau), s, (before[0], after[0]), (before[1], after[1])))
    return tuple(found)
