"""A short, seeded part of benchmarks/kills.py; whole windows are killed in tests/gui/test_main_window.py."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SCRIPT = ROOT / "benchmarks" / "kills.py"
forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="kill -9 is for Linux and macOS")


@pytest.fixture
def kills(monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPT.parent))
    import kills

    yield kills
    sys.modules.pop("kills", None)


@forks
@pytest.mark.parametrize("counts", [("2", "8", "0", "0"), ("0", "0", "4", "0")], ids=["runs and saves", "workers"])
def test_what_is_killed_leaves_whole_files_and_work_goes_on(counts):
    if counts[2] != "0":
        pytest.importorskip("PySide6", reason="the windows need the extra gui")
    # In a process of its own: it forks, and this one has threads.
    done = subprocess.run(
        [sys.executable, str(SCRIPT), *counts, "3"], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "nothing torn, nothing lost" in done.stdout


def test_torn_files_are_found(kills, tmp_path):
    for name, data in {
        "a.step": b"ISO-10303-21;\nDATA;", "b.html": b"<html>", "c.json": b'{"a": 1', "d.csv": b"x,y\n1,",
        "e.png": b"\x89PNG", "f.step": b"", "g.json": b"{}\n", ".h.step": b"under way",
    }.items():  # fmt: skip
        (tmp_path / name).write_bytes(data)
    assert sorted(line.split(":")[0] for line in kills.torn(tmp_path)) == [
        "a.step", "b.html", "c.json", "d.csv", "e.png", "f.step",
    ]  # fmt: skip


CREW = """
import os, time
from geofit.project.side_by_side import crew

if __name__ == "__main__":
    with crew(2) as hands:
        print(*(pid for _, pid in hands.do([os.getpid, os.getpid], None)), flush=True)
        time.sleep(600)
"""


@forks
def test_workers_end_with_the_process_that_was_killed(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(CREW, encoding="utf-8")
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as parent:
        workers = [int(word) for word in parent.stdout.readline().split()]
        assert workers
        parent.send_signal(signal.SIGKILL)
    end = time.monotonic() + 30
    while (left := [pid for pid in workers if runs(pid)]) and time.monotonic() < end:
        time.sleep(0.1)
    assert not left


def runs(pid: int) -> bool:
    """Whether a process is there and not only waits to be reaped."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    status = Path(f"/proc/{pid}/stat")
    return not status.exists() or status.read_text().rpartition(")")[2].split()[0] != "Z"
