"""Distances to a trimmed patch by a search that is dense rather than clever, to compare with."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from geofit.geometry.trim_loops import inside_loops
from geofit.splines.patch import Patch

__all__ = ["converged_distances", "ring"]

#: Places a side of the dense lattice, starts a point, steps of Newton's method; places along the edge, its starts.
LATTICE, STARTS, STEPS = 400, 48, 40
AROUND, BESIDE = 200_000, 24


def converged_distances(patch: Patch, loops: tuple[np.ndarray, ...], xyz: np.ndarray) -> np.ndarray:
    """Return the distances (n,) of points to a patch within its loops, or to the whole patch where there are none."""
    u0, u1, v0, v1 = patch.domain
    edge = loops or (np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]]),)
    return np.minimum(_within(patch, loops, xyz), np.min([_along(patch, loop, xyz) for loop in edge], axis=0))


def _within(patch: Patch, loops: tuple[np.ndarray, ...], xyz: np.ndarray) -> np.ndarray:
    """Return the distances to feet inside the loops, by Newton's method from many places of a dense lattice."""
    u0, u1, v0, v1 = patch.domain
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(u0, u1, LATTICE), np.linspace(v0, v1, LATTICE)))
    held = inside_loops(patch, loops, u, v)
    u, v = u[held], v[held]
    starts = cKDTree(patch.evaluate(u, v)).query(xyz, k=STARTS)[1].ravel()
    u, v, target = u[starts], v[starts], np.repeat(xyz, STARTS, axis=0)
    best = np.full(len(u), np.inf)
    for _ in range(STEPS):
        s, su, sv = (patch.evaluate(u, v, *order) for order in ((0, 0), (1, 0), (0, 1)))
        suu, suv, svv = (patch.evaluate(u, v, *order) for order in ((2, 0), (1, 1), (0, 2)))
        away = s - target
        best = np.minimum(best, np.where(inside_loops(patch, loops, u, v), np.linalg.norm(away, axis=1), np.inf))

        def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
            return np.einsum("nk,nk->n", a, b)

        gu, gv = dot(away, su), dot(away, sv)
        a, b, c = dot(su, su) + dot(away, suu), dot(su, sv) + dot(away, suv), dot(sv, sv) + dot(away, svv)
        # Where the Hessian does not point downhill, Gauss and Newton's does.
        poor = (a * c - b * b <= 1e-12 * dot(su, su) * dot(sv, sv)) | (a <= 0)
        a, b, c = (np.where(poor, g, h) for g, h in ((dot(su, su), a), (dot(su, sv), b), (dot(sv, sv), c)))
        determinant = a * c - b * b
        du, dv = (b * gv - c * gu) / determinant, (b * gu - a * gv) / determinant
        u, v = (
            np.clip(u + np.clip(du, -(u1 - u0) / 60, (u1 - u0) / 60), u0, u1),
            np.clip(v + np.clip(dv, -(v1 - v0) / 60, (v1 - v0) / 60), v0, v1),
        )
    return best.reshape(len(xyz), STARTS).min(axis=1)


def _along(patch: Patch, loop: np.ndarray, xyz: np.ndarray) -> np.ndarray:
    """Return the distances to a loop, by ternary search around the nearest of many places of it."""
    ends = np.roll(loop, -1, axis=0)
    count = max(2, AROUND // len(loop))
    share = np.arange(count) / count
    start = (loop[:, None] + share[:, None] * (ends - loop)[:, None]).reshape(-1, 2)
    way = np.repeat((ends - loop) / count, count, axis=0)
    piece = cKDTree(patch.evaluate(*(start + way / 2).T)).query(xyz, k=BESIDE)[1].ravel()
    target = np.repeat(xyz, BESIDE, axis=0)
    low, high = np.zeros(len(piece)), np.ones(len(piece))

    def far(t: np.ndarray) -> np.ndarray:
        return np.linalg.norm(patch.evaluate(*(start[piece] + t[:, None] * way[piece]).T) - target, axis=1)

    for _ in range(45):
        third = (high - low) / 3
        left = far(low + third) <= far(high - third)
        low, high = np.where(left, low, low + third), np.where(left, high - third, high)
    return np.minimum(far((low + high) / 2), np.minimum(far(low), far(high))).reshape(len(xyz), BESIDE).min(axis=1)


def ring(patch: Patch, middle: tuple[float, float], radius: float, count: int) -> np.ndarray:
    """Return a loop of five rays in the parameters of a patch; middle and radius are shares of its sides."""
    u0, u1, v0, v1 = patch.domain
    t = np.linspace(0, 2 * np.pi, count, endpoint=False)
    r = radius * (1 + 0.15 * np.sin(5 * t))
    return np.column_stack([u0 + (u1 - u0) * (middle[0] + r * np.cos(t)), v0 + (v1 - v0) * (middle[1] + r * np.sin(t))])
