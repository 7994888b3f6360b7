"""How time and memory grow: points in memory up to 1e6, clouds up to 1e7 (1e8 on request), CSV, horizons side by side.

Run ``python benchmarks/scale.py [LARGEST]`` (default 1e7): each row runs in a process of its own, which reports its
processor time and its peak memory. The figures are kept in build/scale.json, and docs/scale.md is written from them;
``python benchmarks/scale.py page`` writes it again, ``python benchmarks/scale.py streamed 1e8`` measures one row anew.
1e8 takes 5 GB of disk.
"""

from __future__ import annotations

import json
import math
import multiprocessing
import os
import resource
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "scale.json"
sys.path.append(str(ROOT / "tests"))
from drawing import drawing_section, with_section  # noqa: E402
from truth import EASTING, NORTHING, hills  # noqa: E402

NOISE, SIZE, CHUNK = 0.05, 2000.0, 100_000
CSV_ROWS, HORIZONS, POINTS = 1_000_000, 200, 600
#: Points whose distances are measured, and those of them that the dense search measures.
DISTANCES, CHECKED = 1_000_000, 60
Figures = dict[str, float]
COMMANDS = (
    "geofit fit scan.laz --out results",
    "geofit fit scan.csv --out results --stream     # a table that need not fit into the memory",
    "geofit fit scan.laz --out results --scheduler tcp://host:8786",
)
TABLE = (
    "| points | `fit_horizon`, s | MB above the input's | `fit_cloud`, s | MB above the input's "
    "| streamed: fit, s | fit and distances, s | MB |",
    "|---|---|---|---|---|---|---|---|",
)


def made(n: int, seed: int = 0) -> Iterator[np.ndarray]:
    """Yield n points of a truth with noise, some at a time."""
    rng, height = np.random.default_rng(seed), hills(seed)
    for start in range(0, n, CHUNK):
        xy = rng.uniform((EASTING, NORTHING), (EASTING + SIZE, NORTHING + SIZE), (min(CHUNK, n - start), 2))
        yield np.column_stack([xy, height(*xy.T) + rng.normal(0, NOISE, len(xy))])


def used(since: float = 0.0) -> float:
    """Return the processor seconds of this process and its ended children."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) - since


def resident() -> float:
    """Return the memory that this process takes now, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1024**2


def peak() -> float:
    """Return the largest memory that this process or one of its children took, MB."""
    return max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) / 1024


def from_arrays(n: int) -> Figures:
    from geofit import FitSettings, PointSet, fit_horizon

    points = PointSet(_array(n))
    before, start, wall = resident(), used(), time.perf_counter()
    fit_horizon(points, FitSettings(core="none"))
    wall = time.perf_counter() - wall
    return {"cpu": used(start), "wall": wall, "before": before, "peak": peak(), "input": points.xyz.nbytes / 1024**2}


def _array(n: int) -> np.ndarray:
    """Return n points in one array that was filled in place: nothing larger was in the memory before."""
    xyz, start = np.empty((n, 3)), 0
    for part in made(n):
        xyz[start : start + len(part)] = part
        start += len(part)
    return xyz


def cloud_in_memory(n: int) -> Figures:
    from geofit.streaming.fit import fit_cloud

    xyz = _array(n)
    before, start = resident(), used()
    fit_cloud(xyz)
    return {"cpu": used(start), "before": before, "peak": peak(), "input": xyz.nbytes / 1024**2}


def streamed(n: int) -> Figures:
    from geofit.streaming.fit import fit_cloud
    from geofit.streaming.residuals import measure
    from geofit.streaming.spool import spooled

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        spool = spooled(made(n), folder, "made", n)
        start, wall = used(), time.perf_counter()
        fit = fit_cloud(spool.xyz(), folder=folder)
        fitted = used(start)
        found = measure(spool, fit.surface, 0.1, 0.5, fit.field.noise, folder=folder / "distances")
        whole = time.perf_counter() - wall
        return {"cpu": used(start), "fit": fitted, "wall": whole, "peak": peak(), "sigma": found.sigma}


def csv_file(rows: int) -> Figures:
    from geofit.io.picks import read_points

    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "picks.csv"
        with path.open("w", encoding="utf-8") as file:
            file.write("x,y,z,horizon\n")
            for part in made(rows):
                file.writelines(f"{x:.3f},{y:.3f},{z:.3f},T2\n" for x, y, z in part.tolist())
        before, start = peak(), used()
        read_points(path)
        figures = {"cpu": used(start), "before": before, "peak": peak(), "bytes": float(path.stat().st_size)}
        try:
            import polars
        except ImportError:
            return figures
        times = []
        for _ in range(5):
            start = used()
            polars.read_csv(path)
            mid = used()
            read_points(path)
            times.append((mid - start, used(mid)))
        theirs, ours = np.median(times, axis=0)
        return {**figures, "polars": float(theirs), "again": float(ours)}


