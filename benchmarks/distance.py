"""Projection in points a second: geofit and OpenCASCADE (initialised once), both against a converged reference.

Run ``python benchmarks/distance.py [POINTS]`` (default 100,000; OpenCASCADE projects every 100th of them). Points a
second are those of one processor.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from geofit.geometry.projection import project
from geofit.geometry.trim_loops import nearest_on_trimmed
from geofit.splines import bspline
from geofit.splines.patch import Patch

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from converged import converged_distances, ring

#: Points that the reference measures: it takes 10 ms for each.
CHECKED = 100


def horizon(rows: int = 100, columns: int = 45) -> Patch:
    """Return a wavy horizon of 1,000 m x 700 m as a bicubic height field."""
    knots_u = bspline.clamped_knots(np.linspace(0, 1000, rows - 2), 3)
    knots_v = bspline.clamped_knots(np.linspace(0, 700, columns - 2), 3)
    x, y = np.meshgrid(bspline.greville(knots_u, 3), bspline.greville(knots_v, 3), indexing="ij")
    noise = np.random.default_rng(0).normal(0, 0.2, x.shape)
    z = 40 * np.sin(x / 130) * np.cos(y / 170) + 0.2 * x + noise
    return Patch("core", (3, 3), knots_u, knots_v, np.stack([x, y, z], axis=-1))


def fold() -> Patch:
    """Return an overturned fold of 500 m: x turns back twice while z rises."""
    knots_u = bspline.clamped_knots(np.linspace(0, 1, 98), 3)
    knots_v = bspline.clamped_knots(np.linspace(0, 500, 43), 3)
    u, y = np.meshgrid(bspline.greville(knots_u, 3), bspline.greville(knots_v, 3), indexing="ij")
    x = 150 * u + 180 * np.sin(2 * np.pi * u) + 0.1 * y
    z = 300 * u + 10 * np.sin(y / 90)
    return Patch("limb", (3, 3), knots_u, knots_v, np.stack([x, y, z], axis=-1))


def occ_distances(patch: Patch, xyz: np.ndarray) -> np.ndarray:
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt

    from geofit.cad.faces import to_geom

    projector = GeomAPI_ProjectPointOnSurf()
    projector.Init(to_geom(patch), *patch.domain)
    distance = np.full(len(xyz), np.nan)
    for i, point in enumerate(xyz):
        projector.Perform(gp_Pnt(*point))
        if projector.NbPoints():
            distance[i] = projector.LowerDistance()
    return distance


def compare(title: str, patch: Patch, spread: float, count: int) -> None:
    rng = np.random.default_rng(1)
    u0, u1, v0, v1 = patch.domain
    u, v = rng.uniform(u0, u1, count), rng.uniform(v0, v1, count)
    xyz = patch.evaluate(u, v) + patch.normal(u, v) * rng.normal(0, spread, count)[:, None]
    project([patch], xyz[:10])
    start = time.process_time()
    ours = np.abs(project([patch], xyz).distance)
    speed = count / (time.process_time() - start)
    some = xyz[::100]
    start = time.process_time()
    theirs = occ_distances(patch, some)
    speed_occ = len(some) / (time.process_time() - start)
    difference = ours[::100] - theirs
    found = np.isfinite(difference)
    print(
        f"{title:28s} {speed:10,.0f}/s  {speed_occ:8,.0f}/s  {speed / speed_occ:6.0f} x   "
        f"{np.nanmax(difference):9.1e}  {np.nanmin(difference):9.1e}  {(~found).sum():4d}"
    )


def against_reference(title: str, patch: Patch, loops: tuple[np.ndarray, ...], spread: float, count: int) -> None:
    rng = np.random.default_rng(2)
    u0, u1, v0, v1 = patch.domain
    u, v = rng.uniform(u0, u1, count), rng.uniform(v0, v1, count)
    xyz = patch.evaluate(u, v) + patch.normal(u, v) * rng.normal(0, spread, count)[:, None]
    trimmed = (loops,) if loops else ()
    nearest_on_trimmed([patch], xyz[:10], trimmed)
    start = time.process_time()
    found = nearest_on_trimmed([patch], xyz, trimmed)
    speed = count / (time.process_time() - start)
    assert found.beyond is not None
    off = np.abs(found.distance[:CHECKED]) - converged_distances(patch, loops, xyz[:CHECKED])
    print(f"{title:28s} {speed:10,.0f}/s {found.beyond.mean():10.0%}     {off.max():9.1e}  {off.min():9.1e}")


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    print(f"{count:,} points          geofit        OpenCASCADE  ratio   farther    nearer (m)  no foot")
    compare("horizon, 0.2 m off", horizon(), 0.2, count)
    compare("horizon, 20 m off", horizon(), 20.0, count)
    compare("overturned fold, 0.2 m off", fold(), 0.2, count)
    compare("overturned fold, 20 m off", fold(), 20.0, count)
    count = min(count, 20_000)
    print(f"\n{count:,} points          geofit    beyond the edge    farther    nearer than the reference (m)")
    for name, patch in (("horizon", horizon()), ("fold", fold())):
        loops = (ring(patch, (0.5, 0.5), 0.4, 400), ring(patch, (0.45, 0.55), 0.1, 90))
        for spread in (0.2, 40.0):
            against_reference(f"{name}, {spread} m off", patch, (), spread, count)
            against_reference(f"trimmed {name}, {spread} m off", patch, loops, spread, count)


if __name__ == "__main__":
    main()
