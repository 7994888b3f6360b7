"""Fit bodies to the logs of Copper Creek and write docs/real_bodies.md; with ``--planted N``, score planted bodies.

The data are looked for in GEOFIT_DATA, else in ../shared/data next to the repository.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np

from geofit.bodies.fit import fit_body
from geofit.io.boreholes import read_boreholes

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "real_bodies.md"
CODES = 4
#: Classes of the probability of lying inside.
LIMITS = (0.01, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 0.99)


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
    reasons: list[str] = []
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
        reasons += [f"- {code}: {check.text}" for check in step.checks if check.name == "grade"]
    if reasons:
        lines += ["", "Why triangles, where NURBS patches were asked for:", "", *reasons]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def planted(count: int, first: int = 0) -> None:
    """Print how well volumes, their P10 to P90 and the probability of planted bodies of ten kinds hold."""
    sys.path.insert(0, str(ROOT / "tests"))
    from bodies.planted import ORIGIN, SIZE
    from bodies.shapes import KINDS, case

    from geofit.bodies.posterior import Posterior

    held: dict[str, list[bool]] = {kind: [] for kind in KINDS}
    errors: dict[str, list[float]] = {kind: [] for kind in KINDS}
    chance, truth, wrong = [], [], 0
    for seed in range(first, first + count):
        one = case(seed)
        if len(one.data.contacts) < 6:
            print(f"{seed} ({one.kind}): {len(one.data.contacts)} contacts only, not fitted")
            continue
        body, volume = fit_body(one.data), one.volume()
        volumes = body.volumes()
        held[one.kind].append(volumes.p10 < volume < volumes.p90)
        errors[one.kind].append(volumes.best / volume - 1)
        assert body.accuracy is not None
        wrong += body.accuracy.wrong_side
        places = np.random.default_rng(seed).uniform(-0.9, 0.9, (3000, 3))
        chance.append(Posterior(body).probability(places * SIZE + ORIGIN))
        truth.append(one.truth(places) < 0)
    for kind, found in errors.items():
        if found:
            middle, worst = np.median(np.abs(found)), np.abs(found).max()
            print(
                f"{kind:<20}{len(found):>4}: volume median {middle:.1%}, mean {np.mean(found):+.1%}, "
                f"worst {worst:.1%}; P10-P90 holds {np.mean(held[kind]):.0%}"
            )
    every, hold = np.concatenate(list(errors.values())), np.concatenate(list(held.values()))
    print(f"all {len(every)}: median {np.median(np.abs(every)):.1%}, mean {every.mean():+.1%}, holds {hold.mean():.1%}")
    print(f"samples on the wrong side: {wrong}")
    p, inside = np.concatenate(chance), np.concatenate(truth)
    for low, high in pairwise(LIMITS):
        own = (p > low) & (p <= high)
        print(f"P {low:.2f}-{high:.2f}: {own.sum():>6} places, mean {p[own].mean():.3f}, true {inside[own].mean():.3f}")


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