def side_by_side(count: int) -> Figures:
    from geofit import PointSet
    from geofit.data.site import Site
    from geofit.site.fit_site import fit_site

    horizons = {f"H{k}": PointSet(next(made(POINTS, k))) for k in range(count)}
    site = Site(name="many", horizons=horizons)
    start, wall = used(), time.perf_counter()
    fit_site(site)
    one, alone = used(start), time.perf_counter() - wall
    start, wall = used(), time.perf_counter()
    fit_site(site, scheduler="local", workers=2)
    figures = {"one": one, "two": used(start), "wall_one": alone, "wall_two": time.perf_counter() - wall}
    start, wall = used(), time.perf_counter()
    fit_site(site, scheduler="local", workers=4)
    return {**figures, "four": used(start), "wall_four": time.perf_counter() - wall}


def distances(n: int) -> Figures:
    """Measure n distances from each kind of surface: microseconds of the processor a point, and the largest error."""
    from converged import converged_distances, ring
    from distance import fold, horizon

    from geofit.geometry.trim_loops import nearest_on_trimmed

    found: Figures = {}
    for name, patch in (("horizon", horizon()), ("fold", fold())):
        u0, u1, v0, v1 = patch.domain
        cut = ring(patch, (0.5, 0.5), 0.4, 400), ring(patch, (0.45, 0.55), 0.1, 90)
        for spread, loops in ((0.2, ()), (20.0, ()), (0.2, cut), (20.0, cut)):
            rng = np.random.default_rng(2)
            u, v = rng.uniform(u0, u1, n), rng.uniform(v0, v1, n)
            xyz = patch.evaluate(u, v) + patch.normal(u, v) * rng.normal(0, spread, n)[:, None]
            whole = (loops,) if loops else ()
            nearest_on_trimmed([patch], xyz[:20_000], whole)
            start = used()
            distance = np.abs(nearest_on_trimmed([patch], xyz, whole).distance)
            key = f"{'trimmed ' if loops else ''}{name}, points {spread:g} m off"
            found[f"{key}: us"] = 1e6 * used(start) / n
            found[f"{key}: error"] = float(
                np.abs(distance[:CHECKED] - converged_distances(patch, loops, xyz[:CHECKED])).max()
            )
    return found


TASKS: dict[str, Callable[[int], Figures]] = {
    "arrays": from_arrays,
    "cloud": cloud_in_memory,
    "streamed": streamed,
    "csv": csv_file,
    "horizons": side_by_side,
    "distances": distances,
}


def apart(task: str, n: int) -> Figures:
    """Run one measurement in a process of its own."""
    context = multiprocessing.get_context("spawn")
    queue: Any = context.SimpleQueue()
    child = context.Process(target=_told, args=(queue, task, n))
    child.start()
    child.join()
    if queue.empty():
        sys.exit(f"{task} {n:,}: the process ended without a result")
    figures: Figures = queue.get()
    print(f"{task:10s}{n:12,d}  " + ", ".join(f"{key} {value:.4g}" for key, value in figures.items()), flush=True)
    return figures


def _told(queue: Any, task: str, n: int) -> None:
    queue.put(TASKS[task](n))


def exponent(table: dict[int, Figures], key: str = "cpu") -> float:
    """Return the slope of the logarithm of time against that of n, between the ends of a table."""
    low, high = min(table), max(table)
    if low == high:
        return math.nan
    return math.log(table[high][key] / table[low][key]) / math.log(high / low)


def _beside(row: Figures) -> str:
    """Return what else the machine did during a run, where its load was above its processors."""
    return f", next to other work (load {row['load']:.0f})" if row["load"] > 1.5 * (os.cpu_count() or 1) else ""


