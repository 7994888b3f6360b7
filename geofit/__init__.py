"""geofit: NURBS surfaces of geological horizons, fitted, checked, stitched.

>>> import geofit
>>> points = geofit.PointSet([[0, 0, 1.0], [1, 0, 2.0], [0, 1, 3.0], [1, 1, 4.0]])
>>> surface = geofit.fit_horizon(points)
>>> round(float(surface.elevation(0.5, 0.5)), 6)
2.5
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from geofit.data.errors import GeofitError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Site

if TYPE_CHECKING:
    from geofit import io
    from geofit.fitting.horizon_fit import HorizonFit
    from geofit.fitting.pipeline import fit_horizon

__version__ = "0.1.0"

__all__ = ["FitSettings", "GeofitError", "HorizonFit", "PointSet", "Site", "fit_horizon", "io"]

# scipy and OpenCASCADE are imported when they are first needed.
_LAZY = {"fit_horizon": "geofit.fitting.pipeline", "HorizonFit": "geofit.fitting.horizon_fit", "io": "geofit.io"}


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'geofit' has no attribute '{name}'")
    module = import_module(_LAZY[name])
    return module if name == "io" else getattr(module, name)
