"""Patches that cannot cross: height fields over one plane, each over its own part of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geofit.geometry.elevation import PlanMap, plan_map
from geofit.splines import bspline
from geofit.splines.patch import Patch, Patches

__all__ = ["lie_apart", "one_sheet"]

Floats = NDArray[np.float64]

#: Share of the size of all by which the plans of patches side by side may overlap: rounding.
SHARED = 1e-11
#: Share of the coordinates below which what bends a patch is their rounding.
FLAT = 1e-12


def one_sheet(patches: Sequence[Patch]) -> bool:
    """Whether patches are height fields over one plane and lie apart in it.

    Over each place of the plane such patches stand once, so they cannot cross themselves or each other. That is a proof
    for the patches as they are: no place is sampled, and no frame is taken on trust.
    """
    return Patches.of(patches).prepared(_one_sheet)


def lie_apart(plans: Sequence[PlanMap], patches: Sequence[Patch]) -> bool:
    """Whether patches share no more than edges in plan; not if one is laid out in another direction than the first."""
    low, high = [], []
    for plan, patch in zip(plans, patches, strict=True):
        u0, u1, v0, v1 = patch.domain
        corners = plan.matrix @ [[u0, u1, u1, u0], [v0, v0, v1, v1]] + plan.start[:, None]
        held = plans[0].parameters(corners)
        low.append(held.min(axis=1))
        high.append(held.max(axis=1))
    size = np.max(high, axis=0) - np.min(low, axis=0)
    common = np.minimum(np.array(high)[:, None], high) - np.maximum(np.array(low)[:, None], low)
    over = (common > SHARED * size).all(axis=2)
    return bool(over.sum() == len(low))


def _one_sheet(patches: Patches) -> bool:
    turn = _across(patches)
    level = [replace(patch, control=patch.control @ turn) for patch in patches]
    plans = [plan for patch in level if (plan := plan_map(patch)) is not None]
    return len(plans) == len(level) and lie_apart(plans, level)


def _across(patches: Patches) -> Floats:
    """Return the rotation (3, 3), for rows from its left, that sets the heights of the patches upright.

    What is left of the control points without their affine part lies along the heights; of planes nothing is left.
    """
    control = patches[0].control
    normal = np.cross(control[-1, 0] - control[0, 0], control[0, -1] - control[0, 0])
    heights = np.concatenate([_bent(patch) for patch in patches])
    flat = np.abs(heights).max() <= FLAT * np.abs(control).max()
    _, _, axes = np.linalg.svd(normal[None] if flat else heights, full_matrices=bool(flat))
    return np.asarray(axes[[1, 2, 0]].T)


def _bent(patch: Patch) -> Floats:
    """Return the control points (n, 3) without their affine part over the Greville abscissae."""
    u, v = np.meshgrid(
        bspline.greville(patch.knots_u, patch.degree[0]),
        bspline.greville(patch.knots_v, patch.degree[1]),
        indexing="ij",
    )
    flat = np.column_stack([np.ones(u.size), u.ravel() - u.mean(), v.ravel() - v.mean()])
    points = patch.control.reshape(-1, 3)
    return np.asarray(points - flat @ np.linalg.lstsq(flat, points, rcond=None)[0])
