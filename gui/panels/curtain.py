"""A section's line in plan: straight ones by azimuth and position, places along it, and what lies beside it. No Qt."""

from __future__ import annotations

from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.prediction import Uncertainty
from geofit.data.progress import Progress, tell
from geofit.data.site import Site
from geofit.data.threads import one_thread
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.mesh import Mesh
from geofit.prediction.section_bands import SectionBand, section_bands
from geofit.sampling.cut import CutLine, cut_section, section_line

__all__ = ["Curtain", "Traces", "site_extent", "trace"]

Floats = NDArray[np.float64]
#: Triangles of each surface that was cut already, with the surface that they belong to.
Meshes = MutableMapping[str, tuple[HorizonFit, Mesh]]
#: Lines in which the curtain cuts each surface, with their 90 % bands.
Traces = Mapping[str, list[tuple[CutLine, SectionBand | None]]]

#: Lines of a drawing need not be nearer to the surface than this, metres; their vertices lie on it.
TOLERANCE = 0.2


@dataclass(frozen=True, eq=False)
class Curtain:
    """A vertical curtain along ``line`` (k, 2), map coordinates in metres."""

    line: Floats

    @classmethod
    def along(cls, line: ArrayLike) -> Curtain:
        """Return the curtain of any line in plan."""
        return cls(section_line(line))

    @classmethod
    def straight(cls, azimuth: float, position: float, box: Floats) -> Curtain:
        """Return a straight curtain through a site.

        Parameters
        ----------
        azimuth : float
            Direction, degrees clockwise from grid north.
        position : float
            Metres to the right of the middle of the box, looking along the azimuth.
        box : (2, 2) array
            Lowest and highest easting and northing of the site.
        """
        way = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
        right = np.array([way[1], -way[0]])
        middle = box.mean(axis=0)
        corners = np.array([[x, y] for x in box[:, 0] for y in box[:, 1]]) - middle
        reach = corners @ way
        at = middle + position * right
        return cls(np.stack([at + reach.min() * way, at + reach.max() * way]))

    @property
    def starts(self) -> Floats:
        """Distance of each corner along the line, metres."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.line, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """Length in metres."""
        return float(self.starts[-1])

    @property
    def azimuth(self) -> float:
        """Direction from the first to the last corner, degrees clockwise from grid north, 0 to 360."""
        east, north = self.line[-1] - self.line[0]
        return float(np.degrees(np.arctan2(east, north)) % 360)

    def position(self, box: Floats) -> float:
        """Return how far to the right of the middle of a box the line's middle lies, metres."""
        angle = np.radians(self.azimuth)
        right = np.array([np.cos(angle), -np.sin(angle)])
        return float(((self.line[0] + self.line[-1]) / 2 - box.mean(axis=0)) @ right)

    def places(self, count: int = 400) -> tuple[Floats, Floats]:
        """Return distances along the line and their places (count, 2)."""
        distance = np.linspace(0, self.length, count)
        return distance, np.column_stack([np.interp(distance, self.starts, self.line[:, k]) for k in (0, 1)])

    def project(self, xy: Floats) -> tuple[Floats, Floats]:
        """Return for places (n, 2) the distance along the line and beside it (of the nearest leg), metres.

        Places beyond the line's ends are nan.
        """
        along, beside = np.full(len(xy), np.nan), np.full(len(xy), np.inf)
        for start, end, at in zip(self.line[:-1], self.line[1:], self.starts, strict=False):
            length = float(np.linalg.norm(end - start))
            way = (end - start) / length
            forward = (xy - start) @ way
            off = np.abs((xy - start) @ np.array([way[1], -way[0]]))
            better = (forward >= 0) & (forward <= length) & (off < beside)
            along[better], beside[better] = at + forward[better], off[better]
        return along, np.where(np.isnan(along), np.nan, beside)


def site_extent(site: Site, surfaces: Mapping[str, HorizonFit]) -> Floats:
    """Return the lowest and highest easting and northing of a site, (2, 2)."""
    parts = [points.xyz[:, :2] for points in site.horizons.values() if len(points)]
    parts += [s.patches[0].control[..., :2].reshape(-1, 2) + s.origin[:2] for s in surfaces.values() if s.patches]
    parts += [] if site.boundary is None else [site.boundary]
    parts += [hole.xyz[:, :2] for hole in site.holes]
    xy = np.concatenate(parts) if parts else np.array([[0.0, 0.0], [1.0, 1.0]])
    return np.stack([xy.min(axis=0), xy.max(axis=0)])


def trace(
    surfaces: Mapping[str, HorizonFit],
    uncertainty: Mapping[str, Uncertainty],
    line: Floats,
    meshes: Meshes,
    progress: Progress | None = None,
) -> Traces:
    """Cut every surface along a line, with its 90 % band where its uncertainty is known.

    Triangles are kept in ``meshes`` for the next cut.

    Raises
    ------
    Cancelled
        If ``progress`` returned False.
    """
    found: dict[str, list[tuple[CutLine, SectionBand | None]]] = {}
    with one_thread():
        for k, (name, surface) in enumerate(surfaces.items()):
            tell(progress, "section", k / len(surfaces))
            kept = meshes.get(name)
            if kept is None or kept[0] is not surface:
                kept = (surface, surface.triangulate(TOLERANCE))
                meshes[name] = kept
            cuts = cut_section(surface, line, tolerance=TOLERANCE, mesh=kept[1])
            bands = section_bands(surface, uncertainty.get(name), line, cuts)
            found[name] = list(zip(cuts, bands, strict=True))
    return found
