"""Folds of the cross-validation on several processes or a Dask cluster: the same errors, to the last bit."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from geofit import PointSet, fit_horizon
from geofit.data.errors import SchedulerError
from geofit.prediction import refits
from geofit.prediction.examine import examine
from geofit.streaming.executors import Where
from geofit.streaming.kept import clear_kept, keep


def overturned():
    """Return the fit of an overturned fold along five sections."""
    t, parts = np.linspace(0, 1, 40), []
    for k, y in enumerate(np.linspace(0, 400, 5)):
        x = 100 * t + 120 * np.sin(2 * np.pi * t)
        xyz = np.column_stack([x + 0.05 * y, np.full(len(t), y), 200 * t + 5 * np.sin(y / 60)])
        parts.append(PointSet(xyz, section=f"S{k}"))
    fit = fit_horizon(PointSet.concatenate(parts))
    assert fit.frame == "sections"
    return fit


def few():
    """Return the fit of so few points that each group is left out by a fit of its own."""
    rng = np.random.default_rng(4)
    xy = rng.uniform(0, 300, (14, 2))
    z = 20 * np.sin(xy[:, 0] / 90) + rng.normal(0, 0.1, len(xy))
    return fit_horizon(PointSet(np.column_stack([xy, z]), hole=[f"B{k}" for k in range(len(xy))]))


@pytest.fixture(scope="module")
def folded():
    return overturned()


@pytest.fixture(scope="module")
def sparse():
    return few()


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed", reason="distributed is not installed (extra scale)")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, processes=True, silence_logs=50
    ) as made:
        yield made


def assert_same(one, other):
    assert [fold.scheme for fold in one.left_out] == [fold.scheme for fold in other.left_out]
    assert one.left_out
    for a, b in zip(one.left_out, other.left_out, strict=True):
        assert a.error.tobytes() == b.error.tobytes()
        # Sums of products: their last digits depend on where in the memory an array begins.
        assert np.allclose(a.sd, b.sd, rtol=1e-9, atol=0, equal_nan=True)
        assert np.isfinite(a.error).any()


@pytest.mark.parametrize("name", ["folded", "sparse"])
def test_folds_on_two_processes_are_those_of_one(request, name):
    surface = request.getfixturevalue(name)
    assert_same(examine(surface, scheduler="local", workers=2), examine(surface))


@pytest.mark.filterwarnings("ignore")
def test_folds_on_a_dask_cluster_are_those_of_one_process(cluster, folded):
    assert_same(examine(folded, scheduler=cluster.scheduler_address), examine(folded))


def dying(fold):
    """Fit without a section; the first worker that comes to one of them is killed."""
    mark = Path(os.environ["GEOFIT_TEST_MARK"])
    if fold.name == "doomed" and not mark.exists():
        mark.write_text("killed")
        os.kill(os.getpid(), signal.SIGKILL)
    return refits.refit_without(fold)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill on this system")
def test_a_worker_that_is_killed_over_a_fold_costs_nothing(folded, tmp_path, monkeypatch):
    monkeypatch.setenv("GEOFIT_TEST_MARK", str(tmp_path / "killed"))
    groups = [np.flatnonzero(folded.points.section == f"S{k}") for k in (1, 2, 3)]
    names = ("sound", "doomed", "sound")
    net = folded.model.net
    tasks = [
        refits.RefitFold(folded.points, group, folded.settings, None, name, net.field, net.unit)
        for group, name in zip(groups, names, strict=True)
    ]
    found = dict(Where("local", 2).run(dying, tasks))
    assert (tmp_path / "killed").exists()
    for k, task in enumerate(tasks):
        errors, variances = refits.refit_without(task)
        assert found[k][0].tobytes() == errors.tobytes()
        assert np.allclose(found[k][1], variances, rtol=1e-9, atol=0)


@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_that_is_not_there_ends_the_examination_with_an_error(folded, monkeypatch):
    pytest.importorskip("distributed", reason="distributed is not installed (extra scale)")
    monkeypatch.setattr("geofit.streaming.executors.PATIENCE", 1)
    with pytest.raises(SchedulerError):
        examine(folded, scheduler="tcp://127.0.0.1:9")


#: A run that is killed when so many folds are kept.
KILLED = """
import os, signal, sys
from pathlib import Path
sys.path.insert(0, {tests!r})
import test_folds
from geofit.prediction.examine import examine
from geofit.streaming import executors
keep = executors.keep
def keep_some(path, result):
    keep(path, result)
    if len(list(path.parent.iterdir())) == {count}:
        os.kill(os.getpid(), signal.SIGKILL)
executors.keep = keep_some
examine(test_folds.{made}(), folder=Path({folder!r}))
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill on this system")
@pytest.mark.parametrize(("made", "name", "count"), [("overturned", "folded", 2), ("few", "sparse", 9)])
def test_a_killed_examination_goes_on_with_the_other_folds(request, tmp_path, monkeypatch, made, name, count):
    surface, folder = request.getfixturevalue(name), tmp_path / "folds"
    code = KILLED.format(tests=str(Path(__file__).parent), count=count, made=made, folder=str(folder))
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == -signal.SIGKILL
    before = {path.name for path in folder.iterdir()}
    assert len(before) == count
    computed = []

    def noted(path, result):
        computed.append(path.name)
        keep(path, result)

    monkeypatch.setattr("geofit.streaming.executors.keep", noted)
    assert_same(examine(surface, folder=folder), examine(surface))
    # Each of the others once, and none of those that were ready.
    assert len(computed) == len(set(computed)) > 0
    assert before.isdisjoint(computed)
    assert {path.name for path in folder.iterdir()} == before | set(computed)


def test_a_kept_fold_that_was_cut_off_is_computed_again(folded, tmp_path):
    whole = examine(folded, folder=tmp_path)
    first = min(tmp_path.iterdir())
    first.write_bytes(first.read_bytes()[:60])
    assert_same(examine(folded, folder=tmp_path), whole)
    clear_kept(tmp_path)
    assert not tmp_path.exists()
