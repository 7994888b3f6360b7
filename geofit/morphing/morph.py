"""Metamorphosis: what is given becomes the ways between surveys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import date
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.implicit.grid import spline_grid
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.align import Alignment, Carried
from geofit.morphing.align import align as align_bodies
from geofit.morphing.dates import dates_of, knots_of
from geofit.morphing.distance import Samples, distances, samples_of
from geofit.morphing.ends import End, ends_of
from geofit.morphing.errors import MorphError
from geofit.morphing.leg import Mode, Pace, leg_between
from geofit.morphing.sequence import Morph

__all__ = ["morph"]

#: Spacings between the bodies and the border of the lattice.
MARGIN = 7
#: Nodes of the largest lattice.
MOST = 520**3
#: Bodies farther from each other than this many times the longest one have other coordinates.
FAR = 20.0
#: Weight of the area in the level-set equation, in squares of the spacing.
EPS = 0.25


@arguments_checked
def morph(
    a: Any,
    b: Any,
    *more: Any,
    mode: Mode = "arrival",
    pace: Pace = "progress",
    dates: Sequence[str | date] | None = None,
    spacing: float | None = None,
    cells: int = 128,
    align: Literal["principal"] | None = None,
    seeds: bool | Sequence[ArrayLike] = False,
    eps: float | None = None,
    sd: Sequence[float] | None = None,
    names: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Morph:
    """Return the metamorphosis of one body into another, through more if given.

    Parameters
    ----------
    a, b : Field, ImplicitBody, TriangleMesh, MeshSurface or MorphBody
        The bodies: implicit fields, fitted bodies, closed meshes in map coordinates (see :func:`geofit.io.read_body`),
        or two horizons closed by :func:`geofit.between`.
    more : body
        Further surveys, in order.
    mode : {"arrival", "blend", "pde"}
        "arrival": a front with the speed |d_B|, from one solve; "blend": (1 - tau) d_A + tau d_B; "pde": the level-set
        equation with curvature and path correction, level-set metamorphosis after Pan & Xu, completed.
    pace : {"progress", "volume", "time"}
        What grows evenly with tau: the share of the symmetric difference that is done, the volume (where it rises or
        falls all the way), or 1 - exp(-t) of the front's own time (the weight of a blend).
    dates : sequence of date or str, optional
        A date for each body, rising, as "2024-05-31" or datetime.date: tau is then proportional to time.
    spacing : float, optional
        Of the lattice, metres; by default the longest side of both bodies over ``cells``.
    cells : int
        Cells along the longest side, 16 or more.
    align : {"principal"}, optional
        Align the first body with the second by principal axes; the way still starts where the first body is. For two
        bodies without dates only: coordinates of surveys are real. Dated surveys get the alignment as a report.
    seeds : bool or sequence of (3,) array_like
        Places (map coordinates, metres) at which small balls start, so that parts of a later body are reached that the
        earlier one does not touch. True: the deepest place of each.
    eps : float, optional
        Weight of the area in "pde", m2; by default a quarter of the squared spacing, none where the pace is "volume".
    sd : sequence of float, optional
        Standard deviation of the surface of each survey, metres, for the uncertainty of volumes of change.
    names : sequence of str, optional
        What errors call the bodies; by default their own names, and A, B, ... for bodies without one.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    Morph
        ``m(tau)`` or ``m(date)`` is a body; the ends are the given bodies themselves.

    Raises
    ------
    MorphError
        If a body is none, open, inconsistent or empty, dates do not rise, or no part of a body is reached.
    SettingsError
        If a setting is out of its range, or the lattice needs too much memory.

    Notes
    -----
    Between surveys nothing is known: frames are geometry, not a record of the process. D. Breen & R. Whitaker, A
    level-set approach for the metamorphosis of solid models, IEEE TVCG 7(2), 2001; Pan Qing & Xu Guoliang, Chinese J.
    Computers 32(2), 2009, for the level-set equation on C2 splines.

    Examples
    --------
    >>> from geofit.implicit import Sphere
    >>> m = morph(Sphere([0, 0, 0], 3.0), Sphere([0, 0, 0], 7.0), cells=32, pace="time")
    >>> round(float(np.cbrt(m(0.5).volume * 0.75 / np.pi)), 1)
    5.0
    """
    bodies = (a, b, *more)
    if names is not None and len(names) != len(bodies):
        raise SettingsError(
            message(
                "morphing.names-uncounted",
                "{given} names are given for {count} bodies: give one for each.",
                given=len(names),
                count=len(bodies),
            )
        )
    _check(bodies, mode, pace, cells, spacing, eps, sd, align, dates)
    days = dates_of(dates) if dates is not None else None
    knots = knots_of(days, len(bodies))
    ends, origin = ends_of(bodies, names)
    lattice = _lattice(ends, spacing, cells)
    tell(progress, "distances", 0.0)
    samples = [_samples(end, lattice) for end in ends]
    alignment = None
    if align is not None or days is not None:
        alignment = _aligned(samples[0], samples[1], applied=align is not None)
    if align is not None and alignment is not None:
        ends_moved = _carried_end(ends[0], alignment)
        lattice = _lattice((ends_moved, ends[1]), spacing, cells)
        samples = [_samples(ends_moved, lattice), _samples(ends[1], lattice)]
    weight = (0.0 if pace == "volume" else EPS * lattice.spacing**2) if eps is None else eps
    legs = []
    for k, (start, end) in enumerate(pairwise(samples)):
        tell(progress, "morph", (k + 0.3) / len(samples))
        legs.append(
            leg_between(start, end, mode=mode, origin=origin, leg=k, eps=weight, seeds=seeds, progress=progress)
        )
    spread = None if sd is None else tuple(float(one) for one in sd)
    return Morph(ends, origin, tuple(legs), knots, mode, pace, days, spread, alignment)


def _check(
    bodies: Sequence[Any], mode: str, pace: str, cells: int, spacing: float | None, eps: float | None,
    sd: Sequence[float] | None, align: str | None, dates: Sequence[Any] | None,
) -> None:  # fmt: skip
    for given, choices, what in ((mode, get_args(Mode), "mode"), (pace, get_args(Pace), "pace")):
        if given not in choices:
            raise SettingsError(
                message(
                    "morphing.choice-unknown",
                    "{what}='{given}' is unknown: choose one of {choices}.",
                    what=what,
                    given=given,
                    choices=", ".join(choices),
                )
            )
    positive = all(value is None or (np.isfinite(value) and value > 0) for value in (spacing,))
    if cells < 16 or not positive or (eps is not None and not (np.isfinite(eps) and eps >= 0)):
        raise SettingsError(
            message(
                "morphing.lattice-settings-unusable",
                "cells={cells}, spacing={spacing}, eps={eps}: give 16 cells or more, a positive spacing and eps >= 0.",
                cells=cells,
                spacing=spacing,
                eps=eps,
            )
        )
    if sd is not None and (len(sd) != len(bodies) or not all(np.isfinite(s) and s >= 0 for s in sd)):
        raise SettingsError(
            message(
                "morphing.standard-deviations-unusable",
                "sd={sd}: give one standard deviation in metres, 0 or more, for each of the {count} surveys.",
                sd=list(sd),
                count=len(bodies),
            )
        )
    if align not in (None, "principal"):
        raise SettingsError(
            message("morphing.align-unknown", "align='{given}' is unknown: give 'principal' or nothing.", given=align)
        )
    if align is not None and (len(bodies) > 2 or dates is not None):
        raise SettingsError(
            message(
                "morphing.surveys-not-aligned",
                "Surveys with dates, and more than two bodies, are not aligned: their coordinates are real. Read the "
                "alignment that is reported, and register the surveys first if it is large.",
            )
        )


def _lattice(ends: Sequence[End], spacing: float | None, cells: int) -> Lattice:
    low = np.min([end.bounds[0] for end in ends], axis=0)
    high = np.max([end.bounds[1] for end in ends], axis=0)
    size = float((high - low).max())
    own = max(float((end.bounds[1] - end.bounds[0]).max()) for end in ends)
    if size > FAR * own:
        raise MorphError(
            message(
                "morphing.bodies-far-apart",
                "The bodies span {size:.6g} m together, but are at most {own:.4g} m long: they lie far from each "
                "other. Check their coordinates: an origin that only one of the files states, or millimetres in one of "
                "them.",
                size=size,
                own=own,
            )
        )
    h = size / cells if spacing is None else float(spacing)
    counts = np.maximum(np.ceil((high - low) / h - 1e-9).astype(int), 1) + 2 * MARGIN
    if float(np.prod(counts + 1.0)) > MOST:
        least = h * (float(np.prod(counts + 1.0)) / MOST) ** (1 / 3)
        raise SettingsError(
            message(
                "morphing.lattice-too-large",
                "A spacing of {spacing:.3g} m needs {count:.3g} nodes, about {memory:.0f} GB: give {least:.3g} m or "
                "more.",
                spacing=h,
                count=float(np.prod(counts + 1.0)),
                memory=float(np.prod(counts + 1.0)) * 60 / 1e9,
                least=least,
            )
        )
    start = (low + high) / 2 - counts * h / 2
    return Lattice(start, h, (int(counts[0]) + 1, int(counts[1]) + 1, int(counts[2]) + 1))


def _samples(end: End, lattice: Lattice) -> Samples:
    found = samples_of(end.shape, lattice)
    if not found.inside.any() or not len(found.mesh.triangles):
        raise MorphError(
            message(
                "morphing.body-lost",
                "Body '{name}' has no node of the lattice inside: it is empty, or thinner than the spacing of "
                "{spacing:.3g} m. Use a smaller spacing.",
                name=end.name,
                spacing=lattice.spacing,
            )
        )
    return found


def _aligned(a: Samples, b: Samples, *, applied: bool) -> Alignment:
    splines = [spline_grid(distances(one, one.inside), one.lattice) for one in (a, b)]
    return replace(align_bodies(a, b, *splines, principal=applied), applied=applied)


def _carried_end(end: End, alignment: Alignment) -> End:
    """Return the first body laid on the second."""
    if isinstance(end.shape, TriangleMesh):
        mesh = TriangleMesh(alignment.points(end.shape.vertices), end.shape.triangles)
        return replace(end, shape=mesh, bounds=(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)))
    field = Carried(end.shape, alignment, 1.0)
    return replace(end, shape=field, bounds=field.bounds)
