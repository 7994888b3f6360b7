"""What is said of manual edits: a note for what was done, an error for what cannot be."""

from __future__ import annotations

from collections.abc import Sequence

from geofit.data.columns import LARGEST
from geofit.data.errors import FitError
from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite, shown

__all__ = ["core_ruled", "move_note", "moved_aside", "require_finite", "require_three"]


def move_note(patch: str, i: int, j: int, dz: float, aside: Sequence[float]) -> Message:
    """Return the note of a control point that was moved."""
    if not any(aside):
        return message(
            "fitting.control-point-moved-note",
            "manual edit: control point ({i}, {j}) of patch '{patch}' moved by {dz:+.3g} m",
            i=i,
            j=j,
            patch=patch,
            dz=dz,
        )
    x, y, z = aside
    return message(
        "fitting.control-point-moved-aside-note",
        "manual edit: control point ({i}, {j}) of patch '{patch}' moved by {dz:+.3g} m, and sideways by ({x:+.3g}, "
        "{y:+.3g}, {z:+.3g}) m",
        i=i,
        j=j,
        patch=patch,
        dz=dz,
        x=x,
        y=y,
        z=z,
    )


def require_finite(value: float, name: str) -> None:
    """Refuse a length that is infinite, not a number, or too large."""
    if not is_finite(value) or abs(value) > LARGEST:
        raise FitError(
            message(
                "fitting.value-not-finite",
                "{name} is {value}; a finite number up to {most:.0e} is needed.",
                name=name,
                value=shown(value),
                most=LARGEST,
            )
        )


def require_three(values: Sequence[float], name: str) -> None:
    """Refuse a move that is not three lengths."""
    if len(values) != 3:
        raise FitError(
            message(
                "fitting.move-not-three",
                "{name} has {count} values; three are needed: east, north and up, metres.",
                name=name,
                count=len(values),
            )
        )
    for value in values:
        require_finite(value, name)


def core_ruled() -> FitError:
    """Return the error for a core whose control points follow its section curves."""
    return FitError(
        message(
            "fitting.core-ruled",
            "The core is straight between its section curves, and its control points follow them. Change the "
            "periphery, or fit with across='cubic'.",
        )
    )


def moved_aside() -> FitError:
    """Return the error for a place where the surface is a height field no longer."""
    return FitError(
        message(
            "fitting.control-points-aside",
            "Control points that were moved sideways affect the surface here. Undo their moves, or move the control "
            "point itself.",
        )
    )
