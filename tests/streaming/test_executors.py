"""Tasks on several processes: the results are those of one; a worker that dies loses nothing."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from faulted import faulted_site

from geofit.data.errors import SettingsError
from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.site.fit_site import fit_site
from geofit.streaming.executors import SchedulerError, run_tasks


def square(x):
    return x * x


def most_threads(_):
    """Return the threads that linear algebra may use, scipy's own library included, which is loaded only now."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import threadpool_info

    return max(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")


def dies_once(task):
    """Kill the worker's own process at the first try of one task."""
    k, folder = task
    mark = Path(folder) / "died"
    if k == 3 and not mark.exists():
        mark.write_text(str(os.getpid()))
        os.kill(os.getpid(), signal.SIGKILL)
    return k


def always_dies(task):
    os.kill(os.getpid(), signal.SIGKILL)


def fails(task):
    raise SettingsError(__import__("geofit.data.messages", fromlist=["message"]).message("x", "wrong"))


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="one processor has one thread")
def test_a_worker_uses_one_thread_whatever_it_loads(monkeypatch):
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    assert dict(run_tasks(most_threads, range(2), workers=2)) == {0: 1, 1: 1}


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_with_their_places(workers):
    assert dict(run_tasks(square, range(7), workers=workers)) == {k: k * k for k in range(7)}


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill on this system")
def test_a_killed_worker_loses_nothing(tmp_path):
    tasks = [(k, str(tmp_path)) for k in range(8)]
    assert dict(run_tasks(dies_once, tasks, workers=2)) == {k: k for k in range(8)}
    assert (tmp_path / "died").exists()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill on this system")
def test_workers_that_die_again_and_again_end_with_an_error():
    with pytest.raises(SchedulerError):
        list(run_tasks(always_dies, [1, 2], workers=2))


def test_an_error_of_a_task_is_its_own():
    with pytest.raises(SettingsError):
        list(run_tasks(fails, [1, 2], workers=2))


def test_a_scheduler_that_is_none_is_refused():
    pytest.importorskip("distributed", reason="distributed is not installed (extra scale)")
    with pytest.raises(SettingsError):
        list(run_tasks(square, [1], "nowhere.json"))


def horizons(count=4, n=120):
    rng = np.random.default_rng(5)
    made = {}
    for k in range(count):
        xy = rng.uniform(0, 300, (n, 2))
        made[f"H{k}"] = PointSet(np.column_stack([xy, 20 * np.sin(xy[:, 0] / 90 + k) + rng.normal(0, 0.05, n)]))
    made["flat"] = PointSet(np.zeros((3, 3)))
    return Site(name="many", horizons=made)


def same(one, other):
    assert list(one.surfaces) == list(other.surfaces)
    assert one.failures.keys() == other.failures.keys() == {"flat"}
    for name, surface in one.surfaces.items():
        for a, b in zip(surface.patches, other.surfaces[name].patches, strict=True):
            assert a.control.tobytes() == b.control.tobytes()
        assert surface.accuracy.residuals.tobytes() == other.surfaces[name].accuracy.residuals.tobytes()


def test_horizons_side_by_side_are_those_of_one_process():
    site = horizons()
    same(fit_site(site, scheduler="local", workers=2), fit_site(site))


def test_the_blocks_of_a_fault_side_by_side_are_those_of_one_process():
    site = faulted_site()
    one, other = fit_site(site, scheduler="local", workers=2), fit_site(site)
    assert list(one.surfaces) == list(other.surfaces)
    assert len(one.cuts) == len(other.cuts) > 0
    for name, surface in one.surfaces.items():
        for a, b in zip(surface.patches, other.surfaces[name].patches, strict=True):
            assert a.control.tobytes() == b.control.tobytes()


#: A scheduler with two workers, which prints its address and ends with its standard input. It is a process of its own:
#: one that is killed is lost as a computer is, and leaves nothing that a loaded machine could wait for.
CLUSTER = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, processes=True, silence_logs=50
    ) as made:
        print(made.scheduler_address, flush=True)
        sys.stdin.read()
"""


def lose(group):
    """Kill the scheduler and its workers, if they still run."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(group, signal.SIGKILL)


@pytest.fixture
def cluster(tmp_path):
    pytest.importorskip("distributed", reason="distributed is not installed (extra scale)")
    if not hasattr(os, "killpg"):
        pytest.skip("no groups of processes on this system")
    script = tmp_path / "cluster.py"
    script.write_text(CLUSTER)
    # The workers import this module by its name.
    paths = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen(
        [sys.executable, script],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=paths,
        start_new_session=True,
    ) as process:
        try:
            yield process.stdout.readline().strip(), process.pid
        finally:
            lose(process.pid)


@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_gives_the_same_and_survives_a_worker(cluster, tmp_path):
    address, _ = cluster
    assert dict(run_tasks(square, range(5), address)) == {k: k * k for k in range(5)}
    tasks = [(k, str(tmp_path)) for k in range(8)]
    assert dict(run_tasks(dies_once, tasks, address)) == {k: k for k in range(8)}
    site = replace(horizons(2))
    same(fit_site(site, scheduler=address), fit_site(site))


def slow(k):
    time.sleep(0.3)
    return k


@pytest.mark.filterwarnings("ignore")
def test_a_lost_scheduler_ends_with_a_clear_error(cluster):
    address, group = cluster
    ready = []
    with pytest.raises(SchedulerError):  # noqa: PT012 - the cluster is lost on the way
        for k, _ in run_tasks(slow, range(40), address):
            ready.append(k)
            if len(ready) == 3:
                lose(group)
    assert len(ready) >= 3
