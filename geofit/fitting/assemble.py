"""One tensor-product surface into named patches that share their edge rows of control points."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.geometry.frame import Frame
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.splines.tensor import TensorSpace

__all__ = [
    "Division",
    "NetPart",
    "carried",
    "divide",
    "multiply_knots",
    "patches_of",
]

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
    net = coefficients.reshape(tu.shape[1], tv.shape[1], -1)
    # Matrix products: the last digits of einsum's own sums depend on where in the memory the arrays begin.
    rows = np.tensordot(tu, net, axes=(1, 0))
    fine: Floats = np.ascontiguousarray(np.tensordot(tv, rows, axes=(1, 1)).swapaxes(0, 1))
    return fine.reshape(len(tu) * len(tv), *coefficients.shape[1:])


def _raised(knots: Floats, at: dict[float, int]) -> Floats:
    missing = [np.repeat(x, max(m - int((knots == x).sum()), 0)) for x, m in at.items()]
    return np.sort(np.concatenate([knots, *missing]))


def patches_of(
    space: TensorSpace,
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
    space : TensorSpace
        Space of the whole surface, in units.
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
    net = _control_points(whole.space, whole.refined(coefficients), frame, unit)
    patches = []
    for part in whole.parts:
        control, knots_u, degree_u = net[part.rows, part.columns], part.knots_u, p
        if part.name == "core" and ruled_lines is not None:
            nodes = np.abs(bspline.greville(knots_u, p)[:, None] - ruled_lines).argmin(axis=0)
            degree_u, control = 1, control[nodes]
            knots_u = bspline.clamped_knots(ruled_lines, 1)
        patches.append(Patch(part.name, (degree_u, p), knots_u * unit, part.knots_v * unit, control.copy()))
    return tuple(sorted(patches, key=lambda patch: patch.name != "core"))


@dataclass(frozen=True, eq=False)
class NetPart:
    """One patch as a part of the refined net: its rows and columns of control points, and its knots in units."""

    name: str
    rows: slice
    columns: slice
    knots_u: Floats
    knots_v: Floats


@dataclass(frozen=True, eq=False)
class Division:
    """A surface's net refined along the core's edges, and the parts it falls into.

    ``refine_u`` and ``refine_v`` turn rows and columns of the surface's own coefficients into the refined ones.
    """

    space: TensorSpace
    refine_u: Floats
    refine_v: Floats
    parts: tuple[NetPart, ...]

    def refined(self, coefficients: Floats) -> Floats:
        """Return the coefficients of the refined net, (size,) or (size, 3)."""
        return _refined(coefficients, self.refine_u, self.refine_v)


def divide(space: TensorSpace, core: Rectangle | None, frame: Frame, interpolated: bool = False) -> Division:
    """Find the patches of a surface: knots of full multiplicity along the core's edges (The NURBS Book, A5.1).

    Parameters as those of :func:`patches_of`.
    """
    p = space.degree
    seams_u = _inner(core[:2], space.knots_u) if core else []
    seams_v = _inner(core[2:], space.knots_v) if core else []
    knots_u = _raised(space.knots_u, dict.fromkeys(seams_u, p))
    knots_v = _raised(space.knots_v, dict.fromkeys(seams_v, p))
    parts = []
    for u0, u1 in itertools.pairwise([space.knots_u[0], *seams_u, space.knots_u[-1]]):
        for v0, v1 in itertools.pairwise([space.knots_v[0], *seams_v, space.knots_v[-1]]):
            name = _name((u0, u1, v0, v1), core, frame, interpolated)
            rows, part_u = _part(knots_u, p, u0, u1)
            columns, part_v = _part(knots_v, p, v0, v1)
            parts.append(NetPart(name, rows, columns, part_u, part_v))
    return Division(
        TensorSpace(knots_u, knots_v, p),
        bspline.insertion_matrix(space.knots_u, knots_u, p),
        bspline.insertion_matrix(space.knots_v, knots_v, p),
        tuple(parts),
    )


def _inner(edges: tuple[float, float], knots: Floats) -> list[float]:
    return [float(x) for x in edges if knots[0] < x < knots[-1]]


def _control_points(space: TensorSpace, coefficients: Floats, frame: Frame, unit: float) -> Floats:
    if coefficients.ndim == 2:
        return frame.turn_back(coefficients.reshape(*space.shape, 3))
    u = bspline.greville(space.knots_u, space.degree) * unit
    v = bspline.greville(space.knots_v, space.degree) * unit
    local = np.stack([*np.meshgrid(u, v, indexing="ij"), coefficients.reshape(space.shape)], axis=2)
    return frame.turn_back(local)


def _part(knots: Floats, degree: int, low: float, high: float) -> tuple[slice, Floats]:
    """Return the rows of control points of one part, and its clamped knot vector."""
    first = int(np.searchsorted(knots, low, side="left"))
    start = max(first - 1, 0)
    inner = knots[(knots > low) & (knots < high)]
    part = np.concatenate([np.repeat(low, degree + 1), inner, np.repeat(high, degree + 1)])
    return slice(start, start + len(part) - degree - 1), part


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
