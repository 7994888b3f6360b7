"""The errors that geofit raises on purpose.

::

    GeofitError                  catch this one to catch them all
    ├── InputError               a file or a table cannot be used: file, row, column, value, remedy
    ├── ArgumentError            an argument of another type or shape than the function takes, unknown or missing
    ├── PointsError              arrays that are not a set of points (shape, NaN, infinities)
    ├── SettingsError            a setting out of its range
    ├── FitError                 these points cannot be fitted in this way
    │   └── ExactnessError       no control net within the cap passes through all of the core's points
    ├── StitchError              patches that do not make one valid shell
    ├── MissingDependencyError   an optional package is not installed; the text holds the install line
    ├── SchedulerError           a scheduler is lost, or workers die again and again
    └── Cancelled                the caller's progress function asked to stop

Each carries a :class:`~geofit.data.messages.Message` (``error.message``, ``error.code``) that states what was given,
what is needed, and what to do. ``str(error)`` is English; :func:`geofit.data.languages.translate` gives other
languages.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from geofit.data.legible import legible
from geofit.data.messages import EMPTY, Message, Untranslated, folded, message

__all__ = [
    "ArgumentError",
    "Cancelled",
    "ExactnessError",
    "FitError",
    "GeofitError",
    "InputError",
    "MissingDependencyError",
    "PointsError",
    "SchedulerError",
    "SettingsError",
    "StitchError",
]


class GeofitError(Exception):
    """Base of every error raised by geofit on purpose.

    Parameters
    ----------
    message : Message
        What was given, what is needed, and what to do. ``str(error)`` is its English text.

    Attributes
    ----------
    issues : tuple of ImportIssue
        What the readers of the files had found until then: rows that are not used, guesses.
    """

    issues: tuple[Any, ...] = ()

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message

    @property
    def code(self) -> str:
        """Identifier of what is wrong, for comparisons."""
        return self.message.code

    def __str__(self) -> str:
        return str(self.message)


class InputError(GeofitError):
    """A file cannot be used as it is.

    Parameters
    ----------
    reason : Message
        What is wrong, in one sentence.
    remedy : Message
        What the user can do about it, in one sentence.
    file : str, optional
        Path of the file.
    row : int, optional
        Line of the file, counted from 1 as an editor shows it.
    column : str, optional
        Header of the column.
    value : str, optional
        The offending cell as the file has it.
    """

    def __init__(
        self,
        reason: Message,
        remedy: Message = EMPTY,
        *,
        file: str | None = None,
        row: int | None = None,
        column: str | None = None,
        value: str | None = None,
    ) -> None:
        self.reason, self.remedy = reason, remedy
        self.file = None if file is None else legible(file)
        self.row, self.column, self.value = row, column, value
        super().__init__(self.at_place(_sentence(reason, remedy)))

    @property
    def code(self) -> str:
        """Identifier of the reason, for comparisons."""
        return self.reason.code

    @property
    def fault(self) -> Message:
        """Place and reason without the remedy."""
        return self.at_place(_sentence(self.reason, EMPTY))

    def at_place(self, sentence: Message) -> Message:
        """Return a sentence with file, row, column and value in front, as far as they are known."""
        place: list[Message | str] = [Untranslated(self.file)] if self.file else []
        if self.row is not None:
            place.append(message("data.place-row", "row {row}", row=self.row))
        if self.column is not None:
            place.append(message("data.place-column", "column '{column}'", column=Untranslated(self.column)))
        if self.value is not None:
            place.append(message("data.place-value", "value '{value}'", value=Untranslated(folded(self.value))))
        if not place:
            return sentence
        return message("data.sentence-at-place", "{place}: {sentence}", place=tuple(place), sentence=sentence)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what another process makes the same error from."""
        again = partial(type(self), file=self.file, row=self.row, column=self.column, value=self.value)
        return again, (self.reason, self.remedy)


def _sentence(reason: Message, remedy: Message) -> Message:
    """Return reason and remedy with one full stop between them, which some reasons bring with them."""
    if reason.is_sentence:
        return (
            message("data.sentence-and-remedy", "{reason} {remedy}", reason=reason, remedy=remedy) if remedy else reason
        )
    if remedy:
        return message("data.reason-and-remedy", "{reason}. {remedy}", reason=reason, remedy=remedy)
    return message("data.reason-sentence", "{reason}.", reason=reason)


class ArgumentError(GeofitError, TypeError):
    """An argument of another type or shape than the function takes, unknown to it, or missing."""


class PointsError(GeofitError, ValueError):
    """Arrays that are not a set of points."""


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


class SchedulerError(GeofitError):
    """A scheduler is lost, or workers die again and again: the same work can be started once more."""


class Cancelled(GeofitError):  # noqa: N818 - what happened is not an error of anybody's
    """The caller's progress function returned False."""
