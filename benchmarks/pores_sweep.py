"""How the two parameters of the pore network change it, on two rocks: a section and a picture of docs/pores.md.

Run ``python benchmarks/pores_sweep.py [--page]``. Each parameter is swept while the other keeps its default.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pores_rocks import ROOT, folder, volume_of

from geofit.pores import network_permeability, pore_network
from geofit.pores.extraction import DEFAULT_R_MIN, DEFAULT_TAU

ROCKS = {"berea_200": "Berea 200³", "ketton_256": "Ketton 256³"}
TAU = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.01)
R_MIN = (0.0, 1.0, 1.25, 1.75, 2.0, 2.5, 3.0, 4.0)
TITLE = "## How tau and the smallest pore change the network"
_TEXT = """
Written by `python benchmarks/pores_sweep.py --page`. Two pores part where the passage between them is narrower than tau
times the radius of the smaller one; a ball of a radius below `r_min` voxels is not a pore of its own. Each was swept
while the other kept its default (tau {tau:g}, r_min {r_min:g}). K is the network's permeability along the three axes.

![Pores, throats, coordination and permeability against tau and r_min](images/pores_sweep.png)

"""


@dataclass(frozen=True)
class Swept:
    """Figures of the network for one choice of the parameters; radii in voxels, permeability in millidarcy."""

    tau: float
    r_min: float
    pores: int
    throats: int
    coordination: float
    radii: tuple[float, float]
    millidarcy: tuple[float, ...]

    @property
    def k(self) -> float:
        """Geometric mean of the permeability along the axes."""
        return float(np.exp(np.log(np.maximum(self.millidarcy, 1e-12)).mean()))


def sweep(name: str) -> list[Swept]:
    """Return the networks of a rock: tau swept first, then r_min."""
    volume = volume_of(name)
    rows = []
    for tau, r_min in [*((tau, DEFAULT_R_MIN) for tau in TAU), *((DEFAULT_TAU, r_min) for r_min in R_MIN)]:
        began = time.process_time()
        network = pore_network(volume, tau=tau, r_min=r_min)
        flow = network_permeability(network)
        radii = float(network.pores.inscribed.mean()), float(network.throats.inscribed.mean())
        counts = len(network.pores), len(network.throats)
        rows.append(Swept(tau, r_min, *counts, float(network.coordination.mean()), radii, tuple(flow.millidarcy)))
        print(name, rows[-1], f"{time.process_time() - began:.1f} s", flush=True)
    return rows


def section(swept: Mapping[str, Sequence[Swept]]) -> str:
    """Return the section of the page."""
    header = ("rock", "tau", "r_min", "pores", "throats", "coordination", "mean radii, voxels", "K, mD")
    lines = [header, ("---",) * len(header)]
    for name, rows in swept.items():
        for row in rows:
            k = " / ".join(f"{value:.0f}" for value in row.millidarcy)
            radii = f"{row.radii[0]:.2f}, {row.radii[1]:.2f}"
            counts = f"{row.pores:,}", f"{row.throats:,}", f"{row.coordination:.2f}"
            lines.append((ROCKS[name], f"{row.tau:g}", f"{row.r_min:g}", *counts, radii, k))
    table = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return TITLE + "\n" + _TEXT.format(tau=DEFAULT_TAU, r_min=DEFAULT_R_MIN) + table + "\n\n" + finding(swept) + "\n"


def finding(swept: Mapping[str, Sequence[Swept]]) -> str:
    """Return what the table shows, in words with its figures."""
    parts = []
    for name, rows in swept.items():
        by_tau, by_r = rows[: len(TAU)], rows[len(TAU) :]
        near = [row for row in by_tau if 0.8 <= row.tau <= 0.95]
        small = [row for row in by_r if row.r_min <= 2.0]
        parts.append(
            f"{ROCKS[name]}: tau from 0.8 to 0.95 changes the pores by {_span([r.pores for r in near])}, the "
            f"coordination by {_span([r.coordination for r in near])} and K by {_span([r.k for r in near])}; r_min "
            f"from 0 to 2 by {_span([r.pores for r in small])}, {_span([r.coordination for r in small])} and "
            f"{_span([r.k for r in small])}; over the whole sweeps K changes by {_span([r.k for r in by_tau])} and "
            f"{_span([r.k for r in by_r])}."
        )
    text = " ".join(parts) + " Compare counts of pores and throats only between networks of the same parameters."
    lines, line = [], ""
    for word in text.split():
        if len(line) + len(word) > 118:
            lines.append(line)
            line = ""
        line = f"{line} {word}".strip()
    return "\n".join([*lines, line])


def _span(values: Sequence[float]) -> str:
    return f"{100 * (max(values) / min(values) - 1):.0f} %"


def picture(swept: Mapping[str, Sequence[Swept]], path: Path) -> None:
    """Draw each figure relative to its value at the defaults."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    kinds = (
        ("pores", "#0b5c8a", "o", "-", lambda row: row.pores),
        ("throats", "#d9a441", "s", "-", lambda row: row.throats),
        ("coordination", "#1b6e3c", "^", "--", lambda row: row.coordination),
        ("permeability (mean of the axes)", "#a3271c", "D", "-", lambda row: row.k),
    )
    figure, all_axes = plt.subplots(2, len(swept), figsize=(3.9 * len(swept), 5.6), sharey="row", squeeze=False)
    for column, (name, rows) in enumerate(swept.items()):
        for line, (part, what, default) in enumerate(
            ((rows[: len(TAU)], "tau", DEFAULT_TAU), (rows[len(TAU) :], "r_min", DEFAULT_R_MIN))
        ):
            axes = all_axes[line][column]
            at = np.array([getattr(row, what) for row in part])
            for label, colour, marker, style, value in kinds:
                values = np.array([value(row) for row in part], float)
                relative = values / values[np.argmin(np.abs(at - default))]
                axes.plot(at, relative, style, marker=marker, ms=4, lw=1.3, color=colour, label=label)
            axes.axvline(default, color="#8795a3", lw=0.8, ls=":")
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
            axes.yaxis.set_minor_formatter(mpl.ticker.NullFormatter())
            axes.set_yticks([0.1, 0.2, 0.5, 1, 2, 5])
            axes.set_xlabel("tau" if what == "tau" else "r_min, voxels")
            axes.grid(axis="y", color="#d4dae1", lw=0.5)
            axes.spines[["top", "right"]].set_visible(False)
        all_axes[0][column].set_title(ROCKS[name], loc="left", fontsize=10)
    for line in all_axes:
        values = np.concatenate(
            [graph.get_ydata() for axes in line for graph in axes.lines if len(graph.get_ydata()) > 2]
        )
        line[0].set_ylim(0.85 * min(values.min(), 0.8), 1.15 * max(values.max(), 1.25))
        line[0].set_ylabel("times its value at the default")
    handles, labels = all_axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=4, frameon=False, fontsize=8.5)
    figure.tight_layout(rect=(0, 0.045, 1, 1))
    figure.savefig(path, dpi=140, metadata={"Software": ""})
    plt.close(figure)


def kept(page: Path) -> str:
    """Return the section as the page has it, for those who write the page anew; empty if it has none."""
    found = re.search(rf"{re.escape(TITLE)}\n.*?(?=\n## |\Z)", page.read_text(encoding="utf-8"), re.DOTALL)
    return found[0].rstrip() + "\n" if found else ""


def put(text: str, page: Path) -> None:
    """Replace the section of the page, or add it at the end."""
    whole, old = page.read_text(encoding="utf-8"), kept(page)
    changed = whole.replace(old.rstrip(), text.rstrip()) if old else whole.rstrip() + "\n\n\n" + text.rstrip() + "\n"
    page.write_text(changed, encoding="utf-8")


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--page", action="store_true")
    given = options.parse_args()
    if not folder().is_dir():
        print(f"rock volumes are not at {folder()}; set GEOFIT_DATA", file=sys.stderr)
        return 2
    swept = {name: sweep(name) for name in ROCKS}
    if given.page:
        put(section(swept), ROOT / "docs" / "pores.md")
        picture(swept, ROOT / "docs" / "images" / "pores_sweep.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
