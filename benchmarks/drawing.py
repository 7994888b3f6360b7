"""Drawing: triangles of ten horizons, frames of a cloud while the viewpoint turns, and what lies under the pointer.

    python benchmarks/drawing.py [POINTS]

(1e7 points if none are given; the name of a task measures that one anew.) Each row runs in a process of its own;
without a display, on a virtual screen. The figures stay in build/drawing.json; the last section of docs/scale.md is
written from them, and ``page`` in place of POINTS writes it again. Seconds are CPU time summed over all threads;
software rendering uses two threads.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import resource
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
KEPT, PAGE, HEAD = ROOT / "build" / "drawing.json", ROOT / "docs" / "scale.md", "## Drawing\n"
ORIGIN = np.array([501_000.0, 3_100_000.0, 1_500.0])
HALF, TRIANGLES, HORIZONS = 1_000.0, 1_000_000, 10
#: Frames that are measured after some to settle; pixels that are asked, and those of them for which all points are
#: searched; places of each surface's triangles that are measured.
FRAMES, ASKED, CHECKED, PLACES = 40, 40, 5, 2_000
Figures = dict[str, float]


def waves(number: int, control: int = 40) -> np.ndarray:
    """Return the control points of a smooth horizon, 60 m under the one before."""
    x, y = _plan(control)
    return np.stack([x, y, 40 * np.sin(x / 240 + number) * np.cos(y / 300) - 60 * number], axis=-1)


def rough(number: int) -> np.ndarray:
    """Return the control points of a horizon of 100 x 100 knots with a relief of every size."""
    rng = np.random.default_rng(number)
    x, y = _plan(100)
    z = sum(
        0.02 * length * np.sin(rng.normal(0, 1, 2) @ np.stack([x.ravel(), y.ravel()]) / length + rng.uniform(0, 6))
        for length in np.geomspace(30, 800, 12)
    )
    return np.stack([x, y, z.reshape(x.shape) - 60 * number], axis=-1)


def _plan(control: int) -> tuple[np.ndarray, np.ndarray]:
    knots = _knots(control)
    at = HALF * (2 * np.array([knots[i + 1 : i + 4].mean() for i in range(control)]) - 1)
    x, y = np.meshgrid(at, at, indexing="ij")
    return x, y


def _knots(control: int) -> np.ndarray:
    return np.concatenate([np.zeros(3), np.linspace(0, 1, control - 2), np.ones(3)])


def horizon(number: int, kind: str = "waves") -> Any:
    """Return a horizon: "waves", "rough", or waves within an "outline" of 60 corners."""
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.splines.patch import Patch
    from geofit.surfaces.patch_surface import PatchSurface

    control = rough(number) if kind == "rough" else waves(number)
    knots, outline = _knots(len(control)), None
    if kind == "outline":
        angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
        reach = 850 + 80 * np.sin(3 * angle + number)
        outline = reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]) + ORIGIN[:2]
    patch = Patch("core", (3, 3), knots, knots, control)
    return HorizonFit(PatchSurface((patch,), ORIGIN, outline=outline), name=f"H{number}")


def scan(count: int, kind: str) -> np.ndarray:
    """Return points of a wavy outcrop: "even", or as dense near eight "stations" as a scanner makes them."""
    rng = np.random.default_rng(1)
    xy = rng.uniform(-HALF, HALF, (count, 2))
    if kind == "stations":
        station = rng.uniform(-HALF, HALF, (8, 2))[rng.integers(8, size=count)]
        reach, angle = np.exp(rng.uniform(0, np.log(HALF), count)), rng.uniform(0, 2 * np.pi, count)
        xy = np.clip(station + reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), -HALF, HALF)
    z = 40 * np.sin(xy[:, 0] / 240) * np.cos(xy[:, 1] / 300) + rng.normal(0, 0.5, count)
    return np.column_stack([xy, z]) + ORIGIN


def resident() -> float:
    """Return the memory that this process takes now, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1024**2


