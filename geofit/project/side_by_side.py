"""Work on several horizons side by side: a process for each core, and none where there is one core or one horizon."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from typing import TypeVar

from geofit.data.errors import Cancelled
from geofit.data.messages import Message
from geofit.data.progress import Progress, tell

__all__ = ["Crew", "available", "crew"]

T = TypeVar("T")

#: Imports what a process needs; where processes are forked, the one that they are forked from.
PRELOAD = "geofit.project.preload"
#: Seconds between two looks at Cancel.
LOOK = 0.1


def available() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Crew:
    """Processes that work on tasks; without any, the tasks are done here, one after another."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        self._pool = pool
        # Tasks are handed over by a thread: whoever starts the first process waits until all is imported there.
        self._giver = ThreadPoolExecutor(1, "crew")

    def begin(self, task: Callable[[], T]) -> Callable[[], T]:
        """Begin one task now, and return a function that waits for its result; without processes it does the task.

        Parameters
        ----------
        task : callable
            As for :meth:`do`. What it raises, the function that is returned raises.
        """
        if self._pool is None:
            return task
        given = self._giver.submit(self._pool.submit, task)

        def result() -> T:
            try:
                return given.result().result()
            except BrokenProcessPool:
                return task()

        return result

    def leave(self) -> None:
        """Hand over no more tasks."""
        self._giver.shutdown(wait=False, cancel_futures=True)

    def do(
        self, tasks: Sequence[Callable[[], T]], progress: Progress | None, stage: str | Message = ""
    ) -> Iterator[tuple[int, T]]:
        """Call each task; yield the number of a task and its result as they are ready.

        Parameters
        ----------
        tasks : sequence of callable
            Functions of modules with their arguments (:func:`functools.partial`), picklable like their results; the
            first begins first.
        progress : callable, optional
            Called as ``progress(stage, share of the tasks that are done)``.
        stage : str or Message
            What the progress says.

        Raises
        ------
        Cancelled
            If ``progress`` returned False; tasks that have not begun are dropped.
        """
        if self._pool is None:
            for i, task in enumerate(tasks):
                tell(progress, stage, i / len(tasks))
                yield i, task()
            return
        # A process that was killed, for want of memory for one, breaks the pool: the rest is done here.
        pending: dict[Future[T], int] = {}
        broken: list[int] = []
        for i, task in enumerate(tasks):
            try:
                pending[self._giver.submit(self._pool.submit, task).result()] = i
            except BrokenProcessPool:
                broken.append(i)
        while pending:
            done, _ = wait(pending, timeout=LOOK, return_when=FIRST_COMPLETED)
            try:
                tell(progress, stage, 1 - len(pending) / len(tasks))
            except Cancelled:
                for future in pending:
                    future.cancel()
                raise
            for future in sorted(done, key=pending.__getitem__):
                i = pending.pop(future)
                try:
                    yield i, future.result()
                except BrokenProcessPool:
                    broken.append(i)
        for i in broken:
            yield i, tasks[i]()


@contextmanager
def crew(size: int) -> Iterator[Crew]:
    """Keep a crew of ``size`` processes at work; below 2, or within a process that may have none, there is none."""
    if size < 2 or multiprocessing.current_process().daemon:
        yield Crew(None)
        return
    context = multiprocessing.get_context("forkserver" if sys.platform.startswith("linux") else "spawn")
    if sys.platform.startswith("linux"):
        context.set_forkserver_preload([PRELOAD])
    pool = ProcessPoolExecutor(size, mp_context=context, initializer=_begin)
    hands = Crew(pool)
    try:
        for _ in range(size):
            hands.begin(_ready)
        yield hands
    except BaseException:
        hands.leave()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    hands.leave()
    pool.shutdown()


def _begin() -> None:
    """Import what the work needs, leave Ctrl-C to the process that gives it, and one core to each process."""
    from threadpoolctl import threadpool_limits

    _end_with_parent()
    import_module(PRELOAD)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(limits=1)


def _end_with_parent() -> None:
    """End this process as soon as the one that gives it work has gone.

    It holds both ends of its pipes, and would wait for ever for a task of a process that was killed.
    """
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _ready() -> None:
    """Do nothing: the process starts, and imports what it needs."""
