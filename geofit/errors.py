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

Each message says what was given, what is needed, and what to do.
"""

from __future__ import annotations

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
        place = ", ".join(
            text
            for text in (
                file or "",
                f"row {row}" if row is not None else "",
                f"column '{column}'" if column is not None else "",
                f"value '{value}'" if value is not None else "",
            )
            if text
        )
        sentence = f"{reason.rstrip('.')}." + (f" {remedy}" if remedy else "")
        super().__init__(f"{place}: {sentence}" if place else sentence)


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
