"""What the application is busy with: one task after another, shown in the status bar, with Cancel."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, Signal

from geofit.data.errors import GeofitError
from geofit.data.messages import message
from geofit.gui.translate import shown_error
from geofit.gui.worker import Task, run, run_in_process

__all__ = ["Activity"]

_LOG = logging.getLogger(__name__)
#: A function with its arguments; None if there is nothing to do any more.
Work = tuple[Callable[..., Any], tuple[Any, ...]] | None


@dataclass(frozen=True)
class _Job:
    title: str
    prepare: Callable[[], Work]
    on_done: Callable[[Any], object]
    on_failed: Callable[[Exception], object] | None
    in_process: bool


class Activity(QObject):
    """A queue of tasks: a model is changed by one at a time, and each begins with what the last one left.

    Signals: ``began(title)``, ``progressed(stage, fraction)``, ``ended()`` when the queue is empty,
    ``failed(title, exception)``.
    """

    began = Signal(str)
    progressed = Signal(object, float)
    ended = Signal()
    failed = Signal(str, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._waiting: deque[_Job] = deque()
        self._task: Task | None = None

    @property
    def busy(self) -> bool:
        """Whether a task runs or waits."""
        return self._task is not None or bool(self._waiting)

    def do(
        self,
        title: str,
        function: Callable[..., Any],
        *args: Any,
        on_done: Callable[[Any], object],
        on_failed: Callable[[Exception], object] | None = None,
        in_process: bool = False,
    ) -> None:
        """Run ``function(*args, progress=...)`` when its turn comes; ``in_process`` in a process of its own.

        Without ``on_failed`` a failure is reported by the signal.
        """
        self.prepare(title, lambda: (function, args), on_done=on_done, on_failed=on_failed, in_process=in_process)

    def prepare(
        self,
        title: str,
        prepare: Callable[[], Work],
        *,
        on_done: Callable[[Any], object],
        on_failed: Callable[[Exception], object] | None = None,
        in_process: bool = False,
    ) -> None:
        """As :meth:`do`, with the function and its arguments asked for when the turn comes."""
        self._waiting.append(_Job(title, prepare, on_done, on_failed, in_process))
        if self._task is None:
            self._next()

    def cancel(self) -> None:
        """Stop what runs, and forget what waits."""
        waited = bool(self._waiting)
        self._waiting.clear()
        if self._task is not None:
            self._task.cancel()
        elif waited:
            self.ended.emit()

    def fail(self, title: str, error: Exception) -> None:
        """Log a failure, and report it by the signal."""
        _LOG.error(message("gui.log-task-error", "{task}: {error}", task=title, error=shown_error(error)))
        self.failed.emit(title, error)

    def _next(self) -> None:
        while self._waiting:
            job = self._waiting.popleft()
            failed = job.on_failed or partial(self.fail, job.title)
            try:
                work = job.prepare()
            except Exception as error:  # those that wait must have their turn, whatever this one lacks
                if not isinstance(error, GeofitError):
                    _LOG.exception(message("gui.log-task-failed", "{task} failed", task=job.title))
                failed(error)
                continue
            if work is None:
                continue
            start = run_in_process if job.in_process else run
            self._task = start(
                self,
                work[0],
                *work[1],
                title=job.title,
                on_done=job.on_done,
                on_failed=failed,
                on_progress=self.progressed.emit,
                on_cancelled=partial(_LOG.info, message("gui.log-stopped", "Stopped: {task}", task=job.title)),
            )
            self._task.ended.connect(self._after)
            # Not before there is a task: who hears of it checks whether something can be stopped.
            self.began.emit(job.title)
            return
        self.ended.emit()

    def _after(self) -> None:
        self._task = None
        self._next()
