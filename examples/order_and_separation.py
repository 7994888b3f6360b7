"""Find where two horizons cross, and separate them.

Where data are sparse, two horizons fitted one by one may cross. ``compare_horizons`` measures the thickness between
them and the crossings; ``separate_horizons`` moves both by the smallest change, and keeps exact points exact.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
rng = np.random.default_rng(3)


def horizon(name, height, gap):
    """Return a fit of points 60 m apart on average, none nearer to the crest of a dome than ``gap``."""
    x, y = rng.uniform(0, 1000, 160), rng.uniform(0, 600, 160)
    x, y = x[abs(x - 500) > gap], y[abs(x - 500) > gap]
    z = height + 18 * np.exp(-(((x - 500) / 130) ** 2))
    return geofit.fit_horizon(geofit.PointSet(np.column_stack([x, y, z])), geofit.FitSettings(core="none"), name=name)


# Both horizons follow the dome, 8 m apart; the points of the upper one miss it.
fits = {"upper": horizon("upper", 208.0, 260), "lower": horizon("lower", 200.0, 0)}
order = geofit.compare_horizons(fits["upper"], fits["lower"])
print(order.check().text)
separated = geofit.separate_horizons(fits, ["upper", "lower"], minimum=0.5)
print(geofit.compare_horizons(*separated.surfaces.values()).check().text)

x = np.linspace(20, 980, 400)
figure, rows = plt.subplots(2, 1, figsize=(8, 5.5), sharex=True, layout="constrained")
for axes, surfaces, title in ((rows[0], fits, "as fitted"), (rows[1], separated.surfaces, "separated")):
    for (name, fit), colour in zip(surfaces.items(), ("#b08a20", "#5a91cf"), strict=True):
        axes.plot(x, fit.elevation(x, 300.0), color=colour, label=name)
    axes.set(title=title, ylabel="elevation, m")
rows[0].legend()
rows[1].set(xlabel="x along y = 300, m")
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "order_and_separation.png", dpi=120)
