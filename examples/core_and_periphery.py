"""Choose the core.

The surface meets the points of the core exactly and approximates those of the periphery. By default the core is found
from the density of the points; ``core`` takes a polygon, "all" or "none" instead.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
site = geofit.io.read_site(Path(__file__).parents[1] / "sample_data" / "site.toml")
points = site.horizons["T2-T1"]

figure, row = plt.subplots(1, 3, figsize=(12, 4.6), sharey=True, layout="constrained")
for axes, core in zip(row, ("auto", "all", "none"), strict=True):
    fit = geofit.fit_horizon(points, geofit.FitSettings(core=core), site.boundary, name="T2-T1")
    x, y, _ = (points.xyz - fit.origin).T
    axes.plot(x[~fit.core], y[~fit.core], ".", color="#d5701a", markersize=3, label="periphery")
    axes.plot(x[fit.core], y[fit.core], ".", color="#0b5c8a", markersize=3, label="core")
    for patch in fit.patches:
        u0, u1, v0, v1 = patch.domain
        u, v = np.array([u0, u1, u1, u0, u0]), np.array([v0, v0, v1, v1, v0])
        along = np.linspace(0, 4, 81)
        edge = patch.evaluate(np.interp(along, range(5), u), np.interp(along, range(5), v))
        axes.plot(edge[:, 0], edge[:, 1], color="black", linewidth=0.8)
    axes.set(title=f'core="{core}"\nsigma {fit.accuracy.sigma:.4f} m', aspect="equal", xlabel="x - origin, m")
row[0].legend(loc="lower left")
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "core_and_periphery.png", dpi=120)
