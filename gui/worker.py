"""Long tasks beside the window: stages, progress, Cancel; results come back in the window's own thread.

A task is a function that takes ``progress=`` (see :mod:`geofit.data.progress`). :func:`run` calls it in a thread.
:func:`run_in_process` calls it in a process of its own: whatever holds the interpreter's lock in a thread (OpenCASCADE
for seconds, a fit for tenths) would stop the window; such a function, its arguments and its result must be picklable.
"""

from __future__ import annotations

import itertools
import logging
import multiprocessing
import shutil
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QObject, Qt, QThreadPool, Signal
from shiboken6 import isValid

from geofit.data.errors import Cancelled, GeofitError
from geofit.data.files import report_unfinished_to
from geofit.data.messages import message

__all__ = ["Task", "finish_all", "run", "run_in_process", "tasks", "warm"]

_LOG = logging.getLogger(__name__)

#: Seconds between two reports of progress that reach the window.
_PAUSE = 0.05
#: Seconds between two looks at a process of its own.
_LOOK = 0.05
#: Seconds that a process has to end when it is asked to.
_PATIENCE = 1.0
#: Bytes of the longest news of a file; what is longer is a result.
_SHORT = 1 << 16


class _Line:
    """What a task's thread knows of it: whether to stop, and where news go.

    It is not a Qt object: those die in the window's thread, at any time.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.stop = threading.Event()
        self._reported = 0.0

    def listen(self, stage: str, fraction: float, /) -> bool:
        """Hear of progress in the task's thread, and pass it on, not too often."""
        now = time.monotonic()
        if now - self._reported >= _PAUSE or fraction >= 1.0:
            self._reported = now
            _bridge().heard.emit(self.number, stage, fraction)
        return not self.stop.is_set()


class Task(QObject):
    """A task under way. Signals come in the thread that started it; after ``ended`` nothing more comes."""

    # Objects: of a sentence Qt would keep the letters only, not what another language is raised from.
    progressed = Signal(object, float)
    done = Signal(object)
    failed = Signal(object)
    cancelled = Signal()
    ended = Signal()

    def __init__(self, parent: QObject, title: str, line: _Line) -> None:
        super().__init__(parent)
        self.title = title
        self._line = line
        parent.destroyed.connect(line.stop.set)

    @property
    def stopping(self) -> bool:
        """Whether somebody asked to stop."""
        return self._line.stop.is_set()

    def cancel(self) -> None:
        """Ask the task to stop; it ends with ``cancelled`` at its next report of progress."""
        self._line.stop.set()

    def end(self, kind: str, value: object) -> None:
        """Tell how the task ended."""
        if kind == "done" and self.stopping:
            kind = "cancelled"
        if kind == "done":
            self.done.emit(value)
        elif kind == "failed":
            self.failed.emit(value)
        else:
            self.cancelled.emit()
        self.ended.emit()
        # Not deleteLater(): the last reference to it goes here, and a deletion from the event loop has been seen to
        # meet connections to Python functions half gone.
        self.setParent(None)


class _Job:
    """A function and its arguments.

    Not a QRunnable: PySide keeps those as long as their pool, with their arguments.
    """

    def __init__(self, line: _Line, title: str, function: Callable[..., Any], args: tuple[Any, ...]) -> None:
        self._line, self._title, self._function, self._args = line, title, function, args

    def run(self) -> None:
        """Call the function, in a thread of the pool; whatever happens is raised in the window's thread."""
        try:
            if self._line.stop.is_set():
                raise Cancelled(message("gui.stopped-before-start", "Stopped before it began."))
            result = self._function(*self._args, progress=self._line.listen)
        except Cancelled as stop:
            outcome: tuple[str, object] = ("cancelled", stop)
        except GeofitError as error:
            outcome = ("failed", error)
        except Exception as error:  # the last frame of this thread: the window must hear of any failure
            _LOG.exception(
                message(
                    "gui.log-task-failed",
                    "{task} failed",
                    task=self._title or getattr(self._function, "__name__", "task"),
                )
            )
            outcome = ("failed", error)
        else:
            outcome = ("done", result)
        number = self._line.number
        # The last reference to the line is the task's: Qt must disconnect it in the window's thread.
        del self._line, self._function, self._args
        _bridge().ended.emit(number, *outcome)


