"""How fast the 3D view turns: a cloud of a million points and ten horizons, on whatever draws here.

    xvfb-run -s "-screen 0 1600x1000x24" python benchmarks/view3d.py

Prints frames a second while the eye turns (each frame drawn, composed and shown before the next is asked for),
the processor's seconds a frame, which other work on the machine does not change, and how long the full picture
takes once the eye rests.
"""

from __future__ import annotations

import argparse
import os
import time
from statistics import median

import numpy as np
from PySide6.QtCore import QEventLoop
from PySide6.QtWidgets import QApplication

from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.view3d.view import SceneView
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

ORIGIN = np.array([501_000.0, 3_100_000.0, 1_500.0])
HALF, CONTROL = 1_000.0, 40


def horizon(number: int) -> HorizonFit:
    """One bicubic height field of 40 x 40 control points, 60 m under the one before."""
    knots = np.concatenate([np.zeros(3), np.linspace(0, 1, CONTROL - 2), np.ones(3)])
    at = np.array([knots[i + 1 : i + 4].mean() for i in range(CONTROL)])
    x, y = np.meshgrid(HALF * (2 * at - 1), HALF * (2 * at - 1), indexing="ij")
    z = 40 * np.sin(x / 240 + number) * np.cos(y / 300) - 60 * number
    patch = Patch("core", (3, 3), knots, knots, np.stack([x, y, z], axis=-1))
    return HorizonFit(PatchSurface((patch,), ORIGIN), name=f"H{number}")


def cloud(count: int) -> PointSet:
    rng = np.random.default_rng(1)
    xy = rng.uniform(-HALF, HALF, (count, 2))
    z = 40 * np.sin(xy[:, 0] / 240) * np.cos(xy[:, 1] / 300) + rng.normal(0, 0.5, count)
    return PointSet(np.column_stack([xy, z]) + ORIGIN, kind="section")


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--points", type=int, default=1_000_000)
    options.add_argument("--horizons", type=int, default=10)
    options.add_argument("--opacity", type=float, default=1.0)
    options.add_argument("--tries", type=int, default=5, help="seconds of turning, each measured by itself")
    options.add_argument("--picture", help="PNG of the scene at rest")
    given = options.parse_args()
    app = QApplication([])
    view = SceneView()
    view.resize(1280, 800)
    view.show()
    view.show_site(Site("benchmark", {"cloud": cloud(given.points)}))
    for k in range(given.horizons):
        view.show_surface(horizon(k))
        view.layers.change(f"surface:H{k}", opacity=given.opacity)
    app.processEvents()
    canvas = view.canvas
    for _ in range(5):
        turn(app, view)
    tries = [window(app, view) for _ in range(given.tries)]
    best = max(rate for rate, _ in tries)
    cpu = 1e3 * median(cost for _, cost in tries)
    began = time.perf_counter()
    canvas.rest()
    app.processEvents()
    canvas.finish()
    full = time.perf_counter() - began
    print(canvas.ren_win.ReportCapabilities().splitlines()[1])
    print(f"{given.points} points, {given.horizons} horizons, opacity {given.opacity:g}, 1280 x 800")
    rates = ", ".join(f"{rate:.1f}" for rate, _ in tries)
    print(f"turning: best {best:.1f} frames/s of {given.tries} tries ({rates}); processor {cpu:.0f} ms a frame")
    print(f"drawn with 1/{canvas.shrink} of the pixels a side")
    print(f"full picture at rest: {full:.2f} s; load of the machine {os.getloadavg()[0]:.1f}")
    if given.picture:
        view.grab().save(given.picture)
    view.close()


def window(app: QApplication, view: SceneView) -> tuple[float, float]:
    """Turn for a second; return frames a second and the processor's seconds a frame."""
    frames, cpu, wall = view.canvas.frames, time.process_time(), time.perf_counter()
    while time.perf_counter() - wall < 1.0:
        turn(app, view)
    frames = view.canvas.frames - frames
    return frames / (time.perf_counter() - wall), (time.process_time() - cpu) / frames


def turn(app: QApplication, view: SceneView) -> None:
    """Turn by two degrees and wait for the frame."""
    canvas = view.canvas
    canvas.look(canvas.eye.turned(2.0, 0.0), moving=True)
    before = canvas.frames
    while canvas.frames == before:
        app.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 50)


if __name__ == "__main__":
    main()
