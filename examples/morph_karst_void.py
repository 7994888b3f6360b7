"""A karst void at two surveys, and what lies between them.

The void was scanned twice, a year apart: its roof came down, a passage broke through, and debris covers the floor. The
front that starts from the first survey gives a closed body at any date; the film is a GIF next to the picture.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import geofit

implicit = geofit.implicit
out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
out.mkdir(parents=True, exist_ok=True)

# Two planted surveys in map coordinates: chambers and passages, blended where they meet.
place = np.array([612_340.0, 3_341_820.0, 512.0])
hall, side = implicit.ellipsoid([0, 0, 0], [11, 7, 5]), implicit.ellipsoid([19, 4, -2], [5, 4, 3])
higher = implicit.smooth_union(hall, implicit.ellipsoid([-3, 0, 4], [5, 4.5, 4]), 2.0)
passage = implicit.RoundCones([[8, 1, -1], [18, 4, -2]], [1.6, 1.9])
debris = implicit.Plane([0, 0, -3.2], [0, 0, -1])
before = implicit.moved(implicit.union(hall, side), shift=place)
grown = implicit.smooth_union(implicit.smooth_union(higher, side, 1.5), passage, 1.5)
after = implicit.moved(implicit.intersection(grown, debris), shift=place)

m = geofit.morph(before, after, dates=["2023-06-01", "2024-06-01"], sd=[0.05, 0.05], cells=96)
(change,) = m.changes
print(f"gain {change.gain:,.0f} m3, loss {change.loss:,.0f} m3, net {change.net:+,.0f} m3 +- {change.net_sd:,.0f} m3")
for event in m.events:
    print(event.date, "closed surfaces", event.components[0], "->", event.components[1])
geofit.write_film(m.frames(13), out / "morph_karst_void.gif")

figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), subplot_kw={"projection": "3d"}, layout="constrained")
for axis, when in zip(axes, ("2023-06-01", "2023-12-01", "2024-06-01"), strict=True):
    mesh = m.surface(when)
    x, y, z = (mesh.vertices - place).T
    axis.plot_trisurf(x, y, mesh.triangles, z, color="#8fa7b3", linewidth=0)
    axis.set_title(f"{when}, {'survey' if m(when).given else 'interpolated'}: {mesh.volume:,.0f} m$^3$")
    axis.set_box_aspect((np.ptp(x), np.ptp(y), np.ptp(z)), zoom=1.5)
    axis.view_init(22, -60)
    axis.set_axis_off()
figure.savefig(out / "morph_karst_void.png", dpi=110)
