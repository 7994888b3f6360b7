"""A child that works on a document and is killed: each command that is journalled is acknowledged on stdout.

``python cut_off.py FOLDER COUNT SEED`` forks COUNT sessions, one after another, and kills each (SIGKILL) at a random
moment; it prints, a line each, the seed, how many steps the session had acknowledged, and its process number.
"""

from __future__ import annotations

import os
import random
import select
import signal
import sys
import time
from pathlib import Path

import numpy as np

from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site
from geofit.project.commands import (
    AdjustControlPoint,
    Command,
    ExcludeRows,
    IncludeRows,
    MoveToPoint,
    RenameSite,
    SetCore,
    SetOrder,
    SetSettings,
    SetSurface,
)
from geofit.project.document import Document
from geofit.project.journal import SessionJournal
from geofit.project.provenance import DocumentError, Row

STEPS = 400
NAMES = ("上层 T3/T2", "T2-T1", "W")


def tiny_site() -> Site:
    """Three horizons of 12 points."""
    rng = np.random.default_rng(5)
    sets = {}
    for k, name in enumerate(NAMES):
        xyz = np.column_stack([rng.uniform(0, 100, (12, 2)), rng.uniform(0, 5, 12) - 10 * k])
        sets[name] = PointSet(xyz, file="picks.csv", row=np.arange(2, 14))
    return Site("Tiny", sets, boundary=np.array([[0.0, 0], [100, 0], [100, 100], [0, 100]]))


def steps(seed: int):
    """Yield what a session does, for ever: a command, "undo" or "redo"; whether it applies is seen when it is tried."""
    rng = random.Random(seed)
    while True:
        name = rng.choice(NAMES)
        row = Row("picks.csv", rng.randint(2, 13))
        order = tuple(rng.sample(NAMES, 3))
        x, y = rng.uniform(0, 30), rng.uniform(0, 30)
        yield rng.choice(
            [
                "undo",
                "redo",
                SetSettings(name, FitSettings(epsilon=rng.uniform(0.01, 2), seam="position")),
                SetCore(name, rng.choice(["auto", "none", ((x, y), (x + 40, y), (x + 40, y + 40.1))])),
                ExcludeRows(name, (row,)),
                IncludeRows(name, (row,)),
                SetOrder(order),
                RenameSite(f"坝址 {rng.random()}"),
                "fit",
                AdjustControlPoint(name, "core", rng.randint(0, 3), 1, rng.uniform(-1, 1)),
                MoveToPoint(name, rng.randint(0, 11), rng.random()),
            ]
        )


class Player:
    """Plays steps on a document with an undo stack of its own, and tells a journal if there is one."""

    def __init__(self, journal: SessionJournal | None) -> None:
        self.document, self.journal = Document(), journal
        self.document.open(tiny_site(), Path("site.toml"))
        self.done: list[Command] = []
        self.undone: list[Command] = []

    def play(self, step: Command | str) -> bool:
        """Do one step; False if it does not apply, and nothing was done."""
        if step == "undo":
            if not self.done:
                return False
            self.undone.append(self.done.pop())
            self.undone[-1].undo(self.document)
            if self.journal:
                self.journal.undone()
        elif step == "redo":
            if not self.undone:
                return False
            self.done.append(self.undone.pop())
            self.done[-1].redo(self.document)
            if self.journal:
                self.journal.redone()
        else:
            command = SetSurface(self.document.provenance(self.document.horizons[0])) if step == "fit" else step
            assert isinstance(command, Command)
            try:
                command.redo(self.document)
            except DocumentError:
                return False
            self.done.append(command)
            self.undone.clear()
            if self.journal:
                self.journal.done(command)
        return True


def session(folder: Path, seed: int, acknowledge: int) -> None:
    """Work until killed."""
    document = Document()
    document.open(tiny_site(), Path("site.toml"))
    player = Player(SessionJournal(folder, document.state, Path("site.toml"), None))
    os.write(acknowledge, b".")
    count = 0
    for step in steps(seed):
        if player.play(step):
            os.write(acknowledge, b".")
            count += 1
            if count == STEPS:
                signal.pause()


def main(folder: Path, count: int, seed: int) -> None:
    """Fork sessions and kill them."""
    rng = random.Random(seed)
    for turn in range(count):
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            session(folder, seed + turn, writing)
        os.close(writing)
        # So many steps first, then at any moment: steps take longer where the machine has other work.
        told, least = 0, rng.randrange(1, 40)
        while told < least and select.select([reading], [], [], 30)[0] and (said := os.read(reading, least - told)):
            told += len(said)
        time.sleep(rng.uniform(0, 0.01))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        while data := os.read(reading, 65536):
            told += len(data)
        os.close(reading)
        print(seed + turn, told - 1, child, flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
