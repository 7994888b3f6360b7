"""Names of what the scene holds, for its legend and list."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

__all__ = ["layer_title", "word"]

_WORDS: dict[str, Any] = {
    "ground": QT_TRANSLATE_NOOP("Scene", "Ground"),
    "boundary": QT_TRANSLATE_NOOP("Scene", "Study area"),
    "holes": QT_TRANSLATE_NOOP("Scene", "Boreholes"),
    "adits": QT_TRANSLATE_NOOP("Scene", "Adits"),
    "sections": QT_TRANSLATE_NOOP("Scene", "Section lines"),
    "dips": QT_TRANSLATE_NOOP("Scene", "Measured dips"),
    "points": QT_TRANSLATE_NOOP("Scene", "Points"),
    "surface": QT_TRANSLATE_NOOP("Scene", "Surface"),
    "seams": QT_TRANSLATE_NOOP("Scene", "Seams"),
    "control": QT_TRANSLATE_NOOP("Scene", "Control points"),
    "upper": QT_TRANSLATE_NOOP("Scene", "Upper 90 % bound"),
    "lower": QT_TRANSLATE_NOOP("Scene", "Lower 90 % bound"),
    "suggestions": QT_TRANSLATE_NOOP("Scene", "Next holes"),
    "body": QT_TRANSLATE_NOOP("Scene", "Body"),
    "body data": QT_TRANSLATE_NOOP("Scene", "Contacts and intervals"),
    "morph": QT_TRANSLATE_NOOP("Scene", "Frame"),
    "morph end": QT_TRANSLATE_NOOP("Scene", "End"),
    "plain": QT_TRANSLATE_NOOP("Scene", "One colour"),
    "kind": QT_TRANSLATE_NOOP("Scene", "Kind of source"),
    "deviation": QT_TRANSLATE_NOOP("Scene", "Deviation"),
    "elevation": QT_TRANSLATE_NOOP("Scene", "Elevation"),
    "standard deviation": QT_TRANSLATE_NOOP("Scene", "Standard deviation"),
    "dip": QT_TRANSLATE_NOOP("Scene", "Dip"),
    "thickness": QT_TRANSLATE_NOOP("Scene", "Thickness below"),
    "gap": QT_TRANSLATE_NOOP("Scene", "Gap of the seam"),
    "angle": QT_TRANSLATE_NOOP("Scene", "Angle at the seam"),
    "borehole": QT_TRANSLATE_NOOP("Scene", "Borehole"),
    "adit": QT_TRANSLATE_NOOP("Scene", "Adit"),
    "section": QT_TRANSLATE_NOOP("Scene", "Section"),
    "outcrop": QT_TRANSLATE_NOOP("Scene", "Outcrop"),
    "geophysics": QT_TRANSLATE_NOOP("Scene", "Geophysics"),
    "map": QT_TRANSLATE_NOOP("Scene", "Map"),
    "point": QT_TRANSLATE_NOOP("Scene", "Point"),
}


def word(text: str) -> str:
    """Return the name of a kind of layer, a way of colouring or a kind of source; others as they are."""
    known = _WORDS.get(text)
    return text if known is None else QCoreApplication.translate("Scene", known)


def layer_title(kind: str, horizon: str) -> str:
    """Return the name of a layer with its horizon."""
    return f"{horizon} · {word(kind)}" if horizon else word(kind)
