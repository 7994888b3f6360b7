"""Places all over a surface: the ends and the middle of every knot span, with normals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from geofit.geometry.clip import inside
from geofit.geometry.trim_loops import inside_loops as inside_loops
from geofit.splines.bspline import basis
from geofit.splines.patch import Patch
from geofit.surfaces.protocol import FittedSurface

__all__ = ["PatchLattice", "lattice_places", "lattices"]

Floats = NDArray[np.float64]

#: Fewest spans along each side of a patch that loops cut: a plane has one, which they may miss.
LOOPED = 24


@dataclass(frozen=True, eq=False)
class PatchLattice:
    """One patch: ``points`` (a, b, 3) about the origin, ``normal`` (a, b, 3), ``within`` (a, b) outline and loops.

    A normal is as long as the sine of the angle between S_u and S_v: 0 where the patch is degenerate. Places with
    two odd indices are the middles of spans.
    """

    points: Floats
    normal: Floats
    within: NDArray[np.bool_]

    @property
    def middles(self) -> PatchLattice:
        """The middles of the spans alone."""
        return PatchLattice(self.points[1::2, 1::2], self.normal[1::2, 1::2], self.within[1::2, 1::2])

    @property
    def areas(self) -> Floats:
        """About the area of each span, m^2, which its middle represents."""
        along = np.linalg.norm(self.points[2::2, 1::2] - self.points[:-2:2, 1::2], axis=-1)
        across = np.linalg.norm(self.points[1::2, 2::2] - self.points[1::2, :-2:2], axis=-1)
        return np.asarray(along * across * np.linalg.norm(self.normal[1::2, 1::2], axis=-1))


def lattices(surface: FittedSurface) -> tuple[PatchLattice, ...]:
    """Lay a lattice over each patch, fine enough that no wiggle of one control point falls between its places."""
    each = zip(surface.patches, surface.loops, strict=True)
    return tuple(_lattice(surface, patch, loops) for patch, loops in each)


def lattice_places(parts: Sequence[PatchLattice]) -> tuple[Floats, Floats]:
    """Return points (n, 3) and normals (n, 3) of all places within the outline and the loops."""
    return np.concatenate([p.points[p.within] for p in parts]), np.concatenate([p.normal[p.within] for p in parts])


def _lattice(surface: FittedSurface, patch: Patch, loops: tuple[Floats, ...]) -> PatchLattice:
    u, v = (_ends_and_middles(knots, LOOPED if loops else 1) for knots in (patch.knots_u, patch.knots_v))
    points, su, sv = _grid(patch, u, v)
    lengths = np.linalg.norm(su, axis=-1) * np.linalg.norm(sv, axis=-1)
    normal = np.cross(su, sv) / np.maximum(lengths, 1e-300)[..., None]
    within = np.ones(points.shape[:2], bool)
    if surface.outline is not None:
        outline = surface.outline - surface.origin[:2]
        within = inside(outline, points[..., :2].reshape(-1, 2)).reshape(within.shape)
    if loops:
        within &= inside_loops(patch, loops, *np.meshgrid(u, v, indexing="ij"))
    return PatchLattice(points, normal, within)


def _grid(patch: Patch, u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Points and first derivatives on the lattice, each (a, b, 3)."""
    if patch.weights is not None:
        grid = u[:, None], v[None, :]
        return patch.evaluate(*grid), patch.evaluate(*grid, 1, 0), patch.evaluate(*grid, 0, 1)
    along, along_du = (_rows(patch.knots_u, patch.degree[0], u, order) for order in (0, 1))
    across, across_dv = (_rows(patch.knots_v, patch.degree[1], v, order) for order in (0, 1))
    nu, nv = patch.control.shape[:2]
    # One axis after the other: a sum over rows for each column of the lattice instead of 16 products a place.
    rows, rows_du = ((m @ patch.control.reshape(nu, -1)).reshape(-1, nv, 3).swapaxes(0, 1) for m in (along, along_du))
    found = (
        (m @ np.ascontiguousarray(part).reshape(nv, -1)).reshape(len(v), len(u), 3)
        for part, m in ((rows, across), (rows_du, across), (rows, across_dv))
    )
    points, su, sv = (np.ascontiguousarray(part.swapaxes(0, 1)) for part in found)
    return points, su, sv


def _rows(knots: Floats, degree: int, x: Floats, derivative: int) -> csr_array:
    """Return the (n, count) matrix of the basis functions at ``x``; of each row few are not zero."""
    first, values = basis(knots, degree, x, derivative)
    columns = first[:, None] + np.arange(degree + 1)
    start = np.arange(0, columns.size + 1, degree + 1)
    return csr_array((values.ravel(), columns.ravel(), start), shape=(len(x), len(knots) - degree - 1))


def _ends_and_middles(knots: Floats, fewest: int) -> Floats:
    """Return the ends and middles of the spans, each of them cut until there are ``fewest`` at least."""
    breaks = np.unique(knots)
    pieces = -(-fewest // (len(breaks) - 1))
    cuts = breaks[:-1, None] + np.arange(pieces) / pieces * np.diff(breaks)[:, None]
    breaks = np.append(cuts.ravel(), breaks[-1])
    return np.sort(np.concatenate([breaks, (breaks[1:] + breaks[:-1]) / 2]))
