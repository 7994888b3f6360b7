"""One tensor-product surface into named patches that share their edge rows of control points."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from geofit.geometry.frame import Frame
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.splines.refined import RefinedSpace, Space, outer_of
from geofit.splines.tensor import TensorSpace

__all__ = ["Division", "NetPart", "carried", "divide", "flattened", "multiply_knots", "patches_of", "with_knots"]

Floats = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]


def multiply_knots(
    space: TensorSpace, coefficients: Floats, at_u: dict[float, int], at_v: dict[float, int]
) -> tuple[TensorSpace, Floats]:
    """Raise the multiplicity of knots without changing the surface (The NURBS Book, A5.1)."""
    finer = TensorSpace(_raised(space.knots_u, at_u), _raised(space.knots_v, at_v), space.degree)
    tu = bspline.insertion_matrix(space.knots_u, finer.knots_u, space.degree)
    tv = bspline.insertion_matrix(space.knots_v, finer.knots_v, space.degree)
    return finer, _refined(coefficients, tu, tv)


def with_knots(
    space: Space, coefficients: Floats, at_u: dict[float, int], at_v: dict[float, int]
) -> tuple[Space, Floats]:
    """Add knots outside what is finer in a space, without changing the surface."""
    if isinstance(space, TensorSpace):
        return multiply_knots(space, coefficients, at_u, at_v)
    size = space.outer.size
    outer, own = multiply_knots(space.outer, coefficients[:size], at_u, at_v)
    return space.with_outer(outer), np.concatenate([own, coefficients[size:]])


def flattened(space: Space, coefficients: Floats) -> tuple[TensorSpace, Floats]:
    """Return the surface on one tensor space, whose knots run through it."""
    if isinstance(space, TensorSpace):
        return space, coefficients
    p, knots, first = space.degree, [], []
    for whole, fine in ((space.knots_u, space.fine.knots_u), (space.knots_v, space.fine.knots_v)):
        knots.append(bspline.common_knots(whole, fine[(fine > fine[0]) & (fine < fine[-1])]))
        first.append(int(np.searchsorted(knots[-1], fine[0], side="right")) - 1 - p)
    outer, more = space.split(coefficients)
    both = (
        bspline.insertion_matrix(old, new, p) for old, new in zip((space.knots_u, space.knots_v), knots, strict=True)
    )
    found, (nu, nv) = TensorSpace(knots[0], knots[1], p), space.fine.shape
    net = _refined(outer, *both).reshape(*found.shape, *coefficients.shape[1:])
    net[first[0] : first[0] + nu, first[1] : first[1] + nv] += more.reshape(nu, nv, *coefficients.shape[1:])
    return found, net.reshape(found.size, *coefficients.shape[1:])


def carried(space: TensorSpace, coefficients: Floats, knots_u: Floats, knots_v: Floats) -> tuple[TensorSpace, Floats]:
    """Return the surface on other knots: interpolated at their Greville abscissae (The NURBS Book, sec. 9.2).

    Knots that contain the surface's own leave it as it is.
    """
    moves: list[Floats] = []
    for knots, own in ((knots_u, space.knots_u), (knots_v, space.knots_v)):
        at = bspline.greville(knots, space.degree)
        matrices = (bspline.collocation(each, space.degree, at) for each in (knots, own))
        moves.append(np.asarray(np.linalg.solve(*matrices), float))
    return TensorSpace(knots_u, knots_v, space.degree), _refined(coefficients, moves[0], moves[1])


def _refined(coefficients: Floats, tu: Floats, tv: Floats) -> Floats:
    """Return the coefficients of refined rows and columns, in the shape of the given ones."""
    net = coefficients.reshape(tu.shape[1], tv.shape[1], -1)
    # Matrix products: the last digits of einsum's own sums depend on where in the memory the arrays begin.
    rows = np.tensordot(tu, net, axes=(1, 0))
    fine: Floats = np.ascontiguousarray(np.tensordot(tv, rows, axes=(1, 1)).swapaxes(0, 1))
    return fine.reshape(len(tu) * len(tv), *coefficients.shape[1:])


def _raised(knots: Floats, at: dict[float, int]) -> Floats:
    missing = [np.repeat(x, max(m - int((knots == x).sum()), 0)) for x, m in at.items()]
    return np.sort(np.concatenate([knots, *missing]))


def patches_of(
    space: Space,
    coefficients: Floats,
    core: Rectangle | None,
    frame: Frame,
    unit: float,
    ruled_lines: Floats | None = None,
    interpolated: bool = False,
) -> tuple[Patch, ...]:
    """Cut the surface along the core's edges.

    Parameters
    ----------
    space : TensorSpace or RefinedSpace
        Space of the whole surface, in units; what is finer is the core.
    coefficients : (size,) or (size, 3) array
        Heights over the frame's plane, or coordinates about the origin, metres.
    core : (u0, u1, v0, v1) or None
        The core's rectangle in units.
    frame : Frame
        Turns the control points to the map's axes.
    unit : float
        Metres a unit.
    ruled_lines : (k,) array, optional
        Section lines, where the core is linear across them: its patch then has degree 1 in u.
    interpolated : bool
        Whether a surface without a seam is a core (all points exact) or a periphery.

    Returns
    -------
    patches : tuple of Patch
        The core first.
    """
    p = space.degree
    whole = divide(space, core, frame, interpolated)
    patches = []
    for part in whole.parts:
        own = whole.coefficients(part, coefficients)
        control = _control_points(TensorSpace(part.knots_u, part.knots_v, p), own, frame, unit)
        knots_u, degree_u = part.knots_u, p
        if part.name == "core" and ruled_lines is not None:
            nodes = np.abs(bspline.greville(knots_u, p)[:, None] - ruled_lines).argmin(axis=0)
            degree_u, control = 1, control[nodes]
            knots_u = bspline.clamped_knots(ruled_lines, 1)
        patches.append(Patch(part.name, (degree_u, p), knots_u * unit, part.knots_v * unit, control.copy()))
    return tuple(sorted(patches, key=lambda patch: patch.name != "core"))


@dataclass(frozen=True, eq=False)
class NetPart:
    """One patch as a part of the net: its knots in units, and its control points.

    ``to_u`` (nu, size) and ``to_v`` (nv, size) turn rows and columns of the surface's coefficients into the patch's.
    ``fine`` states that the patch is the rectangle in which the surface is finer: the coefficients of the finer
    functions add to its control points.
    """

    name: str
    knots_u: Floats
    knots_v: Floats
    to_u: Floats
    to_v: Floats
    fine: bool

    @property
    def shape(self) -> tuple[int, int]:
        """Number of control points in u and v."""
        return len(self.to_u), len(self.to_v)


@dataclass(frozen=True, eq=False)
class Division:
    """A surface's net, and the parts it falls into along the core's edges."""

    space: Space
    parts: tuple[NetPart, ...]

    def coefficients(self, part: NetPart, of_whole: Floats) -> Floats:
        """Return the coefficients (nu * nv,) or (nu * nv, 3) of a part from those of the whole surface."""
        outer, fine = (of_whole, None) if isinstance(self.space, TensorSpace) else self.space.split(of_whole)
        net = outer.reshape(part.to_u.shape[1], part.to_v.shape[1], -1)
        # Sparse products: what a row sums to depends on that row alone, so parts share their edges to the last bit.
        for to in (part.to_u, part.to_v):
            acted = np.asarray(csr_array(to) @ net.reshape(len(net), -1))
            net = acted.reshape(-1, *net.shape[1:]).swapaxes(0, 1)
        flat = net.reshape(-1, *of_whole.shape[1:])
        return np.asarray(flat if fine is None or not part.fine else flat + fine)

    def acting_most(self, part: NetPart, i: int, j: int) -> tuple[int, float]:
        """Return the coefficient that moves control point (i, j) of a part most, and by which share of its own move."""
        if part.fine and isinstance(self.space, RefinedSpace):
            found = np.flatnonzero(self.space.inner == i * part.shape[1] + j)
            if len(found):
                return self.space.outer.size + int(found[0]), 1.0
        in_u, in_v = part.to_u[i], part.to_v[j]
        a, b = int(in_u.argmax()), int(in_v.argmax())
        return a * len(in_v) + b, float(in_u[a] * in_v[b])


def divide(space: Space, core: Rectangle | None, frame: Frame, interpolated: bool = False) -> Division:
    """Find the patches of a surface: knots of full multiplicity along the core's edges (The NURBS Book, A5.1).

    Parameters as those of :func:`patches_of`.
    """
    p, outer = space.degree, outer_of(space)
    strips = []
    for knots, edges in ((outer.knots_u, core[:2] if core else ()), (outer.knots_v, core[2:] if core else ())):
        ends = itertools.pairwise([float(knots[0]), *_inner(edges, knots), float(knots[-1])])
        strips.append([(low, high, *_part(knots, knots, p, low, high)) for low, high in ends])
    parts = []
    for (u0, u1, knots_u, to_u), (v0, v1, knots_v, to_v) in itertools.product(*strips):
        name = _name((u0, u1, v0, v1), core, frame, interpolated)
        if isinstance(space, RefinedSpace) and (u0, u1, v0, v1) == space.rectangle:
            fine_u, fine_v = (
                _part(knots, own, p, float(own[0]), float(own[-1]))
                for knots, own in ((outer.knots_u, space.fine.knots_u), (outer.knots_v, space.fine.knots_v))
            )
            parts.append(NetPart(name, fine_u[0], fine_v[0], fine_u[1], fine_v[1], fine=True))
        else:
            parts.append(NetPart(name, knots_u, knots_v, to_u, to_v, fine=False))
    return Division(space, tuple(parts))


def _inner(edges: tuple[float, ...], knots: Floats) -> list[float]:
    return [float(x) for x in edges if knots[0] < x < knots[-1]]


def _control_points(space: TensorSpace, coefficients: Floats, frame: Frame, unit: float) -> Floats:
    if coefficients.ndim == 2:
        return frame.turn_back(coefficients.reshape(*space.shape, 3))
    u = bspline.greville(space.knots_u, space.degree) * unit
    v = bspline.greville(space.knots_v, space.degree) * unit
    local = np.stack([*np.meshgrid(u, v, indexing="ij"), coefficients.reshape(space.shape)], axis=2)
    return frame.turn_back(local)


def _part(knots: Floats, finer: Floats, degree: int, low: float, high: float) -> tuple[Floats, Floats]:
    """Return the clamped knots of one part, which are those of ``finer`` there, and what turns coefficients into its.

    ``finer`` contains the knots of the surface between ``low`` and ``high``.
    """
    inner = finer[(finer > low) & (finer < high)]
    beyond = [knots[knots < low], knots[knots > high]]
    ends = [np.repeat(x, max(degree, int((knots == x).sum()))) for x in (low, high)]
    whole = np.concatenate([beyond[0], ends[0], inner, ends[1], beyond[1]])
    first = max(len(beyond[0]) - 1, 0)
    part = np.concatenate([np.repeat(low, degree + 1), inner, np.repeat(high, degree + 1)])
    rows = slice(first, first + len(part) - degree - 1)
    return part, bspline.insertion_matrix(knots, whole, degree)[rows]


def _name(part: Rectangle, core: Rectangle | None, frame: Frame, interpolated: bool) -> str:
    if core is None:
        return "core" if interpolated else "periphery"
    middle = (part[0] + part[1]) / 2, (part[2] + part[3]) / 2
    across = -1 if middle[0] < core[0] else int(middle[0] > core[1])
    along = -1 if middle[1] < core[2] else int(middle[1] > core[3])
    if not across and not along:
        return "core"
    if frame.kind == "best-plane":
        side_v = {1: "up-dip", -1: "down-dip"}.get(along, "")
        side_u = _compass(frame.axes[0] * across) if across else ""
        return "-".join(word for word in (side_v, side_u) if word)
    words = [_compass(frame.axes[0] * across)] if across else []
    words += [_compass(frame.axes[1] * along)] if along else []
    return "-".join(sorted(words, key=("north", "south", "east", "west").index))


def _compass(direction: Floats) -> str:
    """Return the nearest of the four winds; two directions at right angles never get the same axis."""
    quarter = round(float(np.degrees(np.arctan2(direction[1], direction[0]))) / 90 + 1e-9) % 4
    return ("east", "north", "west", "south")[quarter]
