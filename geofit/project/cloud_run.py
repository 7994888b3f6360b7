"""A run over a cloud of points: read once to the disk, fitted by its sums, measured part by part, written."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geofit.data.accuracy import plain
from geofit.data.files import file_stems, folder_for, replacing
from geofit.data.legible import legible
from geofit.data.messages import Message
from geofit.data.progress import Progress, tell
from geofit.data.settings import FitSettings

if TYPE_CHECKING:
    from geofit.data.accuracy import Check, ReadBack
    from geofit.data.site import Orientations
    from geofit.io.clouds import Cloud
    from geofit.project.step_files import Signed
    from geofit.streaming.fit import CloudFit
    from geofit.streaming.residuals import CloudAccuracy

__all__ = ["CloudResult", "cloud_name", "run_cloud"]

#: Shares of a run after which the points are read, and the surface is fitted.
READ, FITTED = 0.3, 0.6


@dataclass(frozen=True, eq=False)
class CloudResult:
    """What a run over a cloud made: the fit, distances of the points, figures for JSON, files, the check of dips."""

    fit: CloudFit
    accuracy: CloudAccuracy
    readback: ReadBack
    figures: Mapping[str, Any]
    files: tuple[Path, ...]
    dips: Check | None = None

    @property
    def exit_code(self) -> int:
        """0: sigma < epsilon; 1: not."""
        return 0 if self.accuracy.passed else 1


def run_cloud(
    cloud: Cloud,
    out: Path,
    changes: Mapping[str, Any] | None = None,
    boundary: Any = None,
    progress: Progress | None = None,
    *,
    scheduler: str = "local",
    workers: int | None = None,
    signed: Signed | None = None,
    orientations: Orientations | None = None,
) -> CloudResult:
    """Fit a cloud and write its surface, its figures and its distances.

    Leaves ``NAME.step``, ``NAME.json``, ``NAME_deviations.csv`` (a grid), ``NAME_worst.csv``,
    ``NAME_import_issues.csv`` and, where pyarrow is installed, the distance of every point in
    ``NAME_distances/part-*.parquet``. A run that was stopped goes on where it was when it is started again with the
    same source, folder and settings.

    Parameters
    ----------
    cloud : Cloud
        The source, of :func:`geofit.io.clouds.open_cloud`.
    out : Path
        Folder for the files; created if missing. While the run lasts, 24 bytes a point are kept there.
    changes : mapping
        Settings by the names of :class:`geofit.FitSettings`.
    boundary : (k, 2) array, optional
        Corners of the study area, metres.
    progress : callable, optional
        Called as ``progress(stage, fraction)``.
    scheduler, workers : str, int
        See :func:`geofit.streaming.executors.run_tasks`.
    signed : Signed, optional
        What the STEP file states, and whether it gets a certificate.
    orientations : Orientations, optional
        Measured dips; those that name the cloud's horizon (:func:`cloud_name`) are compared with its surface.

    Raises
    ------
    InputError
        If the source cannot be read, or the disk is full.
    FitError
        If the cloud cannot be fitted.
    SchedulerError
        If the scheduler is lost; the parts that were measured are kept.
    Cancelled
        If ``progress`` returned False; what was read and measured is kept.
    """
    from geofit.cad.step import write_step
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.project.step_files import Signed, certified
    from geofit.site.dips import check_dips
    from geofit.streaming.fit import fit_cloud
    from geofit.streaming.residuals import measure
    from geofit.streaming.spool import spooled

    settings = FitSettings(**(changes or {}))
    name = cloud_name(cloud)
    stem = out / file_stems([name])[name]
    state = folder_for(stem.with_name(stem.name + "_state"))
    spool = spooled(cloud.chunks(), state, cloud.key, cloud.total, _within(progress, 0.0, READ))
    rows = _rows(cloud, spool.n, state, stem)
    fit = fit_cloud(spool.xyz(), settings, boundary, _within(progress, READ, FITTED), name=name, folder=state)
    distances = stem.with_name(stem.name + "_distances")
    accuracy = measure(
        spool,
        fit.surface,
        settings.interior_tolerance,
        settings.epsilon,
        fit.field.noise,
        folder=distances,
        scheduler=scheduler,
        workers=workers,
        progress=_within(progress, FITTED, 0.95),
    )
    tell(progress, "STEP and read-back", 0.95)
    step = stem.with_name(stem.name + ".step")
    stated = (signed or Signed()).about([fit.surface.bounds[0]])
    back = write_step({name: HorizonFit(fit.surface, settings=settings, name=name)}, step, **stated.fields)
    readback, page = back[name], certified(step, back, {name: settings.epsilon}, stated)
    compared, check = check_dips(HorizonFit(fit.surface, settings=settings, name=name), orientations)
    found = figures(cloud.path.name, rows, fit, accuracy, readback)
    if check is not None:
        found |= {"dips": {"check": plain(check), "measured": plain(compared)}}
    tables = _write(found, accuracy, stem)
    for file in ("points.f64", "points.json", "rows.json"):
        (state / file).unlink(missing_ok=True)
    state.rmdir()
    tell(progress, "done", 1.0)
    pages = () if page is None else (page,)
    files = (step, *tables, *pages, *sorted(distances.glob("*.parquet")))
    return CloudResult(fit, accuracy, readback, found, files, check)


def cloud_name(cloud: Cloud) -> str:
    """Return the name of a cloud's surface: its horizon's, or its file's."""
    return cloud.horizon or legible(cloud.path.stem)


