"""Read a site and fit all its horizons.

A site file names the tables of boreholes, adits, sections and outcrops. Every row is used or listed with its reason.
``fit_site`` fits the horizons one after another, faulted ones block by block.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
site = geofit.io.read_site(Path(__file__).parents[1] / "sample_data" / "site.toml")
print(site)
fits = geofit.fit_site(site)

origin = np.append(site.boundary.mean(axis=0), 1400.0)  # VTK draws in single precision: keep coordinates small
plotter = pv.Plotter(off_screen=True, window_size=(1400, 900))
colours = ("#5a91cf", "#b08a20", "#27784f", "#cf8275", "#9a4aa0")
for (name, fit), colour in zip(fits.surfaces.items(), colours, strict=True):
    print(fit)
    mesh, opacity = fit.triangulate(tolerance=1.0), 1.0 if name in ("F1", "M1") else 0.5
    drawn = pv.PolyData.from_regular_faces(mesh.xyz - origin, mesh.triangles)
    plotter.add_mesh(drawn, color=colour, opacity=opacity, label=name, smooth_shading=True)
for hole in site.holes:
    plotter.add_mesh(pv.lines_from_points(hole.xyz - origin).tube(radius=4), color="black")
plotter.add_legend(bcolor=None, face="rectangle", loc="lower right", size=(0.12, 0.2))
plotter.set_scale(zscale=2)
plotter.camera_position = [(-1600, -2500, 1900), (0, 0, 0), (0, 0, 1)]
out.mkdir(parents=True, exist_ok=True)
plotter.screenshot(out / "site_from_files.png")
