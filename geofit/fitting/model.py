"""The model behind a surface's patches: what was given to the fit, and the control net that it found."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Conflict, Partition
from geofit.data.allowance import accuracies
from geofit.data.messages import Message, message
from geofit.data.points import PointSet
from geofit.data.prepared import Preparing
from geofit.data.settings import FitSettings
from geofit.data.threads import one_thread
from geofit.fitting.active_points import gather_points
from geofit.fitting.assemble import patches_of
from geofit.fitting.core import fit_with_core
from geofit.fitting.field import FieldChoice
from geofit.fitting.net import Net, approximate_all
from geofit.fitting.parametrize import Parametrization
from geofit.fitting.periphery import BLUNDER
from geofit.fitting.resolution import Choice
from geofit.fitting.slopes import Slopes
from geofit.fitting.split import Split
from geofit.splines.patch import Patch
from geofit.splines.refined import abscissae, outer_of, padded
from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["Model", "Problem", "names_of"]

Floats = NDArray[np.float64]

#: Points that a note names.
NAMED = 5
#: A move aside that is shorter is rounding, metres.
STILL = 1e-9


def names_of(points: PointSet, rows: NDArray[np.intp]) -> tuple[Message | str, ...]:
    """Return the names of some points, the first few of many."""
    names = [points.describe(int(k)) for k in rows[:NAMED]]
    return tuple([*names, "..."] if len(rows) > NAMED else names)


@dataclass(frozen=True, eq=False)
class Problem:
    """What stays the same while a horizon's control points are fitted and adjusted.

    ``kept`` (n,) marks the points that conflicts left; ``outline`` (k, 2) is where the surface ends if that is not the
    study area: at faults, map coordinates. ``slopes`` are the measured dips that the fit uses, in the frame.
    ``sources`` is the noise of the kinds of points that state none (:mod:`geofit.fitting.sources`), metres. ``unit`` is
    what lengths are measured by, metres; None: the spacing of the sparse points.
    """

    points: PointSet
    settings: FitSettings
    parametrization: Parametrization
    split: Split
    kept: NDArray[np.bool_]
    conflicts: tuple[Conflict, ...]
    name: str
    outline: Floats | None = None
    slopes: Slopes | None = None
    sources: Mapping[str, float] = field(default_factory=dict)
    unit: float | None = None

    @cached_property
    def accuracy(self) -> Floats:
        """Accuracy of the points, (n,) metres, as stated or as found for their kind; nan where neither is known."""
        return accuracies(self.points, self.sources)

    def fit(
        self,
        active: NDArray[np.bool_],
        stage: Callable[[str, float], None],
        chosen: Choice | None = None,
        sketched: Sequence[FieldChoice] = (),
    ) -> Model:
        """Return the control net that meets the core's points and approximates the other active ones.

        ``chosen`` is the field to take; None: it is chosen by these points, from ``sketched`` fields on if these points
        have given any.
        """
        split = None if self.split.core is None else self.split
        given = gather_points(self.accuracy, self.parametrization, self.settings, active, split, self.slopes, self.unit)
        if split is None:
            net = approximate_all(given, self.settings, stage, chosen, sketched)
        else:
            net = fit_with_core(
                self.points, given, self.parametrization, split, active, self.settings, stage, chosen, sketched
            )
        torn = np.flatnonzero(active)[net.torn]
        return Model(self, replace(net, notes=(*net.notes, *self._torn_notes(torn))))

    def _torn_notes(self, torn: NDArray[np.intp]) -> tuple[Message, ...]:
        """Name points that were let go."""
        if not len(torn):
            return ()
        note = message(
            "fitting.neighbours-contradict",
            "points not met, because they contradict those around them ({count}: {names}); through one of them and a "
            "close neighbour the surface would be steeper than 45°, or it lies {times:g} times as far from the field "
            "as most do (strict meets them where knots allow, robust takes outliers out of the fit)",
            count=len(torn),
            names=names_of(self.points, torn),
            times=BLUNDER,
        )
        return (note.with_severity("warning"),)

    def partition(self) -> Partition:
        """Return the split in map coordinates."""
        corners = None
        if self.split.core is not None and not self.parametrization.parametric:
            u0, u1, v0, v1 = self.split.core
            local = np.array([[u0, v0, 0], [u1, v0, 0], [u1, v1, 0], [u0, v1, 0]])
            xyz = self.parametrization.frame.turn_back(local) + self.parametrization.frame.origin
            corners = tuple((float(x), float(y)) for x, y in xyz[:, :2])
        inside = int((self.split.inside & self.kept).sum())
        return Partition(corners, inside, len(self.kept) - inside, self.split.reason, self.split.lost)


@dataclass(frozen=True, eq=False)
class Model(Preparing):
    """A problem with one control net for the whole surface, of which the patches are parts.

    ``weights`` holds the weights of the control points of patches that were weighted manually, by name. ``aside``
    (size, 2) is how far coefficients of a height field were moved along the frame's plane, metres; None: none was.
    """

    problem: Problem
    net: Net
    weights: Mapping[str, Floats] = field(default_factory=dict)
    aside: Floats | None = None

    def with_net(self, net: Net) -> Model:
        """Return the same problem with another control net."""
        return replace(self, net=net)

    def moved(self, index: int, by: Floats) -> Model:
        """Return the model with one coefficient moved by (3,) metres along the frame's axes u, v and height."""
        coefficients = self.net.coefficients.copy()
        if coefficients.ndim == 2:
            coefficients[index] += by
            return self.with_net(replace(self.net, coefficients=coefficients))
        coefficients[index] += by[2]
        net = replace(self.net, coefficients=coefficients)
        if np.abs(by[:2]).max() < STILL:
            return self.with_net(net)
        aside = np.zeros((len(coefficients), 2)) if self.aside is None else self.aside.copy()
        aside[index] += by[:2]
        return replace(self, net=net, aside=aside)

    def control(self) -> Floats:
        """Return what :func:`geofit.fitting.assemble.patches_of` cuts: heights, or (size, 3) coordinates."""
        net = self.net
        if self.aside is None:
            return net.coefficients
        plane = padded(net.space, abscissae(outer_of(net.space)) * net.unit)
        return np.column_stack([plane + self.aside, net.coefficients])

    def patches(self) -> tuple[Patch, ...]:
        """Cut the surface into patches along the core's edges."""
        net, interpolated = self.net, self.problem.split.core is not None
        frame = self.problem.parametrization.frame
        # The same last digits whether a fit cuts its patches or a manual edit.
        with one_thread():
            patches = patches_of(net.space, self.control(), net.core, frame, net.unit, net.lines, interpolated)
        return tuple(replace(patch, weights=self.weights.get(patch.name)) for patch in patches)

    def patch_surface(self) -> PatchSurface:
        """Return the surface of the control net."""
        given, frame = self.problem, self.problem.parametrization.frame
        outline = given.parametrization.boundary if given.outline is None else given.outline
        return PatchSurface(self.patches(), frame.origin, given.name, outline, frame.kind)

    def figures(self) -> dict[str, Any]:
        """Return the figures of the fit for the report."""
        net = self.net
        return {
            "frame": self.problem.parametrization.frame.kind,
            "energy": net.field.energy,
            "smoothing": net.field.smoothing,
            "noise": net.field.noise,
            "noise_limit": net.limit,
            "sources": dict(self.problem.sources),
            "spacing": net.unit,
            "rounds": net.rounds,
        }