def _within(progress: Progress | None, low: float, high: float) -> Progress:
    def listen(stage: str | Message, fraction: float, /) -> None:
        tell(progress, stage, low + (high - low) * fraction)

    return listen


def _rows(cloud: Cloud, n: int, state: Path, stem: Path) -> dict[str, int]:
    """Return how many rows the source has and how many are used, told by the reading or by an earlier one."""
    path = state / "rows.json"
    if cloud.read or not path.exists():
        from geofit.data.languages import EN
        from geofit.report.tables import write_issues

        # Also when there is nothing to list: a file of an earlier run would mislead.
        write_issues(cloud.issues, stem.with_name(stem.name + "_import_issues.csv"), EN)
        rows = {"read": cloud.read or n, "used": n, "listed": (cloud.read or n) - n}
        with replacing(path) as part:
            part.write_text(json.dumps(rows), encoding="utf-8")
    found: dict[str, int] = json.loads(path.read_text(encoding="utf-8"))
    return found


def figures(
    source: str, rows: Mapping[str, int], fit: CloudFit, accuracy: CloudAccuracy, readback: ReadBack
) -> dict[str, Any]:
    """Return the figures of a run as plain data."""
    found = accuracy.residuals
    tolerances = {"interior_tolerance": fit.settings.interior_tolerance, "epsilon": accuracy.epsilon}
    return {
        "source": source,
        "settings": plain(fit.settings),
        "rows": dict(rows),
        "n": fit.n,
        "coincident": len(fit.coincident),
        "noise": fit.field.noise,
        "covariance": fit.field.energy,
        "control_points": sum(int(np.prod(patch.control.shape[:2])) for patch in fit.surface.patches),
        "frame": fit.surface.frame,
        "sigma": accuracy.sigma,
        "epsilon": accuracy.epsilon,
        "passed": accuracy.passed,
        "max_abs": accuracy.max_abs,
        "mean": accuracy.mean,
        "over": {
            key: {"limit": limit, "count": count}
            for (key, limit), count in zip(tolerances.items(), found.over, strict=True)
        },
        "histogram": {"reach": accuracy.reach, "counts": found.histogram.tolist()},
        "seconds": dict(fit.seconds),
        "readback": plain(readback),
    }


def _write(found: Mapping[str, Any], accuracy: CloudAccuracy, stem: Path) -> tuple[Path, ...]:
    paths = [stem.with_name(stem.name + end) for end in (".json", "_deviations.csv", "_worst.csv")]
    with replacing(paths[0]) as part:
        text = json.dumps(found, indent=1, ensure_ascii=False)
        part.write_text(text + "\n", encoding="utf-8")
    with replacing(paths[1]) as part:
        np.savetxt(part, _grid(accuracy), "%.3f,%.3f,%d,%.6g,%.6g", header="x,y,points,mean,rms", comments="")
    with replacing(paths[2]) as part:
        np.savetxt(part, accuracy.residuals.worst, "%d,%.4f,%.4f,%.4f,%.6f", header="point,x,y,z,distance", comments="")
    paths.append(stem.with_name(stem.name + "_import_issues.csv"))
    return tuple(paths)


def _grid(accuracy: CloudAccuracy) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return x, y, count, mean and root mean square of the distances of each cell that has points."""
    cells = accuracy.residuals.cells
    rows, columns = cells.shape[:2]
    x0, x1, y0, y1 = accuracy.box
    x = x0 + (np.arange(columns) + 0.5) * (x1 - x0) / columns
    y = y0 + (np.arange(rows) + 0.5) * (y1 - y0) / rows
    xx, yy = np.meshgrid(x, y)
    filled = cells[..., 0] > 0
    count, total, squares = cells[filled].T
    return np.column_stack([xx[filled], yy[filled], count, total / count, np.sqrt(squares / count)])
