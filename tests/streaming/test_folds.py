"""Folds of the cross-validation on several processes or a Dask cluster: the same errors, to the last bit."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
import pytest

from geofit import PointSet, fit_horizon
from geofit.data.errors import SchedulerError
from geofit.prediction import refits
from geofit.prediction.examine import examine
from geofit.streaming.executors import Where


@pytest.fixture(scope="module")
def folded():
    """Return the fit of an overturned fold along five sections."""
    t, parts = np.linspace(0, 1, 40), []
    for k, y in enumerate(np.linspace(0, 400, 5)):
        x = 100 * t + 120 * np.sin(2 * np.pi * t)
        xyz = np.column_stack([x + 0.05 * y, np.full(len(t), y), 200 * t + 5 * np.sin(y / 60)])
        parts.append(PointSet(xyz, section=f"S{k}"))
    fit = fit_horizon(PointSet.concatenate(parts))
    assert fit.frame == "sections"
    return fit


@pytest.fixture(scope="module")
def sparse():
    """Return the fit of so few points that each group is left out by a fit of its own."""
    rng = np.random.default_rng(4)
    xy = rng.uniform(0, 300, (14, 2))
    z = 20 * np.sin(xy[:, 0] / 90) + rng.normal(0, 0.1, len(xy))
    return fit_horizon(PointSet(np.column_stack([xy, z]), hole=[f"B{k}" for k in range(len(xy))]))


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
    tasks = [
        refits.RefitFold(folded.points, group, folded.settings, None, name)
        for group, name in zip(groups, names, strict=True)
    ]
    found = dict(Where("local", 2).run(dying, tasks))
    assert (tmp_path / "killed").exists()
    for k, task in enumerate(tasks):
        assert found[k].tobytes() == refits.refit_without(task).tobytes()


@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_that_is_not_there_ends_the_examination_with_an_error(folded, monkeypatch):
    pytest.importorskip("distributed", reason="distributed is not installed (extra scale)")
    monkeypatch.setattr("geofit.streaming.executors.PATIENCE", 1)
    with pytest.raises(SchedulerError):
        examine(folded, scheduler="tcp://127.0.0.1:9")
