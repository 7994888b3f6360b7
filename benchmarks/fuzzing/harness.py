"""Seeded cases, each in results or a geofit error: the one loop of all fuzzers."""

from __future__ import annotations

import random
import signal
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from fuzzing.mutate import damaged
from geofit.data.errors import GeofitError

__all__ = ["Files", "run"]

#: Failures that are kept as text.
KEPT = 20
#: A case may take so many times its seconds of processor time by the clock: other programs run too.
PATIENCE = 20


class Group(Protocol):
    """A module of sound files and of what reads them."""

    def originals(self, folder: Path) -> dict[str, bytes]:
        """Return sound files by name."""

    def read(self, name: str, folder: Path, done: list[str], case: int) -> Counter[str]:
        """Read one of them; return what is to be counted, raise AssertionError for what must not be."""


@dataclass
class Files:
    """Files of one group: each case damages one and reads it with the undamaged others."""

    group: Group
    folder: Path
    names: tuple[str, ...] = ()
    sound: dict[str, bytes] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.sound = self.sound or self.group.originals(self.folder)

    def __call__(self, case: int) -> Counter[str]:
        """Damage and read one file, all of it given by the number of the case."""
        rng = random.Random(case)
        name = rng.choice(self.names or tuple(sorted(self.sound)))
        data, done = damaged(self.sound[name], rng)
        for other, text in self.sound.items():
            (self.folder / other).write_bytes(data if other == name else text)
        try:
            return self.group.read(name, self.folder, done, case) + Counter(["read"])
        except GeofitError:
            raise
        except Exception as error:
            error.add_note(f"{name}: {', '.join(done)}")
            raise


def run(cases: int, seed: int, one: Callable[[int], Counter[str]], limit: int) -> tuple[Counter[str], list[str]]:
    """Return the outcomes of seeded cases, and the first failures as text; ``limit`` in seconds of processor time."""
    outcomes: Counter[str] = Counter()
    failures: list[str] = []
    for case in range(seed * 1_000_000, seed * 1_000_000 + cases):
        try:
            with _limited(limit), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                outcomes += one(case)
        except GeofitError:
            outcomes["geofit error"] += 1
        except Exception:  # the point of the exercise is to see every other one
            outcomes["failed"] += 1
            if len(failures) < KEPT:
                failures.append(f"case {case}:\n{traceback.format_exc(limit=-4)}")
    return outcomes, failures


@contextmanager
def _limited(seconds: int) -> Iterator[None]:
    """Raise TimeoutError in a case that takes too long, where the system has such alarms."""
    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGPROF, _late), signal.signal(signal.SIGALRM, _late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE * seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGPROF, before[0])
        signal.signal(signal.SIGALRM, before[1])


def _late(number: int, frame: object) -> None:
    raise TimeoutError("longer than its limit")
