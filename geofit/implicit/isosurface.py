"""The surface of an implicit body as a closed triangle mesh.

Lorensen & Cline's two steps, cells of a lattice and polygons in each cell, here by VTK's flying edges. It sees only the
signs of the nodes; a vertex is then the root of the field on its edge of the lattice, so that it lies on the surface to
rounding, stays in its cell, and is the same whether its block or the whole lattice is polygonised. Blocks in which the
field is known to keep its sign (:func:`geofit.implicit.field.range_in`) are not evaluated. Where places of the surface
are known, only blocks to which it leads from there are (Wyvill, McPheeters & Wyvill, *Data structure for soft objects*,
1986: continuation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError, SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.clean import collapse_slivers
from geofit.implicit.field import Field, points_of, range_in
from geofit.implicit.lattice import BATCH, Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.implicit.roots import roots_between

__all__ = ["isosurface", "isosurface_of_blocks", "isosurface_of_samples", "open_sides"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Cells of a block along each axis.
BLOCK = 8
#: Vertices of samples stay this part of an edge away from its nodes: otherwise triangles at a node have no area.
NODE_GAP = 1e-3
#: Triangles below this area (in h^2) are collapsed.
SLIVER = 1e-7
SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")


@arguments_checked
def isosurface(
    field: Field, lattice: Lattice, *, capped: bool = False, slivers: bool = False, near: Floats | None = None
) -> TriangleMesh:
    """Return the surface on which a field is zero.

    Parameters
    ----------
    field : Field
        Negative inside.
    lattice : Lattice
        Nodes; parts of the body thinner than their spacing may be lost.
    capped : bool
        Close the body along the box of the lattice where it leaves it. Otherwise the mesh ends there, and
        :func:`open_sides` names the sides.
    slivers : bool
        Leave triangles without area in the mesh: enough where only its volume and area are wanted.
    near : (n, 3) array, optional
        Places on or near every part of the surface: it is followed from there, and looked for nowhere else. Fine
        lattices have few cells with surface, and a field without bounds would be evaluated in all.

    Returns
    -------
    TriangleMesh
        Vertices on the surface; normals outwards; empty if the field has one sign at all nodes.

    Raises
    ------
    FitError
        If the field is NaN at a node.
    """
    open_to = _may_hold_surface(field, lattice, capped)
    if near is None:
        blocks = BLOCK * np.argwhere(open_to) - int(capped)
        values = _samples(field, lattice, blocks)
    else:
        blocks, values = _followed(field, lattice, capped, open_to, points_of(near))
    crossed = _crossings(values, blocks, np.array(lattice.shape) - 1 + int(capped))
    start = lattice.origin + lattice.spacing * crossed.node
    share = np.where(np.isinf(crossed.low), 1.0, 0.0)
    between = np.isfinite(crossed.low) & np.isfinite(crossed.high)
    step = lattice.spacing * np.eye(3)[crossed.axis]
    share[between] = roots_between(field, start[between], step[between], crossed.low[between], crossed.high[between])
    mesh = TriangleMesh(start + share[:, None] * step, crossed.triangles)
    if slivers:
        return mesh
    return collapse_slivers(mesh, SLIVER * lattice.spacing**2, lattice.spacing)


@arguments_checked
def isosurface_of_samples(values: NDArray[np.floating], lattice: Lattice, *, capped: bool = False) -> TriangleMesh:
    """Return the surface on which stored samples are zero, linear along the edges of the lattice.

    Parameters
    ----------
    values : (nx, ny, nz) array
        Samples at the nodes, negative inside; zero counts as outside.
    lattice : Lattice
        The nodes.
    capped : bool
        Close the body along the box of the lattice.

    Raises
    ------
    SettingsError
        If there are more or fewer samples than nodes.
    FitError
        If a sample is NaN.
    """
    samples = np.asarray(values)
    if samples.shape != lattice.shape:
        raise SettingsError(
            message(
                "implicit.samples-wrong-shape",
                "the samples have shape {given}, the lattice {needed}: give one value a node",
                given=samples.shape,
                needed=lattice.shape,
            )
        )
    if capped:
        samples = np.pad(samples, 1, constant_values=np.inf)
    crossed = _crossings(samples[None].transpose(0, 3, 2, 1), np.full((1, 3), -int(capped)), None)
    mesh = _linear(crossed, lattice)
    return collapse_slivers(mesh, SLIVER * lattice.spacing**2, lattice.spacing) if capped else mesh


@arguments_checked
def isosurface_of_blocks(values: NDArray[np.floating], blocks: Ints, lattice: Lattice) -> TriangleMesh:
    """Return the surface on which samples of some blocks are zero, linear along the edges of the lattice.

    Parameters
    ----------
    values : (k, b, b, b) array
        Samples of each block of b nodes an edge, x fastest (last), negative inside; neighbours share a layer of nodes.
    blocks : (k, 3) array of int
        First node (x, y, z) of each block.
    lattice : Lattice
        The nodes.

    Returns
    -------
    TriangleMesh
        The mesh of :func:`isosurface_of_samples` if every block with both signs is given.

    Raises
    ------
    FitError
        If a sample is NaN.
    """
    return _linear(_crossings(values, blocks, np.array(lattice.shape) - 1), lattice)


def _linear(crossed: _Crossed, lattice: Lattice) -> TriangleMesh:
    """Return triangles with vertices where samples are zero on straight lines between nodes."""
    start = lattice.origin + lattice.spacing * crossed.node
    low, high = np.abs(crossed.low), np.abs(crossed.high)
    with np.errstate(invalid="ignore"):
        share = np.clip(low / (low + high), NODE_GAP, 1 - NODE_GAP)
    share[np.isinf(high)], share[np.isinf(low)] = 0.0, 1.0
    start[np.arange(len(start)), crossed.axis] += lattice.spacing * share
    return TriangleMesh(start, crossed.triangles)


@arguments_checked
def open_sides(mesh: TriangleMesh, lattice: Lattice) -> tuple[str, ...]:
    """Return the sides of the box, such as "-x" or "+z", at which a mesh ends; empty for a closed one."""
    ends = mesh.vertices[mesh.boundary_edges].mean(axis=1)
    low, high = lattice.bounds
    near = 1e-6 * lattice.spacing
    touched = np.stack([ends - low < near, high - ends < near], axis=-1).reshape(len(ends), 6)
    return tuple(side for side, reached in zip(SIDES, np.any(touched, axis=0).tolist(), strict=True) if reached)


@dataclass(frozen=True, eq=False)
class _Crossed:
    """Edges of the lattice with a change of sign, and triangles between them."""

    node: Ints
    axis: Ints
    low: Floats
    high: Floats
    triangles: Ints


def _nodes(blocks: Ints) -> Ints:
    """Nodes of blocks given by their first node, (k, 9, 9, 9, 3), x fastest as VTK stores them."""
    local = np.stack(np.meshgrid(*[np.arange(BLOCK + 1)] * 3, indexing="ij"), axis=-1)[..., ::-1]
    return np.asarray(blocks[:, None, None, None] + local)


def _inside(blocks: Ints, lattice: Lattice) -> NDArray[np.bool_]:
    """Return which nodes of blocks the lattice has, (k, 9, 9, 9), x fastest."""
    along = blocks[:, :, None] + np.arange(BLOCK + 1)
    has = (along >= 0) & (along < np.array(lattice.shape)[:, None])
    return np.asarray(has[:, 2, :, None, None] & has[:, 1, None, :, None] & has[:, 0, None, None, :])


def _may_hold_surface(field: Field, lattice: Lattice, capped: bool) -> NDArray[np.bool_]:
    """Return which blocks along x, y and z may hold both signs; the first begins a node early if the body is capped."""
    first, extra = (-1, 2) if capped else (0, 0)
    counts = [-(-(n - 1 + extra) // BLOCK) for n in lattice.shape]
    blocks = first + BLOCK * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    last = np.array(lattice.shape) - 1
    lower = lattice.origin + lattice.spacing * np.clip(blocks, 0, last)
    upper = lattice.origin + lattice.spacing * np.clip(blocks + BLOCK, 0, last)
    lowest, highest = range_in(field, lower, upper)
    if capped:
        outer = ((blocks < 0) | (blocks + BLOCK > last)).any(axis=1)
        highest = np.where(outer, np.inf, highest)
    # Written so that NaN keeps a block: it is reported where it is evaluated.
    return np.asarray(~((lowest > 0) | (highest < 0))).reshape(counts)


def _samples(field: Field, lattice: Lattice, blocks: Ints) -> Floats:
    """Return the field at the nodes of blocks, (k, 9, 9, 9), x fastest; infinite where the lattice has no node."""
    values = np.full((len(blocks), BLOCK + 1, BLOCK + 1, BLOCK + 1), np.inf)
    batch = max(1, BATCH // (BLOCK + 1) ** 3)
    for first in range(0, len(blocks), batch):
        nodes = _nodes(blocks[first : first + batch])
        part = np.full(nodes.shape[:-1], np.inf)
        inside = _inside(blocks[first : first + batch], lattice)
        part[inside] = field.value(lattice.origin + lattice.spacing * nodes[inside])
        values[first : first + batch] = part
    return values


def _followed(
    field: Field, lattice: Lattice, capped: bool, open_to: NDArray[np.bool_], near: Floats
) -> tuple[Ints, Floats]:
    """Return the blocks that hold the places, and those to which a change of sign leads from them, with their nodes.

    A surface leaves a block where a side of it has nodes of both signs. The order is that of the lattice.
    """
    at = (near - lattice.origin) / lattice.spacing + int(capped)
    waiting = np.zeros(open_to.shape, bool)
    for shift in np.ndindex(2, 2, 2):  # the surface may lie on either side of a place, a cell away
        block = ((at + 2 * np.array(shift) - 1) // BLOCK).astype(int)
        waiting[tuple(np.clip(block, 0, np.array(open_to.shape) - 1).T)] = True
    left, found, samples = open_to.copy(), [], []
    while len(index := np.argwhere(waiting & left)):
        left &= ~waiting
        values = _samples(field, lattice, BLOCK * index - int(capped))
        found.append(index)
        samples.append(values)
        waiting = np.zeros(open_to.shape, bool)
        for axis in range(3):
            for side, step in ((0, -1), (BLOCK, 1)):
                nodes = values.take(side, axis=3 - axis).reshape(len(values), -1)
                leads = ((nodes < 0).any(axis=1)) & ((nodes >= 0).any(axis=1))
                next_to = index[leads] + step * np.eye(3, dtype=int)[axis]
                next_to = next_to[(next_to[:, axis] >= 0) & (next_to[:, axis] < open_to.shape[axis])]
                waiting[tuple(next_to.T)] = True
    if not found:
        return np.zeros((0, 3), np.int64), _samples(field, lattice, np.zeros((0, 3), np.int64))
    blocks, values = np.concatenate(found), np.concatenate(samples)
    order = np.lexsort(blocks.T[::-1])
    return BLOCK * blocks[order] - int(capped), values[order]


def _crossings(values: NDArray[np.floating], blocks: Ints, end: Ints | None) -> _Crossed:
    """Polygonise blocks of one shape.

    Parameters
    ----------
    values : (k, nz, ny, nx) array
        Samples of each block.
    blocks : (k, 3) array of int
        First node (x, y, z) of each block.
    end : (3,) array of int, optional
        Cells from this one on are left out; None if the blocks have none to leave out.
    """
    if np.isnan(values).any():
        raise FitError(
            message(
                "implicit.field-not-finite",
                "the field is not a number at {count} nodes: check its data and its box",
                count=int(np.isnan(values).sum()),
            )
        )
    _, nz, ny, nx = values.shape
    points, triangles = _flying_edges(values)
    # Blocks lie above each other in one image; the layer of cells between two of them means nothing.
    sums = points[triangles].sum(axis=1)
    block, layer = np.divmod(sums[:, 2] // 6, nz)
    keep = layer < nz - 1
    cell = np.stack([sums[:, 0] // 6, sums[:, 1] // 6, layer], axis=1) + blocks[block]
    if end is not None:
        keep &= (cell < end).all(axis=1)
    triangles, cell = triangles[keep], cell[keep]

    base = points // 2
    axis = np.argmax(points % 2, axis=1)
    block, layer = np.divmod(base[:, 2], nz)
    node = np.stack([base[:, 0], base[:, 1], layer], axis=1) + blocks[block]
    low = node.min(axis=0, initial=0)
    span = node.max(axis=0, initial=0) - low + 2
    key = np.ravel_multi_index(tuple((node - low).T), tuple(span)) * 3 + axis
    used = np.zeros(len(points), bool)
    used[triangles] = True
    used_at = np.nonzero(used)[0]
    _, first, index = np.unique(key[used_at], return_index=True, return_inverse=True)
    new = np.zeros(len(points), np.int64)
    new[used_at] = index
    order = np.argsort(np.ravel_multi_index(tuple((cell - low).T), tuple(span)), kind="stable")
    at = used_at[first]
    x, y, z = base[at].T
    step = np.eye(3, dtype=np.int64)[axis[at]]
    stacked = values.reshape(-1, ny, nx)
    return _Crossed(
        node=node[at],
        axis=axis[at],
        low=np.asarray(stacked[z, y, x], float),
        high=np.asarray(stacked[z + step[:, 2], y + step[:, 1], x + step[:, 0]], float),
        triangles=new[triangles[order]],
    )


def _flying_edges(values: NDArray[np.floating]) -> tuple[Ints, Ints]:
    """Vertices in half steps of the stacked image (one odd coordinate each), and triangles with outward normals."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

    none = np.zeros((0, 3), np.int64)
    if not values.size:
        return none, none
    ny, nx = values.shape[2:]
    signs = np.where(values < 0, np.int8(-1), np.int8(1)).ravel()
    image = vtkImageData()
    image.SetDimensions(nx, ny, signs.size // (nx * ny))
    image.GetPointData().SetScalars(numpy_to_vtk(signs))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.ComputeNormalsOff()
    edges.ComputeGradientsOff()
    edges.ComputeScalarsOff()
    edges.SetValue(0, 0.0)
    edges.Update()
    surface = edges.GetOutput()
    if not surface.GetNumberOfPoints():
        return none, none
    points = np.rint(2.0 * vtk_to_numpy(surface.GetPoints().GetData())).astype(np.int64)
    triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).astype(np.int64).reshape(-1, 3)
    return points, triangles[:, ::-1]
