"""Even samples of a surface by particles that repel each other and stay on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Field, normals
from geofit.implicit.foot import project_along_gradient
from geofit.implicit.mesh import TriangleMesh

__all__ = ["even_samples"]

Floats = NDArray[np.float64]

ROUNDS = 40
#: Reach of the repulsion in mean distances of the particles, and the largest move of a round.
REACH, MOVE = 1.6, 0.25


@arguments_checked
def even_samples(field: Field, mesh: TriangleMesh, count: int, *, seed: int = 0) -> tuple[Floats, Floats]:
    """Return points spread evenly over the surface of a field, and the normals there.

    Parameters
    ----------
    field : Field
        phi.
    mesh : TriangleMesh
        Its surface mesh, from which the first places are drawn by area.
    count : int
        Number of points.
    seed : int
        Of the first places.

    Returns
    -------
    (count, 3) array, (count, 3) array
        Points on phi = 0, metres, and outward unit normals.

    Raises
    ------
    SettingsError
        If the mesh is empty or ``count`` below 1.

    Notes
    -----
    After A. Witkin & P. Heckbert, Using particles to sample and control implicit surfaces, SIGGRAPH 1994, with a
    Gaussian repulsion of a fixed width and a projection after every move; without birth and death, as the area is
    known.
    """
    from scipy.spatial import KDTree

    count = int(count)
    if seed < 0:
        raise SettingsError(
            message("implicit.seed-negative", "The seed is {seed}; give a whole number of 0 or more.", seed=seed)
        )
    if count < 1 or not len(mesh.triangles):
        raise SettingsError(
            message(
                "implicit.points-not-spreadable",
                "{count} points cannot be spread over {triangles} triangles: give at least one of each",
                count=count,
                triangles=len(mesh.triangles),
            )
        )
    rng = np.random.default_rng(seed)
    areas = np.cumsum(mesh.areas)
    # One draw in every equal share of the area: more even than independent ones.
    share = (np.arange(count) + rng.uniform(size=count)) / count * areas[-1]
    corners = mesh.corners[np.minimum(np.searchsorted(areas, share), len(areas) - 1)]
    a, b = np.sqrt(rng.uniform(size=count)), rng.uniform(size=count)
    weight = np.stack([1 - a, a * (1 - b), a * b], axis=1)
    distance = float(np.sqrt(areas[-1] / count))
    x = project_along_gradient(field, (weight[:, :, None] * corners).sum(axis=1), reach=distance)
    for round_ in range(ROUNDS):
        pairs = KDTree(x).query_pairs(REACH * distance, output_type="ndarray")
        apart = x[pairs[:, 0]] - x[pairs[:, 1]]
        push = np.exp(-2 * (apart**2).sum(axis=1) / distance**2)[:, None] * apart
        force = np.zeros_like(x)
        np.add.at(force, pairs[:, 0], push)
        np.add.at(force, pairs[:, 1], -push)
        normal = normals(field, x)
        force -= (force * normal).sum(axis=1)[:, None] * normal
        # Steps shorten with the rounds: the particles come to rest.
        force *= 1 - round_ / ROUNDS
        size = np.linalg.norm(force, axis=1)
        force *= np.minimum(1, MOVE * distance / np.where(size > 0, size, 1.0))[:, None]
        x = project_along_gradient(field, x + force, reach=distance, steps=3)
    x = project_along_gradient(field, x, reach=distance)
    return x, normals(field, x)
