"""Kills at random moments of runs, saves, workers and windows: what is on the disk is whole, and work goes on.

Run ``python benchmarks/kills.py [RUNS] [SAVES] [WORKERS] [WINDOWS] [SEED]`` (default 60, 80, 40, 20, seed 1) on Linux
or macOS. A kill (SIGKILL) fails the run if a file is torn, a project names a file that is not there or has changed, the
next task of a window does not end, or a session that was killed does not come back with each step that it had told.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from geofit import PointSet, fit_horizon
from geofit.data.site import Site
from geofit.io.project import Project, open_project, save_project

ROOT = Path(__file__).resolve().parents[1]
#: How a whole file of each kind ends.
ENDS = {
    ".step": b"END-ISO-10303-21;\n",
    ".html": b"</html>",
    ".png": b"IEND\xaeB`\x82",
    ".csv": b"\n",
    ".json": b"}\n",
}


def points(seed: int) -> PointSet:
    """Return twelve points of a gentle surface."""
    plan = np.random.default_rng(seed).uniform(0, 100, (12, 2))
    return PointSet(np.column_stack([plan + np.array([500_000.0, 3_100_000.0]), 0.1 * plan[:, 0]]))


def killed(work: Callable[[], object], seconds: float | None) -> bool:
    """Do work in a fork of this process, and kill it after some seconds; return whether it was still at it."""
    child = os.fork()
    if child == 0:
        try:
            work()
        finally:
            os._exit(0)
    if seconds is not None:
        time.sleep(seconds)
        os.kill(child, signal.SIGKILL)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


def torn(folder: Path) -> list[str]:
    """Return the files that are there and not whole; what was under way has a hidden name."""
    found = []
    for path in folder.rglob("*"):
        if path.is_file() and not path.name.startswith("."):
            data = path.read_bytes()
            end = ENDS.get(path.suffix, b"")
            if not data or not data.endswith(end):
                found.append(f"{path.name}: {len(data)} bytes, ends with {data[-20:]!r}")
    return found


def runs(kills: int, rng: random.Random, folder: Path) -> int:
    """Kill runs of one horizon; return how many were cut off."""
    from geofit.project.run import run_horizons

    site = Site("killed", {"T": points(1)})

    def work(out: Path) -> None:
        run_horizons(site, out, date="2024-01-01")

    start = time.perf_counter()
    killed(lambda: work(folder / "whole"), None)  # in a fork, too: this process shall have no connection to a screen
    whole = time.perf_counter() - start
    assert not torn(folder / "whole"), torn(folder / "whole")
    cut = 0
    for turn in range(kills):
        out = folder / f"run{turn % 7}"  # into folders that hold an earlier run, too
        cut += killed(lambda out=out: work(out), rng.uniform(0, 1.2 * whole))
        assert not torn(out), torn(out)
        step = out / "T.step"
        assert not step.exists() or step.read_bytes() == (folder / "whole" / "T.step").read_bytes()
    killed(lambda: work(folder / "run0"), None)
    assert (folder / "run0" / "report.json").is_file()
    return cut


def saves(kills: int, rng: random.Random, folder: Path) -> int:
    """Kill saves of one project whose surface changes each time; return how many were cut off."""
    surfaces = [fit_horizon(points(seed), name="T") for seed in (1, 2)]
    target = folder / "p.geofit"
    save_project(Project(name="0"), target, {"T": surfaces[0]})

    def work() -> None:
        for turn in range(1_000):
            save_project(Project(name=str(turn)), target, {"T": surfaces[turn % 2]})

    cut = 0
    for _ in range(kills):
        cut += killed(work, rng.uniform(0.0, 0.5))
        project = open_project(target)
        assert project.changed(folder) == {}, project.changed(folder)
        assert len(project.results) == 1
        assert not torn(folder), torn(folder)
    return cut


def workers(kills: int, rng: random.Random, folder: Path) -> int:
    """Kill, or stop, worker processes of a window, idle or busy: each task ends, and the next one has its result."""
    import multiprocessing

    from PySide6.QtCore import QCoreApplication, QObject

    from geofit.data.errors import GeofitError
    from geofit.gui import worker

    app = QCoreApplication.instance() or QCoreApplication([])
    owner = QObject()

    def ended(task: worker.Task, seconds: float = 120.0) -> None:
        last = time.monotonic() + seconds
        while task in worker.tasks():
            app.processEvents()
            time.sleep(0.005)
            assert time.monotonic() < last, "a task does not end"

    cut = 0
    try:
        for turn in range(kills):
            results: list[object] = []
            errors: list[Exception] = []
            keep = {"on_done": results.append, "on_failed": errors.append}
            ended(worker.run_in_process(owner, _slowly, 0.0, **keep))
            assert results == [0.0], errors
            (process,) = multiprocessing.active_children()
            number = process.pid or 0
            how = signal.SIGSTOP if turn % 4 == 3 else signal.SIGKILL
            if turn % 2:  # at work
                task = worker.run_in_process(owner, _slowly, 0.3, **keep)
                until = time.monotonic() + rng.uniform(0, 0.4)
                while time.monotonic() < until:
                    app.processEvents()
                os.kill(number, how)
                if how is signal.SIGSTOP:
                    task.cancel()
                ended(task)
                if number in [left.pid for left in multiprocessing.active_children()]:
                    os.kill(number, signal.SIGKILL)  # stopped after its work, it would wait until somebody ends it
                assert all(isinstance(error, GeofitError) for error in errors), errors
            else:
                os.kill(number, how)
                time.sleep(rng.uniform(0, 0.1))
            cut += 1
    finally:
        worker.finish_all(30)
    return cut


def _slowly(seconds: float, *, progress: Callable[[str, float], bool | None]) -> float:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        progress("on", 0.5)
        time.sleep(0.01)
    return seconds


def windows(kills: int, rng: random.Random, folder: Path) -> int:
    """Kill whole applications at work; each comes back with the last step that it told, or the one after."""
    from geofit.project.journal import unfinished

    (folder / "picks.csv").write_text(
        "x,y,z,horizon\n" + "".join(f"{x:.3f},{y:.3f},{z:.3f},T\n" for x, y, z in points(1).xyz)
    )
    (folder / "site.toml").write_text('[site]\nname = "s"\n[picks]\nfile = "picks.csv"\n')
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        sys.path.insert(0, str(ROOT / "tools"))
        import virtual_screen

        if why := virtual_screen.start("1280x800"):
            raise SystemExit(why)
    script = ROOT / "tests" / "gui" / "killed_window.py"
    for turn in range(kills):
        home = folder / f"home{turn}"
        env = os.environ | {"XDG_STATE_HOME": str(home), "XDG_CONFIG_HOME": str(home)}
        command = [sys.executable, str(script), str(folder / "site.toml")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=env) as child:
            assert child.stdout is not None
            first = child.stdout.readline()
            time.sleep(rng.uniform(0.0, 0.6))
            child.send_signal(signal.SIGKILL)
            lines = (first + child.stdout.read()).decode().splitlines()
        told = [line.split() for line in lines if len(line.split()) == 2 and len(line.split()[1]) == 16]
        assert told, "the window did nothing"
        (session,) = unfinished(home / "geofit" / "geofit" / "sessions")
        states = [
            hashlib.sha256(json.dumps(state.to_data(), sort_keys=True).encode()).hexdigest()[:16]
            for state in session.states()
        ]
        count, last = int(told[-1][0]), told[-1][1]
        undone = (count + 1) % 3 == 0 and states[-1] in [name for _, name in told]
        assert last in states[-2:] or undone, (states[-3:], told[-3:])
    return kills


KINDS = {"runs": runs, "saves": saves, "workers": workers, "windows": windows}


def main(words: list[str]) -> int:
    counts = [int(word) for word in (*words, *("60", "80", "40", "20", "1")[len(words) :])]
    for (name, kind), count in zip(KINDS.items(), counts, strict=False):
        if not count:
            continue
        with tempfile.TemporaryDirectory() as place:
            cut = kind(count, random.Random(counts[4]), Path(place))
        print(f"{count} kills of {name}, seed {counts[4]}: {cut} cut off, nothing torn, nothing lost", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
