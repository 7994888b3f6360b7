"""Model a cavern with two adits and an access ramp by constructive solid geometry.

The field gives volume, sections, and the depths at which a planned hole enters and leaves.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

import geofit

implicit = geofit.implicit
out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
out.mkdir(parents=True, exist_ok=True)

# A vaulted hall: a lying cylinder above the springing line, a box below it.
floor, springing, half_width, half_length = 0.0, 12.0, 11.0, 45.0
walls = implicit.intersection(
    *(implicit.Plane([0, s * half_length, 0], [0, s, 0]) for s in (-1, 1)),
    *(implicit.Plane([s * half_width, 0, 0], [s, 0, 0]) for s in (-1, 1)),
    implicit.Plane([0, 0, floor], [0, 0, -1]),
)
vault = implicit.Cylinder([0, 0, springing], [0, 1, 0], half_width)
below = implicit.Plane([0, 0, springing], [0, 0, 1])
hall = implicit.intersection(walls, implicit.union(vault, below))
adits = [implicit.RoundCones([[-75, y, 4], [-8, y, 4]], 3.0) for y in (-25.0, 25.0)]
ramp = implicit.CurveTube(np.array([[0, 40, 5], [15, 60, 7], [45, 65, 11], [60, 40, 16], [55, 10, 21.0]]), 3.5)
cavern = implicit.union(implicit.smooth_union(hall, ramp, 3.0), *adits)

lower, upper = cavern.bounds
lattice = implicit.Lattice.around(np.maximum(lower, [-72, -60, -5]), np.minimum(upper, [70, 72, 30]), cells=240)
mesh = implicit.isosurface(cavern, lattice, capped=True)
(hole,) = implicit.hole_crossings(cavern, [[-15, -20, 60]], [[0.25, 0.1, -1]], length=90.0)
print(f"{mesh.volume:,.0f} m3, closed {mesh.is_closed}, Euler number {mesh.euler}")
print("hole:", ", ".join(f"{'in' if c.entering else 'out'} at {c.depth:.2f} m" for c in hole))

plotter = pv.Plotter(off_screen=True, window_size=(1100, 700))
faces = np.insert(mesh.triangles, 0, 3, axis=1)
plotter.add_mesh(pv.PolyData(mesh.vertices, faces.ravel()), color="#c9b79c", specular=0.2)
for line in implicit.field_contours(cavern, [-72, -60, 4], [1, 0, 0], [0, 1, 0], size=(140, 130), spacing=1.0):
    plotter.add_mesh(pv.lines_from_points(line.xyz, close=line.closed), color="#b03a2e", line_width=4)
along = np.array([0.25, 0.1, -1]) / np.linalg.norm([0.25, 0.1, -1])
plotter.add_mesh(pv.Line([-15, -20, 60], np.array([-15, -20, 60]) + 90 * along), color="black", line_width=5)
plotter.camera_position = [(-120, -140, 105), (0, 0, 8), (0, 0, 1)]
plotter.screenshot(out / "implicit_cavern.png")
