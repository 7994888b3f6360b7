"""Compiled: distance to a chain of round cones."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["nearest_cone"]

Floats = NDArray[np.float64]


@njit(cache=True)
def nearest_cone(xyz: Floats, points: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Return the distance of (n, 3) points to the nearest cone, and the unit vector away from it.

    In the plane through the axis, with u along it and v from it, the mantle has the unit normal (s, c) with
    s = (r0 - r1) / length. A point belongs to the mantle if the normal through it meets the axis between the ends.
    """
    count, cones = xyz.shape[0], points.shape[0] - 1
    value, gradient = np.empty(count), np.full((count, 3), np.nan)
    for i in range(count):
        best = math.nan if math.isnan(xyz[i].sum()) else math.inf
        for k in range(cones):
            r0, r1 = radii[k], radii[k + 1]
            ax, ay, az = (
                points[k + 1, 0] - points[k, 0],
                points[k + 1, 1] - points[k, 1],
                points[k + 1, 2] - points[k, 2],
            )
            px, py, pz = xyz[i, 0] - points[k, 0], xyz[i, 1] - points[k, 1], xyz[i, 2] - points[k, 2]
            length = math.sqrt(ax * ax + ay * ay + az * az)
            along = math.sqrt(px * px + py * py + pz * pz)
            if along - length - max(r0, r1) > best:
                continue
            ax, ay, az = ax / length, ay / length, az / length
            u = px * ax + py * ay + pz * az
            wx, wy, wz = px - u * ax, py - u * ay, pz - u * az
            v = math.sqrt(wx * wx + wy * wy + wz * wz)
            s = (r0 - r1) / length
            at = 0.0 if s > 0 else length
            if abs(s) < 1:
                c = math.sqrt(1 - s * s)
                at = u - v * s / c
                if 0 < at < length:
                    d = s * u + c * v - r0
                    if d < best:
                        best = d
                        f = c / v if v > 0 else 0.0
                        gradient[i, 0] = s * ax + f * wx
                        gradient[i, 1] = s * ay + f * wy
                        gradient[i, 2] = s * az + f * wz
                    continue
            # A ball at one end; if one ball contains the other, the larger one.
            end, r = (0.0, r0) if at <= 0 else (length, r1)
            qx, qy, qz = px - end * ax, py - end * ay, pz - end * az
            q = math.sqrt(qx * qx + qy * qy + qz * qz)
            if q - r < best:
                best = q - r
                f = 1 / q if q > 0 else 0.0
                gradient[i, 0], gradient[i, 1], gradient[i, 2] = f * qx, f * qy, f * qz
        value[i] = best
    return value, gradient
