"""Files to sites, points and surfaces, and back; one module a format.

The names are listed in ``__init__.pyi`` and imported when they are first used.
"""

from geofit._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
