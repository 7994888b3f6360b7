"""The errors that geofit raises on purpose.

::

    GeofitError                  catch this one to catch them all
    ├── InputError               a file or a table cannot be used: file, row, column, value, remedy
    ├── PointsError              arrays that are no set of points (shape, NaN, infinities)
    ├── SettingsError            a setting out of its range
    ├── FitError                 these points cannot be fitted in this way
    │   └── ExactnessError       no control net within the cap passes through all of the core's points
    ├── StitchError              patches that do not make one valid shell
    ├── MissingDependencyError   an optional package is not installed; the text holds the install line
    └── Cancelled                the caller's progress function asked to stop

Each message says what was given, what is needed, and what to do. A message by
:func:`geofit.data.messages.said` can be translated; ``str(error)`` is English.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from geofit.data.messages import Said, Verbatim, folded, listed, said

__all__ = [
    "Cancelled",
    "ExactnessError",
    "FitError",
    "GeofitError",
    "InputError",
    "MissingDependencyError",
    "PointsError",
    "SettingsError",
    "StitchError",
]


class GeofitError(Exception):
    """Base of every error raised by geofit on purpose."""

    def __str__(self) -> str:
        return self.args[0] if len(self.args) == 1 and isinstance(self.args[0], str) else super().__str__()


class InputError(GeofitError):
    """A file cannot be used as it is.

    Parameters
    ----------
    reason : str
        What is wrong, in one sentence.
    remedy : str
        What the user can do about it, in one sentence.
    file : str, optional
        Path of the file.
    row : int, optional
        Line of the file, counted from 1 as an editor shows it.
    column : str, optional
        Header of the column.
    value : str, optional
        The offending cell as it stands in the file.
    """

    def __init__(
        self,
        reason: str,
        remedy: str = "",
        *,
        file: str | None = None,
        row: int | None = None,
        column: str | None = None,
        value: str | None = None,
    ) -> None:
        self.reason, self.remedy = reason, remedy
        self.file, self.row, self.column, self.value = file, row, column, value
        place: list[str] = [Verbatim(file)] if file else []
        place += [said("row {row}", row=row)] if row is not None else []
        place += [said("column '{column}'", column=Verbatim(column))] if column is not None else []
        place += [said("value '{value}'", value=Verbatim(folded(value)))] if value is not None else []
        sentence = _sentence(reason, remedy)
        super().__init__(said("{place}: {sentence}", place=listed(place), sentence=sentence) if place else sentence)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what another process makes the same error from."""
        again = partial(type(self), file=self.file, row=self.row, column=self.column, value=self.value)
        return again, (self.reason, self.remedy)


def _sentence(reason: str, remedy: str) -> str:
    """Return reason and remedy with one full stop between them, which some reasons bring with them."""
    what = reason if isinstance(reason, Said) else reason.rstrip(".")
    if what.endswith("."):
        return said("{reason} {remedy}", reason=what, remedy=remedy) if remedy else what
    return said("{reason}. {remedy}", reason=what, remedy=remedy) if remedy else said("{reason}.", reason=what)


class PointsError(GeofitError, ValueError):
    """Arrays that are no set of points."""


class SettingsError(GeofitError, ValueError):
    """A setting out of its range."""


class FitError(GeofitError):
    """The points cannot be fitted in the way that was asked for."""


class ExactnessError(FitError):
    """No control net within the cap passes through all of the core's points."""


class StitchError(GeofitError):
    """The patches do not make one valid shell."""


class MissingDependencyError(GeofitError, ImportError):
    """An optional package is not installed."""


class Cancelled(GeofitError):  # noqa: N818 - what happened is no error of anybody's
    """The caller's progress function returned False."""
