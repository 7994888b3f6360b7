"""Map the deviation of every point.

``fit.accuracy`` has the signed orthogonal distance of each point, positive above the surface, and the checks that
look at what sigma cannot show.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
site = geofit.io.read_site(Path(__file__).parents[1] / "sample_data" / "site.toml")
fit = geofit.fit_horizon(site.horizons["T3-T2"], site.settings["T3-T2"], site.boundary, name="T3-T2")

for check in fit.accuracy.checks:
    print(check)
for index in fit.accuracy.worst[:3]:
    print(f"{fit.accuracy.residuals[index]:+.3f} m", fit.points.describe(index))

x, y, _ = (fit.points.xyz - fit.origin).T
figure, axes = plt.subplots(figsize=(8, 6.5), layout="constrained")
axes.fill(*(site.boundary - fit.origin[:2]).T, facecolor="none", edgecolor="black")
dots = axes.scatter(
    x, y, c=fit.accuracy.residuals, s=18, cmap="RdBu_r", edgecolors="grey", linewidths=0.3, vmin=-0.1, vmax=0.1
)
axes.set(
    title=f"{fit.name}: sigma {fit.accuracy.sigma:.3f} m",
    aspect="equal",
    xlabel="x - origin, m",
    ylabel="y - origin, m",
)
figure.colorbar(dots, label="deviation, m (positive: point above the surface)")
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "deviation_map.png", dpi=120)
