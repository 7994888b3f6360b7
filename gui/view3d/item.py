"""What one layer puts into the scene: actors, names, and what can be pointed at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from geofit.gui.view3d.actors import ActorPart
from geofit.gui.view3d.crowd import Crowd
from geofit.gui.view3d.layers import Legend
from geofit.gui.view3d.shape import Shape

__all__ = ["Item", "Look", "corners_of"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Look:
    """How things are drawn just now: about which origin (map coordinates), on a dark ground or not.

    ``points`` is how many times larger than usual data points are.
    """

    origin: Floats
    dark: bool
    points: float = 1.0

    @property
    def text(self) -> str:
        """Colour of thin lines that belong to no horizon."""
        return "#dfe6ec" if self.dark else "#1c2733"


@dataclass(eq=False)
class Item:
    """Actors of a layer; all places in map coordinates.

    ``names`` are written at ``places`` (n, 3). ``targets`` (n, 3) can be clicked, each known by its number; so can
    ``ways``, lines with a name. ``shape`` is hit by the line of sight. ``box`` (2, 3) holds all of it. ``crowd`` draws
    as many of the targets as a view has room for; all of them can be clicked.
    """

    parts: list[ActorPart]
    box: Floats
    places: Floats = field(default_factory=lambda: np.empty((0, 3)))
    names: Sequence[str] = ()
    targets: Floats | None = None
    ways: Sequence[tuple[str, Floats]] = ()
    shape: Shape | None = None
    crowd: Crowd | None = None
    legend: Legend | None = None


def corners_of(xyz: Floats) -> Floats:
    """Return the least and largest coordinates (2, 3)."""
    return np.stack([np.nanmin(xyz, axis=0), np.nanmax(xyz, axis=0)])
