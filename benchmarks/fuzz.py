"""Messy sites, and damaged surfaces, projects and settings: each ends in results or a geofit error.

Run ``python benchmarks/fuzz.py [SITES] [FILES] [SEED]`` (default 10,000 each, seed 1); damaged tables, drawings and
grids are those of ``fuzz_import.py``. A case fails by any other exception, by an unforeseen error in the notes of a fit
or of its examination, by a point that is called exact and is missed, by a file outside its folder that is touched, or
by taking longer than its limit. Foreign CAD files are read in a process of their own, as geofit does for its users.
"""

from __future__ import annotations

import json
import random
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
from fuzz_import import mutate

from geofit import FitSettings, PointSet, fit_horizon
from geofit.checks.check import CORE_LIMIT
from geofit.data.errors import GeofitError
from geofit.geometry.mesh import Mesh
from geofit.io import read_points, read_site, read_surfaces
from geofit.io.mapping import load_mappings
from geofit.io.project import Project, ProjectResult, open_project, save_project
from geofit.prediction.examine import examine

SITE_LIMIT, FILE_LIMIT = 120, 240  # seconds
UNFORESEEN = "unforeseen error"
#: Layouts of points in plan, as people bring them.
LAYOUTS = (
    "three", "two places", "square", "one place", "vertical hole", "line", "sections", "core", "cloud", "lattice",
    "tiny", "huge", "degrees", "repeated", "cluster",
)  # fmt: skip


