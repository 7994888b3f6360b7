"""A surface of a file whose faces end at loops within their patches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import measurable_places
from geofit.geometry.elevation import elevation
from geofit.geometry.mesh import Mesh, Tolerance, triangulate
from geofit.geometry.mesh_projection import ASIDE
from geofit.geometry.projection import Projection
from geofit.geometry.trim_loops import Loops, nearest_on_trimmed, trim
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["TrimmedSurface"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrimmedSurface(PatchSurface):
    """A surface some of whose patches are cut by ``trim_loops``, so that it is smaller than its patches.

    Distances are measured to the faces, not to the patches beyond them; ``project`` marks the points ``beyond``.
    """

    trim_loops: Loops = ()

    @property
    def loops(self) -> Loops:
        """Trim loops of each patch in its parameters."""
        return self.trim_loops or super().loops

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the height at map coordinates in metres, nan outside and where a loop leaves a hole."""
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        plan = np.stack([x.ravel(), y.ravel()], axis=1)
        heights = np.stack([elevation((patch,), self.origin, self.outline, *plan.T) for patch in self.patches])
        uncut = _highest(heights)
        asked = np.isfinite(heights)
        if self.outline is not None:  # one loop around all faces: only where patches overlap is more to be asked
            asked &= asked.sum(axis=0) > 1
        for k in [k for k, loops in enumerate(self.loops) if loops and asked[k].any()]:
            some = np.flatnonzero(asked[k])
            place = np.column_stack([plan[some], heights[k, some]]) - self.origin
            gone = np.abs(nearest_on_trimmed(self.patches[k : k + 1], place, self.loops[k : k + 1]).distance) > ASIDE
            heights[k, some[gone]] = np.nan
        height = _highest(heights)
        if self.outline is not None:  # between two faces whose common curve each follows by its own polygon
            height = np.where(np.isnan(height), uncut, height)
        return height.reshape(x.shape)

    def project(self, xyz: ArrayLike) -> Projection:
        """Return the foot points of (n, 3) map coordinates on the trimmed faces."""
        return nearest_on_trimmed(self.patches, measurable_places(xyz) - self.origin, self.loops)

    def triangulate(self, tolerance: Tolerance = 0.05) -> Mesh:
        """Return triangles within a tolerance (m), cut along the loops."""
        return trim(triangulate(self.patches, self.origin, tolerance), self.patches, self.loops)


def _highest(heights: Floats) -> Floats:
    """Return the highest of each column, nan where there is none."""
    found = np.where(np.isfinite(heights), heights, -np.inf).max(axis=0)
    return np.asarray(np.where(np.isneginf(found), np.nan, found))
