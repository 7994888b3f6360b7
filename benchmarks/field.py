"""The field away from its data: sites of varied truths, many scattered points, folds of the real sets.

Run ``python benchmarks/field.py [sites [COUNT]] [scattered [N ...]] [real [SET ...]] [--page]`` (default: a few sites
and 10,000 points, within two minutes); ``--page`` writes the sites to docs/field.md, the folds to docs/real_folds.md.
Errors are root mean squares; every truth has its own seed.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from threadpoolctl import threadpool_limits

from geofit import FitSettings, GeofitError, HorizonFit, PointSet, fit_horizon
from geofit.prediction.kriging import krige_left_out

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from field_page import METHODS, Folds, Row, folds_table, methods_table, write_folds, write_page
from peers.gp import KERNELS, Process, fit_process
from peers.pspline import PSpline
from peers.smooth_plate import smooth_plate
from realdata.score import folds, one_a_place, thin_plate
from realdata.sets import SETS, data_folder, rectangle
from truth import EASTING, NORTHING, Height, hills, rms

SIZE = 2000.0
DOCS = Path(__file__).resolve().parents[1] / "docs"
PROCESSES = 2
#: Noise (m) and least spacing along the sections (m) that the sites go through.
NOISES, SPACINGS = (0.01, 0.05, 0.15, 0.3), (2.0, 6.0, 15.0, 30.0)
#: Spans of the plain P-spline, and its penalty.
SPANS, PENALTY = 50, 0.01
#: Timed fits of scattered points.
FITS = 3
#: Draws from the process that suits a real horizon best, and the points of horizons that are drawn, at least and most.
DRAWS, DRAWN_POINTS = 3, (20, 200)
Fitted = TypeVar("Fitted")


@dataclass(frozen=True, eq=False)
class Site:
    """Points of one horizon with its truth; ``core`` (x0, x1, y0, y1) holds the sections."""

    title: str
    points: PointSet
    height: Height
    core: tuple[float, float, float, float]


def random_field(seed: int, smoothness: float, reach: float, relief: float = 25.0) -> Height:
    """Return a dipping plane and a random field of Matérn smoothness nu (infinite: Gaussian), as 600 random waves."""
    rng = np.random.default_rng(seed)
    wave = rng.normal(size=(600, 2)) / reach
    if np.isfinite(smoothness):
        wave *= np.sqrt(2 * smoothness / rng.chisquare(2 * smoothness, 600))[:, None]
    phase, dip = rng.uniform(0, 2 * np.pi, 600), rng.normal(0, 0.08, 2)

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        plan = np.stack([np.asarray(x, float) - EASTING, np.asarray(y, float) - NORTHING], axis=-1)
        flat = plan.reshape(-1, 2)
        value = np.concatenate([np.cos(part @ wave.T + phase).sum(axis=1) for part in np.array_split(flat, 20)])
        return 1500.0 + plan @ dip + relief * np.sqrt(2 / 600) * value.reshape(plan.shape[:-1])

    return height


def folded_truth(seed: int) -> Height:
    """Return a train of upright folds with rounded hinges that plunge and change along their axis."""
    rng = np.random.default_rng(seed)
    azimuth, length, plunge = rng.uniform(0, np.pi), rng.uniform(500, 900), rng.normal(0, 0.03)
    phase, sharp, drift = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 0.6), rng.uniform(2000, 4000)
    c, s = np.cos(azimuth), np.sin(azimuth)

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, y = np.asarray(x, float) - EASTING, np.asarray(y, float) - NORTHING
        across, along = c * x + s * y, c * y - s * x
        angle = 2 * np.pi * across / length + phase + 0.8 * np.sin(2 * np.pi * along / drift)
        return 1500.0 + plunge * along + 30 * np.sin(angle + sharp * np.sin(angle))

    return height


def truth_of(seed: int) -> tuple[str, Height]:
    """Return one of six kinds of truth, in turn."""
    kinds: list[tuple[str, Callable[[], Height]]] = [
        ("waves", lambda: hills(seed)),
        ("Matérn 3/2", lambda: random_field(seed, 1.5, 300.0)),
        ("Matérn 5/2", lambda: random_field(seed, 2.5, 250.0)),
        ("Gaussian", lambda: random_field(seed, np.inf, 220.0)),
        ("folded", lambda: folded_truth(seed)),
        ("hills", lambda: hills(seed, shortest=400.0, relief=40.0)),
    ]
    name, make = kinds[seed % len(kinds)]
    return name, make()


def site(seed: int) -> Site:
    """Return about 600 points: 11 sections of unequal, crooked or crossing course in a core, holes around it."""
    rng = np.random.default_rng(5000 + seed)
    name, height = truth_of(seed)
    noise, least = NOISES[(seed // 6) % 4], SPACINGS[(seed // 2) % 4]
    layout = ("straight", "crooked", "crossing", "unequal")[(seed // 3) % 4]
    x0, x1 = 700.0, 1300.0
    lines = np.linspace(x0, x1, 11)
    if layout == "unequal":
        lines = np.sort(np.concatenate([[x0, x1], rng.uniform(x0, x1, 9)]))
        lines = x0 + (x1 - x0) * np.cumsum(np.append(0, np.diff(lines) + 15)) / (x1 - x0 + 150)
    xyz, section = [], []
    for i, x in enumerate(lines):
        gaps = rng.dirichlet(np.ones(41)) * (SIZE - least * 39)
        y = np.cumsum(gaps[:-1]) + least * np.arange(40)
        bend = rng.normal(0, 8) * np.sin(2 * np.pi * y / SIZE + rng.uniform(0, 6)) if layout == "crooked" else 0.0
        xyz.append(np.column_stack([np.clip(x + bend + 0 * y, x0, x1), y]))
        section += [f"S{i + 1:02d}"] * 40
    if layout == "crossing":
        for j, y in enumerate((500.0, 1100.0, 1600.0)):
            x = np.sort(rng.uniform(x0, x1, 12))
            xyz.append(np.column_stack([x, np.full(12, y)]))
            section += [f"C{j + 1}"] * 12
    holes = 157
    side = np.where(rng.uniform(size=holes) < 0.5, 0.0, x1 + 60.0)
    xyz.append(np.column_stack([side + rng.uniform(0, x0 - 60.0, holes), rng.uniform(0, SIZE, holes)]))
    plan = np.concatenate(xyz) + np.array([EASTING, NORTHING])
    z = height(*plan.T) + rng.normal(0, noise, len(plan))
    points = PointSet(
        np.column_stack([plan, z]),
        kind=["section"] * len(section) + ["borehole"] * holes,
        section=section + [""] * holes,
        hole=[""] * len(section) + [f"B{i + 1:03d}" for i in range(holes)],
    )
    core = (EASTING + x0, EASTING + x1, NORTHING, NORTHING + SIZE)
    return Site(f"{name}, {layout}, {noise:g} m, {least:g} m", points, height, core)


AREA = (EASTING, EASTING + SIZE, NORTHING, NORTHING + SIZE)
BOUNDARY = rectangle(np.array([[AREA[0], AREA[2], 0.0], [AREA[1], AREA[3], 0.0]]))


def places(area: tuple[float, float, float, float], count: int = 4000) -> np.ndarray:
    return np.random.default_rng(7).uniform((area[0], area[2]), (area[1], area[3]), (count, 2))


def sites(seeds: list[int], page: bool = False) -> None:
    print("error / exact thin plate; exact: largest distance of a core point; a point: control points a data point")
    print(f"{'site':42s}{'core':>7s}{'whole':>7s}{'exact':>9s}{'in core':>8s}{'a point':>8s}{'s':>7s}  energy, noise")
    rows, page_rows = [], []
    for seed in seeds:
        one = site(seed)
        start = time.process_time()
        try:
            surface = fit_horizon(one.points, FitSettings(), BOUNDARY)
        except GeofitError as error:
            print(f"{seed:3d} {one.title:38s} FAILED {error}")
            continue
        seconds = time.process_time() - start
        ratios = []
        for area in (one.core, AREA):
            at = places(area)
            truth = one.height(*at.T)
            theirs = rms(thin_plate(one.points.xyz, at) - truth)
            ratios.append(rms(surface.elevation(*at.T) - truth) / theirs)
        core = np.abs(surface.accuracy.residuals[surface.core])
        exact = float(core.max()) if len(core) else np.nan
        a_point = surface.control_points / len(one.points)
        rows.append((*ratios, exact, a_point, seconds))
        words = one.title.split(", ")
        noise, least = (float(word.split()[0]) for word in words[2:])
        page_rows.append(Row(words[0], words[1], noise, least, *ratios, exact, len(core), a_point))
        print(
            f"{seed:3d} {one.title:38s}{ratios[0]:7.2f}{ratios[1]:7.2f}{exact:9.1e}{len(core):8d}"
            f"{a_point:8.1f}{seconds:7.2f}  {surface.diagnostics['energy']} {surface.diagnostics['noise']:.3f}",
            flush=True,
        )
    table = np.array(rows)
    lost = int((~(table[:, 2] < 1e-6)).sum())
    for word, figures in (("median", np.median(table, axis=0)), ("worst", np.max(table, axis=0))):
        print(f"{word:42s}{figures[0]:7.2f}{figures[1]:7.2f}{'':17s}{figures[3]:8.1f}{figures[4]:7.2f}")
    print(f"core not exact on {lost} of {len(table)} sites\n")
    if page:
        write_page(page_rows, (seeds[0], seeds[-1] + 1), DOCS)


def cloud(seed: int, n: int, noise: float = 0.05) -> tuple[PointSet, Height]:
    """Return n scattered points, half of them in a dense rectangle."""
    rng, height = np.random.default_rng(seed), hills(seed)
    dense = rng.uniform((700, 500), (1300, 1500), (n // 2, 2))
    plan = np.concatenate([dense, rng.uniform(0, SIZE, (n - n // 2, 2))]) + np.array([EASTING, NORTHING])
    return PointSet(np.column_stack([plan, height(*plan.T) + rng.normal(0, noise, n)])), height


def scattered(counts: list[int]) -> None:
    print(f"scattered points, half in a dense core, noise 0.05 m; P-splines of {SPANS} x {SPANS} spans, with a given")
    print(f"penalty and with a searched one; processor seconds, median of {FITS} fits after a first one")
    print(f"{'':10s}{'n':>8s}{'error':>9s}{'worst':>8s}{'s':>7s}{'ratio':>7s}{'numbers':>9s}")
    at = places(AREA, 10_000)
    for n in counts:
        points, height = cloud(0, n)
        truth = height(*at.T)

        def ours(points: PointSet = points) -> HorizonFit:
            return fit_horizon(points, FitSettings(), BOUNDARY)

        with threadpool_limits(limits=1):
            seconds, surface = _timed(ours)
            rows = [("geofit", seconds, surface.elevation(*at.T), surface.control_points)]
            for name, penalty in (("given", PENALTY), ("searched", None)):
                seconds, spline = _timed(lambda p=penalty, xyz=points.xyz: PSpline(AREA, SPANS, p).fit(xyz))
                rows.append((name, seconds, spline.elevation(*at.T), spline.count**2))
        for name, seconds, found, count in rows:
            off = found - truth
            print(
                f"{name:10s}{n:8,d}{rms(off):9.4f}{np.abs(off).max():8.3f}{seconds:7.2f}"
                f"{rows[0][1] / seconds:7.2f}{count:9,d}"
            )
        words = [check.name for check in surface.accuracy.checks if check.passed is False]
        noise = surface.diagnostics["noise"]
        print(f"geofit: noise found {noise:.4f} m, {surface.accuracy.verdict} {', '.join(words)}", flush=True)
    print()


def _timed(work: Callable[[], Fitted]) -> tuple[float, Fitted]:
    """Return the median processor time of some runs after a first one, and what the last returned."""
    found, seconds = work(), []
    for _ in range(FITS):
        start = time.process_time()
        found = work()
        seconds.append(time.process_time() - start)
    return float(np.median(seconds)), found


def real(keys: list[str], page: bool = False) -> None:
    folder = data_folder()
    if folder is None:
        print("The real data are not here. Set GEOFIT_DATA to their folder, or lay them at ../shared/data.")
        return
    # One thread per process: two processes share two cores, and sums are the same on every machine.
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    names = [(key, name) for key in keys for name in SETS[key](folder).site.horizons]
    draws = [(*of, draw) for draw in range(DRAWS) for of in names]
    with ProcessPoolExecutor(PROCESSES, mp_context=multiprocessing.get_context("spawn")) as pool:
        lines = list(pool.map(_folds, *zip(*names, strict=True)))
        print("\n".join(folds_table(lines)), flush=True)
        drawn = [line for line in pool.map(_folds_of_draw, *zip(*draws, strict=True)) if line is not None]
    print("\n".join(methods_table(drawn)))
    if page:
        write_folds(lines, drawn, DRAWS, DOCS)


def _folds(key: str, name: str) -> Folds:
    """Predict each fold of a horizon by methods that estimate their parameters without it."""
    real_set = SETS[key](data_folder())
    points = real_set.site.horizons[name]
    return _scored(f"{real_set.title}: {name}", points)


def _folds_of_draw(key: str, name: str, draw: int) -> Folds | None:
    """Do so with elevations drawn from the process that suits the horizon best; None for too few or many points."""
    points = SETS[key](data_folder()).site.horizons[name]
    points = points[np.sort(np.unique(points.xyz[:, :2], axis=0, return_index=True)[1])]
    if not DRAWN_POINTS[0] <= len(points) <= DRAWN_POINTS[1]:
        return None
    plane, z = _plane(points), points.xyz[:, 2]
    truth = _likeliest(plane, z, 1)
    drawn = truth.draw(plane, z, draw)
    return _scored(name, PointSet(np.column_stack([points.xyz[:, :2], drawn]), hole=points.hole), truth)


def _scored(title: str, points: PointSet, truth: Process | None = None) -> Folds:
    fold, area, z, plane = folds(points), rectangle(points.xyz), points.xyz[:, 2], _plane(points)
    groups = [np.flatnonzero(fold == k) for k in np.unique(fold)]
    found = {method: np.full(len(z), np.nan) for method in (*METHODS, "truth")}
    for group in groups:
        rest = np.setdiff1d(np.arange(len(z)), group)
        there = points.xyz[group, :2]
        try:
            surface = fit_horizon(points[rest], FitSettings(), area)
            found["geofit"][group] = surface.elevation(*there.T)
        except GeofitError as error:
            print(f"{title}: {error}", flush=True)
        found["thin plate"][group] = thin_plate(points.xyz[rest], there)
        found["smoothing plate"][group] = smooth_plate(np.column_stack(one_a_place(points.xyz[rest])), there)
        for drift, method in enumerate(("GP, constant", "GP, plane")):
            process = _likeliest(plane[rest], z[rest], drift)
            found[method][group] = process.predict(plane[rest], z[rest], plane[group])[0]
        if truth is not None:
            found["truth"][group] = truth.predict(plane[rest], z[rest], plane[group])[0]
    with suppress(np.linalg.LinAlgError):  # coincident points; the page shows a dash
        found["kriging"][:] = krige_left_out(plane, z, groups)
    known = np.isfinite(found["geofit"])
    *errors, of_truth = (rms((one - z)[known]) if known.any() else np.nan for one in found.values())
    return Folds(title, len(z), int((~known).sum()), tuple(errors), of_truth)


def _plane(points: PointSet) -> np.ndarray:
    return points.xyz[:, :2] - points.xyz[:, :2].mean(axis=0)


def _likeliest(plane: np.ndarray, z: np.ndarray, drift: int) -> Process:
    return min((fit_process(plane, z, kernel, drift) for kernel in KERNELS), key=lambda one: one.value)


def main() -> None:
    words = [word for word in sys.argv[1:] if word != "--page"]
    parts: dict[str, list[str]] = {}
    for word in words:
        if word in ("sites", "scattered", "real"):
            parts[word] = []
        elif parts:
            parts[list(parts)[-1]].append(word)
        else:
            sys.exit(f"Unknown part '{word}'. Parts: sites, scattered, real.")
    for part, more in (parts or {"sites": ["12"], "scattered": ["10000"]}).items():
        if part == "sites":
            low, high = (0, int(more[0])) if len(more) == 1 else (int(more[0]), int(more[1])) if more else (0, 24)
            sites(list(range(low, high)), "--page" in sys.argv)
        elif part == "scattered":
            scattered([int(word) for word in more] or [5_000, 10_000, 20_000])
        else:
            real(more or list(SETS), "--page" in sys.argv and not more)


if __name__ == "__main__":
    main()
