"""How finely a surface is triangulated for a view: within half a pixel where it is in sight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.gui.view3d.projector import Projector

__all__ = ["Sight"]

Floats = NDArray[np.float64]

#: Largest distance between triangles and surface, logical pixels.
PIXELS = 0.5


@dataclass(frozen=True, eq=False)
class Sight:
    """The tolerance of triangles that are looked at.

    Parameters
    ----------
    view : Projector
        How they are seen.
    nearest : float
        What is nearer to the viewpoint than this (metres along the line of sight) is taken to be as near.
    """

    view: Projector
    nearest: float

    def tolerance(self, low: Floats, high: Floats, most: float) -> Floats:
        """Return the metres (n,) that PIXELS are in boxes (n, 3) of map coordinates, ``most`` at most and out of sight.

        A place w before the viewpoint moves by at most (|a| + |c|) / w of half the picture a metre, where a and c are
        the rows of the camera's matrix that give the place's numerator and w.
        """
        view = self.view
        rows = view.matrix[[0, 1, 3], :3] * (1.0, 1.0, view.stretch)
        size = np.array([view.width, view.height])
        corner = np.array([[a, b, c] for a in (0, 1) for b in (0, 1) for c in (0, 1)])
        places = np.stack([low, high], axis=1)[:, corner, np.arange(3)] - view.origin
        x, y, w = np.moveaxis(places @ rows.T + view.matrix[[0, 1, 3], 3], 2, 0)
        seen = (w > 0).any(axis=1)
        for along in (x, y):
            seen &= (along <= w).any(axis=1) & (along >= -w).any(axis=1)
        length = np.linalg.norm(rows, axis=1)
        pixels = float(((length[:2] + length[2]) * size / 2).max())
        near = np.maximum(w.min(axis=1), self.nearest if length[2] > 0 else 1.0)
        return np.where(seen, np.minimum(PIXELS * near / pixels, most), most)
