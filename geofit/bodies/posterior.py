"""How well the field of a body is known: its standard deviation, a band in metres, and the chance of being inside.

An interpolant of kernel r^3 is the kriging estimate of an intrinsic random field with that generalised covariance
(Matheron, "The intrinsic random functions and their applications", Adv. Appl. Prob. 5, 1973); the same factorised
system gives the covariance of what the data leave open. The scale of the random field comes from the contacts
themselves, each left out in turn, without a new fit (Dubrule, "Cross validation of kriging in a unique neighborhood",
Math. Geol. 15, 1983).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.active import farthest_apart
from geofit.bodies.clusters import block_scale, sections_of
from geofit.bodies.kernels import CUBIC, KERNELS, LINEAR
from geofit.bodies.rbf import Saddle

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["ON_SURFACE", "SPREAD", "BodyPosterior"]

Floats = NDArray[np.float64]

#: Contacts and samples that represent a body that was fitted in parts.
CONTACTS = 500
SAMPLES = 200
#: Usual scale of the random field in distances between holes, by kernel, and how many contacts weigh as much as it;
#: found on planted bodies (benchmarks/bodies.py). A field of kernel r^n spreads as r^(n / 2).
USUAL = {CUBIC: 0.18, LINEAR: 0.18}
DEGREES = {CUBIC: 1.5, LINEAR: 0.5}
TRUST = 30
#: What makes the scale of outlines come true: a left-out section has a neighbour on each side, as far as two sections
#: are apart; found on 220 planted bodies on 4 to 12 planes (docs/section_trials.md), judged on thirty others.
BETWEEN = 1.35
#: What makes the chance of lying inside come true on planted bodies of fifteen shapes (benchmarks/bodies.py; judged on
#: other bodies, patterns of holes and noise): factors of the standard deviation in the body and off it - samples that
#: are logged outside bound it, and only those that are active are in the covariance - and a shift, as fields of r^3
#: swell a little where data are few.
WITHIN = 0.87
WITHOUT = 0.63
SHIFT = 0.16
#: The chance of lying inside at the surface itself: the normal distribution at -SHIFT.
ON_SURFACE = math.erfc(SHIFT / math.sqrt(2)) / 2
#: The factor with which 80 % of their volumes fall between P10 and P90. It is larger: what a field of one roughness
#: misses of a shape is the same all over a body and does not cancel in its volume.
SPREAD = 1.0


@dataclass(frozen=True, eq=False)
class BodyPosterior:
    """What the data of a body leave open.

    Parameters
    ----------
    body : BodyFit
        The body.
    """

    body: BodyFit

    @cached_property
    def system(self) -> Saddle:
        """The system of contacts, normals and active samples; for a body fitted in parts, of some spread over it."""
        if self.body.fitted.system is not None:
            return self.body.fitted.system
        prepared, frame = self.body.fitted.prepared, self.body.field.frame
        contacts = frame.to_fit(prepared.contacts)
        samples = frame.to_fit(np.concatenate([prepared.inside, prepared.outside]))
        parts = [
            x[np.sort(farthest_apart(x, count))] for x, count in ((contacts, CONTACTS), (samples, SAMPLES)) if len(x)
        ]
        return Saddle(np.concatenate(parts), reach=KERNELS[self.body.settings.kernel])

    @cached_property
    def scale(self) -> float:
        """Standard deviation of the random field per unit of its covariance, metres.

        The root mean square of the contacts' left-out errors over their unit standard deviations, its logarithm drawn
        towards what bodies of this distance between holes usually have: a few contacts say little about a scale. Of
        outlines whole sections are left out (:mod:`geofit.bodies.clusters`).
        """
        own, count = self._left_out
        return self._towards_usual(own, count) if self.sections is None else max(BETWEEN * own, 1e-9)

    @cached_property
    def _left_out(self) -> tuple[float, int]:
        """The scale by what was left out, and how many contacts or sections were."""
        system, count = self.system, len(self.body.fitted.prepared.contacts)
        if self.body.fitted.system is None:
            count = min(count, CONTACTS)
        value = self.body.field.interpolant.value(system.points)
        weights = system.interpolate(value, self._slopes).weights
        if self.sections is not None:
            names = np.unique(self.sections[:count])
            return block_scale(system, weights, count, self.sections), int((names != "").sum())
        weights = weights[:count]
        precision = system.precision()[:count]
        return float(np.sqrt(np.mean(weights**2 / np.maximum(precision, 1e-300)))), count

    def _towards_usual(self, own: float, count: int) -> float:
        """Return a scale found on ``count`` contacts or sections, drawn towards the usual one."""
        spacing = self.body.region.spacing
        kernel = KERNELS[self.body.settings.kernel]
        usual = USUAL[kernel] * spacing / (spacing / self.body.field.frame.size) ** DEGREES[kernel]
        return float(np.exp((count * np.log(max(own, 1e-6 * usual)) + TRUST * np.log(usual)) / (count + TRUST)))

    @cached_property
    def sections(self) -> NDArray[np.str_] | None:
        """The section of each point of the system, "" of none; None for data of holes, or with normals."""
        if len(self.system.oriented):
            return None
        return sections_of(self.body.data, self.body.field.frame.to_map(self.system.points))

    @cached_property
    def spread(self) -> float:
        """The factor of the standard deviation with which volumes are drawn.

        A volume needs the scale of a whole body, of which a dozen sections say little: volumes were off by anything
        between a hundredth and ten times what the sections' own scale let expect. It is drawn towards the usual one,
        as that of holes is (docs/section_trials.md).
        """
        if self.sections is None:
            return SPREAD
        return SPREAD * self._towards_usual(*self._left_out) / self.scale

    @property
    def _slopes(self) -> Floats:
        oriented = self.system.oriented
        return self.body.field.interpolant.gradient(oriented) if len(oriented) else np.zeros((0, 3))

    def deviation(self, xyz: ArrayLike) -> Floats:
        """Return the standard deviation (n,) of the field at (n, 3) places in map coordinates, metres."""
        fitted = self.body.field.frame.to_fit(np.asarray(xyz, float))
        return self.scale * np.sqrt(self.system.variance(fitted))

    def band(self, xyz: ArrayLike) -> Floats:
        """Return the standard deviation (n,) of the surface's position near (n, 3) places on it, metres."""
        slope = np.linalg.norm(self.body.gradient(xyz), axis=1)
        return np.asarray(self.deviation(xyz) / np.maximum(slope, 1e-300))

    def probability(self, xyz: ArrayLike) -> Floats:
        """Return the probability (n,) that each of (n, 3) places lies inside the body; nan where it is not estimated.

        Ground that the settings leave outside (:meth:`open_ground`) has 0 within the reach of any data. Farther from
        all data nothing is known. Of samples of Copper Creek's GHv in holes that were left out, none of 689 in ground
        of the first kind lies inside, and 34 of 226 in that of the second; the field's own chance would be 0.18.

        It is that of a smooth body. In rock that changes over shorter distances than those between holes it is too
        sure: leave holes out to see (:func:`geofit.bodies.crossval.leave_one_hole_out`; docs/section_trials.md).
        """
        from scipy.spatial import cKDTree
        from scipy.special import ndtr

        xyz, origin = np.asarray(xyz, float), self.body.origin
        value = self.body.value(xyz)
        chance = np.where(value < 0, 1.0, 0.0)
        may = self.open_ground(xyz)
        deviation = np.where(value[may] < 0, WITHIN, WITHOUT) * self.deviation(xyz[may])
        chance[may] = ndtr(-value[may] / np.maximum(deviation, 1e-12) - SHIFT)
        prepared = self.body.fitted.prepared
        data = np.concatenate([prepared.contacts, prepared.inside, prepared.outside]) - origin
        chance[~may & (cKDTree(data).query(xyz - origin)[0] > self.body.region.reach)] = np.nan
        return chance

    def margin(self, xyz: ArrayLike, chance: float) -> Floats:
        """Return a smooth function (n,), metres, of (n, 3) places: negative where the probability is above ``chance``.

        Its zero is the line or surface of that chance: the probability itself is too steep for a raster to find it.
        """
        from scipy.special import ndtri

        value = self.body.value(xyz)
        beyond = -float(ndtri(chance)) - SHIFT
        factor = WITHOUT if beyond > 0 else WITHIN
        return np.where(
            (value < 0) | self.open_ground(xyz), value - beyond * factor * self.deviation(xyz), np.abs(value)
        )

    def open_ground(self, xyz: ArrayLike) -> NDArray[np.bool_]:
        """Return which of (n, 3) places in map coordinates a realization of the body may reach.

        Not those off the box nor, where the body is closed, those beyond the reach of contacts and inside samples.
        """
        from scipy.spatial import cKDTree

        xyz = np.asarray(xyz, float)
        region, prepared = self.body.region, self.body.fitted.prepared
        may = ((xyz >= region.lower) & (xyz <= region.upper)).all(axis=1)
        if self.body.settings.closed:
            own = np.concatenate([prepared.contacts, prepared.inside]) - self.body.origin
            may &= (cKDTree(own).query(xyz - self.body.origin)[0] <= region.reach) | (self.body.value(xyz) < 0)
        return np.asarray(may)
