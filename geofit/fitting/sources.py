"""The noise of a source that states no accuracy: one for the points of each kind, by the restricted likelihood.

Boreholes, drawn sections and seismic picks of one horizon scatter about the same field, each by a noise of its own (a
nugget for each source). Points of one kind alone cannot tell noise from relief below their spacing. Those of a kind
that is measured farther from the rock can, against the ones nearer to it: the relief is the same for both, and what
they scatter by more is noise. The kind nearest to the rock is never judged: its points are met.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.labels import Labels
from geofit.data.long_arrays import inverse_squares
from geofit.data.messages import Message, message
from geofit.fitting.active_points import Data, degree_for, gather_points
from geofit.fitting.conflicts import trust_of, trust_of_kinds
from geofit.fitting.field import FieldChoice, choose_covariance
from geofit.fitting.model import Problem
from geofit.fitting.resolution import EVEN, FIRST_LEVEL, GAIN, SKETCH, SKETCHED, even_space, sketched_fields
from geofit.fitting.smoothness import ENOUGH
from geofit.fitting.weighted_points import WeightedPoints
from geofit.splines.tensor import TensorSpace

__all__ = ["with_noise_of_sources"]

Floats = NDArray[np.float64]

#: Factor of the noise between one try and the next, and those that the best is tried by.
STEP, FINER = 2.0, (2**-0.5, 2**0.5)
#: How far the noise of two points may lie apart, in those of the points at first.
MOST = 200.0


@dataclass(frozen=True, eq=False)
class _Trial:
    """Noise of each point relative to the others, -2 log of the restricted likelihood, and the field that gives it."""

    noise: Floats
    value: float
    field: FieldChoice


def with_noise_of_sources(problem: Problem) -> tuple[Problem, tuple[FieldChoice, ...]]:
    """Return the problem with the noise of the kinds of points that scatter more than those nearer to the rock.

    Second come the fields of a sketch of its points, where these had to be found and still apply. Folded surfaces, and
    a smoothing that is given, leave nothing to judge.

    Notes
    -----
    A kind is judged by 16 points or more against as many. Its noise must raise -2 log L by 10, on a sketch and on
    the first level of the field's spaces (:mod:`geofit.fitting.resolution`): on the sketch alone, relief that its spans
    cut in a dense core would count as noise of the sections there.
    """
    kinds, kept, settings = problem.points.labels["kind"], problem.kept, problem.settings
    if len(kinds.table) < 2 or settings.smoothing != "auto" or problem.parametrization.parametric:
        return problem, ()
    some = np.flatnonzero(kept)[:: max(int(kept.sum()) // SKETCHED, 1)]
    judged, found = _to_judge(kinds[some], problem.accuracy[some]), {}
    if not judged:
        return problem, ()
    data = gather_points(problem.accuracy, problem.parametrization, settings, kept, problem.split)
    sketched = sketched_fields(data)
    for size, known in ((SKETCH, sketched), (FIRST_LEVEL, ())):
        found = _found(even_space(data.area, EVEN, degree_for(len(data.plane)), size), data, judged, known)
        judged = {kind: own for kind, own in judged.items() if kind in found}
    if not found:
        return problem, sketched
    notes = (_note(kind, noise) for kind, noise in found.items())
    parametrization = replace(problem.parametrization, notes=(*problem.parametrization.notes, *notes))
    return replace(problem, parametrization=parametrization, sources=found), ()


def _note(kind: str, noise: float) -> Message:
    return message(
        "fitting.source-scatters",
        "points of kind {kind} scatter about the surface by {noise:.2g} m, more than those measured nearer to the "
        "rock; no accuracy is stated, so this scatter counts as theirs",
        kind=kind,
        noise=noise,
    )


def _to_judge(kinds: Labels, accuracy: Floats) -> dict[str, NDArray[np.bool_]]:
    """Return the points of each kind to judge, the kinds farthest from the rock first."""
    trust, unstated = trust_of(kinds), np.isnan(accuracy)
    judged = {}
    for code in np.argsort(-trust_of_kinds(kinds), kind="stable"):
        own = (kinds.codes == code) & unstated
        if own.sum() >= ENOUGH and (trust < trust[own][0]).sum() >= ENOUGH:
            judged[kinds.table[code]] = own
    return judged


def _found(
    space: TensorSpace, data: Data, judged: dict[str, NDArray[np.bool_]], known: Sequence[FieldChoice]
) -> dict[str, float]:
    """Return the noise, in metres, of the kinds that the likelihood on a space gives more than the others.

    ``known`` are the fields of the points without it; none: they are searched there.
    """
    if not judged:
        return {}
    some = slice(None, None, max(len(data.plane) // SKETCHED, 1))
    plane, value = data.plane[some], data.value[some]

    def trial(noise: Floats, known: Sequence[FieldChoice]) -> _Trial:
        given = WeightedPoints(plane, value, inverse_squares(noise))
        field, own = choose_covariance(space, given, None, known, data.trend)[0]
        return _Trial(noise, own + 2 * float(np.log(noise).sum()), field)

    def times(factor: float, before: _Trial, own: NDArray[np.bool_]) -> _Trial:
        noise = np.where(own, before.noise * factor, before.noise)
        return trial(noise, [before.field]) if np.ptp(noise) < MOST else replace(before, value=np.inf)

    best = trial(np.array(data.noise[some]), known)
    found: dict[str, NDArray[np.bool_]] = {}
    for kind, own in judged.items():
        # What the kinds farther from the rock scatter by keeps its ratio: it was found relative to this kind as well.
        raised = np.logical_or.reduce([own, *found.values()])
        louder = best
        for step in (STEP, STEP**2):
            while (tried := times(step, louder, raised)).value < louder.value:
                louder = tried
        if louder.value < best.value - GAIN:
            found[kind], best = own, louder
    for _, own, step in itertools.product(range(2), found.values(), FINER):
        while (tried := times(step, best, own)).value < best.value:
            best = tried
    return {kind: best.field.noise * float(best.noise[own][0]) for kind, own in found.items()}
