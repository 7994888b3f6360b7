"""Files to Site, PointSet and HorizonFit, and back; one module a format.

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
    from geofit.io.mapping import ColumnMapping, load_mappings, save_mappings
    from geofit.io.picks import Picks, read_points
    from geofit.io.preview import TablePreview, preview_file, preview_table
    from geofit.io.site_file import read_site
    from geofit.io.source import Source
    from geofit.io.surface_files import read_surface_file

__all__ = [
    "Boreholes",
    "ColumnMapping",
    "Contacts",
    "Picks",
    "Source",
    "TablePreview",
    "load_mappings",
    "preview_file",
    "preview_table",
    "read_boreholes",
    "read_boundary",
    "read_ground",
    "read_points",
    "read_site",
    "read_surface_file",
    "save_mappings",
    "take_contacts",
]

_MODULES = {
    "Boreholes": "boreholes",
    "ColumnMapping": "mapping",
    "Contacts": "contacts",
    "Picks": "picks",
    "Source": "source",
    "TablePreview": "preview",
    "load_mappings": "mapping",
    "preview_file": "preview",
    "preview_table": "preview",
    "read_boreholes": "boreholes",
    "read_boundary": "boundary",
    "read_ground": "grid",
    "read_points": "picks",
    "read_site": "site_file",
    "read_surface_file": "surface_files",
    "save_mappings": "mapping",
    "take_contacts": "contacts",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'geofit.io' has no attribute '{name}'")
    return getattr(import_module(f"geofit.io.{_MODULES[name]}"), name)
