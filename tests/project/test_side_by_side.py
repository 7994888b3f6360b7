"""Work side by side: the same results in processes and here, errors and Cancel passed on, a killed process survived."""

from __future__ import annotations

import os
import time
from functools import partial

import pytest

from geofit.data.errors import Cancelled, InputError
from geofit.data.messages import message
from geofit.project.side_by_side import available, crew


def square(number: int) -> int:
    return number * number


def refuse(number: int) -> int:
    raise InputError(message("test.bad", "bad"), message("test.remedy", "mend"), value=str(number))


def vanish(number: int, home: int) -> int:
    """End the process at once, unless it is the test's own."""
    if os.getpid() != home:
        os._exit(1)
    return number


@pytest.mark.parametrize("size", [1, 2])
def test_every_task_is_done_once_and_its_result_comes_under_its_number(size):
    heard = []
    with crew(size) as hands:
        found = dict(hands.do([partial(square, k) for k in range(7)], lambda stage, share: heard.append(share), "work"))
    assert found == {k: k * k for k in range(7)}
    assert heard == sorted(heard)


@pytest.mark.parametrize("size", [1, 2])
def test_an_error_of_a_task_is_raised_here(size):
    with pytest.raises(InputError, match="bad"), crew(size) as hands:
        list(hands.do([partial(square, 2), partial(refuse, 1)], None))


@pytest.mark.parametrize("size", [1, 2])
def test_a_task_begun_alone_gives_its_result_or_error_when_it_is_asked_for(size):
    with crew(size) as hands:
        good, bad = hands.begin(partial(square, 3)), hands.begin(partial(refuse, 1))
        killed = hands.begin(partial(vanish, 4, os.getpid()))
        assert good() == 9
        with pytest.raises(InputError, match="bad"):
            bad()
        assert killed() == 4


def test_no_task_waits_for_what_the_processes_import():
    """The first process begins when all is imported, seconds later."""
    since = time.perf_counter()
    with crew(2) as hands:
        begun = hands.begin(partial(square, 3))
        handed_over = time.perf_counter() - since
        assert begun() == 9
    assert handed_over < 0.5 * (time.perf_counter() - since)


def test_cancel_stops_at_once():
    since = time.perf_counter()
    with pytest.raises(Cancelled), crew(2) as hands:
        list(hands.do([partial(time.sleep, 5.0)] * 6, lambda stage, share: False))
    assert time.perf_counter() - since < 5 * 3 - 1


def test_what_a_killed_process_had_to_do_is_done_here():
    with crew(2) as hands:
        found = dict(hands.do([partial(vanish, k, os.getpid()) for k in range(3)], None))
    assert found == {0: 0, 1: 1, 2: 2}


def test_the_number_of_cores_is_at_least_one():
    assert available() >= 1
