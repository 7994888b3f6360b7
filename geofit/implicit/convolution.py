"""Convolution surfaces: a kernel integrated along the segments of a skeleton, in closed form.

Distance surfaces bulge where the parts of a skeleton meet; an integral does not: a segment cut in two has the value of
the whole (Bloomenthal & Shoemake 1991). With x the place of a point along a segment of length L and rho its distance
from the axis, the Gaussian, Cauchy and compact kernels have closed integrals.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.field import Box, box_corners, points_of

__all__ = ["Convolution", "kernel_integral"]

Floats = NDArray[np.float64]
Kernel = Literal["compact", "gauss", "cauchy"]

#: Kernel lengths for a radius of 1: the compact one ends at 2, the others fall as e^(-r^2) and 1/(1 + r^2)^2.
WIDTH = {"compact": 2.0, "gauss": 1.0, "cauchy": 1.0}
#: Pairs of a point and a segment that are worked on at a time.
PAIRS = 1 << 20
#: Gauss-Legendre points: exact for the compact kernel, a polynomial of degree 6 along its chord.
ABSCISSAE, WEIGHTS = np.polynomial.legendre.leggauss(4)


def kernel_integral(
    kernel: Kernel, x: Floats, length: Floats, rho2: Floats, width: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the integral of a kernel over segments, and its derivatives by x and by rho^2.

    Parameters
    ----------
    kernel : {"compact", "gauss", "cauchy"}
        (1 - r^2/w^2)^3 up to r = w; e^(-r^2/w^2); 1/(1 + r^2/w^2)^2.
    x : (n,) array
        Places of the points along the axes, from the starts of the segments, metres.
    length : (n,) array
        Lengths of the segments, metres.
    rho2 : (n,) array
        Squared distances from the axes, m2.
    width : (n,) array
        w, metres.

    Notes
    -----
    The compact kernel is summed over the four Gauss points of its chord, which is exact and, unlike the polynomial
    difference, does not cancel at the rim. The Cauchy kernel is that of McCormack & Sherstyuk 1998.
    """
    scale = 1 / width**2
    if kernel == "compact":
        half = np.sqrt(np.maximum(width**2 - rho2, 0))
        low, high = np.maximum(-x, -half), np.minimum(length - x, half)
        span = np.maximum(high - low, 0) / 2
        t2 = (span * ABSCISSAE[:, None] + (low + high) / 2) ** 2
        base = np.maximum(1 - (rho2 + t2) * scale, 0)
        value = span * (WEIGHTS[:, None] * base**3).sum(axis=0)
        by_rho2 = -3 * scale * span * (WEIGHTS[:, None] * base**2).sum(axis=0)
        start, end = (np.maximum(1 - (rho2 + u**2) * scale, 0) ** 3 for u in (x, length - x))
        return value, start - end, by_rho2
    if kernel == "gauss":
        from scipy.special import erf, erfc

        s = 1 / width
        a, b = s * x, s * (length - x)
        # Beyond an end the difference of two erf cancels, that of two erfc does not.
        outside = np.minimum(a, b) < 0
        far, near = np.maximum(a, b), -np.minimum(a, b)
        integral = np.where(outside, erfc(near) - erfc(far), erf(a) + erf(b))
        fall = np.exp(-scale * rho2)
        value = fall * math.sqrt(math.pi) / (2 * s) * integral
        return value, fall * (np.exp(-(a**2)) - np.exp(-(b**2))), -scale * value
    if kernel != "cauchy":
        raise SettingsError(
            message(
                "implicit.kernel-unknown",
                "there is no kernel '{name}': choose compact, gauss or cauchy",
                name=kernel,
            )
        )
    s = 1 / width
    u, v = x, length - x
    p2 = 1 + scale * rho2
    p = np.sqrt(p2)
    du, dv = p2 + scale * u**2, p2 + scale * v**2
    angle = np.arctan2(s * length / p, 1 - scale * u * v / p2)
    value = length * (p2 + scale * u * v) / (2 * p2 * du * dv) + angle / (2 * s * p2 * p)
    by_p2 = -0.75 * angle / (s * p2**2 * p)
    for w, d in ((u, du), (v, dv)):
        by_p2 -= w * (p2 + d) / (2 * (p2 * d) ** 2) + 0.25 * w / (p2**2 * d)
    return value, 1 / du**2 - 1 / dv**2, scale * by_p2


