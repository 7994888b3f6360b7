"""What the buttons of the mouse do in the scene, as in the program that somebody comes from."""

from __future__ import annotations

from typing import Literal

from PySide6.QtCore import Qt

__all__ = ["SCHEMES", "Drag", "Scheme", "drag_of"]

#: What a drag does: turn the scene, shift it, come nearer, or nothing but a click.
Drag = Literal["turn", "shift", "zoom", "pick"]
Scheme = Literal["geofit", "cad", "leapfrog", "paraview"]

_Button = Qt.MouseButton
#: By button: without and with the shift key.
SCHEMES: dict[Scheme, dict[Qt.MouseButton, tuple[Drag, Drag]]] = {
    "geofit": {
        _Button.LeftButton: ("turn", "shift"),
        _Button.MiddleButton: ("shift", "shift"),
        _Button.RightButton: ("shift", "shift"),
    },
    "cad": {
        _Button.LeftButton: ("pick", "pick"),
        _Button.MiddleButton: ("shift", "turn"),
        _Button.RightButton: ("pick", "pick"),
    },
    "leapfrog": {
        _Button.LeftButton: ("turn", "shift"),
        _Button.MiddleButton: ("shift", "shift"),
        _Button.RightButton: ("zoom", "shift"),
    },
    "paraview": {
        _Button.LeftButton: ("turn", "turn"),
        _Button.MiddleButton: ("shift", "shift"),
        _Button.RightButton: ("zoom", "zoom"),
    },
}


def drag_of(scheme: Scheme, button: Qt.MouseButton, shift: bool) -> Drag:
    """Return what a drag with a button does."""
    return SCHEMES[scheme].get(button, ("shift", "shift"))[shift]