def page(found: dict[str, dict[int, Figures]]) -> str:
    """Return docs/scale.md."""
    arrays, clouds, files = found["arrays"], found["cloud"], found["streamed"]
    largest = max(files)
    best = files[largest]
    rate = best["cpu"] / largest
    csv, many = found["csv"][CSV_ROWS], found["horizons"][HORIZONS]
    each = many["one"] / HORIZONS
    hours, hundred = rate * 1e10 / 3600, best["fit"] / largest * 1e8 + (best["cpu"] - best["fit"]) / largest * 0.5e8
    lines = ["# Scale", ""]

    def say(text: str) -> None:
        lines.extend([*textwrap.wrap(" ".join(text.split()), 118, break_on_hyphens=False), ""])

    say(f"""`python benchmarks/scale.py [LARGEST]` measures this page and writes it. Seconds are those of the processor
        ({os.cpu_count()} processors), of all processes together; memory is the peak of the largest process. Points are
        seeded hills on 2 km x 2 km with a noise of {NOISE} m. What is in *italics* is extrapolated, not measured.""")
    earlier = [
        f"{', '.join(f'{n:,}' for n in sorted(rows) if rows[n].get('earlier'))} ({task})"
        for task, rows in found.items()
        if any(row.get("earlier") for row in rows.values())
    ]
    if earlier:
        say(f"These rows are of an earlier run, with the code of then: {'; '.join(earlier)}.")
    lines += ["## One surface", "", "```", *COMMANDS, "```", ""]
    say("""LAS, LAZ and Parquet need the extra: `python -m pip install ".[scale]"` in the clone. A cloud is read once,
        to 24 bytes a point in the folder of the results; every later pass is over that file. The passes find the
        extent, the frame, coincident points, the sums of the field's cells (one pass a level of control points),
        and the distances. The state is that of the cells: it does not grow with n. Parts of a million points are
        measured by the workers, which write their distances as Parquet and send back sums. A run that is stopped,
        or loses its scheduler, goes on with the same command: points that were read and parts that were measured
        are kept; the fit between them is made again.""")
    lines += [*TABLE]
    for n in sorted({*arrays, *clouds, *files}):
        cells = [f"{n:,}"]
        for table in (arrays, clouds):
            row = table.get(n)
            cells += ["–", "–"] if row is None else [f"{row['cpu']:.2f}", f"{row['peak'] - row['before']:.0f}"]
        row = files.get(n)
        cells += ["–"] * 3 if row is None else [f"{row['fit']:.2f}", f"{row['cpu']:.1f}", f"{row['peak']:.0f}"]
        lines.append("| " + " | ".join(cells) + " |")
    far = f"| *10,000,000,000* | – | – | – | – | *{best['fit'] / largest * 1e10:,.0f}* | *{rate * 1e10:,.0f}* |"
    lines += [f"{far} – |", ""]
    ends = {min(arrays): arrays[min(arrays)], largest: best}
    say(f"""Growth of the time from the smallest to the largest n: exponent {exponent(arrays):.2f} (`fit_horizon`),
        {exponent(clouds):.2f} (`fit_cloud` in memory), {exponent(files):.2f} (streamed), {exponent(ends):.2f} from
        {min(arrays):,} points (`fit_horizon`) to {largest:,} (streamed, distances included).""")
    most, few = arrays[max(arrays)], arrays[100_000]
    above, constant = most["peak"] - most["before"], few["peak"] - few["before"]
    say(f"""`fit_horizon` of {max(arrays):,} points takes {most["cpu"]:.1f} s of one processor ({most["wall"]:.0f} s of
        wall time{_beside(most)}), and {above / most["input"]:.1f} x the memory of the coordinates above them;
        without the {constant:.0f} MB that a fit of 100,000 takes for libraries and cells it is
        {(above - constant) / most["input"]:.1f} x. `tests/fitting/test_memory.py` holds each further point to
        48 bytes, twice its coordinates.""")
    two = best["fit"] + (best["cpu"] - best["fit"]) / 2
    say(f"""*{largest:,} points on two free processors*: {two:.0f} s after reading, as the fit runs on one and the
        distances on both. The run took {best["wall"]:.0f} s of wall time{_beside(best)}.""")
    if largest < 10**8:
        say(f"""*1e8 points* were not measured to the end; at the rate of {largest:,} they take {hundred:.0f} s after
            reading on two free processors.""")
    sizes = " and ".join(f"{row['peak']:.0f} MB at {n:,}" for n, row in sorted(files.items())[-2:])
    say(f"""Peak memory of a streamed run: {sizes}. It holds the cells of the spline and the coincident points (their
        number grows with the square of the density), not the cloud; that of 1e10 points is not extrapolated.""")
    say(f"""*1e10 points*, from {rate * 1e6:.2f} s a million at {largest:,}: {hours:.0f} h of one processor, 240 GB of
        disk for the points and some 80 GB for the distances. Only the distances are spread over the workers: the fit
        takes {best["fit"] / largest * 1e10 / 3600:.0f} h on one processor however many there are.""")
    lines += ["## Distances", ""]
    ((count, of_kinds),) = found["distances"].items()
    say(f"""{count:,} points of each kind, half of those of a trimmed surface beyond its edge. Points a second are those
        of two free processors, twice those of one processor's second; the error is that of {CHECKED} points against a
        dense search (`tests/converged.py`). From 5,000 points on the search is compiled.""")
    lines += ["| surface | points a second | largest error, m |", "|---|---|---|"]
    for key in [key[: -len(": us")] for key in of_kinds if key.endswith(": us")]:
        lines.append(f"| {key} | {2e6 / of_kinds[f'{key}: us']:,.0f} | {of_kinds[f'{key}: error']:.0e} |")
    lines += ["", "## Many horizons", ""]
    say("""`geofit fit site.toml --scheduler local` fits horizons side by side in processes of this machine; an address
        or the file of a scheduler (`dask scheduler --scheduler-file FILE`, as a job of Slurm starts it) sends them to a
        Dask cluster. The surfaces are the same to the last bit. A worker that dies costs its horizon a second try;
        where the scheduler is lost, or the run is stopped, the same command goes on with the other horizons.""")
    lines += [
        "| horizons of 600 points | one process, s | two processes, both together, s | half of these / one "
        "| wall time, two / one |",
        "|---|---|---|---|---|",
        f"| {HORIZONS} | {many['one']:.1f} | {many['two']:.1f} | {many['two'] / 2 / many['one']:.2f} "
        f"| {many['wall_two'] / many['wall_one']:.2f} |",
        f"| *10,000* | *{each * 1e4:,.0f}* | – | – | – |",
        "",
    ]
    say(f"""Two processes cost {many["two"] - many["one"]:.1f} s more of the processors than one: each loads the
        libraries, and they share caches and memory. Half of their seconds is the wall time of two free processors; the
        measured one is that of this run{_beside(many)}. *1e4 horizons*: {each * 1e4 / 3600:.1f} h of one processor,
        {each * 1e4 / 64:.0f} s on 64 if nothing else limits them.""")
    if "four" in many:
        say(f"""Four processes take {many["four"] / many["one"] - 1:.0%} more of the processors than one, and
            {many["wall_four"] / many["wall_one"]:.2f} of its wall time.""")
    say("""The folds of a cross-validation that need a fit (sections of a fold, groups of fewer than 30 points) go the
        same way with `--scheduler`; from Python so do the holes left out of a body (`leave_one_hole_out`) and its
        simulations (`BodyFit.volumes`). Errors are the same to the last bit, standard deviations and volumes to
        rounding. `geofit fit` keeps each fold that is ready: a run that is stopped, or loses its scheduler, goes on
        with the other folds when it is started again.""")
    lines += ["## Tables", ""]
    text = f"""A CSV of {CSV_ROWS:,} rows, {csv["bytes"] / 1e6:.0f} MB: {csv["cpu"]:.2f} s at first, peak memory
        {csv["peak"]:.0f} MB ({(csv["peak"] - csv["before"]) * 1e6 / csv["bytes"]:.1f} bytes a byte above the start)."""
    if "polars" in csv:
        text += f""" polars reads the same file in {csv["polars"]:.2f} s, geofit, which accounts for every row, in
            {csv["again"]:.2f} s: {csv["again"] / csv["polars"]:.1f} times as long."""
    say(text)
    return "\n".join(lines)


