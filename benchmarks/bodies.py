"""Fit bodies to the logs of Copper Creek and write docs/real_bodies.md.

With ``--planted N``, measure planted bodies, N of each family for the volumes, and write docs/bodies.md.
The data are looked for in GEOFIT_DATA, else in ../shared/data next to the repository.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Score:
    """How well volumes, their P10 to P90 and the chance of lying inside held on planted bodies, as lines of a page."""

    kinds: list[str]
    classes: list[str]


def planted(count: int, others: bool = False) -> Score:
    """Fit planted bodies of ten kinds, or of the five others, and score them."""
    from bodies.planted import ORIGIN, SIZE
    from bodies.shapes import KINDS, OTHERS, case, other_case

    from geofit.bodies.posterior import BodyPosterior

    kinds, make = (OTHERS, other_case) if others else (KINDS, case)
    held: dict[str, list[bool]] = {kind: [] for kind in kinds}
    errors: dict[str, list[float]] = {kind: [] for kind in kinds}
    chance, truth = [], []
    for seed in range(count):
        one = make(seed)
        if len(one.data.contacts) < 6:
            continue
        body, volume = fit_body(one.data), one.volume()
        assert body.accuracy is not None
        assert body.accuracy.wrong_side == 0
        volumes = body.volumes()
        held[one.kind].append(volumes.p10 < volume < volumes.p90)
        errors[one.kind].append(volumes.best / volume - 1)
        places = np.random.default_rng(seed).uniform(-0.9, 0.9, (3000, 3))
        chance.append(BodyPosterior(body).probability(places * SIZE + ORIGIN))
        truth.append(one.truth(places) < 0)
    every = {**errors, "all": [e for found in errors.values() for e in found]}
    inside = {**held, "all": [h for found in held.values() for h in found]}
    rows = [
        f"| {kind} | {len(found)} | {np.median(np.abs(found)):.1%} | {np.mean(found):+.1%} | "
        f"{np.abs(found).max():.1%} | {np.mean(inside[kind]):.1%} |"
        for kind, found in every.items()
        if found
    ]
    p, true = np.concatenate(chance), np.concatenate(truth)
    classes = []
    for low, high in pairwise(LIMITS):
        own = (p > low) & (p <= high)
        classes.append(f"| {low:.2f}-{high:.2f} | {own.sum()} | {p[own].mean():.3f} | {true[own].mean():.3f} |")
    print("\n".join([*rows, *classes]), flush=True)
    return Score(rows, classes)


def main() -> int:
    sys.path.insert(0, str(ROOT / "tests"))
    if "--planted" in sys.argv:
        from body_page import write_figures

        count = int(sys.argv[sys.argv.index("--planted") + 1])
        write_figures(planted(count), planted(count, others=True))
        return 0
    data = Path(os.environ.get("GEOFIT_DATA", ROOT / ".." / "shared" / "data")) / "copper_creek"
    if not data.is_dir():
        print(f"The real data are not at {data}; set GEOFIT_DATA.", file=sys.stderr)
        return 2
    write_page(data)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
