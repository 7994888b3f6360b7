"""Balls as parameters of a fit, the energy of Muraki (1991) with its gradient, and the halves of a ball."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ELLIPSOID", "SPHERE", "Balls", "Energy", "halves_of"]

Floats = NDArray[np.float64]

#: Ball parameters: centre, logarithms of the diagonal of A and its lower part, density.
SPHERE, ELLIPSOID = 5, 10
LOWER = np.tril_indices(3, -1)
#: Bounds of ln A for samples of unit size. Without the lower one a wide ball with b = T is on all samples at once.
FLATTEST = (-1.5, 6.0)


@dataclass(frozen=True, eq=False)
class Balls:
    """Centres (n, 3), matrices A (n, 3, 3) lower triangular, densities (n,), for samples of unit size and T = 1."""

    centres: Floats
    shapes: Floats
    densities: Floats
    width: int

    def pack(self) -> Floats:
        """Return the parameters of all balls, one after the other."""
        diagonal = np.log(np.diagonal(self.shapes, axis1=1, axis2=2))
        if self.width == SPHERE:
            return np.concatenate([self.centres, diagonal[:, :1], self.densities[:, None]], axis=1).ravel()
        lower = self.shapes[:, LOWER[0], LOWER[1]]
        return np.concatenate([self.centres, diagonal, lower, self.densities[:, None]], axis=1).ravel()

    @staticmethod
    def unpack(parameters: Floats, width: int) -> Balls:
        """Return the balls of such parameters."""
        rows = parameters.reshape(-1, width)
        shapes = np.zeros((len(rows), 3, 3))
        shapes[:, range(3), range(3)] = np.exp(rows[:, 3:4] if width == SPHERE else rows[:, 3:6])
        if width == ELLIPSOID:
            shapes[:, LOWER[0], LOWER[1]] = rows[:, 6:9]
        return Balls(rows[:, :3].copy(), shapes, rows[:, -1].copy(), width)

    def part(self, index: NDArray[np.intp] | list[int]) -> Balls:
        """Return some of the balls."""
        return Balls(self.centres[index], self.shapes[index], self.densities[index], self.width)

    def with_(self, other: Balls) -> Balls:
        """Return these balls and others."""
        return Balls(
            np.concatenate([self.centres, other.centres]),
            np.concatenate([self.shapes, other.shapes]),
            np.concatenate([self.densities, other.densities]),
            self.width,
        )

    def without(self, i: int) -> Balls:
        """Return all balls but one."""
        return self.part(np.delete(np.arange(len(self.densities)), i))

    def potentials(self, xyz: Floats) -> tuple[Floats, Floats]:
        """Return values (n, m) and gradients (n, m, 3) of every ball at m samples."""
        y = (xyz - self.centres[:, None]) @ self.shapes.transpose(0, 2, 1)
        f = self.densities[:, None] * np.exp(-(y**2).sum(axis=2))
        return f, -2 * f[:, :, None] * (y @ self.shapes)

    @property
    def sizes(self) -> Floats:
        """Integrals over space but for pi^(3/2), by absolute density."""
        return np.asarray(np.abs(self.densities) / np.diagonal(self.shapes, axis1=1, axis2=2).prod(axis=1))


@dataclass(frozen=True, eq=False)
class Energy:
    """E = mean((F - 1)^2 + alpha |n - N|^2) + beta (sum of sizes)^2 on some samples, next to balls that are fixed."""

    xyz: Floats
    normal: Floats
    alpha: float
    beta: float
    #: Weight of a sample: one over the number of all samples.
    weight: float
    fixed_value: Floats
    fixed_gradient: Floats
    fixed_size: float = 0.0

    def of(self, balls: Balls) -> float:
        """Return the energy of balls."""
        f, g = balls.potentials(self.xyz)
        value, gradient = self.fixed_value + f.sum(axis=0), self.fixed_gradient + g.sum(axis=0)
        size = self.fixed_size + float(balls.sizes.sum())
        return float(self.weight * self.residuals(value, gradient).sum() + self.beta * size**2)

    def residuals(self, value: Floats, gradient: Floats) -> Floats:
        """Return the terms of the samples, by value and gradient of the potential there."""
        length = np.linalg.norm(gradient, axis=1)
        cosine = -(self.normal * gradient).sum(axis=1) / np.where(length > 0, length, 1.0)
        return np.asarray((value - 1) ** 2 + self.alpha * 2 * (1 - cosine))

    def slope(self, parameters: Floats, width: int) -> tuple[float, Floats]:
        """Return the energy and its gradient by the parameters."""
        balls = Balls.unpack(parameters, width)
        a = balls.shapes
        d = self.xyz - balls.centres[:, None]
        y = d @ a.transpose(0, 2, 1)
        u = y @ a
        e = np.exp(-(y**2).sum(axis=2))
        f = balls.densities[:, None] * e
        value = self.fixed_value + f.sum(axis=0)
        g = self.fixed_gradient - 2 * (f[:, :, None] * u).sum(axis=0)
        length = np.linalg.norm(g, axis=1)
        length = np.where(length > 0, length, 1.0)
        unit = g / length[:, None]
        cosine = (self.normal * unit).sum(axis=1)
        sizes = balls.sizes
        size = self.fixed_size + float(sizes.sum())
        mean = self.weight * ((value - 1) ** 2 + 2 * self.alpha * (1 + cosine)).sum()
        energy = float(mean + self.beta * size**2)

        by_value = 2 * self.weight * (value - 1)
        w = 2 * self.weight * self.alpha * (self.normal - cosine[:, None] * unit) / length[:, None]
        aw = w @ a.transpose(0, 2, 1)
        uw = (u * w).sum(axis=2)
        by_density = (e * by_value).sum(axis=1) - 2 * (e * uw).sum(axis=1)
        by_density += (
            2
            * self.beta
            * size
            * np.sign(balls.densities)
            * sizes
            / np.abs(np.where(balls.densities == 0, 1.0, balls.densities))
        )
        strength = 2 * f * by_value - 4 * f * uw
        by_centre = (strength[:, None] @ u)[:, 0]
        by_centre += 2 * (f[:, None] @ aw @ a)[:, 0]
        by_shape = -(strength[:, :, None] * y).transpose(0, 2, 1) @ d
        by_shape -= 2 * ((f[:, :, None] * aw).transpose(0, 2, 1) @ d + (f[:, :, None] * y).transpose(0, 2, 1) @ w)
        diagonal = np.diagonal(by_shape, axis1=1, axis2=2) * np.diagonal(a, axis1=1, axis2=2)
        diagonal = diagonal - 2 * self.beta * size * sizes[:, None]
        if width == SPHERE:
            shape = diagonal.sum(axis=1, keepdims=True)
        else:
            shape = np.concatenate([diagonal, by_shape[:, LOWER[0], LOWER[1]]], axis=1)
        return energy, np.concatenate([by_centre, shape, by_density[:, None]], axis=1).ravel()

    def minimised(self, balls: Balls, steps: int) -> Balls:
        """Return the balls of least energy that a descent from these reaches in so many steps."""
        from scipy import optimize

        # The stubs of scipy know no function that returns its gradient and takes arguments.
        minimize: Any = optimize.minimize
        options = {"maxiter": steps, "maxcor": 20, "ftol": 1e-15, "gtol": 1e-12}
        free, sizes = (-np.inf, np.inf), 1 if balls.width == SPHERE else 3
        bounds = ([free] * 3 + [FLATTEST] * sizes + [free] * (balls.width - 3 - sizes)) * len(balls.densities)
        found = minimize(self.slope, balls.pack(), (balls.width,), "L-BFGS-B", jac=True, bounds=bounds, options=options)
        return Balls.unpack(np.asarray(found.x), balls.width)


def halves_of(ball: Balls, xyz: Floats, weight: Floats) -> Iterator[Balls]:
    """Yield two balls of half the density, half the lone radius off along the main axis of samples, then the others.

    Where no halves of an ellipsoid help, round ones of its volume may: a disc that fills a ring is such a trap.
    """
    weight = np.clip(weight, 0, None)
    if not weight.sum() > 0:
        weight = np.ones(len(xyz))
    mean = np.average(xyz, axis=0, weights=weight)
    spread = (weight[:, None] * (xyz - mean)).T @ (xyz - mean)
    # A ball below the threshold has no radius of its own.
    ratio = max(float(np.log(max(float(np.abs(ball.densities[0])), 1.0))), 0.25)
    centre, density = ball.centres[0], ball.densities[0] / 2
    own = ball.shapes[0]
    round_ = np.cbrt(np.diagonal(own).prod()) * np.eye(3)
    for shape in (own,) if ball.width == SPHERE else (own, round_):
        for axis in np.linalg.eigh(spread)[1].T[::-1]:
            shift = np.sqrt(ratio) / float(np.linalg.norm(shape @ axis)) / 2 * axis
            yield Balls(
                np.stack([centre + shift, centre - shift]),
                np.stack([shape, shape]),
                np.array([density, density]),
                ball.width,
            )
