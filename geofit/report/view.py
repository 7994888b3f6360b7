"""From which side a surface is drawn: from above, or, where it is steep, along its strike."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.fitting.horizon_fit import HorizonFit
from geofit.sampling.cut import cut_section
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["View", "choose_view", "cut_edges", "rims", "trimmed"]

Floats = NDArray[np.float64]

#: Steeper on average than this, a surface is drawn along its strike, degrees.
STEEP = 50.0


@dataclass(frozen=True, eq=False)
class View:
    """An orthogonal picture plane: ``axes`` (2, 3) unit vectors, ``start`` (3,) where they count from."""

    axes: Floats
    start: Floats
    labels: tuple[Message, Message]
    caption: str

    def of(self, xyz: Floats) -> Floats:
        """Return picture coordinates (..., 2) of map coordinates (..., 3), metres."""
        return np.asarray((xyz - self.start) @ self.axes.T)


def choose_view(surface: HorizonFit) -> View:
    """Return the plan for a surface that lies flat, the view across the strike for a steep one."""
    normal = np.mean([_normals(patch) for patch in surface.patches], axis=0)
    dip = np.degrees(np.arctan2(np.hypot(normal[0], normal[1]), abs(normal[2])))
    if dip < STEEP:
        return View(
            np.eye(3)[:2],
            np.zeros(3),
            (message("report.easting", "Easting, m"), message("report.northing", "Northing, m")),
            "plan",
        )
    strike = np.array([-normal[1], normal[0], 0.0])
    strike /= np.linalg.norm(strike)
    # Seen so that the strike runs to the right and towards the east (or the north).
    if strike[0] < -1e-9 or (abs(strike[0]) <= 1e-9 and strike[1] < 0):
        strike = -strike
    azimuth = np.degrees(np.arctan2(strike[0], strike[1])) % 360
    along = np.concatenate([surface.points.xyz @ strike, [surface.origin @ strike]])
    return View(
        np.stack([strike, [0.0, 0.0, 1.0]]),
        strike * along.min(),
        (
            message(
                "report.axis-along-strike",
                "Along strike towards {azimuth:03.0f}°, m (mean dip {dip:.0f}°)",
                azimuth=float(azimuth),
                dip=float(dip),
            ),
            message("report.elevation", "Elevation, m"),
        ),
        "across the strike",
    )


def _normals(patch: Patch) -> Floats:
    u0, u1, v0, v1 = patch.domain
    u, v = np.meshgrid(np.linspace(u0, u1, 12)[1:-1], np.linspace(v0, v1, 12)[1:-1])
    area = np.cross(patch.evaluate(u, v, 1, 0), patch.evaluate(u, v, 0, 1)).reshape(-1, 3)
    return np.asarray((area * (u1 - u0) * (v1 - v0)).mean(axis=0))


def rims(surface: HorizonFit, steps: int = 80) -> dict[str, Floats]:
    """Return the closed outline of every patch in map coordinates, (k, 3) each."""
    outlines, t = {}, np.linspace(0, 1, steps)
    for patch in surface.patches:
        u0, u1, v0, v1 = patch.domain
        u, v = (u0 + (u1 - u0) * t)[:, None], (v0 + (v1 - v0) * t)[None]
        south, north = np.moveaxis(patch.evaluate(u, np.array([[v0, v1]])), 1, 0)
        west, east = patch.evaluate(np.array([[u0], [u1]]), v)
        outlines[patch.name] = np.concatenate([south, east, north[::-1], west[::-1]]) + surface.origin
    return outlines


def cut_edges(surface: HorizonFit, name: str) -> list[Floats]:
    """Return the lines along which the study area cuts a patch, in map coordinates, (k, 3) each.

    With the rim of the patch as far as it lies in the area they enclose what is left of it. None over the map: seen
    from above, they are the outline.
    """
    if surface.outline is None or surface.frame == "map":
        return []
    own = [patch for patch in surface.patches if patch.name == name]
    whole = PatchSurface(tuple(own), surface.origin, name)
    rim = rims(surface)[name]
    if (trimmed(surface, rim[:, 0], rim[:, 1]) > 0.0).all():
        return []
    return [line.xyz for line in cut_section(whole, np.vstack([surface.outline, surface.outline[:1]]), tolerance=0.5)]


def trimmed(surface: HorizonFit, x: Floats, y: Floats) -> Floats:
    """Return metres inside the plan outline (negative outside); infinity where the surface is not trimmed."""
    if surface.outline is None:
        return np.full(np.shape(x), np.inf)
    import shapely

    polygon = shapely.Polygon(surface.outline)
    shapely.prepare(polygon)
    x, y = np.asarray(x), np.asarray(y)
    away = np.full(x.shape, np.inf)
    for start, end in zip(surface.outline, np.roll(surface.outline, -1, axis=0), strict=True):
        way = end - start
        share = ((x - start[0]) * way[0] + (y - start[1]) * way[1]) / max(float(way @ way), 1e-300)
        share = share.clip(0, 1)
        away = np.minimum(away, (x - start[0] - share * way[0]) ** 2 + (y - start[1] - share * way[1]) ** 2)
    away = np.sqrt(away)
    return np.asarray(np.where(shapely.intersects_xy(polygon, x, y), away, -away))