def triangles(kind: str) -> Figures:
    """Make ten horizons ready for drawing, with a million triangles in all, and measure how far they leave them."""
    from geofit.gui.view3d.shape import FINE, shape_of

    surfaces = [horizon(k, kind) for k in range(HORIZONS)]
    coarsest, finest = 10 * FINE, FINE / 1000
    while coarsest / finest > 1.05:
        share = (coarsest * finest) ** 0.5
        many = sum(len(surface.triangulate(share * _width(surface)).triangles) for surface in surfaces) >= TRIANGLES
        coarsest, finest = (coarsest, share) if many else (share, finest)
    taken = []
    for _ in range(3):
        start = time.process_time()
        shapes = [shape_of(surface, fine=finest) for surface in surfaces]
        taken.append(time.process_time() - start)
    rng, error = np.random.default_rng(0), 0.0
    for surface, shape in zip(surfaces, shapes, strict=True):
        some = shape.xyz[shape.triangles[rng.integers(len(shape.triangles), size=PLACES)]]
        places = np.einsum("nk,nkd->nd", rng.dirichlet([1, 1, 1], PLACES), some)
        error = max(error, float(np.abs(surface.distance(places)).max()))
    count = sum(len(shape.triangles) for shape in shapes)
    return {"count": count, "cpu": median(taken), "tolerance": finest * _width(surfaces[0]), "error": error}


def _width(surface: Any) -> float:
    return float(np.linalg.norm(np.subtract(*surface.bounds)))


