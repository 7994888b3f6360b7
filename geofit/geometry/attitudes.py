"""Attitudes of planes: normals, the mean of many, and their picture on a stereonet.

The net is Schmidt's: Lambert's equal-area projection of the lower hemisphere, so that equal numbers of poles fill equal
areas (W. Schmidt 1925; N. I. Fisher, T. Lewis, B. J. J. Embleton, *Statistical Analysis of Spherical Data*, 1987,
sec. 2.4 and 3.2). East is x, north is y, the rim is the circle of radius 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["attitudes", "great_circle", "mean_plane", "plane_normals", "poles", "projected"]

Floats = NDArray[np.float64]


def plane_normals(azimuth: Floats, dip: Floats) -> Floats:
    """Return the upward unit normals (n, 3) of planes that dip towards ``azimuth``, both (n,) degrees.

    Examples
    --------
    >>> plane_normals(np.array([90.0]), np.array([45.0])).round(4).tolist()
    [[0.7071, 0.0, 0.7071]]
    """
    a, d = np.radians(azimuth), np.radians(dip)
    return np.stack([np.sin(a) * np.sin(d), np.cos(a) * np.sin(d), np.cos(d)], axis=1)


def attitudes(normals: Floats) -> tuple[Floats, Floats]:
    """Return azimuth and dip, both (n,) degrees, of planes with normals (n, 3) of either sign."""
    up = normals * np.where(normals[:, 2:] < 0, -1.0, 1.0)
    azimuth = np.degrees(np.arctan2(up[:, 0], up[:, 1])) % 360.0
    return azimuth, np.degrees(np.arctan2(np.hypot(up[:, 0], up[:, 1]), up[:, 2]))


def projected(directions: Floats) -> Floats:
    """Return (n, 2) places on the net of unit vectors (n, 3); those that point up are turned to the other side."""
    down = directions * np.where(directions[:, 2:] > 0, -1.0, 1.0)
    return np.asarray(down[:, :2] / np.sqrt(1.0 - down[:, 2:]))


def poles(azimuth: Floats, dip: Floats) -> Floats:
    """Return the (n, 2) places of the poles of planes.

    Examples
    --------
    A plane that dips gently to the east has its pole a little west of the middle.

    >>> float(poles(np.array([90.0]), np.array([10.0]))[0, 0].round(3))
    -0.123
    """
    return projected(plane_normals(azimuth, dip))


def great_circle(azimuth: float, dip: float, count: int = 91) -> Floats:
    """Return ``count`` places (count, 2) along the trace of a plane, from rim to rim."""
    a, d = np.radians([azimuth, dip])
    strike = np.array([np.cos(a), -np.sin(a), 0.0])
    down = np.array([np.sin(a) * np.cos(d), np.cos(a) * np.cos(d), -np.sin(d)])
    turn = np.linspace(0.0, np.pi, count)[:, None]
    return projected(np.cos(turn) * strike + np.sin(turn) * down)


def mean_plane(azimuth: Floats, dip: Floats) -> tuple[float, float, float]:
    """Return azimuth and dip of the mean plane, and the mean angle of the planes from it, degrees.

    The mean pole is the axis of the largest eigenvalue of the orientation tensor, which takes a pole and its opposite
    for the same.
    """
    normals = plane_normals(azimuth, dip)
    axis = np.linalg.eigh(normals.T @ normals)[1][:, -1:].T
    mean_azimuth, mean_dip = attitudes(axis)
    angle = np.degrees(np.arccos(np.clip(np.abs(normals @ axis[0]), 0.0, 1.0)))
    return float(mean_azimuth[0]), float(mean_dip[0]), float(angle.mean())