def measured(largest: int) -> dict[str, dict[int, Figures]]:
    """Measure everything; what is known is kept on the disk after each row, as a run takes long."""
    decades = [10**k for k in range(3, 10) if 10**k <= largest]
    rows = {
        "csv": [CSV_ROWS],
        "arrays": [n for n in decades if n <= 10**7],
        "cloud": [n for n in decades if 10**5 <= n <= 10**7],
        "streamed": [n for n in decades if n >= 10**6],
        "horizons": [HORIZONS],
        "distances": [DISTANCES],
    }
    for task, counts in rows.items():
        for n in counts:
            measure_one(task, n)
    return kept()


def measure_one(task: str, n: int) -> None:
    """Measure one row, and keep it with the others on the disk: a run of all takes long."""
    row = {**apart(task, n), "load": os.getloadavg()[0]}
    found = kept()
    found.setdefault(task, {})[n] = row
    KEPT.parent.mkdir(exist_ok=True)
    KEPT.write_text(json.dumps(found), encoding="utf-8")


def kept() -> dict[str, dict[int, Figures]]:
    """Return the figures that were measured, each the last time."""
    if not KEPT.exists():
        return {}
    found = json.loads(KEPT.read_text(encoding="utf-8"))
    return {task: {int(n): row for n, row in rows.items()} for task, rows in found.items()}


def main() -> None:
    given = sys.argv[1] if len(sys.argv) > 1 else "1e7"
    if given in TASKS:
        for n in sys.argv[2:]:
            measure_one(given, int(float(n)))
    elif given != "page":
        measured(int(float(given)))
    found = kept()
    missing = [task for task in TASKS if task not in found]
    if missing:
        sys.exit(f"The page needs figures of {', '.join(missing)}, too.")
    path = ROOT / "docs" / "scale.md"
    # The last section is that of benchmarks/drawing.py.
    path.write_text(with_section(page(found), drawing_section(path.read_text(encoding="utf-8"))), encoding="utf-8")


if __name__ == "__main__":
    main()
