"""Arguments of another type than the function takes: told at its door, not by an attribute that is missing inside."""

from __future__ import annotations

from geofit.data.errors import ArgumentError
from geofit.data.messages import Message, message

__all__ = ["FIT", "POINTS", "SETTINGS", "SITE", "SURFACES", "require_kind"]

POINTS = message("data.point-set-needed", "a PointSet is needed: PointSet(xyz).")
SETTINGS = message("data.fit-settings-needed", "settings are needed: FitSettings(epsilon=0.5).")
FIT = message(
    "data.fit-needed",
    "a fit is needed: fit_horizon(points) gives one, judge(surface, points) makes one of a surface that was read.",
)
SITE = message("data.site-needed", "a site is needed: read_site(path) gives one.")
SURFACES = message("data.surfaces-needed", "a surface is needed, or several by name: {names}.", names="{'T1': surface}")


def require_kind(argument: str, value: object, kinds: type | tuple[type, ...], needed: Message) -> None:
    """Refuse an argument that is none of the kinds.

    Parameters
    ----------
    argument : str
        Its name in the call.
    value : object
        What was given.
    kinds : type or tuple of type
        What the function takes.
    needed : Message
        What is needed and how to get it: the end of the sentence.

    Raises
    ------
    ArgumentError
        If ``value`` is of another type.
    """
    if not isinstance(value, kinds):
        raise ArgumentError(
            message(
                "data.argument-type-unfit",
                "{argument} is of type {given}; {needed}",
                argument=argument,
                given="None" if value is None else type(value).__name__,
                needed=needed,
            )
        )
