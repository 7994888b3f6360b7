"""Import what a process of a crew needs, before its first work comes and while the fits are still under way.

Garbage is not looked for meanwhile, nor ever among what was imported: that takes a fifth of the time.
"""

from __future__ import annotations

import gc
from contextlib import suppress
from importlib import import_module

__all__ = ["HEAVY"]

HEAVY = (
    "geofit.cad.step", "geofit.cad.read_back", "geofit.cad.sewing", "geofit.prediction.examine",
    "geofit.report.pictures", "geofit.report.section_sheet", "geofit.report.contour_plan",
    "geofit.checks.storage", "geofit.report.schema", "geofit.report.tables", "OCP.BRepBuilderAPI", "pyvista.plotting",
    "vtkmodules.vtkViewsCore", "matplotlib.backends.backend_agg", "matplotlib.figure", "scipy.optimize",
    "scipy.spatial", "shapely",
)  # fmt: skip

gc.disable()
for _name in HEAVY:
    with suppress(ImportError):  # raised again by the task that needs it
        import_module(_name)
gc.freeze()
gc.enable()
