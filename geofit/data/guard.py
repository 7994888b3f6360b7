"""The one place where an unforeseen error is caught: it costs the examination that raised it, and is reported."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from geofit.data.errors import Cancelled, GeofitError, SchedulerError
from geofit.data.messages import Message, message

__all__ = ["guarded", "reason_of"]

T = TypeVar("T")


def guarded(work: Callable[[], T], instead: T, report: Callable[[Message], object]) -> T:
    """Run one examination; if it fails, report the reason and return what takes its place.

    Parameters
    ----------
    work : callable
        The examination.
    instead : object
        The result without it.
    report : callable
        Called with the reason.

    Raises
    ------
    Cancelled
        If the user stopped the examination; it did not fail.
    SchedulerError
        If what the examination runs on is lost: the others would be lost too.

    Examples
    --------
    >>> notes = []
    >>> guarded(lambda: 1 // 0, -1, notes.append), notes[0].params["kind"]
    (-1, 'ZeroDivisionError')
    """
    try:
        return work()
    except (Cancelled, SchedulerError):
        raise
    except Exception as error:  # whatever it is, the other examinations are sound
        report(reason_of(error))
        return instead


def reason_of(error: Exception) -> Message:
    """Return what an error says; of an unforeseen one also the kind and the line, for the report to the developers."""
    if isinstance(error, GeofitError):
        return error.message
    frames = list(traceback.walk_tb(error.__traceback__))
    # The last line of geofit's own: a library's says little of what was asked of it.
    own = [one for one in frames if _own(str(one[0].f_globals.get("__name__")))] or frames
    place = f"{Path(own[-1][0].f_code.co_filename).name}:{own[-1][1]}" if own else "?"
    return message(
        "data.unforeseen-error",
        "unforeseen error {kind} ({text}; {place}); please report it",
        kind=type(error).__name__,
        text=" ".join(str(error).split())[:200],
        place=place,
    )


def _own(module: str) -> bool:
    return module.split(".")[0] == "geofit" and module != __name__
