"""Predict the error away from the data.

``examine`` leaves out each hole, section and block in turn and compares the prediction with the data. From these
errors it calibrates the standard deviation of the surface, and suggests the next boreholes. ``band`` returns the two
surfaces between which the rock lies with a given probability.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
site = geofit.io.read_site(Path(__file__).parents[1] / "sample_data" / "site.toml")
fit = geofit.fit_horizon(site.horizons["T2-T1"], site.settings["T2-T1"], site.boundary, name="T2-T1")
found = geofit.examine(fit)
for folds in found.left_out:
    print(folds)
upper, lower = geofit.band(fit, found, share=0.9)

sd, (x0, y0) = found.uncertainty, fit.origin[:2]
figure, (plan, side) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
filled = plan.pcolormesh(sd.x - x0, sd.y - y0, sd.sd, cmap="magma_r")
plan.plot(*(fit.points.xyz[:, :2] - fit.origin[:2]).T, ".", color="black", markersize=2)
for number, hole in enumerate(found.suggestions[:5], 1):
    plan.text(
        hole.x - x0, hole.y - y0, str(number), ha="center", va="center", bbox={"boxstyle": "circle", "fc": "white"}
    )
plan.set(title="suggested boreholes 1 to 5", aspect="equal", xlabel="x - origin, m", ylabel="y - origin, m")
figure.colorbar(filled, label="standard deviation, m")

x = np.linspace(sd.x[0], sd.x[-1], 300)
y = np.full_like(x, y0 + 200)
middle = fit.elevation(x, y)
side.fill_between(x - x0, lower.elevation(x, y) - middle, upper.elevation(x, y) - middle, alpha=0.4, label="90 % band")
side.set(title="band along y = 200 m", xlabel="x - origin, m", ylabel="above the surface, m")
side.legend()
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "cross_validation_and_band.png", dpi=120)
