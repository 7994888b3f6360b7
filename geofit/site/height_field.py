"""A height field over the map: its height within and beyond its outline, where it stands, the lattice of its knots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.cells import tabulate
from geofit.geometry.elevation import RIM, PlanMap, plan_map

if TYPE_CHECKING:
    from shapely import Geometry

__all__ = ["HeightField", "onto"]

Floats = NDArray[np.float64]

#: Lines of a lattice nearer than this share of its extent are one.
SAME = 1e-9
#: Patches that meet are joined across this many metres in plan; what is left of an area is drawn in by as much.
JOIN = 1e-6


class HeightField:
    """The height over the map of a surface whose patches are height fields.

    Parameters
    ----------
    surface : HorizonFit
        Patches whose x and y follow their parameters: fits over the map, their STEP files read back.

    Raises
    ------
    SettingsError
        If a patch is not a height field over the map (faults, overturned folds, triangles of a file).
    """

    def __init__(self, surface: HorizonFit) -> None:
        self.name, self.origin, self.outline = surface.name, surface.origin, surface.outline
        self.epsilon, self.points = surface.settings.epsilon, surface.points
        mappings = [plan_map(patch) for patch in surface.patches]
        self._mappings: list[PlanMap] = [one for one in mappings if one is not None]
        if not mappings or len(self._mappings) < len(mappings):
            text = message(
                "site.not-a-height-field",
                "'{name}' is not a height field over the map, so above and below are not defined for "
                "it. Name fitted horizons only; leave out faults, overturned folds and triangles read "
                "from files.",
                name=surface.name,
            )
            raise SettingsError(text)
        self._inverse = [np.linalg.inv(mapping.matrix) for mapping in self._mappings]
        self._patches = surface.patches
        self._cells = tabulate(surface.patches)

    def __call__(self, x: Floats, y: Floats) -> Floats:
        """Return elevations at map coordinates, metres, of any one shape; nan beyond the patches, outline or not."""
        plan = np.stack([np.ravel(x) - self.origin[0], np.ravel(y) - self.origin[1]])
        height = np.full(plan.shape[1], np.nan)
        for k, (patch, mapping, inverse) in enumerate(zip(self._patches, self._mappings, self._inverse, strict=True)):
            u, v = inverse @ (plan - mapping.start[:, None])
            u0, u1, v0, v1 = patch.domain
            rim_u, rim_v = RIM * (u1 - u0), RIM * (v1 - v0)
            over = np.flatnonzero((u >= u0 - rim_u) & (u <= u1 + rim_u) & (v >= v0 - rim_v) & (v <= v1 + rim_v))
            height[over] = self._cells.points(self._cells.locate(k, u[over], v[over]))[2]
        return np.asarray((height + self.origin[2]).reshape(np.shape(x)))

    def area(self) -> Geometry:
        """Return where the surface stands, its outline considered: a shapely polygon in map coordinates."""
        import shapely

        quads = []
        for patch, mapping in zip(self._patches, self._mappings, strict=True):
            u0, u1, v0, v1 = patch.domain
            corners = np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])
            quads.append(shapely.Polygon(corners @ mapping.matrix.T + mapping.start + self.origin[:2]))
        whole = shapely.union_all(shapely.buffer(quads, JOIN, join_style="mitre"))
        if self.outline is not None:
            whole = shapely.intersection(whole, shapely.Polygon(self.outline))
        return shapely.buffer(whole, -2 * JOIN, join_style="mitre")

    def lattice(self, pieces: int) -> Floats:
        """Return (nu, nv, 2) map coordinates of a lattice over all patches: each knot span in so many pieces."""
        first = self._mappings[0].matrix
        axes = first / np.linalg.norm(first, axis=0)
        along: tuple[list[Floats], list[Floats]] = ([], [])
        for patch, mapping in zip(self._patches, self._mappings, strict=True):
            start = np.linalg.solve(axes, mapping.start)
            steps = np.linalg.solve(axes, mapping.matrix)
            for axis, knots in enumerate((patch.knots_u, patch.knots_v)):
                across = patch.domain[2 - 2 * axis]
                along[axis].append(start[axis] + steps[axis, axis] * knots + steps[axis, 1 - axis] * across)
        a, b = (_divided(np.concatenate(lines), pieces) for lines in along)
        plan = np.stack(np.meshgrid(a, b, indexing="ij"), axis=-1) @ axes.T
        return np.asarray(plan + self.origin[:2])


def onto(area: Geometry, plan: Floats) -> Floats:
    """Return (n, 2) places, those outside an area moved to the nearest place of it."""
    import shapely

    shapely.prepare(area)
    outside = np.flatnonzero(~shapely.intersects_xy(area, plan[:, 0], plan[:, 1]))
    if not len(outside):
        return plan
    moved = plan.copy()
    ways = shapely.shortest_line(shapely.points(plan[outside]), area)
    moved[outside] = shapely.get_coordinates(ways)[1::2]
    return moved


def _divided(lines: Floats, pieces: int) -> Floats:
    lines = np.unique(lines)
    apart = np.append(True, np.diff(lines) > SAME * (lines[-1] - lines[0]))
    lines = lines[apart]
    share = np.arange(pieces) / pieces
    return np.append((lines[:-1, None] + np.diff(lines)[:, None] * share).ravel(), lines[-1])
