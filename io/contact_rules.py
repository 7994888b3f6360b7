"""Which contact of a hole a horizon is: codes that count as one, thin beds that do not count, which of several."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.legible import latin_letters
from geofit.data.logs import IntervalLog
from geofit.data.messages import message
from geofit.data.numbers import is_finite, shown

__all__ = ["ContactRule", "Limit", "Occurrence", "code_key", "simplified"]

Limit = Literal["top", "base"]
Occurrence = Literal["first", "last"]
#: Depths nearer than this touch, metres.
TOUCH = 0.005


def code_key(code: str) -> str:
    """Return what is the same for codes that differ only in case, blanks, hyphens, underscores and a last full stop.

    Letters that look alike (:func:`geofit.data.legible.latin_letters`) are the same, too.

    Examples
    --------
    >>> [code_key(code) for code in ("SST.", "Sst ", "T2_a", "T2 - a", "T2a", "T2?")]
    ['sst', 'sst', 't2 a', 't2 a', 't2a', 't2?']
    """
    return re.sub(r"[\s_-]+", " ", latin_letters(code)).strip(" .")


@dataclass(frozen=True)
class ContactRule:
    """A contact of interval logs.

    Parameters
    ----------
    codes : tuple of str
        Codes that count as one bed.
    limit : {"top", "base"}
        Which limit of the bed.
    occurrence : {"first", "last"}, optional
        Which bed where a hole has several, from the collar down; None: the first for a top, the last for a base.
    thinner : float
        Beds thinner than this do not count, metres: a parting within the bed, and a bed by itself.

    Raises
    ------
    SettingsError
        If there is no code, or ``thinner`` is below 0.
    """

    codes: tuple[str, ...]
    limit: Limit = "base"
    occurrence: Occurrence | None = None
    thinner: float = 0.0

    def __post_init__(self) -> None:
        if not self.codes or not is_finite(self.thinner) or self.thinner < 0:
            raise SettingsError(
                message(
                    "io.contact-rule-unusable",
                    "A contact needs a code, and a least thickness of 0 m or more; given: {thinner} m.",
                    thinner=shown(self.thinner),
                )
            )

    @property
    def label(self) -> str:
        """The codes as one word."""
        return " + ".join(self.codes)

    @property
    def first(self) -> bool:
        """Whether the first bed from the collar counts."""
        return (self.occurrence or ("first" if self.limit == "top" else "last")) == "first"


def simplified(log: IntervalLog, rule: ContactRule) -> IntervalLog:
    """Return a log in which the codes of a rule are one, and thin beds are part of what surrounds them.

    The thinnest run goes first. A run at the hole's end stays: it may go on below; so does what else lies at the
    collar.
    """
    ours = np.isin(log.code, rule.codes)
    code = np.where(ours, rule.label, log.code).astype(np.str_)
    if rule.thinner > 0:
        for hole in _holes(log):
            _absorb(log, hole, ours, rule.thinner)
        # What was absorbed is called like the bed, or, of the bed, like nothing.
        code = np.where(ours, rule.label, np.where(code == rule.label, "–", code)).astype(np.str_)
    return replace(log, code=code)


def _holes(log: IntervalLog) -> Iterator[NDArray[np.intp]]:
    yield from np.split(np.arange(len(log.hole)), np.flatnonzero(log.hole[1:] != log.hole[:-1]) + 1)


def _absorb(log: IntervalLog, hole: NDArray[np.intp], ours: NDArray[np.bool_], thinner: float) -> None:
    """Turn thin runs of one hole into what surrounds them, the thinnest first."""
    while True:
        starts = np.concatenate([[0], np.flatnonzero(np.diff(ours[hole])) + 1])
        runs = np.split(hole, starts[1:])
        best: tuple[float, int] | None = None
        for k, run in enumerate(runs):
            thickness = float(log.base[run[-1]] - log.top[run[0]])
            at_end, at_collar = k == len(runs) - 1, k == 0
            stays = at_end or (at_collar and not ours[run[0]])
            inside = at_collar or log.top[run[0]] - log.base[runs[k - 1][-1]] <= TOUCH
            if not stays and inside and thickness < thinner and (best is None or thickness < best[0]):
                best = (thickness, k)
        if best is None or len(runs) == 1:
            return
        run = runs[best[1]]
        ours[run] = ~ours[run]
