"""What kinds of tables and roles of columns are called in the windows."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

__all__ = ["kind_name", "role_name"]

_KINDS = {
    "collar": QT_TRANSLATE_NOOP("Kind", "Collars"),
    "survey": QT_TRANSLATE_NOOP("Kind", "Downhole survey"),
    "intervals": QT_TRANSLATE_NOOP("Kind", "Intervals (log)"),
    "adit path": QT_TRANSLATE_NOOP("Kind", "Adit paths"),
    "adit contacts": QT_TRANSLATE_NOOP("Kind", "Contacts in adits"),
    "section": QT_TRANSLATE_NOOP("Kind", "One section"),
    "sections": QT_TRANSLATE_NOOP("Kind", "Several sections"),
    "section lines": QT_TRANSLATE_NOOP("Kind", "Section lines in plan"),
    "traces": QT_TRANSLATE_NOOP("Kind", "Map traces"),
    "picks": QT_TRANSLATE_NOOP("Kind", "Points (picks)"),
    "horizon columns": QT_TRANSLATE_NOOP("Kind", "One column per horizon"),
    "orientations": QT_TRANSLATE_NOOP("Kind", "Measured dips"),
    "boundary": QT_TRANSLATE_NOOP("Kind", "Study area"),
    "ground": QT_TRANSLATE_NOOP("Kind", "Ground surface (grid)"),
    "grid": QT_TRANSLATE_NOOP("Kind", "Horizon (grid)"),
    "drawing": QT_TRANSLATE_NOOP("Kind", "Section drawing"),
    "skip": QT_TRANSLATE_NOOP("Kind", "Leave out"),
    "": QT_TRANSLATE_NOOP("Kind", "Not recognised"),
}

_ROLES = {
    "hole": QT_TRANSLATE_NOOP("Role", "Hole"),
    "x": QT_TRANSLATE_NOOP("Role", "Easting"),
    "y": QT_TRANSLATE_NOOP("Role", "Northing"),
    "z": QT_TRANSLATE_NOOP("Role", "Elevation"),
    "depth": QT_TRANSLATE_NOOP("Role", "Depth"),
    "azimuth": QT_TRANSLATE_NOOP("Role", "Azimuth"),
    "dip": QT_TRANSLATE_NOOP("Role", "Dip"),
    "strike": QT_TRANSLATE_NOOP("Role", "Strike"),
    "from": QT_TRANSLATE_NOOP("Role", "From"),
    "to": QT_TRANSLATE_NOOP("Role", "To"),
    "code": QT_TRANSLATE_NOOP("Role", "Stratum code"),
    "adit": QT_TRANSLATE_NOOP("Role", "Adit"),
    "chainage": QT_TRANSLATE_NOOP("Role", "Chainage"),
    "horizon": QT_TRANSLATE_NOOP("Role", "Horizon"),
    "horizon elevation": QT_TRANSLATE_NOOP("Role", "Horizon elevation"),
    "horizon depth": QT_TRANSLATE_NOOP("Role", "Horizon depth"),
    "distance": QT_TRANSLATE_NOOP("Role", "Distance along"),
    "elevation": QT_TRANSLATE_NOOP("Role", "Elevation"),
    "section": QT_TRANSLATE_NOOP("Role", "Section"),
    "kind": QT_TRANSLATE_NOOP("Role", "Source kind"),
    "accuracy": QT_TRANSLATE_NOOP("Role", "Accuracy"),
    "x0": QT_TRANSLATE_NOOP("Role", "Easting, start"),
    "y0": QT_TRANSLATE_NOOP("Role", "Northing, start"),
    "x1": QT_TRANSLATE_NOOP("Role", "Easting, end"),
    "y1": QT_TRANSLATE_NOOP("Role", "Northing, end"),
    "nx": QT_TRANSLATE_NOOP("Role", "Normal, east"),
    "ny": QT_TRANSLATE_NOOP("Role", "Normal, north"),
    "nz": QT_TRANSLATE_NOOP("Role", "Normal, up"),
}


def kind_name(kind: str) -> str:
    """Return what a kind of table is called."""
    return QCoreApplication.translate("Kind", str(_KINDS.get(kind, kind)))


def role_name(role: str) -> str:
    """Return what the role of a column is called."""
    return QCoreApplication.translate("Role", str(_ROLES.get(role, role)))
