"""Dates of surveys as the pace of a metamorphosis."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date, datetime
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.morphing.errors import MorphError

__all__ = ["dates_of", "knots_of"]


def dates_of(given: Sequence[str | date]) -> tuple[date, ...]:
    """Return dates given as such or as text "2024-05-31".

    Raises
    ------
    MorphError
        If a text is not a date.
    """
    found = []
    for one in given:
        if isinstance(one, datetime):
            found.append(one.date())
        elif isinstance(one, date):
            found.append(one)
        else:
            try:
                found.append(date.fromisoformat(str(one)))
            except ValueError:
                raise MorphError(
                    message(
                        "morphing.not-a-date", "'{text}' is not a date: write year-month-day, 2024-05-31.", text=one
                    )
                ) from None
    return tuple(found)


def knots_of(days: Sequence[date] | None, count: int) -> NDArray[np.float64]:
    """Return the share of the way (n,) at which each body is: even without dates, else in proportion to time.

    Raises
    ------
    MorphError
        If there is not one date a body, or they do not rise.
    """
    if days is None:
        return np.linspace(0.0, 1.0, count)
    if len(days) != count or any(later <= earlier for earlier, later in pairwise(days)):
        raise MorphError(
            message(
                "morphing.dates-not-rising",
                "{count} bodies need as many dates, each later than the one before; given: {dates}.",
                count=count,
                dates=", ".join(day.isoformat() for day in days),
            )
        )
    numbers = np.array([day.toordinal() for day in days], float)
    knots = (numbers - numbers[0]) / (numbers[-1] - numbers[0])
    knots[-1] = 1.0
    return np.asarray(knots)
