"""Pore space of rock: maximal balls, pore network, porosity and permeability, implicit surface (Huang et al. 2007).

Names are loaded when they are first used, so that ``import geofit.pores`` costs nothing.

>>> import numpy as np, geofit.pores as pores
>>> rock = np.ones((9, 9, 20))
>>> rock[1:8, 1:8, 1:8] = rock[1:8, 1:8, 12:19] = rock[4, 4] = 0
>>> volume = pores.RockVolume(rock, pore=0, voxel=1e-6)
>>> network = pores.pore_network(volume)
>>> network.pores.radius.tolist(), network.throats.radius.tolist()
([3.5, 3.5], [0.5])
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geofit.pores.balls import MaximalBalls, maximal_balls
    from geofit.pores.components import Connectivity, connectivity, euler_number
    from geofit.pores.crofton import surface_area
    from geofit.pores.extraction import pore_network
    from geofit.pores.kozeny import kozeny_permeability, kozeny_ratio
    from geofit.pores.laplace import laplace_permeability
    from geofit.pores.network import PoreNetwork
    from geofit.pores.permeability import Permeability, network_permeability
    from geofit.pores.surface import PoreSurface, pore_surface
    from geofit.pores.table import BeforeAfter, before_after
    from geofit.pores.volume import RockVolume, VolumeError

_MODULES = {
    "BeforeAfter": "table",
    "Connectivity": "components",
    "MaximalBalls": "balls",
    "Permeability": "permeability",
    "PoreNetwork": "network",
    "PoreSurface": "surface",
    "RockVolume": "volume",
    "VolumeError": "volume",
    "before_after": "table",
    "connectivity": "components",
    "euler_number": "components",
    "kozeny_permeability": "kozeny",
    "kozeny_ratio": "kozeny",
    "laplace_permeability": "laplace",
    "maximal_balls": "balls",
    "network_permeability": "permeability",
    "pore_network": "extraction",
    "pore_surface": "surface",
    "surface_area": "crofton",
}

__all__ = [
    "BeforeAfter",
    "Connectivity",
    "MaximalBalls",
    "Permeability",
    "PoreNetwork",
    "PoreSurface",
    "RockVolume",
    "VolumeError",
    "before_after",
    "connectivity",
    "euler_number",
    "kozeny_permeability",
    "kozeny_ratio",
    "laplace_permeability",
    "maximal_balls",
    "network_permeability",
    "pore_network",
    "pore_surface",
    "surface_area",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'geofit.pores' has no attribute '{name}'")
    return getattr(import_module(f"geofit.pores.{_MODULES[name]}"), name)
