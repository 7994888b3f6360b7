"""The second pass over a cloud: distances from its surface, reduced part by part and written, never held.

A part is a run of points. Each leaves a file of its distances (Parquet, where pyarrow is installed) and a small file of
its sums; a part whose sums are there is not measured again, so a stopped pass goes on.
"""

from __future__ import annotations

import json
import math
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.files import folder_for, replacing
from geofit.data.progress import Progress, tell
from geofit.geometry.projection import project
from geofit.streaming.executors import run_tasks
from geofit.streaming.spool import Spool
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["CloudAccuracy", "Residuals", "measure"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Points of a part, and those that are measured at a time.
PART, STEP = 1_000_000, 100_000
#: Bins of the histogram, over so many standard deviations of the noise on both sides.
BINS, REACH = 240, 6.0
#: Cells of the longer side of the map of deviations.
MAP = 256
#: Points with the largest distances that are named.
WORST = 20


@dataclass(frozen=True, eq=False)
class Residuals:
    """Sums over distances: those of two parts are added.

    ``histogram`` (BINS + 2,) counts from below ``-reach`` to above ``reach``; ``cells`` (nv, nu, 3) counts points,
    their distances and squared distances in a grid over the surface; ``worst`` (k, 5) index, x, y, z, distance.
    """

    n: int
    total: float
    squares: float
    over: tuple[int, int]
    histogram: Ints
    cells: Floats
    worst: Floats

    def __add__(self, other: Residuals) -> Residuals:
        """Return the sums over the points of both."""
        worst = np.concatenate([self.worst, other.worst])
        order = np.lexsort((worst[:, 0], -np.abs(worst[:, 4])))[:WORST]
        return Residuals(
            self.n + other.n,
            self.total + other.total,
            self.squares + other.squares,
            (self.over[0] + other.over[0], self.over[1] + other.over[1]),
            self.histogram + other.histogram,
            self.cells + other.cells,
            worst[order],
        )


@dataclass(frozen=True, eq=False)
class CloudAccuracy:
    """How far a cloud lies from its surface: sigma (eq. 3 of the paper), and what was summed on the way.

    ``reach`` (m) is where the histogram ends, ``box`` (x0, x1, y0, y1) where the grid of ``residuals.cells`` lies.
    """

    residuals: Residuals
    epsilon: float
    reach: float
    box: tuple[float, float, float, float]

    @property
    def sigma(self) -> float:
        """Return sqrt(sum d_i^2 / (n - 1)) over all points, metres."""
        return math.sqrt(self.residuals.squares / max(self.residuals.n - 1, 1))

    @property
    def passed(self) -> bool:
        """Whether sigma is below epsilon."""
        return self.sigma < self.epsilon

    @property
    def max_abs(self) -> float:
        """Largest distance, metres."""
        return float(abs(self.residuals.worst[0, 4])) if len(self.residuals.worst) else 0.0

    @property
    def mean(self) -> float:
        """Mean signed distance, metres."""
        return self.residuals.total / self.residuals.n


@dataclass(frozen=True, eq=False)
class _Task:
    """What a worker measures: points from start to stop of a spool, or the points themselves."""

    points: Spool | Floats
    start: int
    stop: int
    surface: PatchSurface
    limits: tuple[float, float]
    reach: float
    box: tuple[float, float, float, float]
    shape: tuple[int, int]
    folder: Path | None
    stem: str = ""


def measure(
    points: Spool | Floats,
    surface: PatchSurface,
    tolerance: float,
    epsilon: float,
    noise: float,
    *,
    folder: Path | None = None,
    scheduler: str = "local",
    workers: int | None = None,
    progress: Progress | None = None,
) -> CloudAccuracy:
    """Measure every point of a cloud against a surface.

    Parameters
    ----------
    points : Spool or (n, 3) array
        The cloud; one on the disk is read by the workers themselves.
    surface : PatchSurface
        The surface.
    tolerance, epsilon : float
        Limits, metres, beyond which points are counted.
    noise : float
        Standard deviation that sets the width of the histogram, metres.
    folder : Path, optional
        Where distances and sums of the parts are written; without it nothing is.
    scheduler, workers : str, int
        See :func:`geofit.streaming.executors.run_tasks`.
    progress : callable, optional
        Called as ``progress("residuals", fraction)``.

    Returns
    -------
    CloudAccuracy
        sigma, the worst points, histogram and grid of deviations; the same for any scheduler and number of workers.
    """
    n = points.n if isinstance(points, Spool) else len(points)
    low, high = surface.bounds
    box = float(low[0]), float(high[0]), float(low[1]), float(high[1])
    cell = max(box[1] - box[0], box[3] - box[2]) / MAP or 1.0
    shape = tuple(max(1, math.ceil((b - a) / cell)) for a, b in (box[2:], box[:2]))
    blank = _Task(
        np.empty((0, 3)), 0, 0, surface, (tolerance, epsilon), REACH * noise, box, (shape[0], shape[1]), folder
    )
    if folder is not None:
        folder_for(folder)
    tasks, found = [], dict[int, Residuals]()
    for start in range(0, n, PART):
        task = replace(blank, start=start, stop=min(start + PART, n), stem=f"part-{start // PART:06d}")
        known = None if folder is None else _known(task, folder)
        if known is None:
            tasks.append(task)
        else:
            found[start] = known
    if isinstance(points, Spool):
        tasks = [replace(task, points=points) for task in tasks]
        results = run_tasks(_measured, tasks, scheduler, workers)
    else:
        # Points in memory are not sent to other processes: that would copy them.
        rows = points
        results = ((k, _measured(replace(t, points=rows[t.start : t.stop]))) for k, t in enumerate(tasks))
    for k, result in results:
        found[tasks[k].start] = result
        tell(progress, "residuals", len(found) * PART / max(n, PART * len(found)))
    total = found[0]
    for start in sorted(found)[1:]:
        total = total + found[start]  # in the order of the file: the digits do not depend on who was first
    return CloudAccuracy(total, epsilon, blank.reach, box)


def _measured(task: _Task) -> Residuals:
    total: Residuals | None = None
    distances = []
    for start in range(task.start, task.stop, STEP):
        stop = min(start + STEP, task.stop)
        if isinstance(task.points, Spool):
            xyz = task.points.xyz()[start:stop]
        else:
            xyz = task.points[start - task.start : stop - task.start]
        d = project(task.surface.patches, xyz - task.surface.origin).distance
        part = _reduced(task, xyz, d, start)
        total = part if total is None else total + part
        if task.folder is not None:
            distances.append(d)
    assert total is not None
    if task.folder is not None:
        _write(task, task.folder, np.concatenate(distances), total)
    return total


def _reduced(task: _Task, xyz: Floats, d: Floats, start: int) -> Residuals:
    size = np.abs(d)
    edges = np.linspace(-task.reach, task.reach, BINS + 1)
    histogram = np.bincount(np.searchsorted(edges, d, side="right"), minlength=BINS + 2)
    x0, x1, y0, y1 = task.box
    rows, columns = task.shape
    i = np.clip(((xyz[:, 1] - y0) / ((y1 - y0) or 1.0) * rows).astype(np.int64), 0, rows - 1)
    j = np.clip(((xyz[:, 0] - x0) / ((x1 - x0) or 1.0) * columns).astype(np.int64), 0, columns - 1)
    at = i * columns + j
    cells = np.stack([np.bincount(at, weights, rows * columns) for weights in (np.ones(len(d)), d, d * d)], axis=-1)
    worst = np.argsort(-size, kind="stable")[:WORST]
    return Residuals(
        len(d),
        float(d.sum()),
        float(d @ d),
        (int((size > task.limits[0]).sum()), int((size > task.limits[1]).sum())),
        histogram,
        np.asarray(cells.reshape(rows, columns, 3), np.float64),
        np.column_stack([start + worst, xyz[worst], d[worst]]),
    )


def _write(task: _Task, folder: Path, d: Floats, total: Residuals) -> None:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        pass
    else:
        with replacing(folder / f"{task.stem}.parquet") as part:
            table = pa.table({"point": np.arange(task.start, task.stop), "distance": d})
            parquet.write_table(table, part, compression="zstd")
    data = {"key": _key(task), **{name: _plain(value) for name, value in vars(total).items()}}
    with replacing(folder / f"{task.stem}.json") as part:
        part.write_text(json.dumps(data), encoding="utf-8")


def _known(task: _Task, folder: Path) -> Residuals | None:
    """Return the sums of a part that was measured before with the same surface and limits."""
    try:
        data = json.loads((folder / f"{task.stem}.json").read_text(encoding="utf-8"))
        if data.pop("key") != _key(task):
            return None
        cells = np.zeros((*task.shape, 3))
        filled = data["cells"]
        cells.reshape(-1, 3)[filled["at"]] = filled["values"]
        return Residuals(
            data["n"],
            data["total"],
            data["squares"],
            (data["over"][0], data["over"][1]),
            np.array(data["histogram"], np.int64),
            cells,
            np.array(data["worst"], float).reshape(-1, 5),
        )
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.ndim == 3:
        flat = value.reshape(-1, 3)
        at = np.flatnonzero(flat[:, 0])
        return {"at": at.tolist(), "values": flat[at].tolist()}
    return value.tolist() if isinstance(value, np.ndarray) else value


def _key(task: _Task) -> list[Any]:
    digest = 0
    for patch in task.surface.patches:
        for array in (patch.control, patch.knots_u, patch.knots_v):
            digest = zlib.crc32(array.tobytes(), digest)
    return [task.start, task.stop, list(task.limits), task.reach, list(task.box), digest]
