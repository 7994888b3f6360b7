"""Many tasks on the processors of this machine, or on those of a Dask cluster, by the same call.

``"local"`` starts processes of this machine; ``"tcp://host:port"`` is the address of a Dask scheduler, and the path of
a file the one that a Dask scheduler writes (``dask scheduler --scheduler-file FILE``, as jobs of Slurm do). A task is a
function of one argument; its result does not depend on where it runs. A worker that dies costs its task a second try.
"""

from __future__ import annotations

import contextlib
import itertools
import multiprocessing
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from geofit.data.distribution import install_line
from geofit.data.errors import MissingDependencyError, SchedulerError, SettingsError
from geofit.data.messages import message
from geofit.data.threads import one_thread
from geofit.streaming.kept import keep, kept, kept_path

__all__ = ["HERE", "WORKERS", "SchedulerError", "Where", "run_tasks"]

T = TypeVar("T")
R = TypeVar("R")

#: Processes of this machine.
WORKERS = max(1, os.cpu_count() or 1)
#: Workers that may die over one and the same task before it is given up.
TRIES = 3
#: Seconds within which a scheduler must answer.
PATIENCE = 20
#: Seconds between two looks at a cluster.
LOOK = 0.02


def run_tasks(
    work: Callable[[T], R], tasks: Sequence[T], scheduler: str = "local", workers: int | None = None
) -> Iterator[tuple[int, R]]:
    """Yield the place of each task and its result, as they get ready.

    Parameters
    ----------
    work : callable
        A function at the top of a module, of one argument that can be sent to another process.
    tasks : sequence
        Its arguments.
    scheduler : str
        "local", the address of a Dask scheduler, or the path of its file.
    workers : int, optional
        Number of local processes; by default as many as there are processors. With one, no process is started.

    Raises
    ------
    SchedulerError
        If the scheduler cannot be reached or is lost, or workers die over one task.
    MissingDependencyError
        If a Dask scheduler is named and the extra ``scale`` is not installed.
    """
    if scheduler == "local":
        count = min(workers or WORKERS, len(tasks))
        if count <= 1:
            yield from ((k, work(task)) for k, task in enumerate(tasks))
        else:
            yield from _on_processes(work, tasks, count)
    else:
        yield from _on_dask(work, tasks, scheduler)


@dataclass(frozen=True)
class Where:
    """Where tasks run: a scheduler and, of this machine, the number of its processes; see :func:`run_tasks`.

    In ``folder`` each result is kept as soon as it is ready, and one that is there is not computed again.
    """

    scheduler: str = "local"
    workers: int | None = 1
    folder: Path | None = None

    def run(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R]]:
        """Yield the place of each task and its result, as they get ready."""
        if self.folder is None:
            yield from run_tasks(work, tasks, self.scheduler, self.workers)
            return
        paths, left = [kept_path(self.folder, work, task) for task in tasks], []
        for k, path in enumerate(paths):
            known, result = kept(path)
            if known:
                yield k, result
            else:
                left.append(k)
        for k, result in run_tasks(work, [tasks[k] for k in left], self.scheduler, self.workers):
            keep(paths[left[k]], result)
            yield left[k], result


#: One after another, in this process.
HERE = Where()


def _on_processes(work: Callable[[T], R], tasks: Sequence[T], count: int) -> Iterator[tuple[int, R]]:
    """Run tasks in processes; where one dies all are started anew, and what was under way is tried again."""
    left, tried = dict(enumerate(tasks)), [0] * len(tasks)
    while left:
        pool = ProcessPoolExecutor(count, multiprocessing.get_context("spawn"))
        waiting = iter(list(left))
        running: dict[Future[R], int] = {}
        try:
            while True:
                # Few tasks at a time: what has not begun is not counted as tried.
                for k in itertools.islice(waiting, count + 1 - len(running)):
                    running[pool.submit(_alone, work, left[k])] = k
                if not running:
                    break
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    result = future.result()
                    k = running.pop(future)
                    del left[k]
                    yield k, result
        except BrokenProcessPool:
            for k in running.values():
                tried[k] += 1
                if tried[k] >= TRIES:
                    raise SchedulerError(
                        message(
                            "streaming.workers-die",
                            "Worker processes died {count} times over task {task} of {total}, perhaps for want of "
                            "memory. Free memory, or use fewer workers.",
                            count=TRIES,
                            task=k + 1,
                            total=len(tasks),
                        )
                    ) from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _alone(work: Callable[[T], R], task: T) -> R:
    """Work on one thread: there are as many processes as processors.

    A limit set at the start of a process would not hold for libraries that it loads later, as scipy's own is.
    """
    with one_thread():
        return work(task)


def _on_dask(work: Callable[[T], R], tasks: Sequence[T], scheduler: str) -> Iterator[tuple[int, R]]:
    client, distributed = _client(scheduler)
    total = len(tasks)
    try:
        futures = {k: client.submit(_alone, work, task, pure=False) for k, task in enumerate(tasks)}
        while futures:
            ready = [k for k, future in futures.items() if future.status in ("finished", "error")]
            for k in ready:
                result = futures[k].result()
                del futures[k]
                yield k, result
            gone = any(future.status in ("cancelled", "lost") for future in futures.values())
            if gone or client.status != "running":
                raise _lost(scheduler, total - len(futures), total)
            if not ready:
                time.sleep(LOOK)
    except (OSError, distributed.CancelledError, distributed.KilledWorker):
        raise _lost(scheduler, total - len(futures), total) from None
    finally:
        with contextlib.suppress(Exception):  # the result is known; a cluster that is gone cannot be left politely
            client.close(timeout=2)


def _client(scheduler: str) -> tuple[Any, Any]:
    try:
        import distributed
    except ImportError as error:
        raise MissingDependencyError(
            message(
                "streaming.dask-missing",
                "The scheduler {scheduler} needs Dask, which cannot be imported ({error}). Install it: {install}, or "
                "use --scheduler local.",
                scheduler=scheduler,
                error=error,
                install=install_line("scale"),
            )
        ) from None
    if "://" not in scheduler and not Path(scheduler).is_file():
        raise SettingsError(
            message(
                "streaming.scheduler-unknown",
                "The scheduler '{scheduler}' is neither 'local', nor an address (tcp://host:port), nor a scheduler "
                "file that is there.",
                scheduler=scheduler,
            )
        )
    named = {"address": scheduler} if "://" in scheduler else {"scheduler_file": scheduler}
    try:
        return distributed.Client(**named, timeout=PATIENCE, set_as_default=False), distributed
    except (AssertionError, KeyError, OSError, TimeoutError, ValueError):  # a file without an address as well
        raise SchedulerError(
            message(
                "streaming.scheduler-silent",
                "No scheduler answers at {scheduler} within {seconds} s. Check the address and that it runs.",
                scheduler=scheduler,
                seconds=PATIENCE,
            )
        ) from None


def _lost(scheduler: str, ready: int, total: int) -> SchedulerError:
    return SchedulerError(
        message(
            "streaming.scheduler-lost",
            "The connection to the scheduler at {scheduler} or its workers was lost; {ready} of {total} tasks were "
            "ready. Start the same command again to continue with the others.",
            scheduler=scheduler,
            ready=ready,
            total=total,
        )
    )
