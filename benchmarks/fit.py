"""A horizon of 597 points beside OpenCASCADE's GeomPlate; a million points beside a scipy P-spline; ten truths.

Run ``python benchmarks/fit.py [small] [large] [storage] [truths]`` (default: all four). Ratios count: the seconds are
those of one machine.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from statistics import median
from typing import TypeVar

import numpy as np
from threadpoolctl import threadpool_limits

from geofit import FitSettings, HorizonFit, PointSet, fit_horizon
from geofit.checks.check import sigma
from geofit.checks.storage import equal_accuracy

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from peers.geomplate import COARSE, FINE, Setting, geom_plate
from peers.pspline import PSpline
from truth import EASTING, NORTHING, Height, Truth, hills, paper_arrangement, rms, thin_plate

T = TypeVar("T")

TURNS, FEW_TURNS = 7, 3
#: Fits that do no checking: the stages of ``surface.diagnostics["seconds"]`` that are not part of it.
CHECKING = ("check", "adjust")
MILLION, SIZE, NOISE = 1_000_000, 2_000.0, 0.05
#: Sizes of the reference that are tried, and its penalty: the best of 0.01, 0.1 and 1 at every size.
SPANS, PENALTY = range(20, 73, 4), 0.01
EQUAL = 1.1
#: Spans of the reference that is not sized, and searches its penalty.
USUAL = 60


def timed(work: Callable[[], T]) -> tuple[float, T]:
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def in_turn(first: Callable[[], object], second: Callable[[], object], turns: int = TURNS) -> list[tuple[float, float]]:
    """Return the seconds of both, run one after the other ``turns`` times, after one run of each to warm up."""
    first(), second()
    return [(timed(first)[0], timed(second)[0]) for _ in range(turns)]


def fit_seconds(surface: HorizonFit) -> float:
    """Return the seconds of a fit up to its control points: all stages but the check and what follows it."""
    return float(sum(s for stage, s in surface.diagnostics["seconds"].items() if stage not in CHECKING))


def smallest(error: Callable[[int], float], limit: float, sizes: Iterable[int]) -> int:
    """Return the first size whose error is within a limit; that of the least error if none is."""
    found: dict[int, float] = {}
    for size in sizes:
        found[size] = error(size)
        if found[size] <= limit:
            return size
    return min(found, key=lambda size: found[size])


def scattered(seed: int, n: int) -> tuple[PointSet, Height, np.ndarray]:
    """Return n points spread evenly over the truths' area, with noise; the height; the area's corners."""
    rng, height = np.random.default_rng(seed), hills(seed)
    xy = rng.uniform((EASTING, NORTHING), (EASTING + SIZE, NORTHING + SIZE), (n, 2))
    corners = np.array([EASTING, NORTHING]) + np.array([[0, 0], [SIZE, 0], [SIZE, SIZE], [0, SIZE]])
    return PointSet(np.column_stack([xy, height(*xy.T) + rng.normal(0, NOISE, n)])), height, corners


def errors(elevation: Height, truth: Truth) -> tuple[float, float]:
    """Return the rms error at 10,000 places of the core, and of the whole area; nan if it is not all covered."""
    values = []
    for core in (True, False):
        x, y = truth.places(core=core).T
        values.append(rms(elevation(x, y) - truth.height(x, y)))
    return values[0], values[1]


def small() -> None:
    truth = paper_arrangement(0)
    points, boundary = truth.points, truth.boundary

    def ours() -> HorizonFit:
        surface = fit_horizon(points, FitSettings(), boundary)
        surface.to_cadquery()
        return surface

    for setting in (FINE, COARSE):
        _beside_plate(truth, ours, setting)


def _beside_plate(truth: Truth, ours: Callable[[], HorizonFit], setting: Setting) -> None:
    points = truth.points

    def plate() -> HorizonFit:
        return geom_plate(points, setting)

    seconds = in_turn(ours, plate)
    print(f"{len(points)} points: fit, check and stitch against GeomPlate's fit {setting}, {TURNS} times in turn")
    print(f"{'':12s}{'median, s':>10s}{'sigma, m':>10s}{'core, m':>9s}{'whole, m':>9s}{'poles':>8s}{'a point':>8s}")
    for name, surface, column in (("geofit", ours(), 0), ("GeomPlate", plate(), 1)):
        core, whole = errors(surface.elevation, truth)
        print(
            f"{name:12s}{median(pair[column] for pair in seconds):10.2f}{sigma(surface.distance(points.xyz)):10.3f}"
            f"{core:9.3f}{whole:9.3f}{surface.control_points:8,d}{surface.control_points / len(points):8.1f}"
        )
    ratios = sorted(mine / theirs for mine, theirs in seconds)
    print(
        f"time, geofit / GeomPlate: median {median(ratios):.2f}, {ratios[0]:.2f} to {ratios[-1]:.2f}; aim: at most 1\n"
    )


def large() -> None:
    points, height, boundary = scattered(0, MILLION)
    area = (EASTING, EASTING + SIZE, NORTHING, NORTHING + SIZE)
    places = np.random.default_rng(12345).uniform((area[0], area[2]), (area[1], area[3]), (10_000, 2)).T
    settings = FitSettings(core="none")

    def ours() -> HorizonFit:
        return fit_horizon(points, settings, boundary)

    def reference(spans: int) -> PSpline:
        return PSpline(area, spans, PENALTY).fit(points.xyz)

    surface = ours()
    error = rms(surface.elevation(*places) - height(*places))

    def error_of(spans: int) -> float:
        return rms(reference(spans).elevation(*places) - height(*places))

    # The reference is sized for geofit's error before the clock starts, with the truth available: in its favour.
    spans = smallest(error_of, EQUAL * error, SPANS)
    print(f"{MILLION:,} points, noise {NOISE} m, core='none': medians of {FEW_TURNS} runs in turn")
    runs = []
    # One thread for the linear algebra of both, as fit_horizon takes it for itself.
    with threadpool_limits(limits=1):
        for _ in range(FEW_TURNS):
            sized, spline = timed(lambda: reference(spans))
            searched, usual = timed(lambda: PSpline(area, USUAL).fit(points.xyz))
            whole, surface = timed(ours)
            runs.append((sized, searched, fit_seconds(surface), whole))
    sized, searched, fit, whole = (median(column) for column in zip(*runs, strict=True))
    print(f"{'':44s}{'s':>8s}{'/ sized':>9s}{'/ searched':>12s}{'error, m':>10s}{'coefficients':>14s}")
    rows = (
        ("P-spline, sized", sized, rms(spline.elevation(*places) - height(*places)), spline.count**2),
        (
            f"P-spline, {USUAL} x {USUAL} spans, penalty searched",
            searched,
            rms(usual.elevation(*places) - height(*places)),
            usual.count**2,
        ),
        ("geofit, up to the control points", fit, error, surface.control_points),
        ("geofit, with the check", whole, error, surface.control_points),
    )
    for name, seconds, off, count in rows:
        print(f"{name:44s}{seconds:8.2f}{seconds / sized:9.2f}{seconds / searched:12.2f}{off:10.4f}{count:14,d}")
    stages = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in surface.diagnostics["seconds"].items())
    print(f"stages of geofit, s: {stages}; aim: a ratio of at most 0.35\n")


def storage() -> None:
    truth = paper_arrangement(0)
    surface = fit_horizon(truth.points, FitSettings(), truth.boundary)
    n, poles = len(truth.points), surface.control_points
    print(f"what holds geofit's surface of {n} points: {poles:,} control points, {poles / n:.1f} a point (aim: 10)")
    print("within, m    TIN vertices    grid nodes")
    for tolerance in (0.1, 0.25, 0.5):
        found = equal_accuracy(surface, tolerance)
        cells = [f"{count:,}" if count else "over 12,000" for count in (found.tin_points, found.grid_points)]
        print(f"{tolerance:9.2f}{cells[0]:>16s}{cells[1]:>14s}")
    print()


def truths(count: int = 10) -> None:
    print("rms error against the truth / that of scipy's exact thin plate, core and whole area")
    print("          geofit, m            geofit, ratio      GeomPlate, ratio")
    print("seed      core    whole        core   whole         core   whole")
    table = []
    for seed in range(count):
        truth = paper_arrangement(seed)
        exact = errors(thin_plate(truth.points), truth)
        surfaces = (fit_horizon(truth.points, FitSettings(), truth.boundary), geom_plate(truth.points))
        ours, plate = (errors(surface.elevation, truth) for surface in surfaces)
        ratios = [mine / theirs for tool in (ours, plate) for mine, theirs in zip(tool, exact, strict=True)]
        table.append(ratios)
        print(f"{seed:4d}{ours[0]:10.3f}{ours[1]:9.3f}  {_ratios(ratios)}")
    print(f"{'median':23s}  {_ratios(np.median(table, axis=0))}     aim 1.2, 0.9")
    print(f"{'worst':23s}  {_ratios(np.max(table, axis=0))}     aim 1.4, 1.1\n")


def _ratios(row: Iterable[float]) -> str:
    core, whole, plate_core, plate_whole = row
    return f"{core:10.2f}{whole:8.2f}{plate_core:13.2f}{plate_whole:8.2f}"


PARTS = {"small": small, "large": large, "storage": storage, "truths": truths}


def main() -> None:
    unknown = [name for name in sys.argv[1:] if name not in PARTS]
    if unknown:
        sys.exit(f"Unknown part '{unknown[0]}'. Parts: {', '.join(PARTS)}.")
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()


if __name__ == "__main__":
    main()
