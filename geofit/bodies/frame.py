"""The coordinates in which a body is fitted: about a local origin, with the anisotropy as a metric."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.settings import BodySettings

__all__ = ["BodyFrame"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BodyFrame:
    """``fitted = matrix @ (map - origin)``; the matrix holds the anisotropy and brings the box to a size of about one.

    Parameters
    ----------
    origin : (3,) array
        Map coordinates of the local origin, whole metres.
    matrix : (3, 3) array
        From metres to fitted coordinates.
    """

    origin: Floats
    matrix: Floats

    @classmethod
    def around(cls, lower: Floats, upper: Floats, settings: BodySettings) -> BodyFrame:
        """Return the frame of a box, given by its corners, with the anisotropy of the settings.

        Lengths along the major axis count least; their product over the three axes stays, so that distances in the
        fitted coordinates are comparable with metres.
        """
        azimuth, dip, rake = np.radians([settings.azimuth, settings.dip, settings.rake])
        down = np.array([np.sin(azimuth) * np.cos(dip), np.cos(azimuth) * np.cos(dip), -np.sin(dip)])
        right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
        major = np.cos(rake) * down + np.sin(rake) * right
        middle = -np.sin(rake) * down + np.cos(rake) * right
        axes = np.array([major, middle, np.cross(major, middle)])
        ranges = np.array(settings.ranges) / np.prod(settings.ranges) ** (1 / 3)
        size = max(float((upper - lower).max()) / 2, 1e-9)
        # Isotropic: the axes do not matter, and the plain diagonal keeps the figures free of their rounding.
        matrix = np.eye(3) if np.ptp(ranges) == 0 else axes.T @ (axes / ranges[:, None])
        return cls(np.round((lower + upper) / 2), matrix / size)

    @property
    def size(self) -> float:
        """Metres per unit of the fitted coordinates: the cube root of the volume of a unit cube."""
        return float(np.linalg.det(self.matrix) ** (-1 / 3))

    def to_fit(self, xyz: Floats) -> Floats:
        """Return (n, 3) fitted coordinates of (n, 3) map coordinates."""
        return np.asarray((xyz - self.origin) @ self.matrix.T)

    def to_map(self, fitted: Floats) -> Floats:
        """Return (n, 3) map coordinates of (n, 3) fitted coordinates."""
        return np.asarray(np.linalg.solve(self.matrix, fitted.T).T + self.origin)

    def gradient(self, fitted: Floats) -> Floats:
        """Return gradients per metre of (n, 3) gradients per fitted unit."""
        return np.asarray(fitted @ self.matrix)

    def gradient_to_fit(self, gradient: Floats) -> Floats:
        """Return gradients per fitted unit of (n, 3) gradients per metre."""
        return np.asarray(np.linalg.solve(self.matrix.T, gradient.T).T)
