"""docs/benchmarks.md and its plots, from the figures of benchmarks/bench.py."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path
from statistics import median
from typing import Any

from peers.tools import TOOLS

__all__ = ["page"]

KINDS = {
    "hills": "hills (60 waves on a dipping plane)",
    "folds": "folds (asymmetric, plunging)",
    "rough": "rough ground (random field, Matérn 3/2)",
}
#: What the scripts behind the plain tables compare.
TEXTS = {
    "small": (
        "597 points next to GeomPlate (`fit.py small`)",
        """The paper's arrangement: 440 points on 11 sections, 157 next to them. geofit fits, checks and sews its
        patches to a shell; OpenCASCADE fits a plate and turns it into a B-spline. Wall time, both in turn.""",
    ),
    "truths": (
        "Ten truths (`fit.py truths`)",
        "Error against the truth, divided by that of scipy's exact thin plate through the same 597 points.",
    ),
    "large": (
        "A million points next to sparse P-splines (`fit.py large`)",
        """Wall time. The first reference has a penalty known to be good, and is given, before the clock starts, the
        fewest spans (20, 24, ... 72) with which its error is at most 1.1 times geofit's; if none suffices, those of its
        least error. The second knows no more than geofit does: it has 60 x 60 spans and searches its penalty by
        generalised cross-validation. Linear algebra runs on one thread; geofit's check, which projects every point on
        the surface, on all processors. The references check nothing.""",
    ),
    "scattered": (
        "Ten thousand points next to sparse P-splines (`field.py scattered`)",
        "Errors in metres against the truth at 10,000 places of the whole area.",
    ),
    "storage": (
        "Storage (`fit.py storage`)",
        """Vertices of a TIN and nodes of a square grid that hold geofit's surface of the 597 points, linear between
        them, within a tolerance. The control points hold it exactly.""",
    ),
    "distance": (
        "Distances (`distance.py`)",
        """Orthogonal distances of scattered points to a wavy horizon and to an overturned fold, next to
        `GeomAPI_ProjectPointOnSurf` with one `Init`. "Farther" and "nearer" are the largest differences of |d|, "no
        foot" how many points OpenCASCADE finds none for. Then to whole and trimmed patches, next to a dense search that
        starts Newton's method from 48 places a point and walks 24 pieces of the edge (`tests/converged.py`). Points
        whose nearest place is on the edge take the longest.""",
    ),
}
COLOURS = [
    "#0b6e4f",
    "#0b6e4f",
    "#c0392b",
    "#1f4e79",
    "#7d3c98",
    "#8a8d91",
    "#d35400",
    "#2e86c1",
    "#b7950b",
    "#111111",
    "#d48ca8",
]
STYLE = {
    "font.size": 8,
    "svg.fonttype": "none",
    "svg.hashsalt": "geofit",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "font.family": "sans-serif",
}
Figures = dict[str, Any]


def page(found: Figures, docs: Path) -> None:
    """Write the page and its plots."""
    lines = ["# Benchmarks", ""]

    def say(text: str) -> None:
        lines.extend([*textwrap.wrap(" ".join(text.split()), 118, break_on_hyphens=False), ""])

    n = 1_000
    say(f"""`make bench` measures this page and writes it, every figure of it; nothing here is a test. Unless it says
        otherwise, seconds are those of one processor and one thread, medians of several fits after a first one; memory
        is the peak of the process above its size with the points loaded. Machine: {found["processors"]} processors,
        shared with other work during this run (load {found["load"]:.1f}), so read the ratios.""")
    say("Versions: " + ", ".join(f"{name} {version}" for name, version in found["versions"].items()) + ".")
    say(
        "Scale (1e8 points, many horizons, large tables): [scale.md](scale.md). Pore networks: [pores.md](pores.md). "
        "Real data: [real_data.md](real_data.md)."
    )
    lines += [f"## {n:,} points of three kinds of truth", ""]
    say("""Points are scattered evenly over 2 km x 2 km, with a noise of 0.05 m; geomdl, which fits grids alone, gets as
        many on a grid. The error is the rms difference from the truth at 10,000 places, 100 m or more from the edge,
        the median of three sets. Each program has its usual settings (`benchmarks/peers/tools.py`): none is tuned to
        the truth. "Numbers" are what holds the surface: control points, coefficients, or data points.""")
    lines += ["![Error against time](images/bench_error.svg)", ""]
    for kind, title in KINDS.items():
        rows = {tool: row for tool, row in found["compared"][kind].items() if row}
        own = rows["geofit"]
        lines += [
            f"### {title[0].upper()}{title[1:]}",
            "",
            "| | error, m | / geofit | fit, s | / geofit | 10,000 elevations, s | MB | numbers |",
            "|---|---|---|---|---|---|---|---|",
        ]
        for tool, row in sorted(rows.items(), key=lambda one: median(one[1]["errors"])):
            error = median(row["errors"])
            lines.append(
                f"| {TOOLS[tool].title} | {error:.3f} | {error / median(own['errors']):.2f} | {row['seconds']:.3f} "
                f"| {row['seconds'] / own['seconds']:.2f} | {row['evaluation']:.3f} | {row['memory']:.0f} "
                f"| {row['count']:,} |"
            )
        lines.append("")
        failed = [tool for tool, row in found["compared"][kind].items() if not row]
        say(_winners(rows) + (f" Ended without a result: {_list(failed)}." if failed else ""))
    lines += ["## More points", ""]
    say("""The hills again, from 100 points to 10,000,000. A program stops where its next fit is foreseen to take more
        than 20 s of CPU time; beyond 1,000,000 points geofit is `fit_cloud` alone, which keeps no row
        and no label of a point. verde takes block means from 2,000 points on.""")
    lines += ["![Time and memory against n](images/bench_growth.svg)", ""]
    growth = {tool: {int(n): row for n, row in rows.items()} for tool, rows in found["growth"].items() if rows}
    counts = sorted({n for rows in growth.values() for n in rows})
    lines += ["| fit, s | " + " | ".join(f"{n:,}" for n in counts) + " |", "|---" * (len(counts) + 1) + "|"]
    for tool, rows in growth.items():
        cells = [f"{rows[n]['seconds']:.3g}" if n in rows else "–" for n in counts]
        lines.append(f"| {TOOLS[tool].title} | " + " | ".join(cells) + " |")
    lines += ["", "| error, m | " + " | ".join(f"{n:,}" for n in counts) + " |", "|---" * (len(counts) + 1) + "|"]
    for tool, rows in growth.items():
        cells = [f"{median(rows[n]['errors']):.3f}" if n in rows else "–" for n in counts]
        lines.append(f"| {TOOLS[tool].title} | " + " | ".join(cells) + " |")
    lines.append("")
    for n in counts:
        rows = {tool: by[n] for tool, by in growth.items() if n in by}
        own_tool = "geofit" if "geofit" in rows else "geofit_cloud"
        faster = [t for t, row in rows.items() if row["seconds"] < rows[own_tool]["seconds"] and not _ours(t)]
        nearer = [
            t for t, row in rows.items() if median(row["errors"]) < median(rows[own_tool]["errors"]) and not _ours(t)
        ]
        say(
            f"At {n:,} points {_list(faster)} {_be(faster)} faster than geofit, {_list(nearer)} {_be(nearer)} nearer "
            "to the truth."
        )
    for key, (title, text) in TEXTS.items():
        if key in found["printed"]:
            lines += [f"## {title}", ""]
            say(text)
            lines += ["```", *found["printed"][key].splitlines(), "```", ""]
    (docs / "benchmarks.md").write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    _plots(found["compared"], growth, docs / "images")


def _ours(tool: str) -> bool:
    return tool.startswith("geofit")


def _list(tools: list[str]) -> str:
    names = [TOOLS[tool].title for tool in tools]
    if not names:
        return "no program"
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def _be(tools: list[str]) -> str:
    return "are" if len(tools) > 1 else "is"


def _winners(rows: dict[str, Figures]) -> str:
    own = rows["geofit"]
    nearer = [tool for tool, row in rows.items() if median(row["errors"]) < median(own["errors"])]
    faster = [tool for tool, row in rows.items() if row["seconds"] < own["seconds"]]
    both = [tool for tool in nearer if tool in faster]
    text = f"Nearer to the truth than geofit: {_list(nearer)}. Faster: {_list(faster)}."
    return text + (f" Both: {_list(both)}." if both else "")


def _plots(compared: dict[str, dict[str, Figures]], growth: dict[str, dict[int, Figures]], images: Path) -> None:
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot as plt

    colour = dict(zip(TOOLS, COLOURS, strict=True))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 3, figsize=(10, 3.6), layout="constrained")
        for axis, kind in zip(axes, KINDS, strict=True):
            for tool, row in compared[kind].items():
                if row:
                    axis.scatter(
                        row["seconds"],
                        median(row["errors"]),
                        s=42 if _ours(tool) else 20,
                        color=colour[tool],
                        marker="D" if _ours(tool) else "o",
                        label=TOOLS[tool].title,
                    )
            axis.set(xscale="log", yscale="log", title=kind, xlabel="CPU time of a fit, s")
            _plain(axis)
        axes[0].set_ylabel("rms error against the truth, m")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
        _save(figure, images / "bench_error.svg")
        figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
        for axis, key, label in zip(axes, ("seconds", "memory"), ("CPU time of a fit, s", "memory, MB"), strict=True):
            for tool, rows in growth.items():
                # Less than 1 MB is within what reading the points took for a while.
                n = [k for k in sorted(rows) if key == "seconds" or rows[k][key] >= 1]
                axis.plot(
                    n,
                    [max(rows[k][key], 1e-4) for k in n],
                    color=colour[tool],
                    lw=2.2 if _ours(tool) else 1.1,
                    ls="--" if tool == "geofit_cloud" else "-",
                    marker="D" if _ours(tool) else "o",
                    ms=3,
                    label=TOOLS[tool].title.replace("`", ""),
                )
            axis.set(xscale="log", yscale="log", xlabel="points", ylabel=label)
            _plain(axis)
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=6, frameon=False)
        _save(figure, images / "bench_growth.svg")


def _plain(axis: Any) -> None:
    """Write the ticks of both logarithmic axes as text: viewers of SVG place the parts of a formula each in its way."""
    from matplotlib.ticker import NullFormatter

    for side in (axis.xaxis, axis.yaxis):
        side.set_major_formatter(lambda value, _: f"{value:g}" if value < 1e4 else f"10{_raised(value)}")
        side.set_minor_formatter(NullFormatter())
    axis.grid(alpha=0.25, which="major")


def _raised(value: float) -> str:
    return str(round(math.log10(value))).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _save(figure: Any, path: Path) -> None:
    figure.savefig(path, metadata={"Date": None, "Creator": None})
    text = path.read_text(encoding="utf-8")
    path.write_text("\n".join(line.rstrip() for line in text.splitlines()) + "\n", encoding="utf-8")
