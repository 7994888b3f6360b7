"""Fit metaballs to an ore lens.

Points on the surface are enough: ellipsoidal balls are split, after Muraki, until they follow them.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

import geofit

implicit = geofit.implicit
out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
out.mkdir(parents=True, exist_ok=True)

# The truth: two flat lenses that have grown together, 120 m long, sampled with an error of 0.2 m.
tilt = np.array([[0.94, 0, 0.342], [0, 1, 0], [-0.342, 0, 0.94]])
lens = implicit.smooth_union(
    implicit.ellipsoid([0, 0, 0], [45, 28, 7], np.linalg.qr(tilt)[0]),
    implicit.ellipsoid([50, 18, -10], [32, 22, 6]),
    4.0,
)
lower, upper = lens.bounds
surface = implicit.isosurface(lens, implicit.Lattice.around(lower, upper, cells=120))
points, normals = implicit.even_samples(lens, surface, 500)
points = points + np.random.default_rng(1).normal(0, 0.2, (500, 1)) * normals

fit = implicit.fit_metaballs(points, normals, epsilon=0.3, most=24, ellipsoidal=True)
mesh = implicit.isosurface(fit.body, implicit.Lattice.around(lower, upper, cells=120))
found = implicit.signed_distance(fit.body, points, mesh)
print(f"{len(fit.body.densities)} balls, sigma {np.sqrt((found**2).sum() / (len(found) - 1)):.2f} m")
print(f"volume {mesh.volume:,.0f} m3, true {surface.volume:,.0f} m3, {mesh.components} component")

plotter = pv.Plotter(off_screen=True, window_size=(1100, 700))
body = pv.PolyData(mesh.vertices, np.insert(mesh.triangles, 0, 3, axis=1).ravel())
plotter.add_mesh(body, color="#8e6bb0", opacity=0.85, smooth_shading=True)
plotter.add_points(points, color="#222222", point_size=6, render_points_as_spheres=True)
plotter.camera_position = [(40, -190, 90), (20, 5, -5), (0, 0, 1)]
plotter.screenshot(out / "implicit_ore_lens.png")
