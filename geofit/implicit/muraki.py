"""Metaballs fitted to samples of a surface by splitting one ball at a time.

S. Muraki, Volumetric shape description of range data using "blobby model", Computer Graphics 25(4), 1991. Differences:
the halves of a ball start apart, because identical ones are a saddle that no descent leaves; only the balls with the
largest residuals are tried, and each on the samples that it reaches; balls may be ellipsoids; all are polished together
whenever their number has doubled.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import FitError, SettingsError
from geofit.data.messages import message
from geofit.implicit.blobs import Metaballs
from geofit.implicit.field import points_of
from geofit.implicit.kernels import potential

__all__ = ["BallFit", "fit_metaballs"]

Floats = NDArray[np.float64]

#: Balls with the largest residuals that are tried for each split.
TRIED = 8
#: A split looks at the samples where the potential of its ball exceeds this part of the threshold.
LOCAL = 1e-3
STEPS_SPLIT, STEPS_POLISH = 60, 200
RELAXED, GROWTH = 1e-6, 1.1
#: Ball parameters: centre, logarithms of the diagonal of A and its lower part, density.
SPHERE, ELLIPSOID = 5, 10
LOWER = np.tril_indices(3, -1)
#: Bounds of ln A for samples of unit size. Without the lower one a wide ball with b = T is on all samples at once.
FLATTEST = (-1.5, 6.0)


@dataclass(frozen=True, eq=False)
class BallFit:
    """Metaballs fitted to samples.

    Parameters
    ----------
    body : Metaballs
        The balls, Blinn's potential.
    energies : tuple of float
        Energy after every split, that of a single ball first; the last one after a polish with
        ``beta`` relaxed, if the balls did not grow by it.
    rms : float
        Root mean square distance of the samples from the surface, to first order, metres.
    dropped : int
        Balls removed at the end because the rest fits as well without them.
    """

    body: Metaballs
    energies: tuple[float, ...]
    rms: float
    dropped: int


@dataclass(frozen=True, eq=False)
class _Balls:
    """Centres (n, 3), matrices A (n, 3, 3) lower triangular, densities (n,), for samples of unit size and T = 1."""

    centres: Floats
    shapes: Floats
    densities: Floats
    width: int

    def pack(self) -> Floats:
        diagonal = np.log(np.diagonal(self.shapes, axis1=1, axis2=2))
        if self.width == SPHERE:
            return np.concatenate([self.centres, diagonal[:, :1], self.densities[:, None]], axis=1).ravel()
        lower = self.shapes[:, LOWER[0], LOWER[1]]
        return np.concatenate([self.centres, diagonal, lower, self.densities[:, None]], axis=1).ravel()

    @staticmethod
    def unpack(parameters: Floats, width: int) -> _Balls:
        rows = parameters.reshape(-1, width)
        shapes = np.zeros((len(rows), 3, 3))
        shapes[:, range(3), range(3)] = np.exp(rows[:, 3:4] if width == SPHERE else rows[:, 3:6])
        if width == ELLIPSOID:
            shapes[:, LOWER[0], LOWER[1]] = rows[:, 6:9]
        return _Balls(rows[:, :3].copy(), shapes, rows[:, -1].copy(), width)

    def part(self, index: NDArray[np.intp] | list[int]) -> _Balls:
        return _Balls(self.centres[index], self.shapes[index], self.densities[index], self.width)

    def with_(self, other: _Balls) -> _Balls:
        return _Balls(
            np.concatenate([self.centres, other.centres]),
            np.concatenate([self.shapes, other.shapes]),
            np.concatenate([self.densities, other.densities]),
            self.width,
        )

    def without(self, i: int) -> _Balls:
        return self.part(np.delete(np.arange(len(self.densities)), i))

    def potentials(self, xyz: Floats) -> tuple[Floats, Floats]:
        """Values (n, m) and gradients (n, m, 3) of every ball at m samples."""
        y = (xyz - self.centres[:, None]) @ self.shapes.transpose(0, 2, 1)
        f = self.densities[:, None] * np.exp(-(y**2).sum(axis=2))
        return f, -2 * f[:, :, None] * (y @ self.shapes)

    @property
    def sizes(self) -> Floats:
        """Integrals over space but for pi^(3/2), by absolute density."""
        return np.asarray(np.abs(self.densities) / np.diagonal(self.shapes, axis1=1, axis2=2).prod(axis=1))


@dataclass(frozen=True, eq=False)
class _Energy:
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

    def of(self, balls: _Balls) -> float:
        f, g = balls.potentials(self.xyz)
        value, gradient = self.fixed_value + f.sum(axis=0), self.fixed_gradient + g.sum(axis=0)
        size = self.fixed_size + float(balls.sizes.sum())
        return float(self.weight * self.residuals(value, gradient).sum() + self.beta * size**2)

    def residuals(self, value: Floats, gradient: Floats) -> Floats:
        length = np.linalg.norm(gradient, axis=1)
        cosine = -(self.normal * gradient).sum(axis=1) / np.where(length > 0, length, 1.0)
        return np.asarray((value - 1) ** 2 + self.alpha * 2 * (1 - cosine))

    def slope(self, parameters: Floats, width: int) -> tuple[float, Floats]:
        """Return the energy and its gradient by the parameters."""
        balls = _Balls.unpack(parameters, width)
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

    def minimised(self, balls: _Balls, steps: int) -> _Balls:
        from scipy import optimize

        # The stubs of scipy know no function that returns its gradient and takes arguments.
        minimize: Any = optimize.minimize
        options = {"maxiter": steps, "maxcor": 20, "ftol": 1e-15, "gtol": 1e-12}
        free, sizes = (-np.inf, np.inf), 1 if balls.width == SPHERE else 3
        bounds = ([free] * 3 + [FLATTEST] * sizes + [free] * (balls.width - 3 - sizes)) * len(balls.densities)
        found = minimize(self.slope, balls.pack(), (balls.width,), "L-BFGS-B", jac=True, bounds=bounds, options=options)
        return _Balls.unpack(np.asarray(found.x), balls.width)


def fit_metaballs(
    xyz: ArrayLike,
    normals: ArrayLike,
    *,
    epsilon: float,
    most: int = 400,
    ellipsoidal: bool = False,
    alpha: float = 1.0,
    beta: float = 1e-4,
    tried: int = TRIED,
    progress: Callable[[str, float], bool] | None = None,
) -> BallFit:
    """Return metaballs whose surface passes near samples.

    Parameters
    ----------
    xyz : (m, 3) array
        Samples of the surface, metres; evenly spread (:func:`geofit.implicit.particles.even_samples`).
    normals : (m, 3) array
        Outward unit normals there.
    epsilon : float
        Splitting ends when the rms distance of the samples falls below this, metres.
    most : int
        Largest number of balls.
    ellipsoidal : bool
        Balls become ellipsoids after the first fit of a sphere: flat bodies need fewer of them.
    alpha, beta : float
        Weights of the normals, and of the size of all balls, which keeps them from bulging where there are no samples;
        ``beta`` falls to a millionth for the last polish, which is taken back if the balls grow by it.
    tried : int
        Balls with the largest residuals that are tried for each split; as many as ``most`` tries all, as Muraki did.
    progress : callable, optional
        Called as ``progress("metaballs", fraction)``; False stops the splitting.

    Raises
    ------
    FitError
        If there are fewer than 10 samples, or no surface results.
    SettingsError
        If ``epsilon`` is not positive, or there are not as many normals as samples.
    """
    points, directions = points_of(xyz), points_of(normals)
    if len(points) != len(directions) or not epsilon > 0 or most < 1:
        raise SettingsError(
            message(
                "implicit.metaball-settings-unusable",
                "{points} samples need as many normals, not {normals}; epsilon {epsilon} and most {most} positive",
                points=len(points),
                normals=len(directions),
                epsilon=epsilon,
                most=most,
            )
        )
    if len(points) < 10:
        raise FitError(
            message("implicit.too-few-samples", "{count} samples do not fix a body: give 10 or more", count=len(points))
        )
    middle = points.mean(axis=0)
    scale = float(np.sqrt(((points - middle) ** 2).sum(axis=1).mean()))
    x = (points - middle) / scale
    zero = np.zeros(len(x))
    whole = _Energy(x, directions, alpha, beta, 1 / len(x), zero, np.zeros_like(x))
    first = _Balls(np.zeros((1, 3)), np.eye(3)[None], np.array([np.e]), SPHERE)
    balls = whole.minimised(first, STEPS_POLISH)
    if ellipsoidal:
        balls = whole.minimised(replace(balls, width=ELLIPSOID), STEPS_POLISH)
    energies = [whole.of(balls)]
    polished = 1
    while len(balls.densities) < most and _rms(x, balls) * scale >= epsilon:
        if progress is not None and not progress("metaballs", len(balls.densities) / most):
            break
        split = _best_split(whole, balls, tried)
        if split is None and polished == len(balls.densities):
            break
        if split is not None:
            balls = split
            energies.append(whole.of(balls))
        if split is None or len(balls.densities) >= 2 * polished:
            balls, polished = whole.minimised(balls, STEPS_POLISH), len(balls.densities)
            energies[-1] = whole.of(balls)
    if polished != len(balls.densities):
        balls = whole.minimised(balls, STEPS_POLISH)
        energies[-1] = whole.of(balls)
    # The weight of the size leads to the right basin; there it only pulls the surface inwards, unless it also keeps
    # balls from growing where there are no samples.
    relaxed = replace(whole, beta=RELAXED * beta)
    free = relaxed.minimised(balls, 2 * STEPS_POLISH)
    if free.sizes.sum() <= GROWTH * balls.sizes.sum():
        balls = free
        energies.append(relaxed.of(balls))
    balls, dropped = _without_idle(x, balls)
    try:
        body = Metaballs(
            balls.centres * scale + middle, balls.shapes / scale, balls.densities, potential("blinn"), threshold=1.0
        )
    except SettingsError as error:
        raise FitError(
            message(
                "implicit.balls-without-surface",
                "the balls have no surface: are the normals outward? ({reason})",
                reason=error,
            )
        ) from error
    return BallFit(body, tuple(energies), _rms(x, balls) * scale, dropped)


def _rms(xyz: Floats, balls: _Balls) -> float:
    f, g = balls.potentials(xyz)
    slope = np.linalg.norm(g.sum(axis=0), axis=1)
    # Where the gradient vanishes the first order means nothing: no sample counts for more than the size of all.
    distance = np.minimum(np.abs(f.sum(axis=0) - 1) / np.maximum(slope, 1e-12), 1.0)
    return float(np.sqrt((distance**2).mean()))


def _best_split(whole: _Energy, balls: _Balls, tried: int) -> _Balls | None:
    """Return the balls with one of them split, that which lowers the energy most; None if none does."""
    f, g = balls.potentials(whole.xyz)
    value, gradient = f.sum(axis=0), g.sum(axis=0)
    size = float(balls.sizes.sum())
    residual = whole.residuals(value, gradient)
    before = whole.weight * float(residual.sum()) + whole.beta * size**2
    owner = np.argmax(np.abs(f), axis=0)
    share = np.bincount(owner, residual, minlength=len(f))
    best: tuple[float, int, _Balls] | None = None
    for i in np.argsort(-share, kind="stable")[:tried].tolist():
        near = np.abs(f[i]) > LOCAL
        if near.sum() < 5:
            continue
        local = replace(
            whole,
            xyz=whole.xyz[near],
            normal=whole.normal[near],
            fixed_value=(value - f[i])[near],
            fixed_gradient=(gradient - g[i])[near],
            fixed_size=size - float(balls.sizes[i]),
        )
        # The halves may reach samples that the ball did not.
        others = replace(whole, fixed_value=value - f[i], fixed_gradient=gradient - g[i], fixed_size=local.fixed_size)
        for apart in _halves(balls.part([i]), whole.xyz[near], f[i, near] / value[near]):
            halves = local.minimised(apart, STEPS_SPLIT)
            after = others.of(halves)
            if after < before * (1 - 1e-6):
                if best is None or after < best[0]:
                    best = after, i, halves
                break
    return None if best is None else balls.without(best[1]).with_(best[2])


def _halves(ball: _Balls, xyz: Floats, weight: Floats) -> Iterator[_Balls]:
    """Two balls of half the density, half the lone radius off along the main axis of the samples, then the others.

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
            yield _Balls(
                np.stack([centre + shift, centre - shift]),
                np.stack([shape, shape]),
                np.array([density, density]),
                ball.width,
            )


def _without_idle(xyz: Floats, balls: _Balls) -> tuple[_Balls, int]:
    """Remove the smallest balls, as long as the rms distance rises by less than 1 % in all."""
    limit = 1.01 * _rms(xyz, balls)
    kept = np.ones(len(balls.densities), bool)
    for i in np.argsort(balls.sizes, kind="stable"):
        kept[i] = False
        if not kept.any() or _rms(xyz, balls.part(np.nonzero(kept)[0])) >= limit:
            kept[i] = True
    return balls.part(np.nonzero(kept)[0]), int((~kept).sum())
