"""Surfaces of implicit bodies: block by block against everywhere, stored fields against VTK, distances against others.

Run ``python benchmarks/implicit.py [balls] [stored] [distance] [muraki]`` (default: all four). Ratios of CPU times of
one run, medians of turns: the seconds are those of one machine.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from statistics import median

import numpy as np

import geofit.implicit as implicit

TURNS = 3
CELLS = 255


def cpu(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def ratios(title: str, ours: Callable[[], object], other: Callable[[], object], turns: int = TURNS) -> None:
    """Print the medians of both, run one after the other, after one run of ours to compile and warm up."""
    ours()
    pairs = [(cpu(ours), cpu(other)) for _ in range(turns)]
    a, b = (median(column) for column in zip(*pairs, strict=True))
    print(f"{title}: {a:.3f} s / {b:.3f} s = {median(x / y for x, y in pairs):.3f}")


def random_balls(count: int = 500, seed: int = 0) -> implicit.Metaballs:
    """Balls of a branching body: walks of 50 steps through a cube of 1."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(0, 0.035, (count // 50, 50, 3))
    centres = np.clip(0.5 + rng.uniform(-0.3, 0.3, (count // 50, 1, 3)) + steps.cumsum(axis=1), 0.1, 0.9).reshape(-1, 3)
    return implicit.spherical_metaballs(centres, rng.uniform(0.05, 0.09, len(centres)))


def all_balls(body: implicit.Metaballs, lattice: implicit.Lattice) -> np.ndarray:
    """Every ball at every node, by numpy: what a sum without supports costs."""
    x, y, z = lattice.axes
    total = np.zeros(lattice.shape, np.float32)
    for centre, shape in zip(body.centres, body.shapes, strict=True):
        qx, qy, qz = (
            (a - c).astype(np.float32) ** 2 * np.float32(shape[0, 0] ** 2)
            for a, c in zip((x, y, z), centre, strict=True)
        )
        q = qx[:, None, None] + qy[:, None] + qz
        np.subtract(1, q, out=q)
        np.maximum(q, 0, out=q)
        total += q * q * q
    return (body.threshold - total) / np.float32(body.slope_scale)


def flying_edges(values: np.ndarray, lattice: implicit.Lattice) -> int:
    import pyvista as pv

    image = pv.ImageData(dimensions=values.shape[::-1], spacing=(lattice.spacing,) * 3)
    image["phi"] = values.ravel()
    return int(image.contour([0.0], scalars="phi", method="flying_edges", compute_normals=False).n_cells)


def balls() -> None:
    body = random_balls()
    lattice = implicit.Lattice([0.0, 0, 0], 1 / CELLS, (CELLS + 1,) * 3)
    mesh = implicit.isosurface(body, lattice, capped=True)
    print(f"500 balls, 256^3: {len(mesh.triangles):,} triangles, closed {mesh.is_closed}, {mesh.components} components")
    ratios(
        "  blocks / own sums everywhere + flying edges",
        lambda: implicit.isosurface(body, lattice),
        lambda: flying_edges(implicit.sample(body, lattice), lattice),
    )
    ratios(
        "  blocks / all balls everywhere + flying edges",
        lambda: implicit.isosurface(body, lattice),
        lambda: flying_edges(all_balls(body, lattice), lattice),
        turns=1,
    )


def stored() -> None:
    lattice = implicit.Lattice([0.0, 0, 0], 1 / CELLS, (CELLS + 1,) * 3)
    values = implicit.sample(random_balls(), lattice).astype(np.float32)
    ratios(
        "stored 256^3, cleaned / VTK flying edges",
        lambda: implicit.isosurface_of_samples(values, lattice),
        lambda: flying_edges(values, lattice),
    )


def distance() -> None:
    from scipy.ndimage import distance_transform_edt

    lattice = implicit.Lattice.around([-1] * 3, [1] * 3, cells=127)
    ball = implicit.spline_of_field(implicit.Sphere([0, 0, 0], 0.6), lattice)
    truth = implicit.sample(implicit.Sphere([0, 0, 0], 0.6), lattice)
    inside = truth < 0

    def edt() -> np.ndarray:
        return np.where(inside, -distance_transform_edt(inside), distance_transform_edt(~inside)) * lattice.spacing

    band = np.abs(truth) < 5 * lattice.spacing
    ours = implicit.distance_samples(ball, lattice, band=5)
    print(
        "distance in a band of 5 h, 128^3: error"
        f" {np.abs(ours - truth)[band].max() / lattice.spacing:.1e} h,"
        f" of the distance transform {np.abs(edt() - truth)[band].max() / lattice.spacing:.1e} h"
    )
    ratios("  foot points / scipy's distance transform", lambda: implicit.distance_samples(ball, lattice, band=5), edt)


def muraki() -> None:
    torus = implicit.Torus([0, 0, 0], [0, 0, 1], 1.0, 0.35)
    mesh = implicit.isosurface(torus, implicit.Lattice.around([-1.4] * 3, [1.4] * 3, cells=48))
    xyz, normals = implicit.even_samples(torus, mesh, 300)
    energies = {}

    def fit(tried: int) -> None:
        energies[tried] = implicit.fit_metaballs(xyz, normals, epsilon=1e-6, most=20, tried=tried).energies

    ratios("Muraki, 20 balls, 8 tried / all tried", lambda: fit(8), lambda: fit(20), turns=1)
    print(f"  energy at 20 balls: {energies[8][19]:.2e}, all tried {energies[20][19]:.2e}")


if __name__ == "__main__":
    parts = {"balls": balls, "stored": stored, "distance": distance, "muraki": muraki}
    for name in sys.argv[1:] or parts:
        parts[name]()
