"""Tasks beside the window: results, failures and progress arrive in the window's thread; Cancel stops them."""

from __future__ import annotations

import gc
import os
import signal
import tempfile
import threading
import time
import traceback
import weakref
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path

import pytest
from PySide6.QtCore import QObject

from geofit.data.errors import FitError
from geofit.data.files import replacing, unfinished_file
from geofit.data.messages import message
from geofit.data.progress import tell
from geofit.gui import worker


def double(value, *, progress):
    tell(progress, "half", 0.5)
    tell(progress, "done", 1.0)
    return 2 * value, threading.get_ident()


def endless(*, progress):
    while True:
        tell(progress, "on", 0.3)
        time.sleep(0.005)


def failing(*, progress):
    raise FitError(message("test.text", "These points cannot be fitted."))


def mistaken(*, progress):
    return 1 / 0


class UnreadableError(Exception):
    """Can be written by pickle and not read: its argument is not handed to the base class."""

    def __init__(self, code):
        super().__init__()
        self.code = code

    def __str__(self):
        return f"code {self.code}"


def unreadable(*, progress):
    raise UnreadableError(7)


def process_number(*, progress):
    tell(progress, "there", 0.7)
    return os.getpid()


def stuck(*, progress):
    time.sleep(600)


def writing(path, *, progress):
    """Be in the midst of a file, as most exports are for seconds."""
    with replacing(path) as part:
        part.write_text("half", encoding="utf-8")
        tell(progress, "half", 0.5)
        time.sleep(600)


def reading(path, *, progress):
    """Be in the midst of a CAD file, which a child of the process reads."""
    with tempfile.TemporaryDirectory(dir=path.parent) as folder, unfinished_file(folder):
        (Path(folder) / "result.npz").write_text("half", encoding="utf-8")
        tell(progress, "half", 0.5)
        time.sleep(600)


def dying_in_the_midst(path, *, progress):
    with replacing(path) as part:
        part.write_text("half", encoding="utf-8")
        os._exit(3)


def dying(*, progress):
    os._exit(3)


@pytest.fixture
def owner(qtbot):
    owner = QObject()
    yield owner
    owner.deleteLater()


class Given:
    """What a task is given: ``died`` is called when the one who listens to the task's progress is gone."""

    def __init__(self, died):
        self.died = died


def taking(given, listeners, *, progress):
    listeners.append(weakref.ref(progress.__self__, given.died))


def refusing(given, listeners, *, progress):
    taking(given, listeners, progress=progress)
    failing(progress=progress)


@pytest.mark.parametrize("function", [taking, refusing])
def test_what_tasks_were_given_goes_with_them_and_who_listens_dies_in_the_windows_thread(owner, qtbot, function):
    given, listeners, threads = [], [], []

    def died(_):
        threads.append(threading.current_thread())

    for _ in range(100):
        one = Given(died)
        given.append(weakref.ref(one))
        worker.run(owner, function, one, listeners)
        del one
        qtbot.waitUntil(lambda: not worker.tasks())
    worker.finish_all()
    gc.collect()
    assert not [one for one in (*given, *listeners) if one() is not None]
    assert len(threads) == 100
    assert set(threads) == {threading.main_thread()}


def test_the_result_comes_in_the_windows_thread(owner, qtbot):
    heard, where = [], []

    def listen(stage, fraction):
        heard.append((stage, fraction))
        where.append(threading.get_ident())

    results = []
    task = worker.run(owner, double, 21, on_done=results.append, on_progress=listen)
    with qtbot.waitSignal(task.ended):
        pass
    (value, thread), here = results[0], threading.get_ident()
    assert value == 42
    assert thread != here
    assert heard[-1] == ("done", 1.0)
    assert set(where) == {here}
    assert worker.tasks() == ()


def test_cancel_stops(owner, qtbot):
    stopped, results = [], []
    task = worker.run(owner, endless, on_done=results.append, on_cancelled=lambda: stopped.append(1))
    with qtbot.waitSignal(task.progressed):
        pass
    with qtbot.waitSignal(task.ended):
        task.cancel()
    assert (stopped, results) == ([1], [])


def test_failures_arrive_whole(owner, qtbot, caplog):
    errors = []
    for function in (failing, mistaken):
        task = worker.run(owner, function, on_failed=errors.append)
        with qtbot.waitSignal(task.ended):
            pass
    assert isinstance(errors[0], FitError)
    assert isinstance(errors[1], ZeroDivisionError)
    assert errors[1].__traceback__ is not None
    assert "ZeroDivisionError" in str(caplog.text)


def test_a_process_of_its_own_gives_its_result(owner, qtbot):
    results, errors = [], []
    task = worker.run_in_process(owner, process_number, on_done=results.append, on_failed=errors.append)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert not errors
    assert results[0] != os.getpid()


