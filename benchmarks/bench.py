"""geofit and its peers on the same points in the same run; writes docs/benchmarks.md and its plots.

Run ``make bench``, or ``python benchmarks/bench.py --peers PYTHON``, where PYTHON is that of an environment with
benchmarks/peers/requirements.txt. The figures are kept in build/bench.json; ``python benchmarks/bench.py page`` writes
the page again.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from bench_page import page
from peers.tools import TOOLS
from peers.truths import TRUTHS, sample

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "bench.json"
MEASURE = ROOT / "benchmarks" / "peers" / "measure.py"
#: Points at which errors are compared, and sets of each kind of truth.
COMPARED, SEEDS = 1_000, 3
DECADES = [10**k for k in range(2, 8)]
#: Longest fit of a growing n, s of the processor, as it is foreseen from the last one of another program.
LONGEST = 20.0
#: fit_horizon keeps its points with their rows and labels; beyond this fit_cloud is what reads them.
LARGEST = {"geofit": 10**6, "geofit_cloud": 10**7}
SMALLEST = {"geofit_cloud": 10**5}
#: Scripts of their own whose tables the page shows as they print them.
SCRIPTS = {
    "small": ("fit.py", "small"),
    "truths": ("fit.py", "truths"),
    "storage": ("fit.py", "storage"),
    "large": ("fit.py", "large"),
    "scattered": ("field.py", "scattered", "10000"),
    "distance": ("distance.py",),
}
Figures = dict[str, Any]


def run(tool: str, paths: list[Path], peers: str) -> Figures | None:
    """Return what one program measured of itself; None where it ended without a result."""
    python = sys.executable if TOOLS[tool].own else peers
    alone = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    done = subprocess.run([python, MEASURE, tool, *paths], capture_output=True, text=True, env=alone, check=False)
    if done.returncode:
        print(f"{tool}: {done.stderr.strip().splitlines()[-1:]}", flush=True)
        return None
    figures: Figures = json.loads(done.stdout)
    print(f"{tool:18s} {figures['seconds']:9.3f} s {figures['memory']:8.0f} MB  error {figures['errors']}", flush=True)
    return figures


def compared(folder: Path, peers: str) -> dict[str, dict[str, Figures | None]]:
    """Return the figures of each program on each kind of truth."""
    found: dict[str, dict[str, Figures | None]] = {}
    for kind in TRUTHS:
        paths = [folder / f"{kind}{seed}.npz" for seed in range(SEEDS)]
        for seed, path in enumerate(paths):
            np.savez(path, **sample(kind, COMPARED, seed))
        found[kind] = {tool: run(tool, paths, peers) for tool in TOOLS if tool not in SMALLEST}
    return found


def growth(folder: Path, peers: str) -> dict[str, dict[int, Figures]]:
    """Return the figures of each program on ever more points, as long as a fit is foreseen to end in time."""
    found: dict[str, dict[int, Figures]] = {tool: {} for tool in TOOLS}
    left = set(TOOLS)
    for n in DECADES:
        path = folder / "growth.npz"
        np.savez(path, **sample("hills", n, 0))
        for tool in [tool for tool in TOOLS if tool in left and n >= SMALLEST.get(tool, 0)]:
            last = found[tool].get(n // 10)
            foreseen = 0.0 if last is None or tool in LARGEST else last["seconds"] * 10.0 ** TOOLS[tool].power
            figures = None if foreseen > LONGEST or n > LARGEST.get(tool, n) else run(tool, [path], peers)
            if figures is None:
                left.discard(tool)
            else:
                found[tool][n] = figures
    return found


def printed(*command: str) -> str:
    """Return what a script of this folder prints."""
    print(*command, flush=True)
    script = [sys.executable, str(ROOT / "benchmarks" / command[0]), *command[1:]]
    return subprocess.run(script, capture_output=True, text=True, check=True).stdout.strip()


def versions(peers: str) -> dict[str, str]:
    names = ["scipy", "verde", "pykrige", "gstools", "scikit-learn", "geomdl"]
    code = f"import importlib.metadata as m, json; print(json.dumps({{n: m.version(n) for n in {names}}}))"
    found: dict[str, str] = json.loads(subprocess.check_output([peers, "-c", code], text=True))
    return found | {"Python": platform.python_version()}


def main() -> None:
    if sys.argv[1:] == ["page"]:
        found = json.loads(KEPT.read_text(encoding="utf-8"))
    else:
        peers = sys.argv[sys.argv.index("--peers") + 1] if "--peers" in sys.argv else sys.executable
        KEPT.parent.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory() as name:
            found = {
                "versions": versions(peers),
                "load": os.getloadavg()[1],
                "processors": os.cpu_count(),
                "compared": compared(Path(name), peers),
                "growth": growth(Path(name), peers),
            }
        found["printed"] = {}
        for title, command in SCRIPTS.items():
            found["printed"][title] = printed(*command)
            KEPT.write_text(json.dumps(found), encoding="utf-8")
    page(json.loads(json.dumps(found)), ROOT / "docs")


if __name__ == "__main__":
    main()
