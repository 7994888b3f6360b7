"""Results kept in a folder: a run that was stopped goes on; files of strangers are not read."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from bodies.planted import drilled, ellipsoid

from geofit import fit_body
from geofit.bodies.crossval import leave_one_hole_out
from geofit.data.errors import SchedulerError
from geofit.site.fit_site import fit_site
from geofit.streaming import executors
from geofit.streaming.kept import clear_kept, keep, kept, kept_path

SAMPLE = Path(__file__).parents[2] / "sample_data" / "site.toml"
KILL = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill on this system")


class Command:
    """What runs when it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self):
        return Path.touch, (self.mark,)


def double(x):
    return 2 * x


def test_results_are_read_again_and_cleared(tmp_path):
    folder = tmp_path / "kept"
    path = kept_path(folder, double, 3)
    assert kept(path) == (False, None)
    keep(path, {"a": (np.arange(3.0), None)})
    known, found = kept(path)
    assert known
    assert found["a"][0].tolist() == [0, 1, 2]
    assert kept_path(folder, double, 4) != path
    clear_kept(folder)
    assert not folder.exists()


def test_a_file_of_somebody_else_is_not_read(tmp_path):
    mark, path = tmp_path / "ran", kept_path(tmp_path, double, 3)
    path.write_bytes(bytes(32) + pickle.dumps(Command(mark)))
    assert kept(path) == (False, None)
    assert not mark.exists()


@pytest.mark.parametrize("damage", [lambda data: data[:40], lambda data: data[:-1] + b"!", lambda data: b""])
def test_a_damaged_file_is_not_read(tmp_path, damage):
    path = kept_path(tmp_path, double, 3)
    keep(path, np.arange(100.0))
    path.write_bytes(damage(path.read_bytes()))
    assert kept(path) == (False, None)


def lost_after(count, monkeypatch):
    """Let the scheduler be lost when so many results are there."""
    run = executors.run_tasks

    def some(work, tasks, scheduler="local", workers=None):
        for k, found in enumerate(run(work, tasks, scheduler, workers)):
            if k == count:
                raise SchedulerError(executors.message("x", "lost"))
            yield found

    monkeypatch.setattr(executors, "run_tasks", some)


def counted(monkeypatch):
    """Count the tasks that are computed."""
    run, asked = executors.run_tasks, []

    def some(work, tasks, scheduler="local", workers=None):
        asked.extend(tasks)
        yield from run(work, tasks, scheduler, workers)

    monkeypatch.setattr(executors, "run_tasks", some)
    return asked


def test_horizons_that_were_fitted_before_the_scheduler_was_lost_are_not_fitted_again(
    sample_site, sample_surfaces, tmp_path, monkeypatch
):
    with monkeypatch.context() as patch:
        lost_after(3, patch)
        with pytest.raises(SchedulerError):
            fit_site(sample_site, scheduler="local", workers=1, folder=tmp_path)
    assert len(list(tmp_path.iterdir())) == 3
    asked = counted(monkeypatch)
    found = fit_site(sample_site, scheduler="local", workers=1, folder=tmp_path)
    assert len(asked) == len(sample_site.horizons) - 3
    assert list(found.surfaces) == list(sample_surfaces)
    for name, surface in sample_surfaces.items():
        for one, other in zip(found.surfaces[name].patches, surface.patches, strict=True):
            assert one.control.tobytes() == other.control.tobytes()


def test_holes_left_out_before_a_stop_are_not_left_out_again(tmp_path, monkeypatch):
    body = fit_body(drilled(ellipsoid((0.65, 0.45, 0.35))[0], 3, named=True), name="ORE")
    whole = leave_one_hole_out(body, 4, compared=False)
    with monkeypatch.context() as patch:
        lost_after(2, patch)
        with pytest.raises(SchedulerError):
            leave_one_hole_out(body, 4, compared=False, folder=tmp_path)
    asked = counted(monkeypatch)
    assert leave_one_hole_out(body, 4, compared=False, folder=tmp_path) == whole
    assert len(asked) == 2


@KILL
def test_a_command_that_was_killed_goes_on(tmp_path):
    """The second run leaves the files of one that was not stopped, to the last byte."""
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}

    def started(out: Path) -> subprocess.Popen[bytes]:
        command = "from geofit.cli.main import main; main()"
        options = ["--scheduler", "local", "--workers", "2", "--out", str(out)]
        return subprocess.Popen(
            [sys.executable, "-c", command, "fit", str(SAMPLE), *options],
            env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip

    killed, whole = tmp_path / "killed", tmp_path / "whole"
    first = started(killed)
    while first.poll() is None and len(list(killed.glob("_fits/*"))) < 2:
        time.sleep(0.01)
    os.killpg(first.pid, signal.SIGKILL)
    assert first.wait() == -signal.SIGKILL
    assert list(killed.glob("_fits/*"))
    assert not (killed / "report.json").exists()
    again, straight = started(killed), started(whole)
    assert again.wait() == straight.wait()
    names = sorted(path.name for path in whole.iterdir())
    assert "report.json" in names
    assert sorted(path.name for path in killed.iterdir()) == names
    for name in names:
        if name.endswith((".step", ".csv")):
            assert (killed / name).read_bytes() == (whole / name).read_bytes()
