"""The three largest costs of four works, and what limits each; writes docs/profile.md.

Run ``make profile``. Each work runs in a process of its own under cProfile, on processor time. The time of libraries
and built-in functions is passed up to the functions of geofit that call them, in the shares of their callers, so that
each cost has a name in this code; the library function that takes most of it shows what limits it.
"""

from __future__ import annotations

import cProfile
import json
import os
import pstats
import resource
import subprocess
import sys
import tempfile
import textwrap
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tests"))

Function = tuple[str, int, str]
IMPORTS: Function = ("", 0, "imports")
#: Names in compiled functions that calculate rather than move memory.
ARITHMETIC = (
    "splu",
    "superlu",
    "gstrf",
    "potr",
    "pbtr",
    "gbtr",
    "trtr",
    "solve",
    "dot",
    "matmul",
    "einsum",
    "svd",
    "qr",
    "eigh",
    "cholesky",
    "design_matrix",
    "evaluate",
    "compress",
    "deflate",
    "render",
    "sha256",
)
WAITING = ("poll", "select", "acquire", "wait", "sleep", "recv", "fsync")
#: Seconds of a call from which on it works on whole arrays, and passes up the tree of callers.
WHOLE, PASSES = 2e-4, 40


def fit_small() -> Callable[[], object]:
    from truth import paper_arrangement

    from geofit import FitSettings, fit_horizon

    truth = paper_arrangement(0)
    fit_horizon(truth.points, FitSettings(), truth.boundary)
    return lambda: fit_horizon(truth.points, FitSettings(), truth.boundary)


def fit_large() -> Callable[[], object]:
    import numpy as np
    from scale import made

    from geofit import FitSettings, PointSet, fit_horizon

    points = PointSet(np.concatenate(list(made(1_000_000))))
    return lambda: fit_horizon(points, FitSettings(core="none"))


def report() -> Callable[[], object]:
    from typer.testing import CliRunner

    from geofit.cli.main import app

    def work() -> None:
        with tempfile.TemporaryDirectory() as folder:
            arguments = ["report", str(ROOT / "sample_data" / "site.toml"), "--lang", "en", "--out", folder]
            done = CliRunner().invoke(app, arguments)
            if done.exception and not isinstance(done.exception, SystemExit):
                raise done.exception

    return work


def window() -> Callable[[], object]:
    def work() -> None:
        from geofit.gui.splash import application

        qt = application()
        from geofit.gui.desktop import Desktop

        desktop = Desktop()
        desktop.window.show()
        for _ in range(5):
            qt.processEvents()

    return work


WORKS = {
    "fit_small": ("A fit of 597 points", fit_small),
    "fit_large": ("A fit of 1,000,000 points", fit_large),
    "report": ("`geofit report` of the sample site", report),
    "window": ("The window until it is drawn", window),
}


def measured(name: str) -> dict[str, Any]:
    """Return the processor seconds of a work, and its largest costs."""
    work = WORKS[name][1]()
    children = sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    profile = cProfile.Profile(time.process_time)
    profile.enable()
    work()
    profile.disable()
    stats = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    total = sum(row[2] for row in stats.values())
    costs = by_owner(stats)
    largest = sorted(costs, key=lambda own: -sum(costs[own].values()))[:3]
    return {
        "total": total,
        "children": sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2]) - children,
        "costs": [_described(own, costs[own], stats) for own in largest],
    }


def by_owner(stats: dict[Function, Any]) -> dict[Function, dict[Function, float]]:
    """Return the seconds of each function of geofit by the functions in which they are spent."""
    costs: dict[Function, dict[Function, float]] = defaultdict(lambda: defaultdict(float))
    for leaf, row in stats.items():
        carried = {leaf: row[2]}
        for _ in range(PASSES):
            above: dict[Function, float] = defaultdict(float)
            for function, seconds in carried.items():
                callers = stats[function][4] if function in stats else {}
                weights = {caller: edge[3] + 1e-9 for caller, edge in callers.items() if caller != function}
                if _loads(function):
                    costs[IMPORTS][leaf] += seconds
                elif _own(function) or not weights:
                    costs[function][leaf] += seconds
                else:
                    for caller, weight in weights.items():
                        above[caller] += seconds * weight / sum(weights.values())
            carried = {function: seconds for function, seconds in above.items() if seconds > 1e-7}
    return costs


