"""Fit one horizon from arrays.

Points are an (n, 3) array of easting, northing and elevation in metres. The fit interpolates the dense core of the
points, approximates the rest within a tolerance, and measures itself: it passes when sigma is below epsilon.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
rng = np.random.default_rng(1)

# A gentle fold, drilled densely in the middle and sparsely around it.
x = np.concatenate([rng.uniform(350, 650, 120), rng.uniform(0, 1000, 80)])
y = np.concatenate([rng.uniform(300, 600, 120), rng.uniform(0, 800, 80)])
z = 250 + 20 * np.sin(x / 160) + 0.03 * y + rng.normal(0, 0.05, len(x))

points = geofit.PointSet(np.column_stack([x, y, z]), accuracy=0.05)
fit = geofit.fit_horizon(points, geofit.FitSettings(epsilon=0.5), name="marl")
print(fit)

grid_x, grid_y = np.meshgrid(np.linspace(0, 1000, 201), np.linspace(0, 800, 161))
figure, axes = plt.subplots(figsize=(8, 5), layout="constrained")
filled = axes.contourf(grid_x, grid_y, fit.elevation(grid_x, grid_y), levels=24, cmap="terrain")
axes.plot(x, y, ".", color="black", markersize=3)
axes.set(
    title=f"sigma {fit.accuracy.sigma:.3f} m, {fit.accuracy.verdict}", aspect="equal", xlabel="x, m", ylabel="y, m"
)
figure.colorbar(filled, label="elevation, m")
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "fit_one_horizon.png", dpi=120)
