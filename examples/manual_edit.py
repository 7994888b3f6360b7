"""Edit a surface by hand.

A fit is never changed: each edit returns a new one with its own check. ``move_to`` lets the surface pass through a
point or a place, ``adjust`` moves one control point. Points of the core stay exact, seams stay closed.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
rng = np.random.default_rng(5)
x, y = rng.uniform(0, 1000, 150), rng.uniform(0, 600, 150)
z = 120 + 10 * np.sin(x / 170) + rng.normal(0, 0.2, 150)
settings = geofit.FitSettings(core="none")
fit = geofit.fit_horizon(geofit.PointSet(np.column_stack([x, y, z]), accuracy=0.2), settings, name="T1")

here = np.array([500.0, 300.0])
place = [*here, float(fit.elevation(*here)) + 4.0]  # a geologist knows that the rock lies 4 m higher here
pulled = geofit.move_to(fit, place)
half = geofit.move_to(fit, place, share=0.5)
for one in (fit, half, pulled):
    print(one, one.accuracy.notes[-1:])

line = np.linspace(0, 1000, 400)
figure, axes = plt.subplots(figsize=(8, 4.2), layout="constrained")
for one, label, style in ((fit, "as fitted", "-"), (half, "pulled by 50 %", "--"), (pulled, "pulled by 100 %", ":")):
    axes.plot(line, one.elevation(line, 300.0), style, label=label)
axes.plot(place[0], place[2], "o", color="black")
axes.set(xlabel="x along y = 300, m", ylabel="elevation, m")
axes.legend()
out.mkdir(parents=True, exist_ok=True)
figure.savefig(out / "manual_edit.png", dpi=120)
