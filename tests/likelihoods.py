"""Points about a wavy plane, and the likelihood of a field through them."""

from __future__ import annotations

import numpy as np

from geofit.fitting.likelihood import Likelihood, Slope
from geofit.splines import bspline
from geofit.splines.tensor import TensorSpace

N = 60


def setting(seed=0, columns=1):
    rng = np.random.default_rng(seed)
    space = TensorSpace(bspline.clamped_knots(np.arange(-2, 11.0), 3), bspline.clamped_knots(np.arange(-2, 9.0), 3))
    plane = rng.uniform(0, 7, (N, 2))
    z = np.sin(plane[:, 0]) + 0.3 * plane[:, 1] + rng.normal(0, 0.1, N)
    z = z if columns == 1 else np.column_stack([z, plane[:, 0], np.cos(plane[:, 1])])
    weight = rng.uniform(0.5, 2, N)
    return space, plane, z, weight


def judge(space, plane, z, weight, alpha, slope=None):
    band, right = space.normal_equations(plane, z, weight)
    square = float((weight @ z.reshape(N, -1) ** 2).sum())
    slope = Slope(np.eye(3), np.zeros(3), 0.0) if slope is None else slope
    return Likelihood(space, alpha, band, right, square, slope, N)
