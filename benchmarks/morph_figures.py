"""The figures of docs/morph.md: fronts whose course is known, and the picture of the three modes.

``python benchmarks/morph_figures.py`` prints the table and writes ``docs/images/morph_modes.png``.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

import matplotlib.pyplot as plt

import geofit
import geofit.implicit as implicit

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
BALL, RING = implicit.Sphere([0, 0, 0], 0.5), implicit.Torus([0, 0, 0], [0, 0, 1], 0.55, 0.22)
CELLS = 64
TITLES = {"arrival": "arrival field", "pde": "level-set equation", "blend": "linear blend"}
MODES = {"arrival": "#2f6f8f", "pde": "#b4895a", "blend": "#8a8a8a"}


def concentric() -> None:
    for cells in (24, 48, 96):
        m = geofit.morph(
            implicit.Sphere([0, 0, 0], 0.3), implicit.Sphere([0, 0, 0], 0.7), spacing=2.0 / cells, pace="time"
        )
        off = [np.linalg.norm(m(s).mesh.vertices, axis=1) - 0.3 - 0.4 * s for s in (0.25, 0.5, 0.75)]
        mean, worst = max(abs(o.mean()) for o in off), max(np.abs(o).max() for o in off)
        print(
            f"| concentric spheres, arrival, h = 1/{cells // 2} | {mean * cells / 2:.4f} h, {worst * cells / 2:.4f} h |"
        )


def modes() -> None:
    figure, axes = plt.subplots(1, 4, figsize=(14, 3.6), layout="constrained")
    for axis, (mode, colour) in zip(axes[:3], MODES.items(), strict=True):
        m = geofit.morph(BALL, RING, mode=mode, cells=CELLS, pace="time", eps=0.0)
        rows = m.table(17)
        dip = min(row.volume for row in rows) / rows[-1].volume - 1
        drift = max(row.drift for row in rows) / rows[-1].volume
        print(f"| ball to ring, {mode} | opens at {m.events[0].tau:.4f}, dip {dip:.1%}, drift {drift:.1g} |")
        for tau, shade in zip((0.0, 0.3, 0.6, 0.8, 1.0), np.linspace(0.35, 1.0, 5), strict=True):
            field = m(tau).field
            for line in implicit.field_contours(
                field, [-0.85, 0, -0.6], [1, 0, 0], [0, 0, 1], size=(1.7, 1.2), spacing=0.02
            ):
                x, z = np.vstack([line.xyz, line.xyz[:1]])[:, [0, 2]].T
                axis.plot(x, z, color=colour, alpha=float(shade), linewidth=1.4)
        axis.set(
            aspect="equal", title={"pde": "level-set equation", "blend": "linear blend"}.get(mode, "arrival field")
        )
        axis.set_axis_off()
        axes[3].plot([row.tau for row in rows], [row.volume for row in rows], color=colour, label=mode)
    axes[3].set(title="Volume", xlabel="tau = 1 - exp(-t)")
    axes[3].legend(frameon=False)
    figure.savefig(IMAGES / "morph_modes.png", dpi=110)


if __name__ == "__main__":
    concentric()
    modes()
