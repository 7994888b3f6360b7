"""Literal definitions, compiled but not clever, that the fast ways are compared with."""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy import ndimage


def blobs(seed, shape=(24, 24, 24)):
    """A random pore space: smoothed noise cut at a random level, or plain noise."""
    rng = np.random.default_rng(seed)
    field = rng.random(shape)
    if seed % 4:
        field = ndimage.gaussian_filter(field, rng.uniform(0.4, 2.5))
    return field < np.quantile(field, rng.uniform(0.1, 0.9))


@njit(cache=True)
def ball_inside(reach2, a, b, c, other2):
    """Whether each voxel of {q : |q|² < reach2} lies in the ball of other2 at offset (a, b, c)."""
    m = int(np.sqrt(reach2)) + 1
    for i in range(-m, m + 1):
        for j in range(-m, m + 1):
            for k in range(-m, m + 1):
                if i * i + j * j + k * k < reach2 and (i - a) ** 2 + (j - b) ** 2 + (k - c) ** 2 >= other2:
                    return False
    return True


@njit(cache=True)
def maximal(reach2):
    """Every pore voxel whose ball lies in no other ball of the volume."""
    n0, n1, n2 = reach2.shape
    out = reach2 > 0
    for i in range(n0):
        for j in range(n1):
            for k in range(n2):
                own = reach2[i, j, k]
                m = int(np.sqrt(reach2.max())) + 1
                for a in range(max(i - m, 0), min(i + m + 1, n0)):
                    for b in range(max(j - m, 0), min(j + m + 1, n1)):
                        for c in range(max(k - m, 0), min(k + m + 1, n2)):
                            # A ball holds its own centre, so the other ball must hold it too.
                            far = (a - i) ** 2 + (b - j) ** 2 + (c - k) ** 2
                            if out[i, j, k] and reach2[a, b, c] > own and far < reach2[a, b, c]:
                                out[i, j, k] = not ball_inside(own, a - i, b - j, c - k, reach2[a, b, c])
    return out


@njit(cache=True)
def article_search(pore):
    """The article's step 1: 26 runs bound a cube, then all its voxels are looked at; R² and L² of each pore voxel.

    Where the cube leaves the sample it shrinks into it: half a side r, L² = (r + 1)².
    """
    n0, n1, n2 = pore.shape
    radius2, limit2 = np.full(pore.shape, -1), np.full(pore.shape, -1)
    for i in range(n0):
        for j in range(n1):
            for k in range(n2):
                if not pore[i, j, k]:
                    continue
                # The widest cube within the sample.
                bound = (min(i, j, k, n0 - 1 - i, n1 - 1 - j, n2 - 1 - k) + 1) ** 2
                for a in range(-1, 2):
                    for b in range(-1, 2):
                        for c in range(-1, 2):
                            x, y, z, steps = i, j, k, 0
                            while 0 <= x < n0 and 0 <= y < n1 and 0 <= z < n2 and pore[x, y, z]:
                                x, y, z, steps = x + a, y + b, z + c, steps + 1
                                if steps > 100:
                                    break
                            if steps <= 100 and 0 <= x < n0 and 0 <= y < n1 and 0 <= z < n2:
                                bound = min(bound, steps * steps * (a * a + b * b + c * c))
                half = int(np.sqrt(bound - 1))
                nearest, farthest = -1, 0
                for x in range(i - half, i + half + 1):
                    for y in range(j - half, j + half + 1):
                        for z in range(k - half, k + half + 1):
                            square = (x - i) ** 2 + (y - j) ** 2 + (z - k) ** 2
                            if square >= bound:
                                continue
                            if not pore[x, y, z]:
                                nearest = square if nearest < 0 else min(nearest, square)
                            else:
                                farthest = max(farthest, square)
                if nearest < 0:
                    radius2[i, j, k], limit2[i, j, k] = farthest, bound + 1
                    continue
                largest = 0
                for x in range(half + 1):
                    for y in range(x + 1):
                        for z in range(y + 1):
                            square = x * x + y * y + z * z
                            if square < nearest:
                                largest = max(largest, square)
                radius2[i, j, k], limit2[i, j, k] = largest, nearest + 1
    return radius2, limit2
