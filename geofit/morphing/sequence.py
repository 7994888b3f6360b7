"""Bodies between two or more surveys, by share of the way or by date."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import date
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import Message, message, plural_message
from geofit.data.progress import Progress
from geofit.implicit.grid import spline_grid
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.align import Alignment, Carried
from geofit.morphing.body import MorphBody
from geofit.morphing.dates import dates_of
from geofit.morphing.distance import distances
from geofit.morphing.ends import End
from geofit.morphing.leg import Leg, Mode, Pace
from geofit.morphing.parts import LonePart
from geofit.morphing.paths import quick_surface

if TYPE_CHECKING:
    from geofit.morphing.change import Change
    from geofit.morphing.table import Event, FrameRow

__all__ = ["Morph"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Morph:
    """Bodies between surveys: ``m(tau)`` or ``m(date)``.

    Parameters
    ----------
    ends : tuple of End
        The surveys.
    origin : (3,) array
        Map coordinates of the local origin, metres.
    legs : tuple of Leg
        The ways between neighbouring surveys.
    knots : (n,) array
        tau of each survey, from 0 to 1.
    mode, pace : str
        See :func:`morph`.
    dates : tuple of datetime.date, or None
        Dates of the surveys.
    sd : tuple of float, or None
        Standard deviation of each survey's surface, metres.
    alignment : Alignment or None
        That of the first two bodies: applied if asked for, else a report for dated surveys; None otherwise.
    """

    ends: tuple[End, ...]
    origin: Floats
    legs: tuple[Leg, ...]
    knots: Floats
    mode: Mode
    pace: Pace
    dates: tuple[date, ...] | None
    sd: tuple[float, ...] | None
    alignment: Alignment | None

    def __repr__(self) -> str:
        names = " -> ".join(end.name for end in self.ends)
        return f"<Morph {names}: {self.mode}, {len(self.unreached)} unreached, {len(self.vanishing)} vanishing>"

    @property
    def lattice(self) -> Lattice:
        """Nodes about the local origin."""
        return self.legs[0].lattice

    @property
    def unreached(self) -> tuple[LonePart, ...]:
        """Parts of a later body that no front reaches; seeds are offered at their deepest places."""
        return tuple(part for leg in self.legs for part in leg.unreached)

    @property
    def vanishing(self) -> tuple[LonePart, ...]:
        """Parts of an earlier body that do not touch the later one: they shrink to nothing."""
        return tuple(part for leg in self.legs for part in leg.vanishing)

    def __call__(self, when: float | str | date) -> MorphBody:
        """Return the body at a share tau of the way, 0 to 1, or at a date.

        Raises
        ------
        SettingsError
            If tau is not between 0 and 1, or the date not between the first and the last survey.
        """
        tau = self.tau_of(when)
        at = np.flatnonzero(self.knots == tau)
        if len(at):
            return self._end_body(int(at[0]))
        leg, s = self.place(tau)
        same = self.legs[leg]
        if np.array_equal(same.d_a, same.d_b):
            return replace(self._end_body(leg), tau=tau, s=s, date=self.date_of(tau))
        field: Any = same.spline(s)
        if self.alignment is not None and self.alignment.applied:
            field = Carried(field, self.alignment, tau - 1)
        return MorphBody(self._name(tau), tau, s, self.date_of(tau), field, self.origin, self._drawn(tau))

    def frames(self, n: int = 25) -> tuple[MorphBody, ...]:
        """Return n bodies at equal steps of tau, the first and the last survey included.

        Raises
        ------
        SettingsError
            If n is below 2.
        """
        return tuple(self(float(tau)) for tau in self.steps(n))

    def steps(self, n: int) -> Floats:
        """Return n equal steps of tau from 0 to 1."""
        if n < 2:
            raise SettingsError(
                plural_message(
                    "morphing.too-few-frames",
                    "{count} frame is asked for, but both ends are frames: ask for 2 or more.",
                    "{count} frames are asked for, but both ends are frames: ask for 2 or more.",
                    count=n,
                )
            )
        return np.linspace(0.0, 1.0, n)

    def surface(self, when: float | str | date) -> TriangleMesh:
        """Return quick triangles in map coordinates, linear between nodes: the preview of a slider."""
        tau = self.tau_of(when)
        leg, s = self.place(tau)
        mesh = quick_surface(self.legs[leg].path, s)
        vertices = mesh.vertices
        if self.alignment is not None and self.alignment.applied:
            rotation, scale, shift = self.alignment.part(1 - tau)
            vertices = (vertices - self.alignment.centre - shift) @ rotation / scale + self.alignment.centre
        return TriangleMesh(vertices + self.origin, mesh.triangles)

    def table(self, n: int = 25, progress: Progress | None = None) -> tuple[FrameRow, ...]:
        """Return volume, area, Euler number, components, gain, loss, net, rate and drift of n frames.

        Raises
        ------
        SettingsError
            If n is below 2.
        """
        from geofit.morphing.table import rows

        return rows(self, n, progress)

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """When parts join, part, or holes open and close."""
        from geofit.morphing.table import events

        return events(self)

    @cached_property
    def notes(self) -> tuple[Message, ...]:
        """What a reader of the volumes must know: meshes that were turned, cells too coarse for a part."""
        from geofit.morphing.notes import notes

        return notes(self)

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """Gain, loss, net and rate of each leg, with uncertainty and detection limits where ``sd`` was given."""
        from geofit.morphing.change import change

        return tuple(change(self, k) for k in range(len(self.legs)))

    def tau_of(self, when: float | str | date) -> float:
        """Return the share of the way at a share or date."""
        if isinstance(when, (str, date)):
            if self.dates is None:
                raise SettingsError(
                    message("morphing.no-dates", "The surveys have no dates: give tau between 0 and 1, or dates.")
                )
            (day,) = dates_of((when,))
            span = (self.dates[-1] - self.dates[0]).days
            tau = (day - self.dates[0]).days / span
            shown = day.isoformat()
        else:
            tau, shown = float(when), f"tau {when:g}"
        if not 0 <= tau <= 1:
            raise SettingsError(
                message(
                    "morphing.beyond-surveys",
                    "{when} is not between the first and the last survey: beyond them nothing is known.",
                    when=shown,
                )
            )
        return tau

    def date_of(self, tau: float) -> date | None:
        """Return the date at a share of the way, None if the surveys have none."""
        if self.dates is None:
            return None
        first, last = self.dates[0].toordinal(), self.dates[-1].toordinal()
        return date.fromordinal(round(first + tau * (last - first)))

    def place(self, tau: float) -> tuple[int, float]:
        """Return the leg at a share of the way, and the share s of that leg by the pace."""
        leg = int(np.clip(np.searchsorted(self.knots, tau, side="right") - 1, 0, len(self.legs) - 1))
        p = float((tau - self.knots[leg]) / (self.knots[leg + 1] - self.knots[leg]))
        if p in (0.0, 1.0):
            return leg, p
        match self.pace:
            case "progress":
                return leg, self.legs[leg].share_at_progress(p)
            case "volume":
                return leg, self.legs[leg].share_at_volume(p)
            case _:
                return leg, p

    def tau_at(self, leg: int, s: float) -> float:
        """Return the share of the whole way at the share s of a leg."""
        first, last = self.knots[leg], self.knots[leg + 1]
        match self.pace:
            case "progress":
                p = self.legs[leg].progress(s)
            case "volume":
                low, high = self.legs[leg].volume(0.0), self.legs[leg].volume(1.0)
                p = (self.legs[leg].volume(s) - low) / (high - low)
            case _:
                p = s
        return float(np.clip(first + p * (last - first), first, last))

    def _name(self, tau: float) -> str:
        day = self.date_of(tau)
        names = "-".join((self.ends[0].name, self.ends[-1].name))
        return f"{names} {day.isoformat()}" if day else f"{names} {tau:.4f}"

    def _drawn(self, tau: float) -> Lattice:
        """Return the lattice of a frame: wider where an alignment carries it."""
        if self.alignment is None or not self.alignment.applied:
            return self.lattice
        low, high = self.lattice.bounds
        lower, upper = Carried(_Boxed(low, high), self.alignment, tau - 1).bounds
        spacing = self.lattice.spacing
        counts = np.ceil((upper - lower) / spacing).astype(int) + 1
        return Lattice(lower, spacing, (int(counts[0]), int(counts[1]), int(counts[2])))

    def _end_body(self, k: int) -> MorphBody:
        end, leg = self.ends[k], self.legs[min(k, len(self.legs) - 1)]
        samples, near = (leg.start, leg.d_a) if k < len(self.legs) else (leg.end, leg.d_b)
        mesh = end.shape if isinstance(end.shape, TriangleMesh) else None
        field: Any = end.shape
        if mesh is not None:
            if k == len(self.legs) and leg.unreached:
                near = distances(samples, samples.inside)
            field = spline_grid(near, self.lattice)
        tau = float(self.knots[k])
        return MorphBody(
            end.name, tau, 0.0 if k < len(self.legs) else 1.0, self.dates[k] if self.dates else None, field,
            self.origin, self._drawn(0.0) if k == 0 else self.lattice, end.given, mesh,
        )  # fmt: skip


@dataclass(frozen=True)
class _Boxed:
    """A box in the place of a field, to be carried."""

    low: Floats
    high: Floats

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        return self.low, self.high

    @property
    def lipschitz(self) -> float:
        return 0.0

    def value(self, xyz: Floats) -> Floats:
        return np.zeros(len(xyz))

    def gradient(self, xyz: Floats) -> Floats:
        return np.zeros_like(xyz)