class _Bridge(QObject):
    """Carries news from the tasks' threads to the window's; it outlives them all."""

    heard = Signal(int, object, float)
    ended = Signal(int, str, object)

    def __init__(self) -> None:
        super().__init__()
        self.heard.connect(self._pass_on, Qt.ConnectionType.QueuedConnection)
        self.ended.connect(self._end, Qt.ConnectionType.QueuedConnection)

    def _pass_on(self, number: int, stage: str, fraction: float) -> None:
        task = _RUNNING.get(number)
        if task is not None and isValid(task):
            task.progressed.emit(stage, fraction)

    def _end(self, number: int, kind: str, value: object) -> None:
        task = _RUNNING.pop(number, None)
        if task is not None and isValid(task):
            task.end(kind, value)


_NUMBERS = itertools.count()
_RUNNING: dict[int, Task] = {}
_HELPERS: list[Helper] = []
_POOL: QThreadPool | None = None
_BRIDGE: _Bridge | None = None


def run(
    parent: QObject,
    function: Callable[..., Any],
    *args: Any,
    on_done: Callable[[Any], object] | None = None,
    on_failed: Callable[[Exception], object] | None = None,
    on_progress: Callable[[str, float], object] | None = None,
    on_cancelled: Callable[[], object] | None = None,
    title: str = "",
) -> Task:
    """Call ``function(*args, progress=...)`` in a thread; the callbacks are called in this one.

    If ``parent`` goes, the task is asked to stop and nothing is called any more.
    """
    _bridge()
    line = _Line(next(_NUMBERS))
    task = Task(parent, title, line)
    for signal, callback in (
        (task.done, on_done), (task.failed, on_failed), (task.progressed, on_progress), (task.cancelled, on_cancelled),
    ):  # fmt: skip
        if callback is not None:
            signal.connect(callback)
    _RUNNING[line.number] = task
    _pool().start(_Job(line, title, function, args).run)
    return task


def run_in_process(parent: QObject, function: Callable[..., Any], *args: Any, **listeners: Any) -> Task:
    """As :func:`run`, in another process, which Cancel ends at once."""
    return run(parent, _in_process, function, args, **listeners)


def warm(function: Callable[..., Any]) -> None:
    """Have a process ready before it is needed; it calls ``function``, which loads what will be needed there."""
    _pool().start(lambda: _HELPERS.append(Helper(function)))


def tasks() -> tuple[Task, ...]:
    """Return the tasks under way."""
    return tuple(_RUNNING.values())


def finish_all(seconds: float = 30.0, *, helpers: bool = True) -> bool:
    """Stop all tasks and wait until threads have ended, and idle ``helpers`` too; False if some did not in time."""
    for task in tasks():
        if isValid(task):
            task.cancel()
    ended = _POOL is None or _POOL.waitForDone(int(1000 * seconds))
    while helpers and _HELPERS:
        _HELPERS.pop().end()
    QCoreApplication.sendPostedEvents()
    return ended


def _pool() -> QThreadPool:
    global _POOL
    if _POOL is None:
        # More than one, so that a long export does not hold up a fit; most of them wait for another process.
        _POOL = QThreadPool()
        _POOL.setMaxThreadCount(4)
        _POOL.setExpiryTimeout(2000)
    return _POOL


def _bridge() -> _Bridge:
    """Return the bridge; :func:`run` makes it, in the window's thread."""
    global _BRIDGE
    if _BRIDGE is None:
        _BRIDGE = _Bridge()
    return _BRIDGE


