"""Logged intervals of boreholes to the contacts, inside and outside samples of a body."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.data import BodyData, BodyIssue
from geofit.bodies.settings import BodySettings
from geofit.data.errors import SettingsError
from geofit.data.messages import message

__all__ = ["IntervalSource", "Stretch", "as_body_data", "from_intervals", "stretches"]

Floats = NDArray[np.float64]

#: Depths of logs are written in centimetres: smaller gaps and overlaps are none, metres.
TOLERANCE = 0.005
SHORTEST_STEP = 0.1
#: Samples that a step of its own choice aims at, at most; each stretch has one at least.
SAMPLES = 30_000


class _Path(Protocol):
    def at(self, depth: ArrayLike) -> Floats:
        """Return the places (n, 3) at depths (n,)."""
        ...


class IntervalSource(Protocol):
    """Boreholes with their logs: :class:`geofit.io.boreholes.Boreholes`, or a campaign of a site."""

    @property
    def paths(self) -> Mapping[str, Any]:
        """Path of each hole."""
        ...

    @property
    def logs(self) -> Sequence[Any]:
        """Interval tables."""
        ...


@dataclass(frozen=True)
class Stretch:
    """A part of a hole of one side: ``inside`` or not, from ``top`` to ``base`` along the hole, metres."""

    top: float
    base: float
    inside: bool


def as_body_data(source: BodyData | Any, codes: str | Sequence[str] | None, settings: BodySettings) -> BodyData:
    """Return the data of a body from whatever :func:`geofit.fit_body` accepts.

    Raises
    ------
    SettingsError
        If codes are given for arrays, or missing for intervals, or the object holds no intervals.
    """
    if isinstance(source, BodyData):
        if codes is not None:
            raise SettingsError(
                message(
                    "bodies.codes-without-logs",
                    "codes choose logged intervals; arrays have none. Leave codes out, or give boreholes with logs.",
                )
            )
        return source
    holes = source if hasattr(source, "logs") else getattr(source, "boreholes", None)
    campaigns = tuple(holes) if isinstance(holes, Sequence) else (holes,)
    if not any(getattr(campaign, "logs", ()) for campaign in campaigns):
        raise SettingsError(
            message(
                "bodies.no-logged-intervals",
                "A {kind} contains no logged intervals. Give BodyData, or the boreholes with their interval tables.",
                kind=type(source).__name__,
            )
        )
    if codes is None:
        raise SettingsError(
            message("bodies.codes-missing", "codes is missing: name the codes of the intervals that lie in the body.")
        )
    return from_intervals(campaigns, codes, settings.step)


def from_intervals(
    holes: IntervalSource | Sequence[IntervalSource], codes: str | Sequence[str], step: float | None = None
) -> BodyData:
    """Return contacts and samples of the body that intervals of the given codes make.

    Intervals of other codes are outside. What is not logged is unknown: it gives neither samples nor a contact. Where
    intervals of both sides overlap, the stretch counts as unknown and is listed.

    Parameters
    ----------
    holes : IntervalSource or sequence of IntervalSource
        Boreholes with logs; tables in which none of the codes occurs are left out. Holes of different sources are
        different holes: where they share a name, the later ones have the number of their source behind it.
    codes : str or sequence of str
        Codes inside the body.
    step : float, optional
        Distance of samples along a hole, metres; by default a quarter of the median inside stretch, and at most some
        30,000 samples.

    Raises
    ------
    SettingsError
        If a code does not occur.
    """
    wanted = {codes} if isinstance(codes, str) else set(codes)
    sources = holes if isinstance(holes, Sequence) else (holes,)
    counts: Counter[str] = Counter()
    for log in (log for source in sources for log in source.logs):
        counts.update(log.code.tolist())
    missing = sorted(wanted - set(counts))
    if missing or not wanted:
        frequent = ", ".join(f"{code} ({count})" for code, count in counts.most_common(12))
        raise SettingsError(
            message(
                "bodies.code-not-logged",
                "Code {codes} does not occur in the logs. The most frequent codes are: {frequent}.",
                codes=", ".join(missing) or "''",
                frequent=frequent,
            )
        )
    issues: list[BodyIssue] = []
    folded = {code.casefold() for code in wanted}
    if alike := sorted(code for code in counts if code.casefold() in folded and code not in wanted):
        text = message(
            "bodies.code-differs-in-case",
            "Codes that differ from {codes} in case only count as outside the body: {alike}. Name them too where they "
            "are the same rock",
            codes=", ".join(sorted(wanted)),
            alike=", ".join(f"{code} ({counts[code]})" for code in alike),
        )
        issues.append(BodyIssue("interval", text))
    rows: dict[str, list[tuple[float, float, bool]]] = {}
    paths: dict[str, _Path] = {}
    for number, source in enumerate(sources, 1):
        names = {hole: f"{hole} ({number})" if hole in paths else hole for hole in source.paths}
        paths.update((names[hole], path) for hole, path in source.paths.items())
        for log in source.logs:
            if wanted.isdisjoint(log.code.tolist()):
                continue
            for hole, top, base, code in zip(
                log.hole.tolist(), log.top.tolist(), log.base.tolist(), log.code.tolist(), strict=True
            ):
                if code:
                    rows.setdefault(names[hole], []).append((top, base, code in wanted))
    found = {hole: stretches(rows[hole], hole, issues) for hole in sorted(rows)}
    lengths = [s.base - s.top for parts in found.values() for s in parts if s.inside]
    if step is None:
        total = sum(s.base - s.top for parts in found.values() for s in parts)
        step = max(float(np.median(lengths)) / 4 if lengths else 1.0, SHORTEST_STEP, total / SAMPLES)
    return _sampled(found, paths, step, issues)


def stretches(intervals: Sequence[tuple[float, float, bool]], hole: str, issues: list[BodyIssue]) -> list[Stretch]:
    """Return the stretches of a hole, each of one side, none touching another of its side.

    Parameters
    ----------
    intervals : sequence of (top, base, inside)
        In any order; they may overlap.
    hole : str
        Name, for the issues.
    issues : list of BodyIssue
        Receives overlaps of both sides and gaps.
    """
    ends = np.unique([end for top, base, _ in intervals for end in (top, base)])
    merged: list[Stretch] = []
    unlogged = 0.0
    for top, base in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        middle = (top + base) / 2
        sides = {inside for start, end, inside in intervals if start < middle < end}
        if len(sides) == 1:
            side = sides.pop()
            if merged and merged[-1].inside == side and top - merged[-1].base <= TOLERANCE:
                merged[-1] = Stretch(merged[-1].top, base, side)
            else:
                merged.append(Stretch(top, base, side))
        elif base - top > TOLERANCE:
            if sides:
                text = message(
                    "bodies.intervals-contradict",
                    "Hole '{hole}', {top:.2f} to {base:.2f} m: intervals inside and outside the body contradict each "
                    "other; the stretch counts as unknown",
                    hole=hole,
                    top=top,
                    base=base,
                )
                issues.append(BodyIssue("contradiction", text, used=False))
            else:
                unlogged += base - top
    if unlogged:
        text = message(
            "bodies.hole-not-logged-throughout",
            "Hole '{hole}': {length:.2f} m between logged intervals are not logged; they count as unknown",
            hole=hole,
            length=unlogged,
        )
        issues.append(BodyIssue("gap", text))
    return merged


def _sampled(
    found: Mapping[str, Sequence[Stretch]], paths: Mapping[str, _Path], step: float, issues: Sequence[BodyIssue]
) -> BodyData:
    contacts: list[Floats] = []
    holes: list[str] = []
    samples: dict[bool, list[Floats]] = {True: [], False: []}
    names: dict[bool, list[str]] = {True: [], False: []}
    lengths: dict[bool, list[float]] = {True: [], False: []}
    for hole, parts in found.items():
        path = paths[hole]
        for above, below in pairwise(parts):
            if below.top - above.base <= TOLERANCE:
                contacts.append(path.at(np.array([(above.base + below.top) / 2])))
                holes.append(hole)
        for part in parts:
            count = max(1, int(np.ceil((part.base - part.top) / step)))
            each = (part.base - part.top) / count
            samples[part.inside].append(path.at(part.top + each * (np.arange(count) + 0.5)))
            names[part.inside] += [hole] * count
            lengths[part.inside] += [each] * count
    return BodyData(
        contacts=_stacked(contacts),
        inside=_stacked(samples[True]),
        outside=_stacked(samples[False]),
        hole=np.array(holes, dtype=np.str_),
        inside_hole=np.array(names[True], dtype=np.str_),
        outside_hole=np.array(names[False], dtype=np.str_),
        inside_length=np.array(lengths[True]),
        outside_length=np.array(lengths[False]),
        issues=tuple(issues),
    )


def _stacked(parts: Sequence[Floats]) -> Floats:
    return np.concatenate(parts) if parts else np.zeros((0, 3))
