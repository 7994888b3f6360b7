"""Fit a horizon on both sides of a fault.

``fit_blocks`` splits the points by the side of the fault they lie on, fits each block for itself, ends each block at
the fault, and measures throw and heave along it.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
rng = np.random.default_rng(7)

x, y = rng.uniform(0, 1000, 300), rng.uniform(0, 600, 300)
trace = np.array([[450.0, -50.0], [600.0, 650.0]])
east = (x - trace[0, 0]) * 700 > (y - trace[0, 1]) * 150
z = 300 - 0.04 * x + 6 * np.sin(y / 120) - np.where(east, 12 + 0.02 * y, 0.0)  # the throw grows northwards

area = np.array([[0.0, 0], [1000, 0], [1000, 600], [0, 600]])
found = geofit.fit_blocks(geofit.PointSet(np.column_stack([x, y, z])), [trace], boundary=area, name="T2")
(cut,) = found.cuts
print(cut.text)

grid_x, grid_y = np.meshgrid(np.linspace(0, 1000, 301), np.linspace(0, 600, 181))
figure, (plan, along) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained", width_ratios=(3, 2))
for block in found.blocks:
    print(block)
    plan.contour(grid_x, grid_y, block.elevation(grid_x, grid_y), levels=np.arange(230, 320, 4.0), cmap="viridis")
plan.plot(*trace.T, color="#a3271c", linewidth=2)
plan.plot(x, y, ".", color="black", markersize=2)
plan.set(title="contours every 4 m", aspect="equal", xlim=(0, 1000), ylim=(0, 600), xlabel="x, m", ylabel="y, m")
along.plot(cut.trace[:, 1], cut.throw, color="#a3271c", label="measured")
along.plot(cut.trace[:, 1], 12 + 0.02 * cut.trace[:, 1], "--", color="black", label="true")
along.set(title="throw along the fault", xlabel="y, m", ylabel="throw, m")
along.legend()
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "fault.png", dpi=120)
