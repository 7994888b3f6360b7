"""The triangles of a horizon for drawing, with what they can be coloured by. Numbers only: it may run in a worker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geofit.data.accuracy import Seam
from geofit.data.prediction import Uncertainty
from geofit.data.site import Ground
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.cells import tabulate
from geofit.geometry.mesh import Mesh, Tolerance, cell_boxes, triangle_count
from geofit.gui.view3d.sight import Sight
from geofit.report.view import trimmed
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["Shape", "next_below", "sd_at", "seam_lines", "shape_of", "split", "thinned", "too_coarse"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Chordal tolerance of the still picture as a share of the surface's width; triangles of the moving one, at most
#: about: software draws some 20,000 in the time of a frame.
FINE, FEW = 1 / 8_000, 1_000
#: Of more triangles than these the moving ones are not thinned, but made anew from about so many.
MANY = 4_000
#: Where a view asks for more triangles of one surface its tolerance is doubled, at most to so many times.
MOST, LAST = 300_000, 2.0**20
#: Vertices at which two horizons are compared to find the one below.
PROBES = 200
#: The one below lies under at least this share of them: a short fault is not meant.
COMMON = 0.3


@dataclass(frozen=True, eq=False)
class Shape:
    """Triangles in map coordinates with unit normals at the vertices (upwards), metres; ``coarse`` while moving."""

    xyz: Floats
    triangles: Ints
    normals: Floats
    coarse: Shape | None = None

    @property
    def dip(self) -> Floats:
        """Angle below the horizontal at each vertex, degrees."""
        return np.asarray(np.degrees(np.arccos(np.clip(np.abs(self.normals[:, 2]), 0.0, 1.0))))

    def lifted(self, by: Floats, way: Floats) -> Shape:
        """Return the vertices moved by (n,) metres along a unit vector (3,), without those that are nan."""
        known = np.isfinite(by)
        number = np.cumsum(known) - 1
        keep = self.triangles[known[self.triangles].all(axis=1)]
        return Shape(self.xyz[known] + by[known, None] * way, number[keep], self.normals[known])


def shape_of(surface: HorizonFit, sight: Sight | None = None, fine: float = FINE) -> Shape:
    """Return triangles within ``fine`` of the width of a surface, in sight within half a pixel; and coarse ones."""
    most, times = fine * _width(surface), 1.0
    tolerance: Tolerance = most
    if sight is not None:
        tolerance = _looked_at(sight, times, most)
        while triangle_count(surface.patches, surface.origin, tolerance) > MOST and times < LAST:
            times *= 2
            tolerance = _looked_at(sight, times, most)
    shape = rough = _shape(surface, surface.triangulate(tolerance))
    if len(shape.triangles) > MANY and isinstance(surface.surface, PatchSurface):
        lines = max(int((MANY / 2 / len(surface.patches)) ** 0.5), 3)
        straight = replace(surface.surface, patches=tuple(_straight(patch, lines) for patch in surface.patches))
        rough = _shape(surface, straight.triangulate(_width(surface)))
    return Shape(shape.xyz, shape.triangles, shape.normals, thinned(rough))


def _straight(patch: Patch, lines: int) -> Patch:
    """Return what is bilinear between so many lines of a patch each way, with the same parameters."""
    u, v = (
        np.interp(np.linspace(0, len(breaks) - 1, lines), np.arange(len(breaks)), breaks)
        for breaks in (np.unique(patch.knots_u), np.unique(patch.knots_v))
    )
    knots_u, knots_v = (np.concatenate([[t[0]], t, [t[-1]]]) for t in (u, v))
    return Patch(patch.name, (1, 1), knots_u, knots_v, patch.evaluate(u[:, None], v[None]))


def _looked_at(sight: Sight, times: float, most: float) -> Tolerance:
    return lambda low, high: np.minimum(times * sight.tolerance(low, high, most), most)


def too_coarse(surface: HorizonFit, sight: Sight, before: Sight | None) -> bool:
    """Return whether a surface that was triangulated for one view (None: for none) needs more triangles for another.

    Somewhere in sight its tolerance is then more than twice what the view asks for.
    """
    most = FINE * _width(surface)
    for patch in surface.patches:
        low, high = (end.reshape(-1, 3) for end in cell_boxes(patch, surface.origin))
        has = np.full(len(low), most) if before is None else before.tolerance(low, high, most)
        if (has > 2 * sight.tolerance(low, high, most)).any():
            return True
    return False


def thinned(shape: Shape) -> Shape:
    """Return about FEW triangles whose corners are among the shape's (Schroeder et al. 1992)."""
    if len(shape.triangles) <= FEW:
        return shape
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkDecimatePro

    from geofit.gui.view3d.actors import poly

    middle = shape.xyz.mean(axis=0)
    data = poly(shape.xyz - middle, faces=shape.triangles)
    few = vtkDecimatePro()
    few.SetInputData(data)
    few.SetTargetReduction(1 - FEW / len(shape.triangles))
    few.PreserveTopologyOn()
    few.BoundaryVertexDeletionOn()
    few.Update()
    made = few.GetOutput()
    places = vtk_to_numpy(made.GetPoints().GetData()).astype(float)
    triangles = vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int64)
    known = cKDTree(shape.xyz - middle).query(places)[1]
    return Shape(shape.xyz[known], triangles, shape.normals[known])


