"""Medial axes of voxel bodies and the metaballs that cover them (Guo, Peng and Li 1999).

Names are loaded when they are first used, so that ``import geofit.medial`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geofit.medial.balls import MetaballBody
    from geofit.medial.chamfer import chamfer_distance
    from geofit.medial.fit import metaballs

_MODULES = {"MetaballBody": "balls", "chamfer_distance": "chamfer", "metaballs": "fit"}

__all__ = ["MetaballBody", "chamfer_distance", "metaballs"]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'geofit.medial' has no attribute '{name}'")
    return getattr(import_module(f"geofit.medial.{_MODULES[name]}"), name)