def _own(function: Function) -> bool:
    return any(function[0].startswith(str(ROOT / folder)) for folder in ("geofit", "io", "gui"))


def _loads(function: Function) -> bool:
    return "importlib" in function[0] or function[2] == "<module>" or "_imp." in function[2]


def _described(own: Function, leaves: dict[Function, float], stats: dict[Function, Any]) -> dict[str, Any]:
    leaf = max(leaves, key=lambda one: leaves[one])
    calls, seconds = stats[leaf][1], stats[leaf][2]
    each = seconds / max(calls, 1)
    name = leaf[2].casefold()
    if own == IMPORTS:
        limit = "reading, unmarshalling and linking modules: it grows with what is imported, not with the data"
    elif any(word in name for word in WAITING):
        limit = "waiting for another process, the screen or the disk"
    elif each < WHOLE:
        limit = f"the interpreter: {calls:,} calls of {1e6 * each:.1f} µs"
    elif any(word in name for word in ARITHMETIC):
        limit = f"arithmetic of one thread: {calls:,} calls of {1e3 * each:.2g} ms"
    else:
        limit = f"memory traffic of whole arrays: {calls:,} calls of {1e3 * each:.2g} ms"
    return {
        "name": _named(own),
        "seconds": sum(leaves.values()),
        "most": _named(leaf),
        "part": leaves[leaf],
        "limit": limit,
    }


def _named(function: Function) -> str:
    file, _, name = function
    if function == IMPORTS:
        return "imports"
    if file in ("~", ""):
        return name.strip("<>{}").replace("built-in method ", "").replace("method ", "")
    path = Path(file)
    inside = path.relative_to(ROOT) if path.is_relative_to(ROOT) and ".venv" not in path.parts else Path(path.name)
    return f"{inside}: {name}"


def page(found: dict[str, dict[str, Any]]) -> str:
    lines = ["# Profile", ""]
    text = """`make profile` measures this page and writes it: the three largest costs of four works, in seconds of the
        processor under cProfile, which makes calls of small functions look dearer than they are. A cost is that of a
        function of geofit with all the library functions that it calls; "mostly" is the one of these that takes most
        of it, and what limits that one is read from its name, its calls and the time of each."""
    lines += [*textwrap.wrap(" ".join(text.split()), 118), ""]
    for name, figures in found.items():
        total = figures["total"]
        lines += [
            f"## {WORKS[name][0]}",
            "",
            f"{total:.2f} s in its own process"
            + (f", {figures['children']:.2f} s in others" if figures["children"] > 0.05 else "")
            + ".",
            "",
            "| cost | s | share | mostly | limited by |",
            "|---|---|---|---|---|",
        ]
        for cost in figures["costs"]:
            share = cost["part"] / cost["seconds"]
            if share < 0.3 and cost["name"] != "imports":
                cost["limit"] = f"many functions, none of which takes more than {share:.0%}"
            lines.append(
                f"| `{cost['name']}` | {cost['seconds']:.2f} | {cost['seconds'] / total:.0%} "
                f"| `{cost['most']}` {cost['part'] / cost['seconds']:.0%} | {cost['limit']} |"
            )
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def main() -> None:
    if len(sys.argv) > 1:
        print(json.dumps(measured(sys.argv[1])))
        # The window's threads need not be waited for.
        sys.stdout.flush()
        os._exit(0)
    found = {}
    for name in WORKS:
        command = [sys.executable, __file__, name]
        if name == "window" and not os.environ.get("DISPLAY"):
            command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", *command]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"{name}: {done.stderr[-2000:]}")
        found[name] = json.loads(done.stdout.strip().splitlines()[-1])
        print(name, found[name], flush=True)
    (ROOT / "docs" / "profile.md").write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    main()
