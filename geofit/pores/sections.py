"""Sections of windows: area, width, middle, and the flow that a straight duct of this section would carry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geofit.pores.packed import PackedSpace
from geofit.pores.projections import section_ducts
from geofit.pores.spots import widest_balls
from geofit.pores.windows import Windows

__all__ = ["PoreSections", "measure_sections"]


class PoreSections(NamedTuple):
    """One row a window; lengths in units of the shortest voxel edge, ``middle`` in indices."""

    radius: NDArray[np.float64]
    inscribed: NDArray[np.float64]
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    middle: NDArray[np.float64]
    conductance: NDArray[np.float64]


def measure_sections(
    windows: Windows,
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    edges: NDArray[np.float64],
    radius_at: NDArray[np.float64],
    *,
    in_faces: bool,
) -> PoreSections:
    """Return the sections of windows.

    Parameters
    ----------
    windows : Windows
    space : PackedSpace
        The pore space.
    pore_of : ndarray of int32
        Number of the pore of each pore voxel, counted from 1.
    edges : ndarray of float, shape (3,)
        Edge lengths of a voxel, in units of the shortest one.
    radius_at : ndarray of float
        Radius of a ball of each level.
    in_faces : bool
        Whether the windows lie in the sample's faces or between pores.
    """
    count = len(windows.first)
    if count == 0:
        empty = np.zeros(0)
        return PoreSections(empty, empty, empty, empty, np.zeros((0, 3)), empty)
    begin = windows.start[:-1]
    face_area = edges.prod() / edges
    radius = radius_at[np.maximum.reduceat(windows.level, begin)]
    vector = np.zeros((count, 3))
    for axis in range(3):
        turned = np.where(windows.axis == axis, windows.sign, 0) * face_area[axis]
        vector[:, axis] = np.add.reduceat(turned, begin)
    # A window that closes on itself has no border curve, and so no vector; it is at least as wide as its ball.
    area = np.maximum(np.linalg.norm(vector, axis=1), np.maximum(np.pi * radius**2, face_area.min()))
    index = np.stack(np.unravel_index(windows.voxel, tuple(space.shape.tolist())), axis=1).astype(np.float64)
    index[np.arange(len(index)), windows.axis] += np.where(in_faces & (windows.sign < 0), -0.5, 0.5)
    faces = np.diff(windows.start)
    middle = np.stack([np.add.reduceat(index[:, axis], begin) for axis in range(3)], axis=1) / faces[:, None]
    conductance, perimeter = section_ducts(space, pore_of, windows, vector, edges, in_faces)
    inscribed = np.maximum(_inscribed(windows, index, vector, space, edges) - 0.5, radius)
    return PoreSections(radius, inscribed, area, perimeter, middle, conductance)


def _inscribed(
    windows: Windows,
    index: NDArray[np.float64],
    vector: NDArray[np.float64],
    space: PackedSpace,
    edges: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the distance to the rock from the best place of each window near the middle of its widest faces."""
    begin, faces = windows.start[:-1], np.diff(windows.start)
    widest = windows.level == np.repeat(np.maximum.reduceat(windows.level, begin), faces)
    count = np.add.reduceat(widest.astype(np.int64), begin)
    middle = np.stack([np.add.reduceat(index[:, axis] * widest, begin) for axis in range(3)], axis=1) / count[:, None]
    gap = np.where(widest, (((index - np.repeat(middle, faces, axis=0)) * edges) ** 2).sum(axis=1), np.inf)
    window = np.repeat(np.arange(len(begin)), faces)
    # Faces at the same distance all count, or the order of the axes would decide.
    start = np.flatnonzero(gap <= np.repeat(np.minimum.reduceat(gap, begin), faces) + 1e-9)
    normal = vector / np.maximum(np.linalg.norm(vector, axis=1), 1e-9)[:, None]
    found = widest_balls(index[start], normal[window[start]], space, edges)
    return np.asarray(np.maximum.reduceat(found, np.searchsorted(window[start], np.arange(len(begin)))))
