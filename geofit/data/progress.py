"""Progress and cancellation: one small protocol, with no knowledge of who listens."""

from __future__ import annotations

from typing import Protocol

from geofit.data.errors import Cancelled
from geofit.data.messages import Message, message

__all__ = ["Progress", "tell", "within"]


class Progress(Protocol):
    """Anything that can be called as ``progress(stage, fraction)``.

    ``stage`` is one of :data:`geofit.data.terms.TERMS` ("partition", "core", ...) or a message; ``fraction`` runs
    from 0 to 1 over the whole task.
    Returning ``False`` asks for a stop; any other value, ``None`` included, means go on.
    """

    def __call__(self, stage: str | Message, fraction: float, /) -> bool | None:
        """Hear that the task is at ``fraction`` of its whole, in ``stage``."""
        ...


def tell(progress: Progress | None, stage: str | Message, fraction: float) -> None:
    """Report a stage and raise :class:`~geofit.data.errors.Cancelled` if the listener asks to stop."""
    if progress is not None and progress(stage, min(max(fraction, 0.0), 1.0)) is False:
        raise Cancelled(
            message(
                "data.cancelled-in-stage", "Stopped by the caller during '{stage}'. Nothing was written.", stage=stage
            )
        )


def within(progress: Progress | None, first: float, last: float) -> Progress | None:
    """Return a listener for a part of a task that runs from ``first`` to ``last`` of the whole."""
    if progress is None:
        return None

    def listen(stage: str | Message, fraction: float) -> bool | None:
        return progress(stage, first + (last - first) * fraction)

    return listen