@arguments_checked
@dataclass(frozen=True, eq=False)
class Convolution:
    """phi = (1 - F) / g0 about segments; each alone and without ends has the radius given for it.

    Parameters
    ----------
    segments : (n, 2, 3) array
        Ends of the segments, metres.
    radii : (n,) array or float
        Radius of the body about each, metres.
    kernel : {"compact", "gauss", "cauchy"}
        The compact one is C2 and costs least.
    """

    segments: Floats
    radii: Floats
    kernel: Kernel = "compact"

    def __post_init__(self) -> None:
        segments = np.array(self.segments, float)
        if segments.ndim != 3 or segments.shape[1:] != (2, 3) or not len(segments) or not np.isfinite(segments).all():
            raise SettingsError(
                message(
                    "implicit.segments-wrong-shape",
                    "segments must be a finite (n, 2, 3) array, not one of shape {shape}",
                    shape=segments.shape,
                )
            )
        radii = np.broadcast_to(np.asarray(self.radii, float), len(segments)).copy()
        if not (np.isfinite(radii) & (radii > 0)).all():
            raise SettingsError(
                message(
                    "implicit.radius-not-positive-ball",
                    "the smallest radius, {radius}, must be positive",
                    radius=float(np.min(radii)),
                )
            )
        lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        if not (lengths > 0).all():
            raise SettingsError(
                message(
                    "implicit.segment-without-length",
                    "segment {number} has no length: leave it out",
                    number=int(np.argmin(lengths)),
                )
            )
        if self.kernel not in WIDTH:
            raise SettingsError(
                message(
                    "implicit.kernel-unknown",
                    "there is no kernel '{name}': choose compact, gauss or cauchy",
                    name=self.kernel,
                )
            )
        segments.flags.writeable = radii.flags.writeable = False
        object.__setattr__(self, "segments", segments)
        object.__setattr__(self, "radii", radii)

    @cached_property
    def _axes(self) -> tuple[Floats, Floats]:
        """Unit directions and lengths."""
        vector = self.segments[:, 1] - self.segments[:, 0]
        length = np.linalg.norm(vector, axis=1)
        return vector / length[:, None], length

    @cached_property
    def _line(self) -> tuple[float, float]:
        """Integral and its derivative by r for an infinite line at r = 1, for a radius of 1."""
        one = np.ones(1)
        ends = 1e4 * one if self.kernel == "cauchy" else 50 * one
        value, _, by_rho2 = kernel_integral(self.kernel, ends, 2 * ends, one, WIDTH[self.kernel] * one)
        return float(value[0]), float(2 * by_rho2[0])

    @cached_property
    def _scale(self) -> float:
        """g0: slope at the surface of the thinnest segment, 1/m."""
        value, slope = self._line
        return -slope / value / float(self.radii.min())

    def value(self, xyz: Floats) -> Floats:
        """Return phi at (n, 3) points."""
        xyz = points_of(xyz)
        # A place with a coordinate that is not a number has no value.
        total = np.where(np.isnan(xyz.sum(axis=1)), np.nan, 0.0)
        for point, segment in self._pairs(xyz):
            value = self._integrals(xyz[point], segment)[0]
            total += np.bincount(point, value, minlength=len(xyz))
        return np.asarray((1 - total) / self._scale)

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradient of phi at (n, 3) points."""
        xyz = points_of(xyz)
        total = np.zeros((len(xyz), 3))
        for point, segment in self._pairs(xyz):
            _, by_x, by_rho2, across = self._integrals(xyz[point], segment)
            slope = by_x[:, None] * self._axes[0][segment] + 2 * by_rho2[:, None] * across
            for axis in range(3):
                total[:, axis] += np.bincount(point, slope[:, axis], minlength=len(xyz))
        return np.asarray(-total / self._scale)

    def _pairs(self, xyz: Floats) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Pairs of a point and a segment that reaches it, in parts of bounded size."""
        parts = []
        low, high = self._boxes
        count = max(1, PAIRS // len(self.segments))
        for first in range(0, len(xyz), count):
            part = xyz[first : first + count]
            # Segments far from the whole part drop out at once: parts of a lattice are compact.
            least, most = np.fmin.reduce(part), np.fmax.reduce(part)
            near = np.nonzero((low <= most).all(axis=1) & (high >= least).all(axis=1))[0]
            inside = np.ones((len(part), len(near)), bool)
            for axis in range(3):
                inside &= (part[:, axis, None] >= low[near, axis]) & (part[:, axis, None] <= high[near, axis])
            point, index = np.nonzero(inside)
            parts.append((point + first, near[index]))
        return parts

    @cached_property
    def _boxes(self) -> Box:
        """Corners of the boxes that each segment reaches, (n, 3) each."""
        reach = (WIDTH[self.kernel] * self.radii if self.kernel == "compact" else np.full(len(self.radii), np.inf))[
            :, None
        ]
        return self.segments.min(axis=1) - reach, self.segments.max(axis=1) + reach

    def _integrals(self, xyz: Floats, segment: NDArray[np.intp]) -> tuple[Floats, Floats, Floats, Floats]:
        direction, length = self._axes
        offset = xyz - self.segments[segment, 0]
        x = (offset * direction[segment]).sum(axis=1)
        across = offset - x[:, None] * direction[segment]
        radius = self.radii[segment]
        value, by_x, by_rho2 = kernel_integral(
            self.kernel, x, length[segment], (across**2).sum(axis=1), WIDTH[self.kernel] * radius
        )
        # An infinite line has F = 1 at its radius.
        factor = 1 / (self._line[0] * radius)
        return factor * value, factor * by_x, factor * by_rho2, across

    @property
    def bounds(self) -> Box:
        """Box that contains the body: beyond it all integrals together stay below 1."""
        low, high = self.segments.min(axis=(0, 1)), self.segments.max(axis=(0, 1))
        if self.kernel == "compact":
            boxes = self._boxes
            return boxes[0].min(axis=0), boxes[1].max(axis=0)
        # At distance d a line of radius r gives at most its infinite integral; n of them at most n of the widest.
        reach = float(self.radii.max())
        while self._at_most(np.array([reach]))[0] >= 1:
            reach *= 1.25
        return low - reach, high + reach

    def _at_most(self, distance: Floats) -> Floats:
        """Upper bound of F at a distance from all segments."""
        length = self._axes[1]
        radius = self.radii
        q = (distance[:, None] / (WIDTH[self.kernel] * radius)) ** 2
        kernel = np.exp(-q) if self.kernel == "gauss" else 1 / (1 + q) ** 2
        return np.asarray((kernel * length / (self._line[0] * radius)).sum(axis=1))

    def _slopes(self, lower: Floats, upper: Floats) -> Floats:
        """Upper bounds of |grad F| in boxes: over each segment, its length times the steepest kernel in reach."""
        direction, length = self._axes
        width = WIDTH[self.kernel] * self.radii
        centre, half = (lower + upper) / 2, np.linalg.norm(upper - lower, axis=1) / 2
        # Where (r/w)^2 is smallest or the kernel steepest, whichever is farther out.
        peak = {"compact": 0.2, "gauss": 0.5, "cauchy": 0.2}[self.kernel]
        total = np.zeros(len(lower))
        for i in range(len(length)):
            offset = centre - self.segments[i, 0]
            x = np.clip(offset @ direction[i], 0, length[i])
            distance = np.maximum(np.linalg.norm(offset - x[:, None] * direction[i], axis=1) - half, 0)
            q = np.maximum((distance / width[i]) ** 2, peak)
            slope = {
                "compact": lambda q: 6 * np.sqrt(q) * np.maximum(1 - q, 0) ** 2,
                "gauss": lambda q: 2 * np.sqrt(q) * np.exp(-q),
                "cauchy": lambda q: 4 * np.sqrt(q) / (1 + q) ** 3,
            }[self.kernel](q)
            # Along the axis the derivative is a difference of two kernels; across, no line is longer than this.
            total += slope * np.minimum(length[i], 4 * width[i]) / (self._line[0] * self.radii[i] * width[i])
        return total

    @cached_property
    def lipschitz(self) -> float:
        """Largest bound over boxes about the body."""
        low, high = self.bounds
        edges = np.linspace(low, high, 13)
        lower = np.stack(np.meshgrid(*edges[:-1].T, indexing="ij"), axis=-1).reshape(-1, 3)
        upper = np.stack(np.meshgrid(*edges[1:].T, indexing="ij"), axis=-1).reshape(-1, 3)
        return float(self._slopes(lower, upper).max()) / self._scale

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds of phi in boxes, by the slope that the segments near each can cause."""
        lower, upper = box_corners(lower, upper)
        reach = self._slopes(lower, upper) / self._scale * np.linalg.norm(upper - lower, axis=1) / 2
        centre = self.value((lower + upper) / 2)
        return centre - reach, centre + reach
