"""Cut a dam foundation out of the rock with cadquery.

``fit.to_cadquery()`` is a cadquery shell of exact NURBS faces: here it splits a block of ground into rock and cover,
and the excavation for a gravity dam is cut from the rock.
"""

import sys
from pathlib import Path

import cadquery as cq
import numpy as np
import pyvista as pv

import geofit

out = Path(sys.argv[1] if len(sys.argv) > 1 else "examples_out")
out.mkdir(parents=True, exist_ok=True)
x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(-20, 320, 18), np.linspace(-20, 220, 13)))
z = 60 + 0.0016 * (x - 150) ** 2 + 3 * np.sin(y / 40)  # top of sound rock across a valley
fit = geofit.fit_horizon(geofit.PointSet(np.column_stack([x, y, z])), name="sound rock")
geofit.write_surface(fit, out / "sound_rock.step")

ground = cq.Workplane("XY").box(300, 200, 120, centered=False)
parts = ground.val().split(fit.to_cadquery())
rock = min(parts.Solids(), key=lambda solid: solid.Center().z)

# The dam's base is 60 m wide, 4 m below the lowest rock of the valley floor; the side slopes are 1 to 1.
floor = float(np.nanmin(fit.elevation(x, y))) - 4.0
rise = 120 - floor
trench = (
    cq.Workplane("YZ").polyline([(70, floor), (130, floor), (130 + rise, 120), (70 - rise, 120)]).close().extrude(200)
)
foundation = rock.cut(trench.translate((50, 0, 0)).val())
excavated = rock.Volume() - foundation.Volume()
print(fit, f"rock {rock.Volume():.0f} m3, excavation {excavated:.0f} m3", sep="\n")
cq.exporters.export(cq.Workplane(obj=foundation), str(out / "dam_foundation.step"))

vertices, triangles = foundation.tessellate(0.2)
mesh = pv.PolyData.from_regular_faces(np.array([v.toTuple() for v in vertices]), np.array(triangles))
plotter = pv.Plotter(off_screen=True, window_size=(1400, 900))
plotter.add_mesh(mesh.compute_normals(split_vertices=True), color="#c9b28a", smooth_shading=True)
plotter.camera_position = [(-220, -330, 420), (150, 100, 40), (0, 0, 1)]
plotter.screenshot(out / "dam_foundation.png")
