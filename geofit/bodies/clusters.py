"""Data that lie together: outlines fill their sections densely, and say nothing about the ground between them.

A contact that is left out of an outline is known from its neighbours along it, however far the next section is: the
scale of the random field found so is that of the drawing. Here a section is left out as a whole (Roberts et al.,
"Cross-validation strategies for data with temporal, spatial, hierarchical, or phylogenetic structure", Ecography 40,
2017), by blocks of the inverse of the fit's own system (Dubrule, Math. Geol. 15, 1983).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import BodyData
from geofit.bodies.rbf import Saddle

__all__ = ["block_scale", "fills_planes", "sections_of"]

Floats = NDArray[np.float64]

#: The second size of data that fill a plane, as a share of the first; along a hole it is about 0.
FLAT = 0.2


def fills_planes(xyz: Floats) -> bool:
    """Return whether places (n, 3) of one name fill a plane, as an outline does, and do not follow a line."""
    sizes = np.linalg.svd(xyz - xyz.mean(axis=0), compute_uv=False)
    return bool(len(sizes) > 1 and sizes[1] > FLAT * sizes[0])


def sections_of(data: BodyData, places: Floats) -> NDArray[np.str_] | None:
    """Return the section (n,) of each of (n, 3) places that are data, "" of others; None where the data are of holes.

    Parameters
    ----------
    data : BodyData
        The data with the names of their holes or sections.
    places : (n, 3) array
        Places in map coordinates, metres.
    """
    from scipy.spatial import cKDTree

    xyz = np.concatenate([data.contacts, data.inside, data.outside])
    names = np.concatenate([data.hole, data.inside_hole, data.outside_hole])
    known = np.unique(data.hole)
    if len(known) < 2 or (known == "").any() or not all(fills_planes(xyz[names == name]) for name in known):
        return None
    # Coincident contacts are one at their middle, which is nearer to them than any two data are to each other.
    far, near = cKDTree(xyz - xyz[0]).query(places - xyz[0])
    return np.asarray(np.where(far <= 1e-3, names[near], ""), np.str_)


def block_scale(system: Saddle, weights: Floats, contacts: int, section: NDArray[np.str_]) -> float:
    """Return the root mean square of sections' left-out errors over their unit standard deviations.

    Parameters
    ----------
    system : Saddle
        The system of the fit; its first ``contacts`` points are contacts.
    weights : (n,) array
        Weights of the points in the fitted field.
    contacts : int
        Number of contacts.
    section : (n,) array of str
        Section of each point, "" of none; all points of one are left out together.
    """
    count = len(system.points)
    size = count + 3 * len(system.oriented)
    precision = system.solve(np.eye(size, count))[:count]
    squares = []
    for name in np.unique(section[:contacts][section[:contacts] != ""]):
        own = np.flatnonzero(section == name)
        covariance = np.linalg.inv(precision[np.ix_(own, own)])
        on = own < contacts
        error = (covariance @ weights[own])[on]
        squares.append(float(np.mean(error**2 / np.maximum(np.diag(covariance)[on], 1e-300))))
    # Each section counts once, whatever the length of its outlines.
    return float(np.sqrt(np.mean(squares)))
