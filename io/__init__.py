"""Files to Site, PointSet and HorizonSurface, and back; one module a format.

Names are loaded when they are first asked for, so that ``import geofit.io`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geofit.io.boreholes import Boreholes, read_boreholes
    from geofit.io.boundary import read_boundary
    from geofit.io.contacts import Contacts, take_contacts
    from geofit.io.grid import read_ground
    from geofit.io.picks import Picks, read_points
    from geofit.io.site_file import read_site
    from geofit.io.source import Source

__all__ = [
    "Boreholes",
    "Contacts",
    "Picks",
    "Source",
    "read_boreholes",
    "read_boundary",
    "read_ground",
    "read_points",
    "read_site",
    "take_contacts",
]

_MODULES = {
    "Boreholes": "boreholes",
    "Contacts": "contacts",
    "Picks": "picks",
    "Source": "source",
    "read_boreholes": "boreholes",
    "read_boundary": "boundary",
    "read_ground": "grid",
    "read_points": "picks",
    "read_site": "site_file",
    "take_contacts": "contacts",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'geofit.io' has no attribute '{name}'")
    return getattr(import_module(f"geofit.io.{_MODULES[name]}"), name)
