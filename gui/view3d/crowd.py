"""The actors of a cloud, filled anew for each view with the points that it has room for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.gui.view3d.actors import ActorPart, coloured, dots, poly
from geofit.gui.view3d.cloud import PointCloud
from geofit.gui.view3d.colouring import PointColours
from geofit.gui.view3d.projector import Projector

__all__ = ["Crowd"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Points of the moving picture before its first frame.
FIRST = 10_000
#: Diameters of the smallest points, still and moving, logical pixels.
SMALL = {"full": 2.0, "coarse": 3.0}
#: Opacity of points that take no part in the fit.
GHOSTLY = 0.3


class Crowd:
    """Draws a cloud: points of one size are an actor, for the still and for the moving picture; so are ghosts.

    Parameters
    ----------
    cloud : PointCloud
        The points.
    made : PointColours
        Their colours and sizes.
    excluded : (n,) array of bool or None
        Points that are drawn as ghosts, in the colour ``ghost``.
    origin : (3,) array
        Map coordinates of the scene's zero, metres.
    share : float
        How many times larger than usual points are.
    """

    def __init__(
        self, cloud: PointCloud, made: PointColours, excluded: Bools | None, origin: Floats, ghost: str, share: float
    ) -> None:
        self.cloud = cloud
        self._made, self._excluded, self._origin = made, excluded, origin
        self._seen: dict[str, object] = {}
        least = float(made.sizes.min())
        self._sizes = np.unique(made.sizes)
        self._parts: dict[str, list[ActorPart]] = {}
        ghosts = excluded is not None and bool(excluded.any())
        for detail, small in SMALL.items():
            pieces = [
                ActorPart(_none("#000000"), detail, size=small * size / least * share) for size in self._sizes.tolist()
            ]
            if ghosts:
                pieces.append(ActorPart(_none(ghost), detail, size=small * share, opacity=GHOSTLY))
            self._parts[detail] = pieces
        self._fill("coarse", cloud.beginnings(FIRST * cloud.sizes // max(len(cloud), FIRST)))

    @property
    def parts(self) -> list[ActorPart]:
        """All actors."""
        return [part for parts in self._parts.values() for part in parts]

    def count(self, detail: str) -> int:
        """Return how many points the "full" or the "coarse" picture draws."""
        return sum(part.actor.GetMapper().GetInput().GetNumberOfPoints() for part in self._parts[detail])

    def renew(self, view: Projector, detail: str, budget: int) -> None:
        """Choose the points of the "full" or the "coarse" picture anew, at most ``budget``, where the view is another.

        Where all fit into the budget all are drawn, whatever the view.
        """
        whole = len(self.cloud) <= budget
        seen = "all" if whole else (view.matrix.tobytes(), view.width, view.height, view.stretch, budget)
        if self._seen.get(detail) != seen:
            self._seen[detail] = seen
            self._fill(detail, np.arange(len(self.cloud)) if whole else self.cloud.drawn(view, budget))

    def _fill(self, detail: str, which: Ints) -> None:
        ghost = np.zeros(len(which), bool) if self._excluded is None else self._excluded[which]
        size = np.searchsorted(self._sizes, self._made.sizes)[self._made.code[which]]
        for k, part in enumerate(self._parts[detail]):
            mine = which[~ghost & (size == k)] if k < len(self._sizes) else which[ghost]
            part.actor.GetMapper().SetInputData(poly(self.cloud.xyz[mine] - self._origin))
            if k < len(self._sizes):
                coloured(part.actor, self._made.shades[self._made.code[mine]])


def _none(colour: str) -> Any:
    return dots(poly(np.empty((0, 3))), colour, balls=False)