def split(shape: Shape, value: Floats) -> Shape:
    """Return triangles of which none crosses where a value (n,) at the vertices is 0; those that did are cut."""
    inside = value >= 0
    mixed = (
        inside[shape.triangles].any(axis=1)
        & ~inside[shape.triangles].all(axis=1)
        & np.isfinite(value)[shape.triangles].all(axis=1)
    )
    if not mixed.any():
        return Shape(shape.xyz, shape.triangles, shape.normals)
    cut = shape.triangles[mixed]
    # The corner that lies on the other side than the other two comes first; the turn stays.
    alone = np.where((inside[cut].sum(axis=1) == 1)[:, None], inside[cut], ~inside[cut]).argmax(axis=1)
    a, b, c = (np.take_along_axis(cut, ((alone + k) % 3)[:, None], axis=1).ravel() for k in range(3))
    share = [np.clip(value[a] / (value[a] - value[other]), 0.0, 1.0)[:, None] for other in (b, c)]
    places = [shape.xyz[a] + s * (shape.xyz[o] - shape.xyz[a]) for s, o in zip(share, (b, c), strict=True)]
    normals = [shape.normals[a] + s * (shape.normals[o] - shape.normals[a]) for s, o in zip(share, (b, c), strict=True)]
    normals = [n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-12) for n in normals]
    p = len(shape.xyz) + np.arange(len(cut))
    q = p + len(cut)
    pieces = [np.stack(three, axis=1) for three in ((a, p, q), (p, b, c), (p, c, q))]
    return Shape(
        np.concatenate([shape.xyz, *places]),
        np.concatenate([shape.triangles[~mixed], *pieces]),
        np.concatenate([shape.normals, *normals]),
    )


def _width(surface: HorizonFit) -> float:
    low, high = surface.bounds
    return max(float(np.linalg.norm(high - low)), 1e-3)


def _shape(surface: HorizonFit, mesh: Mesh) -> Shape:
    normals = _patch_normals(surface.patches, mesh) if surface.patches else _triangle_normals(mesh)
    lost = ~np.isfinite(normals).all(axis=1)
    normals[lost] = (0.0, 0.0, 1.0)
    normals *= np.where(normals[:, 2:] < 0, -1.0, 1.0)
    return Shape(mesh.xyz, mesh.triangles, normals)


def _patch_normals(patches: Sequence[Patch], mesh: Mesh) -> Floats:
    """Return normals of the surface itself, at one corner of each vertex."""
    # Of the corners of a vertex the first is assigned last.
    corner = np.full(len(mesh.points), -1)
    corner[mesh.triangles.ravel()[::-1]] = np.arange(mesh.triangles.size)[::-1]
    normals = np.full(mesh.points.shape, np.nan)
    cells = tabulate(patches)
    patch = np.where(corner >= 0, mesh.patch[corner // 3], -1)
    for k in range(len(patches)):
        mine = np.flatnonzero(patch == k)
        u, v = mesh.uv.reshape(-1, 2)[corner[mine]].T
        along, across = cells.slopes(cells.locate(k, u, v))
        cross = np.stack([along[i] * across[j] - along[j] * across[i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)
        length = np.linalg.norm(cross, axis=1, keepdims=True)
        normals[mine] = cross / np.where(length > 0, length, np.nan)
    return normals


def _triangle_normals(mesh: Mesh) -> Floats:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    total = np.zeros(mesh.points.shape)
    for k in range(3):
        np.add.at(total, mesh.triangles[:, k], cross)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.asarray(total / np.where(length > 0, length, np.nan))


def sd_at(uncertainty: Uncertainty, xyz: Floats) -> Floats:
    """Return the standard deviation at places, bilinear between the nodes of a grid over the map, nan outside."""
    if uncertainty.frame != "map":
        return np.full(len(xyz), np.nan)
    return Ground(uncertainty.x, uncertainty.y, uncertainty.sd).elevation(xyz[:, 0], xyz[:, 1])


def next_below(surface: HorizonFit, shape: Shape, others: Sequence[HorizonFit]) -> HorizonFit | None:
    """Return the horizon next below, by the median difference over common ground; None if there is none."""
    some = shape.xyz[:: max(len(shape.xyz) // PROBES, 1)]
    best, least = None, np.inf
    for other in others:
        if other is surface:
            continue
        apart = some[:, 2] - other.elevation(some[:, 0], some[:, 1])
        apart = apart[np.isfinite(apart)]
        if apart.size >= COMMON * len(some) and 0 < np.median(apart) < least:
            best, least = other, float(np.median(apart))
    return best


def seam_lines(surface: HorizonFit, seams: Sequence[Seam], samples: int = 60) -> list[list[Floats]]:
    """Return, for each seam, its lines inside the study area, (k, 3) map coordinates."""
    patches = {patch.name: patch for patch in surface.patches}
    found: list[list[Floats]] = []
    for seam in seams:
        first, second = patches.get(seam.first), patches.get(seam.second)
        if first is None or second is None:
            found.append([])
            continue
        ways, others = _rim(first, samples), _rim(second, samples)
        apart = [
            (min(np.linalg.norm(a[[0, -1]] - o, axis=1).max() for b in others for o in (b[[0, -1]], b[[-1, 0]])), k)
            for k, a in enumerate(ways)
        ]
        line = ways[min(apart)[1]] + surface.origin
        inside = trimmed(surface, line[:, 0], line[:, 1]) > -1e-6
        runs = np.split(np.arange(samples), np.flatnonzero(np.diff(inside)) + 1)
        found.append([line[run] for run in runs if inside[run[0]] and len(run) > 1])
    return found


def _rim(patch: Patch, samples: int) -> list[Floats]:
    u0, u1, v0, v1 = patch.domain
    u, v = np.linspace(u0, u1, samples), np.linspace(v0, v1, samples)
    return [patch.evaluate(u0, v), patch.evaluate(u1, v), patch.evaluate(u, v0), patch.evaluate(u, v1)]