def test_no_thread_outlives_the_call_of_a_process(owner, qtbot, monkeypatch):
    send = Connection.send_bytes

    def slow(connection, order):
        send(connection, order)
        time.sleep(0.5)  # on a busy machine the result may be here before the thread has ended

    monkeypatch.setattr(Connection, "send_bytes", slow)
    before = set(threading.enumerate())
    task = worker.run_in_process(owner, double, 2)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert not [thread for thread in set(threading.enumerate()) - before if not thread.name.startswith("Dummy-")]


def test_cancel_ends_a_process_that_tells_nothing(owner, qtbot):
    stopped = []
    task = worker.run_in_process(owner, stuck, on_cancelled=lambda: stopped.append(1))
    with qtbot.waitSignal(task.progressed):
        pass
    with qtbot.waitSignal(task.ended, timeout=20_000):
        task.cancel()
    assert stopped == [1]


@pytest.mark.parametrize("function", [writing, reading])
def test_what_a_stopped_process_had_begun_is_removed(owner, qtbot, tmp_path, function):
    task = worker.run_in_process(owner, function, tmp_path / "sheet.pdf")
    qtbot.waitUntil(lambda: bool(list(tmp_path.iterdir())), timeout=60_000)
    with qtbot.waitSignal(task.ended, timeout=20_000):
        task.cancel()
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_a_dying_process_had_begun_is_removed(owner, qtbot, tmp_path):
    (tmp_path / "sheet.pdf").write_text("former")
    task = worker.run_in_process(owner, dying_in_the_midst, tmp_path / "sheet.pdf")
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("sheet.pdf", "former")]


def test_a_process_that_dies_says_so(owner, qtbot):
    errors = []
    task = worker.run_in_process(owner, dying, on_failed=errors.append)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert "ended unexpectedly (exit code 3)" in str(errors[0])


def test_a_failure_keeps_its_kind_across_the_process(owner, qtbot):
    errors = []
    task = worker.run_in_process(owner, failing, on_failed=errors.append)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert isinstance(errors[0], FitError)


def test_a_mistake_in_another_process_keeps_the_place_where_it_was_made(owner, qtbot, caplog):
    errors = []
    for function in (mistaken, unreadable):
        task = worker.run_in_process(owner, function, on_failed=errors.append)
        with qtbot.waitSignal(task.ended, timeout=60_000):
            pass
    assert isinstance(errors[0], ZeroDivisionError)
    assert "return 1 / 0" in "".join(traceback.format_exception(errors[0]))
    assert str(errors[1]) == "UnreadableError: code 7"
    assert "raise UnreadableError(7)" in "".join(traceback.format_exception(errors[1]))
    assert "return 1 / 0" in caplog.text


def pid_of_the_only_helper(owner, qtbot):
    """Have one idle process, and return its number."""
    worker.finish_all(10)
    results = []
    task = worker.run_in_process(owner, process_number, on_done=results.append)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    return results[0]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kill -9 is for Linux and macOS")
def test_a_process_that_died_while_idle_is_replaced(owner, qtbot):
    number = pid_of_the_only_helper(owner, qtbot)
    os.kill(number, signal.SIGKILL)
    time.sleep(0.2)
    results, errors = [], []
    task = worker.run_in_process(owner, process_number, on_done=results.append, on_failed=errors.append)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert not errors
    assert results[0] != number


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kill -9 is for Linux and macOS")
@pytest.mark.parametrize("wait", [0.0, 0.001, 0.01])
def test_a_process_that_dies_as_its_order_comes_is_replaced(owner, qtbot, monkeypatch, wait):
    number = pid_of_the_only_helper(owner, qtbot)
    # It seems alive when it is looked at, and dies before it reads its order.
    monkeypatch.setattr(worker.Helper, "alive", property(lambda helper: True))
    os.kill(number, signal.SIGKILL)
    time.sleep(wait)
    results, errors = [], []
    task = worker.run_in_process(owner, process_number, on_done=results.append, on_failed=errors.append)
    with qtbot.waitSignal(task.ended, timeout=60_000):
        pass
    assert not errors
    assert results[0] != number


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="processes are stopped on Linux and macOS")
@pytest.mark.parametrize("size", [1, 3_000_000])
def test_cancel_ends_a_stopped_process(owner, qtbot, size):
    # An order larger than a pipe holds is still on its way when Cancel comes.
    number = pid_of_the_only_helper(owner, qtbot)
    os.kill(number, signal.SIGSTOP)
    stopped = []
    task = worker.run_in_process(owner, double, "x" * size, on_cancelled=lambda: stopped.append(1))
    qtbot.wait(200)
    try:
        with qtbot.waitSignal(task.ended, timeout=20_000):
            task.cancel()
    finally:
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
    assert stopped == [1]


def test_the_owner_may_go_first(qtbot):
    owner = QObject()
    results = []
    worker.run(owner, endless, on_done=results.append)
    owner.deleteLater()
    del owner
    qtbot.wait(50)
    assert worker.finish_all(10)
    qtbot.waitUntil(lambda: worker.tasks() == ())
    assert results == []