class Helper:
    """A process that runs one function after another; it has loaded OpenCASCADE when the second comes."""

    def __init__(self, first: Callable[..., Any] | None = None) -> None:
        self.first = first
        self._sender: threading.Thread | None = None
        #: Files and folders that the process has begun, and will remove or rename.
        self._unfinished: set[Path] = set()
        # A fresh interpreter: a fork of a process with threads and a window would inherit locks nobody frees.
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, first), daemon=True)
        self._process.start()
        theirs.close()

    @property
    def alive(self) -> bool:
        """Whether the process is there: one that idles may have been ended by the system, for its memory."""
        return self._process.is_alive()

    def call(self, function: Callable[..., Any], args: tuple[Any, ...], progress: Callable[..., bool | None]) -> Any:
        order = ForkingPickler.dumps((function, args))
        # In a thread: a process that the system has stopped reads nothing, and Cancel must be heard meanwhile.
        self._sender = threading.Thread(target=self._send, args=(order,), daemon=True)
        self._sender.start()
        name, fraction, begun = "start", 0.0, False
        while True:
            if progress(name, fraction) is False:
                raise Cancelled(message("gui.stopped-by-caller", "Stopped by the caller."))
            if not self.pipe.poll(_LOOK):
                continue
            try:
                kind, value = self.pipe.recv()
            except (EOFError, OSError):
                self._process.join(5)
                ended = GeofitError(
                    message(
                        "gui.worker-ended",
                        "The worker process ended unexpectedly (exit code {code}). Memory may have run out: "
                        "close other programs and try again.",
                        code=self._process.exitcode,
                    )
                )
                raise (ended if begun else _NotBegunError(ended)) from None
            if kind == "begun":
                begun = True
                self._sender.join()  # the order was read: no thread outlives the call
            elif kind == "progress":
                name, fraction = value
            elif kind == "file":
                self._hear_file(*value)
            elif kind == "error":
                raise _ChildError(value)
            else:
                return value

    def _send(self, order: memoryview) -> None:
        with suppress(OSError):  # the process has ended, which the reading end finds out
            self.pipe.send_bytes(order)

    def end(self) -> None:
        self._process.terminate()
        self._process.join(_PATIENCE)
        # A stopped process hears no other signal.
        self._process.kill()
        self._process.join()
        if self._sender is not None:
            self._sender.join(_PATIENCE)  # nobody reads any more: its writing fails
        self._sweep()
        self.pipe.close()
        self._process.close()

    def _hear_file(self, path: Path, begun: bool) -> None:
        (self._unfinished.add if begun else self._unfinished.discard)(path)

    def _sweep(self) -> None:
        """Remove the files that the ended process had begun: it could not."""
        with suppress(Exception):  # its last news may be cut off
            while self.pipe.poll():
                news = self.pipe.recv_bytes()
                if len(news) < _SHORT:
                    kind, value = ForkingPickler.loads(news)
                    if kind == "file":
                        self._hear_file(*value)
        for path in self._unfinished:
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                with suppress(OSError):
                    path.unlink(missing_ok=True)


class _ChildError(Exception):
    """An error that the function raised: the process itself is sound."""

    def __init__(self, error: Exception) -> None:
        super().__init__(str(error))
        self.error = error


class _NotBegunError(Exception):
    """A process ended before it took up the work."""

    def __init__(self, error: GeofitError) -> None:
        super().__init__(str(error))
        self.error = error


def _in_process(function: Callable[..., Any], args: tuple[Any, ...], progress: Callable[..., bool | None]) -> Any:
    helper, idle = _ready()
    try:
        result = helper.call(function, args, progress)
    except _NotBegunError as gone:
        helper.end()
        if idle:  # it was ended while it waited, perhaps as the order was on its way: a fresh one does the work
            return _in_process(function, args, progress)
        raise gone.error from None
    except _ChildError as raised:
        _HELPERS.append(helper)
        raise raised.error from None
    except BaseException:
        helper.end()
        if helper.first is not None:
            # Another one gets ready meanwhile: to begin afresh takes seconds.
            _HELPERS.append(Helper(helper.first))
        raise
    _HELPERS.append(helper)
    return result


def _ready() -> tuple[Helper, bool]:
    """Return a process that has waited for work, or a new one; and whether it has waited."""
    while _HELPERS:
        helper = _HELPERS.pop()
        if helper.alive:
            return helper, True
        helper.end()
    return Helper(), False


def _serve(pipe: Connection, first: Callable[..., Any] | None) -> None:
    if first is not None:
        first()

    # Threads of a task may write files, too.
    turn = threading.Lock()

    def send(kind: str, value: object) -> None:
        with turn:
            pipe.send((kind, value))

    def listen(stage: str, fraction: float, /) -> None:
        send("progress", (stage, fraction))

    report_unfinished_to(lambda path, begun: send("file", (path.absolute(), begun)))
    while True:
        try:
            function, args = pipe.recv()
        except EOFError:
            return  # the application has ended
        send("begun", None)
        try:
            send("done", function(*args, progress=listen))
        except Exception as error:  # the last frame of this task: the window must hear of any failure
            send("error", _portable(error))


def _portable(error: Exception) -> Exception:
    """Return an error that another process can read, with the traceback as a note: that itself stays here."""
    if isinstance(error, GeofitError):
        return error
    trace = "".join(traceback.format_exception(error))
    try:
        ForkingPickler.loads(ForkingPickler.dumps(error))
    except Exception:  # errors of other libraries: some can be written and not read again
        error = RuntimeError(f"{type(error).__name__}: {error}")
    error.add_note(trace)
    return error