def messy(rng: np.random.Generator, layout: str) -> tuple[PointSet, FitSettings, np.ndarray | None]:
    """Return points of a layout, with noise, gaps and repetitions, settings, and perhaps a study area."""
    n = int(rng.integers(3, 60))
    size = float(10 ** rng.uniform(0, 4))
    plan = rng.uniform(0, size, (n, 2))
    match layout:
        case "three":
            plan = plan[:3]
        case "two places":
            plan = plan[rng.integers(0, 2, n)]
        case "square":
            plan = size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        case "one place" | "vertical hole":
            plan = np.repeat(plan[:1], n, axis=0)
        case "line":
            plan[:, 1] = plan[:, 0] * rng.uniform(-2, 2)
        case "sections":
            plan[:, 1] = size / 4 * rng.integers(0, 4, n)
        case "core":
            rows = [np.column_stack([rng.uniform(0.3, 0.7, k) * size, np.full(k, y * size)])
                    for k, y in zip(rng.integers(8, 24, 3), (0.3, 0.5, 0.7), strict=True)]  # fmt: skip
            plan = np.concatenate([*rows, rng.uniform(0, size, (int(rng.integers(4, 16)), 2))])
        case "lattice":
            axis = np.arange(6) * size / 5
            plan = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        case "tiny":
            plan *= 2e-3 / size
        case "huge":
            plan *= 1e9 / size
        case "degrees":
            plan *= 0.05 / size
        case "repeated":
            plan = plan[rng.integers(0, max(n // 2, 1), n)]
        case "cluster":
            plan[n // 2 :] = plan[0] + plan[n // 2 :] * 1e-3
    x, y = plan.T / max(float(np.ptp(plan)), 1e-9)
    z = 0.1 * size * (np.sin(4 * x) + y) + rng.normal(0, rng.choice([0.0, 0.1, 5.0]), len(plan))
    if layout == "vertical hole":
        z = np.arange(len(plan), dtype=float)
    shift = np.array([110.1, 30.2] if layout == "degrees" else [500_000.0, 3_100_000.0])
    names = np.where(rng.uniform(size=len(plan)) < 0.3, "", [f"S{int(4 * value)}" for value in y])
    points = PointSet(np.column_stack([plan + shift, z]), section=names if layout == "sections" else "")
    settings = FitSettings(
        core=str(rng.choice(["auto", "auto", "all", "none"])),  # type: ignore[arg-type]
        frame=str(rng.choice(["auto", "auto", "auto", "map", "best-plane", "sections"])),  # type: ignore[arg-type]
        robust=bool(rng.uniform() < 0.2),
    )
    low, high = plan.min(axis=0) + shift, plan.max(axis=0) + shift
    area = None
    if rng.uniform() < 0.3:
        area = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])[rng.permutation(4) if n % 3 else slice(None)]
    return points, settings, area


def fit_one(seed: int, folder: Path) -> str:
    """Fit and examine one messy site; return what came of it."""
    rng = np.random.default_rng(seed)
    layout = LAYOUTS[seed % len(LAYOUTS)]
    points, settings, area = messy(rng, layout)
    surface = fit_horizon(points, settings, area)
    assert surface.accuracy is not None
    residuals = surface.accuracy.residuals
    if not np.isfinite(residuals).all():
        raise AssertionError("residuals are not finite")
    if surface.diagnostics["frame"] == "sections" and np.abs(residuals[surface.core]).max(initial=0.0) > CORE_LIMIT:
        raise AssertionError("a point is called exact and is missed")
    notes = [*surface.accuracy.notes, *examine(surface).notes]
    unforeseen = [note for note in notes if UNFORESEEN in str(note)]
    if unforeseen:
        raise AssertionError(f"{layout}: {unforeseen[0]}")
    return "fitted"


def originals(folder: Path) -> dict[str, bytes]:
    """Return sound surfaces in every format, a project, a site file, a mapping and a workbook."""
    from geofit.cad.export import write_brep, write_iges
    from geofit.cad.step import write_step
    from geofit.io.export.tsurf import write_tsurf

    rng = np.random.default_rng(1)
    surface = fit_horizon(PointSet(rng.uniform(0, 100, (12, 3)) + np.array([500_000.0, 3_100_000.0, 0.0])), name="a")
    write_step({"a": surface}, folder / "a.step")
    write_iges({"a": surface}, folder / "a.igs")
    write_brep({"a": surface}, folder / "a.brep")
    mesh: Mesh = surface.triangulate(0.5)
    write_tsurf({"a": mesh}, folder / "a.ts")
    save_project(Project(name="p"), folder / "p.geofit", {"a": surface})
    (folder / "picks.csv").write_text("x,y,z\n" + "\n".join("{},{},{}".format(*row) for row in surface.points.xyz))
    (folder / "site.toml").write_text('[site]\nname = "s"\n[picks]\nfile = "picks.csv"\nhorizon = "T"\n')
    (folder / "map.toml").write_text('version = 1\n[[table]]\nfile = "picks.csv"\nkind = "picks"\n')
    names = ["a.step", "a.igs", "a.brep", "a.ts", "p.geofit", "site.toml", "map.toml"]
    with suppress(ImportError):
        import openpyxl

        book = openpyxl.Workbook()
        for row in [("x", "y", "z"), *surface.points.xyz.tolist()]:
            book.active.append(row)
        book.save(folder / "book.xlsx")
        names.append("book.xlsx")
    return {name: (folder / name).read_bytes() for name in names}


def _project(path: Path) -> None:
    """Open a damaged project and save it again: nothing but its own surfaces may be removed."""
    project = open_project(path)
    strange = ProjectResult(horizon="b", surface=r"p_surfaces/..\..\kept", sha256="")
    save_project(Project(name=project.name, results=(*project.results, strange)), path)
    save_project(Project(name=project.name), path)


READERS: dict[str, Callable[[Path], object]] = {
    ".step": read_surfaces,
    ".igs": read_surfaces,
    ".brep": read_surfaces,
    ".ts": read_surfaces,
    ".geofit": _project,
    ".xlsx": read_points,
}


def read_one(seed: int, sound: dict[str, bytes], folder: Path, names: tuple[str, ...] = ()) -> str:
    """Damage one file and read it; return what came of it."""
    rng = random.Random(seed)
    name = rng.choice(names or tuple(sorted(sound)))
    data = sound[name]
    for _ in range(rng.randrange(1, 4)):
        if data:
            data, _ = mutate(data, rng)
    path = folder / name
    kept = folder / r"p_surfaces" / r"..\..\kept"
    kept.parent.mkdir(exist_ok=True)
    kept.write_text("somebody's")
    for other, text in sound.items():
        (folder / other).write_bytes(data if other == name else text)
    read = READERS.get(path.suffix) or (read_site if name == "site.toml" else load_mappings)
    try:
        read(path)
    finally:
        if kept.read_text() != "somebody's":
            raise AssertionError(f"{name}: a file that is not the project's was touched")
    return "read"


def run(cases: int, seed: int, one: Callable[[int], str], limit: int = FILE_LIMIT) -> tuple[Counter[str], list[str]]:
    """Return the outcomes of seeded cases, and the first failures as text."""
    outcomes: Counter[str] = Counter()
    failures: list[str] = []
    for case in range(seed * 1_000_000, seed * 1_000_000 + cases):
        try:
            if hasattr(signal, "SIGALRM"):
                signal.alarm(limit)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                outcomes[one(case)] += 1
        except GeofitError:
            outcomes["geofit error"] += 1
        except Exception:  # the point of the exercise is to see every other one
            outcomes["failed"] += 1
            if len(failures) < 20:
                failures.append(f"case {case}:\n{traceback.format_exc(limit=-4)}")
        finally:
            if hasattr(signal, "SIGALRM"):
                signal.alarm(0)
    return outcomes, failures


def _late(number: int, frame: object) -> None:
    raise TimeoutError("longer than its limit")


def main() -> int:
    sites, files, seed = (int(value) for value in (*sys.argv[1:4], *("10000", "10000", "1")[len(sys.argv[1:4]) :]))
    if hasattr(signal, "SIGALRM"):
        signal.signal(signal.SIGALRM, _late)
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sound = originals(folder)
        for what, cases, one, limit in (
            ("messy sites", sites, lambda case: fit_one(case, folder), SITE_LIMIT),
            ("damaged files", files, lambda case: read_one(case, sound, folder), FILE_LIMIT),
        ):
            start = time.perf_counter()
            outcomes, failures = run(cases, seed, one, limit)
            failed += outcomes["failed"]
            print("\n".join(failures))
            print(
                f"{cases} {what}, seed {seed}, {time.perf_counter() - start:.0f} s: {json.dumps(outcomes)}", flush=True
            )
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
