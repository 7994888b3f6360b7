"""Two interpretations of an ore lens from five sections, and the bodies between them.

One geologist outlines a single lens, the other a lens that thins to a neck and thickens again. Each set of outlines
becomes a fitted body; the family between them shows where the interpretations differ, and what that means in volume.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
out.mkdir(parents=True, exist_ok=True)
place, angle = np.array([431_200.0, 5_212_600.0, 840.0]), np.linspace(0, 2 * np.pi, 24, endpoint=False)


def body(name, widths, heights):
    """Fit a body to one ellipse on each section, 40 m apart, with samples inside and outside of it."""
    rings = {}
    for share in (0.5, 1.0, 1.6):
        x = np.repeat(40.0 * np.arange(5), len(angle))
        y = share * (np.asarray(widths)[:, None] * np.cos(angle)).ravel()
        z = share * (np.asarray(heights)[:, None] * np.sin(angle)).ravel() - 0.1 * x
        rings[share] = place + np.stack([x, y, z], axis=1)
    beyond = place + np.array([[-30.0, 0, 3], [190.0, 0, -19]])
    data = geofit.BodyData(contacts=rings[1.0], inside=rings[0.5], outside=np.vstack([rings[1.6], beyond]))
    return geofit.fit_body(data, name=name)


one = body("one lens", [16, 30, 34, 28, 14], [8, 13, 15, 12, 7])
two = body("with a neck", [20, 31, 9, 27, 18], [9, 14, 5, 13, 8])
m = geofit.morph(one, two, cells=72)
rows = m.table(9)
for row in rows:
    print(f"tau {row.tau:.2f}: {row.volume:,.0f} m3, {row.components} closed surface, Euler number {row.euler}")
geofit.write_film(m.frames(9), out / "morph_section_bodies.gif")

figure, axes = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained", width_ratios=(2, 1))
corner = place + np.array([-30.0, -45, -8]) - m.origin
for tau, colour in zip(np.linspace(0, 1, 5), plt.cm.cividis(np.linspace(0, 0.9, 5)), strict=True):
    lines = geofit.implicit.field_contours(m(tau).field, corner, [1, 0, 0], [0, 1, 0], size=(220, 90), spacing=2.0)
    for k, line in enumerate(lines):
        label = None if k else f"tau {tau:.2f}"
        axes[0].plot(*np.vstack([line.xyz, line.xyz[:1]])[:, :2].T, color=colour, label=label)
axes[0].set(aspect="equal", title="Plan at 832 m", xlabel="east about the origin, m", ylabel="north, m")
axes[0].legend(frameon=False, ncols=5, loc="center", fontsize=8)
axes[1].plot([row.tau for row in rows], [row.volume / 1000 for row in rows], marker="o", color="#5b7f8c")
axes[1].set(title="Volume of the cases", xlabel="tau", ylabel="1000 m$^3$")
figure.savefig(out / "morph_section_bodies.png", dpi=110)
