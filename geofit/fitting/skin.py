"""The core: a surface through every one of its points (paper, sec. 3.2, step 1; eq. 2: A X = B).

The regional field passes the core's points at the distance of their noise. The skin adds the smallest change of
control points, in the sense of least squares, that makes it pass exactly: X = X0 + A' (A A')^-1 (B - A X0).
A is the collocation matrix of the core's points, so sections and holes between them are active alike, and
the system has no more unknowns than points. What is between the points stays the field's: measured on ten
sites, half the error of the exact thin-plate spline of the same points, where the interpolant of least
bending energy has 1.2 times it.

All sections share one knot vector (Wang et al. 2008, CAD, the condition for a common knot vector). Its knots
follow the closest neighbours of any section; where two points still pull one control point apart, a knot goes
between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array, kron
from scipy.sparse.linalg import splu

from geofit.data.errors import ExactnessError
from geofit.data.messages import Message, message
from geofit.splines import bspline
from geofit.splines.refined import Space
from geofit.splines.tensor import TensorSpace

__all__ = [
    "Lines",
    "curve_lines",
    "lofted",
    "minimum_norm_correction",
    "refine_knots",
    "regularized_correction",
    "ruled",
    "section_lines",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: How many times the largest misfit of a core point the change of a control point may be.
OVERSHOOT = 10.0
#: The same, beyond which the surface is not worth having.
SWING = 100.0
#: Largest distance at which the linear algebra may leave a core point from the surface, metres.
EXACT = 1e-8
#: Where to add breaks for two neighbours, as multiples of their gap from their midpoint; a set is tried where the one
#: before it already has breaks. A narrow change takes several short spans.
OFFSETS = ((0.0,), (-1.0, 1.0), (-2.5, 2.5))
#: Two neighbours contradict each other if they ask for a slope this far above the field's own: no relief is so steep.
STEEP = 10.0
#: Curves of a fold nearer than this share of their whole distance, and of their mean distance, make one line.
ALMOST_ONE, ALMOST_ONE_OF_MANY = 0.025, 0.15
#: Damping of changes that may leave a misfit, relative to what a point's own control points weigh.
DAMPING = 0.01


@dataclass(frozen=True, eq=False)
class Lines:
    """Section lines across the core: ``u`` (k,) where they lie, ``stray`` (k,) by how much their points leave them.

    ``straight`` if all run along v.
    """

    u: Floats
    stray: Floats
    straight: bool


@dataclass(frozen=True, eq=False)
class Refined:
    """Breaks in u and v, and the strain: how far a control point must move, as a multiple of what it may."""

    breaks: tuple[Floats, Floats]
    strain: float


def section_lines(plane: Floats, section: NDArray[np.str_], spacing: float) -> Lines:
    """Find the lines of constant u that the core's sections run along.

    Named sections give their mean u. Sections that stray by more than a tenth of ``spacing`` are not straight:
    their points are active all the same, but no knot line follows them. Of sections that all but coincide, one counts.
    """
    named = np.unique(section[section != ""])
    means, strays = [], []
    for name in named:
        u, v = plane[section == name].T
        if len(u) >= 2 and np.ptp(v) > np.ptp(u):
            means.append(u.mean())
            strays.append(np.abs(u - u.mean()).max())
    if len(means) < 2:
        return Lines(np.empty(0), np.empty(0), False)
    order = np.argsort(means, kind="stable")
    lines, stray = np.array(means)[order], np.array(strays)[order]
    lines, stray = lines[stray < 0.1 * spacing], stray[stray < 0.1 * spacing]
    if len(lines) < 2:
        return Lines(lines, stray, False)
    # Many sections stand closer together than a share of the whole core.
    least = min(0.05 * spacing, max(0.5 * float(lines[-1] - lines[0]) / (len(lines) - 1), 1e-4 * spacing))
    keep = np.concatenate([[True], np.diff(lines) > least])
    return Lines(lines[keep], stray[keep], int(keep.sum()) >= 2)


def curve_lines(u: Floats) -> Lines:
    """Return the lines of a fold's section curves, whose points have the given ``u``.

    Of curves much closer together than most, one is a line: a surface lofted through both would carry the slope from
    one to the other, and with it what their points differ by, as far as the next curve.
    """
    found = np.unique(u)
    length = float(np.ptp(found)) if len(found) else 0.0
    least = min(ALMOST_ONE, ALMOST_ONE_OF_MANY / max(len(found) - 1, 1)) * length
    lines: list[float] = []
    for line in found.tolist():
        if not lines or line - lines[-1] > least:
            lines.append(line)
    return Lines(np.array(lines), np.zeros(len(lines)), len(lines) >= 2)


def minimum_norm_correction(matrix: csr_array, misfit: Floats, free: NDArray[np.bool_] | None = None) -> Floats:
    """Return the smallest change x of the free control points with matrix @ x = misfit.

    Parameters
    ----------
    matrix : (m, size) sparse array
        Collocation matrix of the points.
    misfit : (m,) or (m, k) array
        What is missing at each point, metres.
    free : (size,) array of bool, optional
        Control points that may move; all by default.

    Raises
    ------
    ExactnessError
        If the points cannot all be met: fewer control points than points near some place.
    """
    acting = matrix if free is None else matrix * free.astype(float)
    acting = csr_array(acting)
    gram = (acting @ acting.T).tocsc()
    try:
        solver = splu(gram, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        raise ExactnessError(
            _unmet(message("fitting.core-system-singular", "the system of its {n} points is singular", n=len(misfit)))
        ) from None
    change = acting.T @ solver.solve(misfit)
    change += acting.T @ solver.solve(misfit - acting @ change)
    left = float(np.abs(misfit - acting @ change).max(initial=0.0))
    if not left <= EXACT:
        raise ExactnessError(
            _unmet(
                message(
                    "fitting.core-not-met",
                    "not all {n} points can be met exactly ({left:.1e} m is left)",
                    n=len(misfit),
                    left=left,
                )
            )
        )
    swing = float(np.abs(change).max(initial=0.0))
    if swing > SWING * max(float(np.abs(misfit).max(initial=0.0)), 1e-3):
        words = message(
            "fitting.core-would-oscillate",
            "meeting all {n} points would swing the surface by {swing:.3g} m",
            n=len(misfit),
            swing=swing,
        )
        raise ExactnessError(_unmet(words))
    return np.asarray(change)


def regularized_correction(matrix: csr_array, misfit: Floats, free: NDArray[np.bool_]) -> Floats:
    """Return a small change of the free control points that takes most of a misfit away.

    Unlike :func:`minimum_norm_correction` it does not force points apart that share their control points: what they
    contradict each other by is left, and so is what only the fringes of the free control points could correct.
    Parameters as there.
    """
    columns = np.flatnonzero(free & (np.bincount(matrix.indices, minlength=matrix.shape[1]) > 0))
    change = np.zeros((matrix.shape[1], *misfit.shape[1:]))
    if not len(columns):
        return change
    acting = csr_array(matrix[:, columns])
    # (A' A + d)^-1 A' = A' (A A' + d)^-1: of points and control points, the fewer are the unknowns.
    many = len(misfit) > len(columns)
    gram = (acting.T @ acting if many else acting @ acting.T).tocsc()
    gram.setdiag(gram.diagonal() + DAMPING * float(matrix.power(2).sum(axis=1).max()))
    solve = splu(gram).solve
    change[columns] = solve(acting.T @ misfit) if many else acting.T @ solve(misfit)
    return change


def _unmet(what: Message) -> Message:
    return message(
        "fitting.core-not-interpolable",
        "The core cannot be interpolated: {what}. Its points are closer together than the allowed control points can "
        "follow. Raise max_control_points or coincidence_distance, or approximate (core='none').",
        what=what,
    )


def refine_knots(
    breaks_u: Floats,
    breaks_v: Floats,
    plane: Floats,
    pairs: Ints,
    misfit: Floats,
    space_of: Callable[[Floats, Floats], Space],
    allowed: Callable[[tuple[int, int]], bool],
    rounds: int,
    unit: float,
) -> Refined:
    """Add knots until no control point has to move far to meet two neighbouring points.

    Parameters
    ----------
    breaks_u, breaks_v : (k,) arrays
        Breaks to start from.
    plane : (m, 2) array
        Places of the core's points, in an order of their places alone.
    pairs : (k, 2) array of int
        Which of them are neighbours.
    misfit : (m,) or (m, k) array
        Distance of the field from them, metres.
    space_of : callable
        The space that has given breaks in u and v.
    allowed : callable
        Whether a net of so many control points (in u, in v) stays below the cap.
    rounds : int
        Cap of the number of rounds.
    unit : float
        Metres in a unit of the plane.

    Returns
    -------
    Refined
        Old and new breaks. The strain stays above 1 where the cap or the number of rounds is reached first, or where
        points contradict each other.
    """
    limit = OVERSHOOT * max(float(np.abs(misfit).max(initial=0.0)), 1e-3)
    first, second = pairs.T
    off = misfit.reshape(len(plane), -1)
    rise = np.linalg.norm(off[first] - off[second], axis=1)
    steep = rise > STEEP * unit * np.linalg.norm(plane[first] - plane[second], axis=1)
    for left in range(rounds, -1, -1):
        space = space_of(breaks_u, breaks_v)
        rows = space.matrix(plane) if isinstance(space, TensorSpace) else space.fine_matrix(plane)
        strain = _strain(rows, misfit) / limit
        strained = np.argsort(-strain, kind="stable")[: int((strain > 1.0).sum())]
        if not len(strained) or not left:
            break
        new_u, new_v = _between(pairs, steep, strained, plane, breaks_u, breaks_v)
        # Where the cap does not allow all of them, the most strained points come first.
        while len(strained) and not allowed(_shape(space.degree, breaks_u, new_u, breaks_v, new_v)):
            strained = strained[: len(strained) // 2]
            new_u, new_v = _between(pairs, steep, strained, plane, breaks_u, breaks_v)
        if not len(new_u) and not len(new_v):
            break
        breaks_u, breaks_v = np.union1d(breaks_u, new_u), np.union1d(breaks_v, new_v)
    return Refined((breaks_u, breaks_v), float(strain.max(initial=0.0)))


def _shape(degree: int, breaks_u: Floats, new_u: Floats, breaks_v: Floats, new_v: Floats) -> tuple[int, int]:
    return len(breaks_u) + len(new_u) - 1 + degree, len(breaks_v) + len(new_v) - 1 + degree


def _strain(matrix: csr_array, misfit: Floats) -> Floats:
    """Return how far the control points near each point must move to meet all points; inf where they cannot.

    ``matrix`` (m, size) holds the rows of the points.
    """
    gram = (matrix @ matrix.T).tocsc()
    # A point on which no function acts is left where it is.
    gram.setdiag(np.maximum(gram.diagonal() * (1 + 1e-10), np.finfo(float).tiny))
    change = matrix.T @ splu(gram).solve(misfit)
    moved = np.abs(change).reshape(len(change), misfit[0].size).max(axis=1)
    near = np.zeros(matrix.shape[0])
    np.maximum.at(near, np.repeat(np.arange(len(near)), np.diff(matrix.indptr)), moved[matrix.indices])
    left = np.abs(misfit - matrix @ change).reshape(len(misfit), -1).max(axis=1)
    return np.where(left > 1e-4 * np.abs(misfit).max(), np.inf, near)


def _between(
    pairs: Ints, steep: NDArray[np.bool_], strained: Ints, plane: Floats, breaks_u: Floats, breaks_v: Floats
) -> tuple[Floats, Floats]:
    """Return new breaks for the tightest pair at each strained point: at its midpoint, else on both sides of it.

    A pair that is too ``steep`` gets none but that at its midpoint.
    """
    near = np.isin(pairs, strained).any(axis=1)
    tight, steep = pairs[near], steep[near]
    first, second = plane[tight[:, 0]], plane[tight[:, 1]]
    middle, gap = (first + second) / 2, np.abs(second - first)
    breaks = (breaks_u, breaks_v)
    ratio = gap / np.column_stack([_span(breaks[axis], middle[:, axis]) for axis in (0, 1)])
    chosen: tuple[list[float], list[float]] = ([], [])
    for point in strained:
        mine = np.flatnonzero((tight == point).any(axis=1))
        if not len(mine):
            continue
        k = mine[np.argmin(ratio[mine].max(axis=1))]
        axis = int(ratio[k, 1] >= ratio[k, 0])
        for offsets in OFFSETS[:1] if steep[k] else OFFSETS:
            places = [middle[k, axis] + offset * gap[k, axis] for offset in offsets]
            apart = 0.3 * max(offsets[-1], 1.0) * gap[k, axis]
            new = [
                x for x in places if np.abs(breaks[axis] - x).min() > apart and breaks[axis][0] < x < breaks[axis][-1]
            ]
            if new:
                chosen[axis].extend(new)
                break
    return _thin(np.unique(chosen[0]), breaks_u), _thin(np.unique(chosen[1]), breaks_v)


def _span(breaks: Floats, x: Floats) -> Floats:
    """Return the length of the span at each of x."""
    k = np.clip(np.searchsorted(breaks, x, side="right") - 1, 0, len(breaks) - 2)
    return breaks[k + 1] - breaks[k]


def _thin(new: Floats, breaks: Floats) -> Floats:
    """Keep one new break a span."""
    _, first = np.unique(np.searchsorted(breaks, new), return_index=True)
    return new[first]


def ruled(space: TensorSpace, lines: Floats, rows: Ints) -> csr_array:
    """Return the matrix from section curves to the control points of a surface linear across them.

    Parameters
    ----------
    space : TensorSpace
        Space with a knot of full multiplicity at each inner line.
    lines : (k,) array
        Where the section curves lie in u.
    rows : (r,) array of int
        Rows of control points (in u) that the core is made of.

    Returns
    -------
    matrix : (r * nv, k * nv) sparse array
        Row i of control points lies on the straight line between two curves at its Greville abscissa, which
        reproduces the ruled surface exactly.
    """
    abscissa = bspline.greville(space.knots_u, space.degree)[rows]
    k = np.clip(np.searchsorted(lines, abscissa, side="right") - 1, 0, len(lines) - 2)
    t = (abscissa - lines[k]) / (lines[k + 1] - lines[k])
    weights = np.zeros((len(rows), len(lines)))
    np.put_along_axis(weights, k[:, None], (1 - t)[:, None], axis=1)
    np.put_along_axis(weights, k[:, None] + 1, t[:, None], axis=1)
    return csr_array(kron(csr_array(weights), eye_array(space.shape[1])))


def lofted(space: TensorSpace, lines: Floats) -> csr_array:
    """Return the matrix from section curves to the control points of the smoothest surface through them.

    Parameters
    ----------
    space : TensorSpace
        Space with a knot at each inner line.
    lines : (k,) array
        Where the section curves lie in u.

    Returns
    -------
    matrix : (nu * nv, k * nv) sparse array
        Across the sections every row of control points takes the least energy of second derivatives (of first
        ones for two curves) that passes through the curves: skinning in the sense of The NURBS Book, sec. 10.3.
    """
    count, k = space.shape[0], len(lines)
    through = bspline.collocation(space.knots_u, space.degree, lines)
    energy = bspline.energy_matrix(space.knots_u, space.degree, 2 if k > 2 else 1)
    system = np.block([[energy / np.trace(energy), through.T], [through, np.zeros((k, k))]])
    right = np.concatenate([np.zeros((count, k)), np.eye(k)])
    weights = np.linalg.lstsq(system, right, rcond=None)[0][:count]
    return csr_array(kron(csr_array(weights), eye_array(space.shape[1])))
