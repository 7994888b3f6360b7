"""Sparse contacts of rough ground: how many are met, and what meeting them costs between them.

Run ``python benchmarks/sparse.py [LOW HIGH] [--page]`` (default: seeds 0 to 40); ``--page`` writes docs/sparse.md.
Truths are Gaussian fields of a Matérn 3/2 covariance, with relief below the spacing of the contacts: either it is part
of the truth that is asked for, or each contact has its own.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.distance import cdist

from geofit import FitSettings, PointSet, fit_horizon
from geofit.data.files import replacing

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from realdata.score import thin_plate
from truth import EASTING, NORTHING, rms

PAGE = Path(__file__).resolve().parents[1] / "docs" / "sparse.md"
PROCESSES = 2
SIDE, PLACES = 2000.0, 1200
ARRANGEMENTS = ("scattered", "clusters", "grid", "profiles")
COUNTS, RELIEF, RANGES = (25, 40, 60, 100, 160, 250, 400), (5.0, 20.0, 60.0), (150.0, 400.0, 900.0)
#: Relief below the spacing (1 sigma, m), and its range (m); 0: that of each contact is its own.
BELOW, SHORT = (0.0, 0.3, 1.0, 3.0), (0.0, 20.0, 60.0)

_HEAD = """# Sparse contacts of rough ground

Written by `python benchmarks/sparse.py {low} {high} --page`; do not edit. Each site has 25 to 400 contacts in an area
of 2 km: scattered, in clusters, on a grid whose nodes are moved at random, or on profiles. The truths are Gaussian
fields of Matérn 3/2 (relief 5, 20 or 60 m, range 150, 400 or 900 m), with relief of 0, 0.3, 1 or 3 m below the spacing
of the contacts. Settings are the defaults: an interior tolerance of 0.1 m.

"Not met" counts the contacts farther than that from the surface, "noise" those of them that the fit explains by noise
of that size, "let go" those that contradict a neighbour, and "core" the rest on sites with an automatic core, whose cap
of 15 control points a contact does not yield to them; the fit states how many it would take. The error is the
geometric mean, over the sites, of the root mean square error at up to 1,200 other places of the surface, divided by
that of scipy's exact thin-plate spline of the same contacts.

| | sites | contacts | not met | noise | let go | core | passed | control points each: median | worst | error |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


@dataclass(frozen=True)
class Row:
    """What came of one site; ``error`` is relative to the thin plate's."""

    arrangement: str
    below: float
    n: int
    missed: int
    noise: int
    torn: int
    cored: int
    passed: bool
    a_point: float
    error: float


def places_of(rng: np.random.Generator, arrangement: str, n: int) -> np.ndarray:
    """Return the plan of about n contacts."""
    if arrangement == "scattered":
        return rng.uniform(0, SIDE, (n, 2))
    if arrangement == "clusters":
        middle = rng.uniform(0, SIDE, (max(n // 12, 2), 2))
        plan = middle[rng.integers(0, len(middle), n)] + rng.normal(0, 90, (n, 2))
        plan[: n // 3] = rng.uniform(0, SIDE, (n // 3, 2))
        return np.clip(plan, 0, SIDE)
    if arrangement == "grid":
        step = SIDE / int(np.ceil(np.sqrt(n)))
        nodes = np.stack(np.meshgrid(*[np.arange(0, SIDE - step / 2, step)] * 2), axis=-1).reshape(-1, 2)[:n]
        return nodes + rng.uniform(0, 0.6 * step, nodes.shape)
    lines = max(n // 12, 2)
    east = np.repeat(np.linspace(100, SIDE - 100, lines), -(-n // lines))[:n]
    return np.column_stack([east + rng.normal(0, 8, n), rng.uniform(0, SIDE, n)])


def site(seed: int) -> tuple[str, float, np.ndarray, np.ndarray]:
    """Return the arrangement, the relief below the spacing, the contacts and points of the truth between them."""
    rng = np.random.default_rng([seed, 17])
    arrangement, n = str(rng.choice(ARRANGEMENTS)), int(rng.choice(COUNTS))
    contacts = places_of(rng, arrangement, n)
    n, plan = len(contacts), np.vstack([contacts, rng.uniform(0.05 * SIDE, 0.95 * SIDE, (PLACES, 2))])
    below, reach, relief, short = (float(rng.choice(given)) for given in (BELOW, RANGES, RELIEF, SHORT))
    apart = cdist(plan, plan)
    covariance = relief**2 * (1 + apart / reach) * np.exp(-apart / reach) + 1e-6 * np.eye(len(plan))
    if short:
        covariance += below**2 * np.exp(-apart / short)
    z = np.linalg.cholesky(covariance) @ rng.normal(size=len(plan))
    if not short:
        z[:n] += below * rng.normal(size=n)
    xyz = np.column_stack([plan + np.array([EASTING, NORTHING]), z])
    return arrangement, below, xyz[:n], xyz[n:]


def row_of(seed: int) -> Row:
    """Fit a site."""
    arrangement, below, contacts, truth = site(seed)
    surface = fit_horizon(PointSet(contacts), FitSettings())
    missed = int((np.abs(surface.distance(contacts)) > surface.settings.interior_tolerance).sum())
    noise = any(note.code == "fitting.points-beyond-tolerance-as-noise" for note in surface.accuracy.notes)
    torn = int(surface.model.net.torn.sum())
    found = surface.elevation(*truth[:, :2].T)
    truth, found = truth[np.isfinite(found)], found[np.isfinite(found)]
    theirs = rms(thin_plate(contacts, truth[:, :2]) - truth[:, 2])
    a_point = surface.control_points / len(contacts)
    rest, cored = missed - torn, bool(surface.core.any()) and not noise
    return Row(
        arrangement, below, len(contacts), missed, rest * noise, torn, rest * cored, surface.accuracy.passed, a_point,
        rms(found - truth[:, 2]) / theirs,
    )  # fmt: skip


def table(rows: list[Row]) -> str:
    """Return the rows of the page: all sites, then each arrangement, then each relief below the spacing."""
    groups = [("all sites", rows)]
    groups += [(name, [row for row in rows if row.arrangement == name]) for name in ARRANGEMENTS]
    groups += [(f"{below:g} m below the spacing", [row for row in rows if row.below == below]) for below in BELOW]
    lines = []
    for name, some in groups:
        if not some:
            continue
        keys = ("n", "missed", "noise", "torn", "cored")
        n, missed, noise, torn, cored = (sum(getattr(row, key) for row in some) for key in keys)
        passed = sum(row.passed for row in some)
        sizes, errors = ([getattr(row, key) for row in some] for key in ("a_point", "error"))
        lines.append(
            f"| {name} | {len(some)} | {n:,} | {missed} | {noise} | {torn} | {cored} | {passed} | "
            f"{np.median(sizes):.1f} | {max(sizes):.1f} | {np.exp(np.log(errors).mean()):.2f} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    words = [word for word in sys.argv[1:] if word != "--page"]
    low, high = (int(word) for word in words) if words else (0, 40)
    # One thread per process: two processes share two cores, and sums are the same on every machine.
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(PROCESSES, mp_context=multiprocessing.get_context("spawn")) as pool:
        rows = list(pool.map(row_of, range(low, high)))
    text = _HEAD.format(low=low, high=high) + table(rows)
    print(text)
    if "--page" in sys.argv:
        with replacing(PAGE) as part:
            part.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
