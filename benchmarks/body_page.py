"""Planted bodies, measured, as docs/bodies.md: NURBS solids, spread of volumes, left-out sections, speed."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import numpy as np

from geofit.bodies.body import BodyFit
from geofit.bodies.data import BodyData
from geofit.bodies.fit import fit_body, fit_field
from geofit.bodies.quads import patched_surface
from geofit.bodies.settings import BodySettings
from geofit.io.boreholes import read_boreholes

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "bodies.md"
SAMPLE = ROOT / "sample_data" / "bodies"
CONTACTS = 10_000


class Score(Protocol):
    """Lines of tables: kinds of bodies, classes of chance."""

    kinds: list[str]
    classes: list[str]


def write_figures(calibrated: Score, others: Score, unseen: Score) -> None:
    """Measure the rest and write the page."""
    lines = [
        "# Planted bodies, measured",
        "",
        "Made by `python benchmarks/bodies.py --planted N`. Truths are known; all settings are the defaults.",
        "",
        "## NURBS solids",
        "",
        "Written as STEP, read back by OpenCASCADE. Volume: against the body, by curved triangles. Asked: at "
        "most 500 faces, seams within 1 degree, deviation within half of epsilon (0.5 m).",
        "",
        "| body | faces | control points a side | deviation m | seam degrees | valid | edge tolerance m | sigma m "
        "| volume | file KiB | CPU s |",
        "|---|---:|---|---:|---:|---|---:|---:|---:|---:|---:|",
        *solids(),
        "",
        "## Spread of volumes",
        "",
        "P10-P90: share of bodies whose true volume lies between them; asked: 74-86 %. Places are drawn in the box; "
        "those of a class of chance should lie inside as often as the chance says; asked: within 5 points. The factors "
        "of the chance were chosen looking at the first two families; so were the reach and the spread of the volumes. "
        "The third family has other bodies, holes and noise, and nothing was chosen on it. Drawing other bodies moves "
        "a class by 1 to 2 points (standard error of a bootstrap over bodies).",
    ]
    families = (
        ("Ten kinds", calibrated),
        ("Five other kinds, fewer holes, more noise", others),
        ("All fifteen kinds, never looked at", unseen),
    )
    for title, score in families:
        lines += ["", f"### {title}", "", "| kind | bodies | volume: median error | mean | worst | P10-P90 holds |"]
        lines += ["|---|---:|---:|---:|---:|---:|", *score.kinds, ""]
        lines += ["| chance | places | mean | truly inside |", "|---|---:|---:|---:|", *score.classes]
    lines += [
        "",
        "## Left-out sections",
        "",
        "Intersection over union of a left-out section's outline with the body of the others, with the mean of the two "
        "neighbours' distances in the plane (shape-based interpolation), and with ITK's morphological contour "
        "interpolation. Asked: .93, .97, .99 with 5, 9, 17 planes.",
        "",
        "| body | planes | body | mean of distances | ITK |",
        "|---|---:|---:|---:|---:|",
        *sections(),
        "",
        "## Speed",
        "",
        "CPU times of one run on one machine; memory beyond that of the process before.",
        "",
        "| task | here | scipy | ratio |",
        "|---|---:|---:|---:|",
        *speed(),
    ]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def bodies() -> dict[str, Callable[[], BodyFit]]:
    from bodies.planted import drilled, pair, torus
    from bodies.shapes import KINDS, horn

    def sample(code: str) -> BodyFit:
        tables = [SAMPLE / f"{table}.csv" for table in ("collar", "survey", "lithology")]
        return fit_body(read_boreholes(*tables[:2], tables[2:], dip="down-positive"), codes=code, name=code)

    fork = KINDS["fork"](np.random.default_rng(3))
    return {
        "ORE": lambda: sample("ORE"),
        "VOID": lambda: sample("VOID"),
        "GABBRO": lambda: sample("GABBRO"),
        "torus": lambda: fit_body(drilled(torus(0.55, 0.22)[0], 1, rows=9)),
        "two bodies": lambda: fit_body(drilled(pair()[0], 1, rows=9)),
        "horn": lambda: fit_body(drilled(horn(), 1, rows=11)),
        "fork": lambda: fit_body(drilled(fork, 1, rows=11)),
    }


def solids() -> list[str]:
    rows = []
    for name, make in bodies().items():
        body = make()
        start = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "body.step"
            found = body.write_step(path)
            size = path.stat().st_size // 1024
        seconds = time.process_time() - start
        patched = patched_surface(body)
        sides = sorted({len(patch.control) for patch in patched.patches})
        valid = "yes" if found.brep_valid and found.passed else "no"
        rows.append(
            f"| {name} | {found.faces} | {sides[0]}-{sides[-1]} | {found.deviation:.3f} | {patched.seam_angle:.2f} | "
            f"{valid} | {found.edge_tolerance:.0e} | {found.sigma:.4f} | "
            f"{found.volume / body.size.volume - 1:+.0e} | {size} | {seconds:.1f} |"
        )
        print(rows[-1], flush=True)
    return rows


def sections() -> list[str]:
    from bodies.sectioned import BODIES, left_out
    from peers.contours import morphological

    rows = []
    for name in BODIES:
        for count in (5, 9, 17):
            (ours, linear), other = left_out(name, count), morphological(name, count)
            peer = "not installed" if other is None else f"{other:.3f}"
            rows.append(f"| {name} | {count} | {ours:.3f} | {linear:.3f} | {peer} |")
            print(rows[-1], flush=True)
    return rows


def speed() -> list[str]:
    def measured(task: str) -> tuple[float, float]:
        command = [sys.executable, __file__, task]
        text = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT / "benchmarks").stdout
        seconds, memory = text.split()
        return float(seconds), float(memory)

    (ours, own), (theirs, other), (intervals, held) = map(measured, ("contacts", "scipy", "intervals"))
    return [
        f"| fit to 1e4 contacts, s | {ours:.1f} | {theirs:.1f} | {ours / theirs:.3f} |",
        f"| its memory, MiB | {own:.0f} | {other:.0f} | {own / other:.3f} |",
        f"| fit to 1e5 samples of intervals, s | {intervals:.1f} | - | - |",
        f"| its memory, MiB | {held:.0f} | - | - |",
    ]


def one(task: str) -> None:
    """Print the CPU seconds and the MiB of one task, in a process of its own."""
    from bodies.planted import ORIGIN, drilled, ellipsoid
    from bodies.test_contacts import bumpy
    from scipy.interpolate import RBFInterpolator

    def memory() -> float:
        # Not getrusage: its peak is inherited from the process that started this one.
        status = Path("/proc/self/status").read_text("ascii")
        return int(status.split("VmHWM:")[1].split()[0]) / 1024

    for count in (500, 800):
        fit_field(BodyData(bumpy(count)[0], inside=[ORIGIN]), BodySettings())
    contacts = bumpy(CONTACTS)[0]
    data = drilled(ellipsoid((0.6, 0.4, 0.3))[0], 1, rows=32, step=2 / 98) if task == "intervals" else None
    before, start = memory(), time.process_time()
    if task == "scipy":
        places = np.vstack([(contacts - ORIGIN) / 500, [[0, 0, 0]]])
        RBFInterpolator(places, np.append(np.zeros(CONTACTS), -1.0), kernel="cubic")
    else:
        fit_field(BodyData(contacts, inside=[ORIGIN]) if data is None else data, BodySettings())
    print(time.process_time() - start, memory() - before)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "tests"))
    one(sys.argv[1])
