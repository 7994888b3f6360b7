"""Metamorphosis: the arrival field against the level-set equation, and the frames a second of a slider.

Run ``python benchmarks/morph.py [frames] [slider] [cells]`` (default: both, 128 cells). CPU times of one run, ratios of
what ran one after the other: the seconds are those of one machine. ``frames`` is the whole job of both modes:
distances, the way, and the triangles of 50 frames. ``benchmarks/peers/openvdb_morph.cpp`` is the same job by OpenVDB.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from statistics import median

import numpy as np

import geofit
import geofit.implicit as implicit

FRAMES = 50
SLIDES = 40
BALL, RING = implicit.Sphere([0, 0, 0], 0.5), implicit.Torus([0, 0, 0], [0, 0, 1], 0.55, 0.22)


def cpu(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def job(mode: str, cells: int) -> None:
    m = geofit.morph(BALL, RING, mode=mode, cells=cells, pace="time", eps=0.0)
    for tau in np.linspace(0, 1, FRAMES):
        m.surface(float(tau))


def frames(cells: int) -> None:
    for mode in ("arrival", "pde"):
        job(mode, 24)
    arrival, equation = (cpu(lambda mode=mode: job(mode, cells)) for mode in ("arrival", "pde"))
    share = arrival / equation
    print(f"{FRAMES} frames at {cells}: arrival {arrival:.1f} s / level set {equation:.1f} s = {share:.3f}")


def slider(cells: int) -> None:
    m = geofit.morph(BALL, RING, cells=cells, pace="time")
    m.surface(0.5)
    took = [cpu(lambda tau=tau: m.surface(tau)) for tau in np.random.default_rng(0).uniform(0, 1, SLIDES).tolist()]
    print(f"slider at {cells}: {1 / median(took):.0f} frames/s (median), {1 / max(took):.0f} at worst")


def main() -> None:
    words = sys.argv[1:]
    cells = next((int(word) for word in words if word.isdigit()), 128)
    chosen = [word for word in words if not word.isdigit()] or ["frames", "slider"]
    for word in chosen:
        {"frames": frames, "slider": slider}[word](cells)


if __name__ == "__main__":
    main()
