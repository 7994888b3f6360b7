"""geofit: NURBS surfaces of geological horizons, fitted, checked, stitched.

>>> import geofit
>>> points = geofit.PointSet([[0, 0, 1.0], [1, 0, 2.0], [0, 1, 3.0], [1, 1, 4.0]])
>>> surface = geofit.fit_horizon(points)
>>> round(float(surface.elevation(0.5, 0.5)), 6)
2.5
"""

from geofit._lazy import attach

__version__ = "0.1.0"

#: The names are listed in ``__init__.pyi``. numpy, scipy and OpenCASCADE are imported when they are first needed.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
