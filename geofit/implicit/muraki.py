"""Metaballs fitted to samples of a surface by splitting one ball at a time.

S. Muraki, Volumetric shape description of range data using "blobby model", Computer Graphics 25(4), 1991. Differences:
the halves of a ball start apart, because identical ones are a saddle that no descent leaves; only the balls with the
largest residuals are tried, and each on the samples that it reaches; balls may be ellipsoids; all are polished together
whenever their number has doubled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import FitError, SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.ball_energy import ELLIPSOID, SPHERE, Balls, Energy, halves_of
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


@arguments_checked
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
    if not (alpha >= 0 and beta >= 0):
        raise SettingsError(
            message(
                "implicit.metaball-weights-negative",
                "alpha is {alpha} and beta is {beta}; give weights of 0 or more.",
                alpha=alpha,
                beta=beta,
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
    whole = Energy(x, directions, alpha, beta, 1 / len(x), zero, np.zeros_like(x))
    first = Balls(np.zeros((1, 3)), np.eye(3)[None], np.array([np.e]), SPHERE)
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


def _rms(xyz: Floats, balls: Balls) -> float:
    f, g = balls.potentials(xyz)
    slope = np.linalg.norm(g.sum(axis=0), axis=1)
    # Where the gradient vanishes the first order means nothing: no sample counts for more than the size of all.
    distance = np.minimum(np.abs(f.sum(axis=0) - 1) / np.maximum(slope, 1e-12), 1.0)
    return float(np.sqrt((distance**2).mean()))


def _best_split(whole: Energy, balls: Balls, tried: int) -> Balls | None:
    """Return the balls with one of them split, that which lowers the energy most; None if none does."""
    f, g = balls.potentials(whole.xyz)
    value, gradient = f.sum(axis=0), g.sum(axis=0)
    size = float(balls.sizes.sum())
    residual = whole.residuals(value, gradient)
    before = whole.weight * float(residual.sum()) + whole.beta * size**2
    owner = np.argmax(np.abs(f), axis=0)
    share = np.bincount(owner, residual, minlength=len(f))
    best: tuple[float, int, Balls] | None = None
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
        for apart in halves_of(balls.part([i]), whole.xyz[near], f[i, near] / value[near]):
            split = local.minimised(apart, STEPS_SPLIT)
            after = others.of(split)
            if after < before * (1 - 1e-6):
                if best is None or after < best[0]:
                    best = after, i, split
                break
    return None if best is None else balls.without(best[1]).with_(best[2])


def _without_idle(xyz: Floats, balls: Balls) -> tuple[Balls, int]:
    """Remove the smallest balls, as long as the rms distance rises by less than 1 % in all."""
    limit = 1.01 * _rms(xyz, balls)
    kept = np.ones(len(balls.densities), bool)
    for i in np.argsort(balls.sizes, kind="stable"):
        kept[i] = False
        if not kept.any() or _rms(xyz, balls.part(np.nonzero(kept)[0])) >= limit:
            kept[i] = True
    return balls.part(np.nonzero(kept)[0]), int((~kept).sum())
