"""Volume and area of a body: from the field on a lattice, from meshes of two spacings, from curved triangles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Field
from geofit.implicit.foot import project_along_gradient
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh

__all__ = ["Extent", "curved_extent", "extent_of_samples", "extrapolated_extent"]

Floats = NDArray[np.float64]

#: The six tetrahedra of a cube: from corner (0, 0, 0) along the axes, in every order, to (1, 1, 1).
TETRAHEDRA = np.array([np.cumsum([[0, 0, 0], *np.eye(3, dtype=int)[list(p)]], axis=0) for p in permutations(range(3))])

#: Points and weights of a rule of degree 4 on a triangle (D. Dunavant, Int. J. Numer. Meth. Engng. 21, 1985).
OUTER, INNER = 0.091576213509771, 0.445948490915965
OUTER_WEIGHT, INNER_WEIGHT = 0.109951743655322, 0.223381589678011

#: Newton steps from the middle of an edge to the surface; share of an edge up to which a vertex lies on the surface.
MOVES = 4
ON = 1e-3


@dataclass(frozen=True)
class Extent:
    """Size of a body.

    Parameters
    ----------
    volume, area : float
        m3 and m2.
    volume_error, area_error : float
        Numerical error that the lattice may cause; 0 if it was not estimated.
    """

    volume: float
    area: float
    volume_error: float = 0.0
    area_error: float = 0.0


@arguments_checked
def extent_of_samples(values: NDArray[np.floating], lattice: Lattice) -> Extent:
    """Return volume and area of what is negative, with the samples linear in six tetrahedra a cell.

    Parameters
    ----------
    values : (nx, ny, nz) array
        Samples at the nodes, negative inside.
    lattice : Lattice
        The nodes.

    Returns
    -------
    Extent
        Exact for linear fields; error of order h^2 for smooth ones. The part of the body within the box counts.

    Raises
    ------
    SettingsError
        If there are more or fewer samples than nodes.

    Notes
    -----
    Integration over the simplices that a linear interface cuts: C. Min & F. Gibou, J. Comput. Phys. 226, 2007.
    """
    f = np.asarray(values)
    if f.shape != lattice.shape:
        raise SettingsError(
            message(
                "implicit.samples-wrong-shape",
                "the samples have shape {given}, the lattice {needed}: give one value a node",
                given=f.shape,
                needed=lattice.shape,
            )
        )
    cells = [slice(None, -1), slice(1, None)]
    corner = {(i, j, k): f[cells[i], cells[j], cells[k]] for i in (0, 1) for j in (0, 1) for k in (0, 1)}
    count = np.sum([c < 0 for c in corner.values()], axis=0, dtype=np.int8)
    full, mixed = int((count == 8).sum()), (count > 0) & (count < 8)
    part = {place: np.asarray(c[mixed], float) for place, c in corner.items()}
    volume, area = float(full), 0.0
    for tetrahedron in TETRAHEDRA:
        at = np.stack([part[tuple(p)] for p in tetrahedron], axis=1)
        order = np.argsort(at, axis=1, kind="stable")
        v, a = _cut(np.take_along_axis(at, order, axis=1), tetrahedron[order].astype(float))
        volume += v / 6
        area += a
    return Extent(volume * lattice.spacing**3, area * lattice.spacing**2)


def _cut(f: Floats, xyz: Floats) -> tuple[float, float]:
    """Sum of the negative parts (of 1) of tetrahedra and area of their cuts; values (n, 4) ascending."""
    negative = (f < 0).sum(axis=1)

    def share(rows: NDArray[np.bool_], i: int, j: int) -> Floats:
        return np.asarray(f[rows, i] / (f[rows, i] - f[rows, j]))

    def cut(rows: NDArray[np.bool_], i: int, j: int) -> Floats:
        return np.asarray(xyz[rows, i] + share(rows, i, j)[:, None] * (xyz[rows, j] - xyz[rows, i]))

    def triangle(a: Floats, b: Floats, c: Floats) -> float:
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)

    volume, area = float((negative == 4).sum()), 0.0
    one, two, three = (negative == n for n in (1, 2, 3))
    volume += float((share(one, 0, 1) * share(one, 0, 2) * share(one, 0, 3)).sum())
    area += triangle(cut(one, 0, 1), cut(one, 0, 2), cut(one, 0, 3))
    volume += float((1 - share(three, 3, 0) * share(three, 3, 1) * share(three, 3, 2)).sum())
    area += triangle(cut(three, 3, 0), cut(three, 3, 1), cut(three, 3, 2))
    # The wedge between edge 01 and the quadrilateral 02-03-13-12, as three tetrahedra.
    p, q, r, s = share(two, 0, 2), share(two, 0, 3), share(two, 1, 2), share(two, 1, 3)
    volume += float((p * q + q * r * (1 - p) + r * s * (1 - q)).sum())
    a, b, c, d = cut(two, 0, 2), cut(two, 0, 3), cut(two, 1, 3), cut(two, 1, 2)
    return volume, area + triangle(a, b, c) + triangle(a, c, d)


@arguments_checked
def extrapolated_extent(field: Field, lattice: Lattice, *, capped: bool = False) -> Extent:
    """Return volume and area from the meshes of a lattice and of every second node of it.

    Parameters
    ----------
    field : Field
        Negative inside.
    lattice : Lattice
        An odd number of nodes along each axis.
    capped : bool
        Close the body along the box where it leaves it; the extent is then that within the box.

    Returns
    -------
    Extent
        (4 V_h - V_2h) / 3, and |V_h - V_2h| / 3 as its error; the same for the area.

    Raises
    ------
    SettingsError
        If a number of nodes is even.
    """
    fine, coarse = (isosurface(field, grid, capped=capped) for grid in (lattice, lattice.coarse()))
    return Extent(
        (4 * fine.volume - coarse.volume) / 3,
        (4 * fine.area - coarse.area) / 3,
        abs(fine.volume - coarse.volume) / 3,
        abs(fine.area - coarse.area) / 3,
    )


@arguments_checked
def curved_extent(field: Field, mesh: TriangleMesh) -> Extent:
    """Return volume and area of a body by quadratic triangles: the middles of the edges are moved onto the surface.

    Parameters
    ----------
    field : Field
        phi, smooth at the surface.
    mesh : TriangleMesh
        Its closed surface mesh, vertices on phi = 0.

    Returns
    -------
    Extent
        Error of order h^4; what flat triangles differ from it is the error that is given. No triangles: 0.
    """
    if not len(mesh.triangles):
        return Extent(0.0, 0.0)
    middles = _curved_middles(field, mesh)
    keys = mesh.edges[:, 0] * len(mesh.vertices) + mesh.edges[:, 1]
    sides = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=-1)
    index = np.searchsorted(keys, sides.min(axis=2) * len(mesh.vertices) + sides.max(axis=2))
    origin = mesh.vertices.mean(axis=0)
    nodes = np.concatenate([mesh.corners, middles[index]], axis=1) - origin
    volume = area = 0.0
    for spot, weight in ((OUTER, OUTER_WEIGHT), (INNER, INNER_WEIGHT)):
        for turn in range(3):
            r, s, t = np.roll([1 - 2 * spot, spot, spot], turn)
            shape = np.array([r * (2 * r - 1), s * (2 * s - 1), t * (2 * t - 1), 4 * r * s, 4 * s * t, 4 * t * r])
            by_s = np.array([1 - 4 * r, 4 * s - 1, 0, 4 * (r - s), 4 * t, -4 * t])
            by_t = np.array([1 - 4 * r, 0, 4 * t - 1, -4 * s, 4 * s, 4 * (r - t)])
            x = np.einsum("i,nij->nj", shape, nodes)
            normal = np.cross(np.einsum("i,nij->nj", by_s, nodes), np.einsum("i,nij->nj", by_t, nodes))
            volume += weight / 2 * float((x * normal).sum()) / 3
            area += weight / 2 * float(np.linalg.norm(normal, axis=1).sum())
    return Extent(volume, area, abs(volume - mesh.volume), abs(area - mesh.area))


def _curved_middles(field: Field, mesh: TriangleMesh) -> Floats:
    """Return the middles (n, 3) of the edges, moved onto the surface where their ends lie on it and it is near."""
    a, b = mesh.vertices[mesh.edges[:, 0]], mesh.vertices[mesh.edges[:, 1]]
    if not len(a):
        return a
    straight, length = (a + b) / 2, np.linalg.norm(b - a, axis=1)
    middles = project_along_gradient(field, straight, reach=float(length.max()) / 4, steps=MOVES)
    slope = np.linalg.norm(field.gradient(mesh.vertices), axis=1)
    on = np.abs(field.value(mesh.vertices)) <= ON * float(length.mean()) * slope
    curved = on[mesh.edges].all(axis=1) & (np.linalg.norm(middles - straight, axis=1) <= length / 4)
    return np.where(curved[:, None], middles, straight)
