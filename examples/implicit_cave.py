"""Model a cave from its survey line.

A convolution surface is smooth at every joint of the passages; a union of round cones has creases there. Both are
implicit fields, negative inside, and become closed meshes.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

import geofit

implicit = geofit.implicit
out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
out.mkdir(parents=True, exist_ok=True)

# Stations (x, y, z) of a main passage and two branches, and the width of the passage at each leg.
main = np.array([[0, 0, 0], [14, 4, -2], [26, 14, -5], [42, 16, -6], [58, 8, -11], [76, 12, -18], [95, 10, -20.0]])
north = np.array([[26, 14, -5], [30, 28, -3], [26, 44, -6], [34, 60, -12.0]])
south = np.array([[58, 8, -11], [62, -8, -14], [58, -24, -22.0]])
legs = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in (main, north, south)])
radii = np.array([2.4, 2.8, 3.6, 3.0, 2.6, 3.2, 1.8, 2.0, 2.2, 2.0, 1.6])
cave = implicit.Convolution(legs, radii)
cones = implicit.union(*(implicit.RoundCones(leg, r) for leg, r in zip(legs, radii, strict=True)))

lattice = implicit.Lattice.around(*cave.bounds, cells=200)
mesh, sharp = (implicit.isosurface(field, lattice) for field in (cave, cones))
print(f"cave {mesh.volume:,.0f} m3, {mesh.components} component, Euler number {mesh.euler}, closed {mesh.is_closed}")
print(f"union of cones {sharp.volume:,.0f} m3")

plotter = pv.Plotter(off_screen=True, window_size=(1200, 700), shape=(1, 2))
for column, (title, part) in enumerate((("convolution", mesh), ("union of round cones", sharp))):
    plotter.subplot(0, column)
    plotter.add_text(title, font_size=12, color="black")
    body = pv.PolyData(part.vertices, np.insert(part.triangles, 0, 3, axis=1).ravel())
    plotter.add_mesh(body, color="#7fa3b5", specular=0.3)
    for line in (main, north, south):
        plotter.add_mesh(pv.lines_from_points(line), color="#b03a2e", line_width=3)
    plotter.camera_position = [(40, -110, 150), (47, 16, -8), (0, 0, 1)]
plotter.screenshot(out / "implicit_cave.png")
