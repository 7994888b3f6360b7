"""Fit bodies to the logs of Copper Creek and write docs/real_bodies.md; with ``--planted N``, print the coverage.

The data are looked for in GEOFIT_DATA, else in ../shared/data next to the repository.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from geofit.bodies.fit import fit_body
from geofit.io.boreholes import read_boreholes

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "real_bodies.md"
CODES = 4


def write_page(data: Path) -> None:
    """Fit the bodies of the most frequent codes at default settings and write their figures."""
    holes = read_boreholes(data / "collar.csv", data / "survey.csv", [data / "lithology.csv"])
    counts = Counter(holes.logs[0].code.tolist())
    lines = [
        "# Real bodies: Copper Creek",
        "",
        "Made by `python benchmarks/bodies.py`: the bodies of the four most frequent rock codes, at default settings.",
        "Volumes in million m3: fitted body, and P10 and P90 of 100 conditional simulations.",
        "",
        "| code | intervals | contacts | samples | wrong side | missed m | excess m | sigma m | parts | volume | P10 "
        "| P90 | STEP | valid | CPU s |",
        "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|---|---:|",
    ]
    for code, count in counts.most_common(CODES):
        start = time.process_time()
        body = fit_body(holes, codes=code, name=code)
        accuracy = body.accuracy
        assert accuracy is not None
        volumes = body.volumes()
        with tempfile.TemporaryDirectory() as folder:
            step = body.write_step(Path(folder) / "body.step")
        seconds = time.process_time() - start
        samples = len(body.data.inside) + len(body.data.outside)
        cells = [
            code, count, accuracy.n, samples, accuracy.wrong_side, f"{accuracy.missed_length:.1f}",
            f"{accuracy.excess_length:.1f}", f"{accuracy.sigma:.1e}", body.overview.components,
            f"{volumes.best / 1e6:.1f}", f"{volumes.p10 / 1e6:.1f}", f"{volumes.p90 / 1e6:.1f}", step.grade,
            "yes" if step.passed else "no", f"{seconds:.0f}",
        ]  # fmt: skip
        lines.append("| " + " | ".join(map(str, cells)) + " |")
        print(lines[-1], flush=True)
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def planted(count: int) -> None:
    """Print how often P10 to P90 holds the true volume of planted bodies."""
    sys.path.insert(0, str(ROOT / "tests"))
    from bodies.planted import SIZE, drilled, ellipsoid, pair, torus

    held, errors = [], []
    for seed in range(count):
        rng = np.random.default_rng(1000 + seed)
        kind = seed % 3
        if kind == 0:
            a, b, c = rng.uniform(0.25, 0.65, 3).tolist()
            (truth, volume), rows = ellipsoid((a, b, c)), 7
        elif kind == 1:
            (truth, volume), rows = torus(rng.uniform(0.45, 0.6), rng.uniform(0.2, 0.28)), 9
        else:
            (truth, volume), rows = pair(), 9
        body = fit_body(drilled(truth, seed, rows=rows, step=(0.04, 0.02, 0.06)[seed // 3 % 3]))
        volumes = body.volumes()
        held.append(volumes.p10 < volume * SIZE**3 < volumes.p90)
        errors.append(volumes.best / (volume * SIZE**3) - 1)
    middle, worst = np.median(np.abs(errors)), np.abs(errors).max()
    print(f"{count} bodies: P10-P90 holds {np.mean(held):.1%}")
    print(f"error of the volume: median {middle:.1%}, mean {np.mean(errors):+.1%}, worst {worst:.1%}")


def main() -> int:
    if "--planted" in sys.argv:
        planted(int(sys.argv[sys.argv.index("--planted") + 1]))
        return 0
    data = Path(os.environ.get("GEOFIT_DATA", ROOT / ".." / "shared" / "data")) / "copper_creek"
    if not data.is_dir():
        print(f"The real data are not at {data}; set GEOFIT_DATA.", file=sys.stderr)
        return 2
    write_page(data)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