def frames(kind: str, count: int) -> Figures:
    """Show a cloud and ten horizons, turn, rest, look from near, and ask what lies under random pixels."""
    from dataclasses import replace

    from PySide6.QtCore import QEventLoop
    from PySide6.QtWidgets import QApplication

    from geofit.data.points import PointSet
    from geofit.data.site import Site
    from geofit.gui.view3d.item import Item
    from geofit.gui.view3d.picking import nearest_target
    from geofit.gui.view3d.view import SceneView

    app, view = QApplication([]), SceneView()
    view.resize(1280, 800)
    view.show()
    app.processEvents()
    points = PointSet(scan(count, kind), kind="section")
    before, start = resident(), time.process_time()
    view.show_site(Site("benchmark", {"cloud": points}))
    app.processEvents()
    view.canvas.finish()
    found: Figures = {"shown": time.process_time() - start, "before": before, "after": resident()}
    for k in range(HORIZONS):
        view.show_surface(horizon(k))
    canvas = view.canvas
    crowd = next(item.crowd for layer, item in view.contents.stage.items() if layer.kind == "points")

    def turn() -> None:
        drawn = canvas.frames
        canvas.look(canvas.viewpoint.turned(2.0, 0.0), moving=True)
        while canvas.frames == drawn:
            app.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 50)

    def settle() -> float:
        start = time.process_time()
        canvas.rest()
        app.processEvents()
        canvas.finish()
        return time.process_time() - start

    for name, distance in (("all", 1.0), ("near", 0.05)):
        canvas.look(replace(canvas.viewpoint, distance=distance * canvas.viewpoint.distance), moving=True)
        for _ in range(12):
            turn()
        start, wall = time.process_time(), time.perf_counter()
        for _ in range(FRAMES):
            turn()
        found[f"{name} frame"] = 1e3 * (time.process_time() - start) / FRAMES
        found[f"{name} rate"] = FRAMES / (time.perf_counter() - wall)
        found[f"{name} moving"] = crowd.count("coarse")
        found[f"{name} rest"] = settle()
        found[f"{name} still"] = crowd.count("full")
        found.setdefault("drawn", resident())
        end = time.perf_counter() + 0.3
        while time.perf_counter() < end:
            app.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 20)
        projector = canvas.projector()
        some = projector.screen(points.xyz[:: max(count // 200_000, 1)])[:, :2]
        some = some[((some > 0) & (some < (canvas.width(), canvas.height()))).all(axis=1)]
        asked = np.random.default_rng(0).permutation(some)[:ASKED]
        whole = [(layer, Item([], item.box, targets=item.targets)) for layer, item in view.contents.stage.items()]
        same, times, surfaces = 0, [], []
        for k, (column, row) in enumerate(asked.tolist()):
            start = time.process_time()
            hit = view.pointer.pick(column, row)
            times.append(1e3 * (time.process_time() - start))
            start = time.process_time()
            view.pointer.place_at(column, row)
            surfaces.append(1e3 * (time.process_time() - start))
            if k < CHECKED:
                other = nearest_target(whole, projector, column, row)
                same += hit is not None and other is not None and hit.which == other.which
        found |= {f"{name} same": same, f"{name} pick": median(times), f"{name} slowest pick": max(times)}
        found |= {f"{name} surface": median(surfaces), f"{name} first surface": surfaces[0]}
        found[f"{name} slowest surface"] = max(surfaces)
    found["input"] = points.xyz.nbytes / 1024**2
    if folder := os.environ.get("PICTURES"):
        view.grab().save(str(Path(folder) / f"drawing_{kind}.png"))
    view.close()
    return found


def opened(count: int) -> Figures:
    """Open a site with a table of so many points in the window, and measure what memory this takes."""
    from PySide6.QtCore import QCoreApplication, QEventLoop

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # Not the windows as their last user left them.
        os.environ.update(dict.fromkeys(("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"), name))
        with (folder / "scan.csv").open("w", encoding="utf-8") as file:
            file.write("x,y,z,horizon\n")
            for part in np.array_split(scan(count, "even"), 20):
                file.writelines(f"{x:.3f},{y:.3f},{z:.3f},T2\n" for x, y, z in part.tolist())
        (folder / "site.toml").write_text('[site]\nname = "scan"\n\n[[picks]]\nfile = "scan.csv"\n', encoding="utf-8")
        from geofit.gui.desktop import Desktop

        desktop = Desktop()
        window = desktop.window
        window.show()

        def wait(seconds: float) -> None:
            end = time.perf_counter() + seconds
            while time.perf_counter() < end or window.activity.busy or window.showing.drawing.busy:
                QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 20)

        wait(1.0)
        found: Figures = {"before": resident()}
        window.files.open(folder / "site.toml")
        wait(2.0)
        wait(2.0)
        known = sum(len(points) for points in desktop.session.document.site.horizons.values())
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        found |= {"after": resident(), "peak": peak, "points": float(known)}
        window.leave_without_asking()
        desktop.session.end()
    return found


ROWS: dict[str, tuple[Callable[..., Figures], tuple[Any, ...]]] = {
    "triangles": (triangles, ("waves", "rough", "outline")),
    "frames": (frames, ("even", "stations")),
    "opened": (opened, (300_000, 1_000_000, 10_000_000)),
}


def apart(task: str, *given: Any) -> Figures:
    """Run one measurement in a process of its own."""
    context = multiprocessing.get_context("spawn")
    queue: Any = context.SimpleQueue()
    child = context.Process(target=_told, args=(queue, task, given))
    child.start()
    child.join()
    if queue.empty():
        sys.exit(f"{task} {given}: the process ended without a result")
    figures: Figures = {**queue.get(), "load": os.getloadavg()[0]}
    print(f"{task} {given}: " + ", ".join(f"{key} {value:.4g}" for key, value in figures.items()), flush=True)
    return figures


def _told(queue: Any, task: str, given: tuple[Any, ...]) -> None:
    queue.put(ROWS[task][0](*given))


def section(found: dict[str, dict[str, Figures]], count: int) -> str:
    """Return the section of the page."""
    lines = [HEAD]

    def say(text: str) -> None:
        lines.extend([*textwrap.wrap(" ".join(text.split()), 118, break_on_hyphens=False), ""])

    say(f"""`python benchmarks/drawing.py` measures this section and writes it; seconds are CPU time summed over all
        threads. VTK renders in software (llvmpipe) on {os.cpu_count()} processors, at 1280 x 800 pixels.""")
    say("""Triangles lie within 1/8000 of a surface's width, more of them where it bends more. When the view comes to
        rest closer, a thread triangulates the visible part again, to within half a pixel of the surface. Neighbouring
        patches share their vertices, so no cracks open (`tests/gui/test_sight.py`). While the view moves, about 1,000
        triangles of each surface are drawn.""")
    lines += [
        f"| ten horizons | triangles | s | tolerance, m | largest error at {HORIZONS * PLACES:,} places, m |",
        "|---|---|---|---|---|",
    ]
    names = {"waves": "smooth, 37 x 37 cells", "rough": "rough, 97 x 97 cells", "outline": "smooth, 60-sided outline"}
    for kind, row in found["triangles"].items():
        lines.append(
            f"| {names[kind]} | {row['count']:,.0f} | {row['cpu']:.2f} | {row['tolerance']:.4f} | {row['error']:.4f} |"
        )
    lines.append("")
    say(f"""A cloud of more than 10,000 points is sorted into blocks of 4,096 neighbours; the first points of
        each block are spread over it. A frame draws points of each visible block in proportion to its pixels: one for
        four pixels while the view moves (at a third of the pixels a side where rendering is slow), three for two at
        rest. All {count:,} points can be picked; only the blocks under the pointer are searched. With ten horizons in
        the scene:""")
    lines += [
        "| cloud, view | points a moving frame | ms of the processor | frames/s | points at rest | s "
        "| picking: median, slowest, ms | first, median, slowest surface, ms | same as a search of all |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for kind, row in found["frames"].items():
        for name, title in (("all", "whole"), ("near", "20 x nearer")):
            r = {key.removeprefix(f"{name} "): value for key, value in row.items() if key.startswith(f"{name} ")}
            lines.append(
                f"| {kind}, {title} | {r['moving']:,.0f} | {r['frame']:.0f} | {r['rate']:.0f} | {r['still']:,.0f} "
                f"| {r['rest']:.2f} | {r['pick']:.1f}, {r['slowest pick']:.1f} "
                f"| {r['first surface']:.1f}, {r['surface']:.1f}, {r['slowest surface']:.1f} "
                f"| {r['same']:.0f} of {CHECKED} |"
            )
    lines.append("")
    row = found["frames"]["even"]
    slowest = max(max(r["all frame"], r["near frame"]) for r in found["frames"].values())
    load = max(r["load"] for r in found["frames"].values())
    loaded = f" on a machine under other load ({load:.0f})" if load > 1.5 * (os.cpu_count() or 1) else ""
    say(f"""Frames/s were measured in this run{loaded}. A frame takes at most {slowest:.0f} ms of CPU time: at least
        {1e3 / slowest:.0f} frames/s where one processor is free.""")
    say(f"""To show {count:,} points takes {row["shown"]:.1f} s. Their coordinates are {row["input"]:.0f} MB; the scene
        adds {row["after"] - row["before"]:.0f} MB when they are shown, and {row["drawn"] - row["before"]:.0f} MB with
        ten horizons and the still picture.""")
    sizes = sorted(found["opened"], key=int)
    low, high = (found["opened"][name] for name in (sizes[0], sizes[-1]))
    each = (high["after"] - low["after"]) / (high["points"] - low["points"]) * 1024**2
    say(f"""A site with a table of {high["points"]:,.0f} points takes {high["after"] - high["before"]:.0f} MB in the
        window (peak {high["peak"] - high["before"]:.0f} MB above that of the empty window): {each:.0f} bytes for each
        point above {low["points"]:,.0f}, with everything that the panels know of it; 5 of them are the blocks'.""")
    return "\n".join(lines)


def with_section(page: str, text: str) -> str:
    """Return a page with another section on drawing at its end."""
    return "\n\n".join(part.rstrip() for part in (page.split(HEAD)[0], text) if part) + "\n"


def drawing_section(page: str) -> str:
    """Return the section on drawing of a page, or nothing."""
    return HEAD + page.split(HEAD)[1] if HEAD in page else ""


def main() -> None:
    """Measure, keep, write."""
    given = sys.argv[1] if len(sys.argv) > 1 else "1e7"
    if given != "page":
        if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            sys.path.append(str(ROOT / "tools"))
            import virtual_screen

            virtual_screen.start("1600x1000")
        found: dict[str, Any] = json.loads(KEPT.read_text(encoding="utf-8")) if given in ROWS else {}
        count = found["count"] = found["count"] if given in ROWS else int(float(given))
        for task, (_, kinds) in ROWS.items():
            if given in ROWS and given != task:
                continue
            more = (count,) if task == "frames" else ()
            found[task] = {str(kind): apart(task, kind, *more) for kind in kinds}
        KEPT.parent.mkdir(exist_ok=True)
        KEPT.write_text(json.dumps(found), encoding="utf-8")
    known = json.loads(KEPT.read_text(encoding="utf-8"))
    text = section(known, known["count"])
    PAGE.write_text(with_section(PAGE.read_text(encoding="utf-8"), text), encoding="utf-8")


if __name__ == "__main__":
    main()
