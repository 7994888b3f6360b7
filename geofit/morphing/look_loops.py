"""Compiled: a frame between two stored fields: its blocks with surface, its volume, and what it shares with another."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["block_spans", "cell_fractions", "gather_blocks", "joint_volumes", "mixed_blocks", "tetrahedra_volume"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Singles = NDArray[np.float32]

#: Corners of the six tetrahedra of a cell between its corners 0 and 7; corner 4 a + 2 b + c is at (a, b, c).
TETRAHEDRA = ((4, 6), (4, 5), (2, 6), (2, 3), (1, 5), (1, 3))


@njit(cache=True)
def mixed_blocks(first: NDArray[np.float32], last: NDArray[np.float32], s: float, block: int) -> Ints:
    """Return the first nodes (k, 3) of the blocks of (1 - s) first + s last that have both signs, in order."""
    nx, ny, nz = first.shape
    p, q = np.float32(1 - s), np.float32(s)
    bx, by, bz = -(-(nx - 1) // block), -(-(ny - 1) // block), -(-(nz - 1) // block)
    found = np.empty((bx * by * bz, 3), np.int64)
    count = 0
    for a in range(bx):
        for b in range(by):
            for c in range(bz):
                negative = positive = False
                for i in range(a * block, min(a * block + block + 1, nx)):
                    for j in range(b * block, min(b * block + block + 1, ny)):
                        for k in range(c * block, min(c * block + block + 1, nz)):
                            inside = p * first[i, j, k] + q * last[i, j, k] < 0
                            negative |= inside
                            positive |= not inside
                    if negative and positive:
                        break
                if negative and positive:
                    found[count, 0], found[count, 1], found[count, 2] = a * block, b * block, c * block
                    count += 1
    return found[:count]


@njit(cache=True)
def block_spans(
    first: NDArray[np.float32], last: NDArray[np.float32], block: int
) -> tuple[Ints, NDArray[np.float32], NDArray[np.float32]]:
    """Return the first nodes (k, 3) of the blocks of (1 - s) first + s last that may have both signs, and when.

    Beyond its least and its largest s in [0, 1] a block has one sign.
    """
    nx, ny, nz = first.shape
    bx, by, bz = -(-(nx - 1) // block), -(-(ny - 1) // block), -(-(nz - 1) // block)
    found = np.empty((bx * by * bz, 3), np.int64)
    low, high = np.empty(len(found), np.float32), np.empty(len(found), np.float32)
    count = 0
    for a in range(bx):
        for b in range(by):
            for c in range(bz):
                inside = outside = False
                join = np.array([2.0, -1.0])
                leave = np.array([2.0, -1.0])
                for i in range(a * block, min(a * block + block + 1, nx)):
                    for j in range(b * block, min(b * block + block + 1, ny)):
                        for k in range(c * block, min(c * block + block + 1, nz)):
                            p, q = first[i, j, k], last[i, j, k]
                            if p < 0 and q < 0:
                                inside = True
                            elif p >= 0 and q >= 0:
                                outside = True
                            else:
                                s = p / (p - q)
                                turn = leave if p < 0 else join
                                turn[0], turn[1] = min(turn[0], s), max(turn[1], s)
                joins, leaves = join[1] >= 0, leave[1] >= 0
                if not (joins or leaves) and not (inside and outside):
                    continue
                # Something is inside from ``start`` to ``stop``, and something outside from ``begin`` to ``end``.
                start = 0.0 if inside or leaves else join[0]
                stop = 1.0 if inside or joins else leave[1]
                begin = 0.0 if outside or joins else leave[0]
                end = 1.0 if outside or leaves else join[1]
                found[count, 0], found[count, 1], found[count, 2] = a * block, b * block, c * block
                low[count], high[count] = max(start, begin), min(stop, end)
                count += 1
    return found[:count], low[:count], high[:count]


@njit(cache=True)
def gather_blocks(
    first: NDArray[np.float32], last: NDArray[np.float32], s: float, blocks: Ints, block: int
) -> NDArray[np.float32]:
    """Return the samples (k, b + 1, b + 1, b + 1) of blocks, x fastest; infinite beyond the lattice."""
    nx, ny, nz = first.shape
    p, q = np.float32(1 - s), np.float32(s)
    values = np.full((len(blocks), block + 1, block + 1, block + 1), np.float32(np.inf))
    for n in range(len(blocks)):
        for i in range(min(block + 1, nx - blocks[n, 0])):
            for j in range(min(block + 1, ny - blocks[n, 1])):
                for k in range(min(block + 1, nz - blocks[n, 2])):
                    x, y, z = blocks[n, 0] + i, blocks[n, 1] + j, blocks[n, 2] + k
                    values[n, k, j, i] = p * first[x, y, z] + q * last[x, y, z]
    return values


@njit(cache=True)
def _passed(f: NDArray[np.floating], i: int, j: int, k: int) -> bool:
    """Return whether a node and the 26 around it are on both sides: else no plane cuts the cube about the node."""
    nx, ny, nz = f.shape
    inside = f[i, j, k] < 0
    for a in range(max(i - 1, 0), min(i + 2, nx)):
        for b in range(max(j - 1, 0), min(j + 2, ny)):
            for c in range(max(k - 1, 0), min(k + 2, nz)):
                if (f[a, b, c] < 0) != inside:
                    return True
    return False


@njit(cache=True)
def cell_fractions(f: NDArray[np.floating], h: float) -> NDArray[np.float32]:
    """Return the part of the cube about each node that a plane at the node's distance leaves inside.

    The distance is the sample over its slope: layers thinner than a spacing keep their volume. Only nodes next to the
    surface have one: elsewhere samples may jump from a bound of the distance to the distance.
    """
    nx, ny, nz = f.shape
    part = np.zeros((nx, ny, nz), np.float32)
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                value = f[i, j, k]
                if not _passed(f, i, j, k):
                    part[i, j, k] = 1.0 if value < 0 else 0.0
                    continue
                gx = (f[min(i + 1, nx - 1), j, k] - f[max(i - 1, 0), j, k]) / 2
                gy = (f[i, min(j + 1, ny - 1), k] - f[i, max(j - 1, 0), k]) / 2
                gz = (f[i, j, min(k + 1, nz - 1)] - f[i, j, max(k - 1, 0)]) / 2
                slope = np.sqrt(gx * gx + gy * gy + gz * gz)
                part[i, j, k] = min(max(0.5 - value / max(slope, 0.1 * h), 0.0), 1.0)
    return part


@njit(cache=True)
def _tetrahedron(a: float, b: float, c: float, d: float) -> float:
    """Part of a tetrahedron on which a linear function with these values at its corners is negative."""
    a, b, c, d = min(a, b), max(a, b), min(c, d), max(c, d)
    a, c, b, d = min(a, c), max(a, c), min(b, d), max(b, d)
    b, c = min(b, c), max(b, c)
    if a >= 0:
        return 0.0
    if d < 0:
        return 1.0
    if b >= 0:
        return float(a**3 / ((a - b) * (a - c) * (a - d)))
    if c >= 0:
        p, q = a / (a - c), a / (a - d)
        r, s = b / (b - c), b / (b - d)
        return float(p * q + q * r * (1 - p) + r * s * (1 - q))
    return float(1 - d**3 / ((d - a) * (d - b) * (d - c)))


@njit(cache=True)
def _cell(f: Floats) -> float:
    """Part of a cell on which samples at its eight corners, linear in six tetrahedra, are negative."""
    total = 0.0
    for second, third in TETRAHEDRA:
        total += _tetrahedron(f[0], f[second], f[third], f[7]) / 6
    return total


@njit(cache=True)
def tetrahedra_volume(f: NDArray[np.floating]) -> float:
    """Return the volume, in cells, on which samples linear in six tetrahedra a cell are negative."""
    nx, ny, nz = f.shape
    corner = np.empty(8)
    total = 0.0
    for i in range(nx - 1):
        for j in range(ny - 1):
            for k in range(nz - 1):
                count = 0
                for a in range(2):
                    for b in range(2):
                        for c in range(2):
                            count += f[i + a, j + b, k + c] < 0
                if count == 0:
                    continue
                if count == 8:
                    total += 1.0
                    continue
                for n in range(8):
                    corner[n] = f[i + n // 4, j + n // 2 % 2, k + n % 2]
                total += _cell(corner)
    return total


@njit(cache=True)
def joint_volumes(
    first: Singles, last: Singles, s: float, other: Singles, blocks: Ints, block: int
) -> tuple[float, float]:
    """Return the volumes, in cells, of the union and of the common part of (1 - s) first + s last and another body.

    Only cells of the given blocks count. Samples are linear in six tetrahedra a cell, so what lies between two bodies
    counts where it is thinner than a cell, too.
    """
    nx, ny, nz = first.shape
    p, q = np.float32(1 - s), np.float32(s)
    low, high = np.empty(8), np.empty(8)
    union = common = 0.0
    for n in range(len(blocks)):
        x, y, z = blocks[n]
        x_end, y_end, z_end = min(x + block, nx - 1), min(y + block, ny - 1), min(z + block, nz - 1)
        own = others = 0
        for i in range(x, x_end + 1):
            for j in range(y, y_end + 1):
                for k in range(z, z_end + 1):
                    own += p * first[i, j, k] + q * last[i, j, k] < 0
                    others += other[i, j, k] < 0
        nodes = (x_end - x + 1) * (y_end - y + 1) * (z_end - z + 1)
        if own in (0, nodes) and others in (0, nodes):
            cells = (x_end - x) * (y_end - y) * (z_end - z)
            union += cells if own + others > 0 else 0
            common += cells if own + others == 2 * nodes else 0
            continue
        for i in range(x, x_end):
            for j in range(y, y_end):
                for k in range(z, z_end):
                    either = both = 0
                    for c in range(8):
                        at = i + c // 4, j + c // 2 % 2, k + c % 2
                        value = p * first[at] + q * last[at]
                        low[c], high[c] = min(value, other[at]), max(value, other[at])
                        either += low[c] < 0
                        both += high[c] < 0
                    if either > 0:
                        union += 1.0 if either == 8 else _cell(low)
                    if both > 0:
                        common += 1.0 if both == 8 else _cell(high)
    return union, common
