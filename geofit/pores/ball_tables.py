r"""Look-up tables that decide whether a digital ball lies inside another one (Remy & Thiel 2005).

A ball of squared radius bound F² is the set {q : |q - p|² < F²}. The ball at p lies inside a ball at p + g exactly
if F²[p + g] >= T_g[F²[p]]. A small set of directions g, with all their rotations and reflections, settles the question
for every shape: each direction is the shortest one that some digital ball needs before its centre is its only axis
point.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from geofit.pores.distance_scans import scan_envelopes, scan_rows

__all__ = ["DIRECTIONS", "EXACT_LIMIT", "ball_directions", "inclusion_table", "signed_directions"]

#: Directions (largest component first), each with the F² from which on it is needed; made by `ball_directions`.
DIRECTIONS: tuple[tuple[int, int, int, int], ...] = (
    (1, 0, 0, 2), (1, 1, 0, 3), (1, 1, 1, 4), (2, 1, 1, 27), (2, 1, 0, 50), (3, 1, 0, 66), (3, 1, 1, 68),
    (2, 2, 1, 84), (3, 2, 1, 90), (4, 2, 1, 135), (4, 1, 1, 147), (4, 3, 1, 166), (3, 3, 1, 181), (4, 3, 2, 196),
    (5, 1, 1, 199), (3, 2, 0, 204), (5, 3, 1, 204), (5, 3, 2, 212), (3, 2, 2, 230), (5, 2, 1, 234), (4, 1, 0, 293),
    (5, 2, 0, 299), (6, 3, 1, 307), (6, 2, 1, 309), (5, 2, 2, 318), (5, 1, 0, 326), (5, 4, 1, 342), (7, 2, 1, 342),
    (3, 3, 2, 356), (6, 4, 1, 374), (7, 5, 2, 374), (6, 1, 1, 403), (5, 4, 2, 406), (5, 3, 0, 426), (5, 3, 3, 460),
    (7, 3, 1, 500), (11, 5, 2, 500), (8, 2, 1, 547), (4, 4, 1, 549), (8, 5, 2, 549), (5, 5, 2, 551), (6, 3, 2, 559),
    (6, 5, 2, 559), (5, 4, 3, 569), (7, 4, 2, 572), (7, 1, 1, 580), (7, 2, 2, 604), (6, 5, 1, 652), (6, 4, 3, 661),
    (9, 2, 1, 691), (7, 5, 1, 692), (7, 5, 3, 692), (9, 3, 1, 700), (7, 3, 2, 715), (8, 3, 1, 723), (4, 3, 0, 726),
    (7, 4, 1, 747), (8, 4, 1, 771), (6, 5, 3, 781), (8, 5, 1, 820), (8, 6, 3, 825), (8, 4, 3, 842), (9, 6, 2, 860),
    (8, 5, 3, 868), (7, 6, 4, 876), (8, 1, 1, 903), (9, 5, 3, 916), (10, 3, 1, 932), (5, 5, 3, 948), (6, 1, 0, 965),
    (7, 5, 4, 990), (7, 4, 3, 996), (7, 4, 4, 998), (7, 6, 3, 1014), (9, 6, 4, 1017), (5, 5, 1, 1018),
    (7, 1, 0, 1026), (7, 6, 2, 1026), (10, 2, 1, 1042), (4, 3, 3, 1049), (7, 6, 1, 1062), (9, 6, 1, 1070),
    (12, 8, 3, 1090), (8, 6, 1, 1113), (8, 7, 2, 1116), (12, 8, 5, 1122), (9, 6, 5, 1146), (9, 5, 2, 1167),
    (10, 7, 2, 1173), (9, 4, 1, 1219), (9, 1, 1, 1229), (7, 5, 0, 1253), (9, 4, 2, 1259), (13, 3, 1, 1261),
    (11, 8, 2, 1268), (9, 4, 3, 1270), (8, 3, 2, 1275), (4, 4, 3, 1284), (10, 4, 1, 1284), (6, 5, 4, 1292),
    (13, 7, 4, 1301), (11, 2, 1, 1311), (9, 5, 1, 1318), (10, 5, 2, 1323), (11, 6, 2, 1323), (9, 7, 3, 1350),
    (11, 6, 4, 1362), (10, 5, 3, 1363), (11, 3, 1, 1372), (9, 3, 2, 1396), (9, 8, 2, 1420), (12, 3, 1, 1444),
    (14, 5, 3, 1446), (9, 7, 1, 1466), (7, 3, 0, 1470), (9, 7, 2, 1484), (10, 6, 1, 1485), (10, 8, 3, 1561),
    (8, 5, 4, 1570), (10, 5, 1, 1587), (11, 5, 3, 1637), (11, 7, 2, 1668), (13, 5, 2, 1668), (5, 4, 0, 1686),
    (8, 7, 1, 1686), (10, 8, 1, 1686), (12, 9, 7, 1722), (10, 7, 4, 1734), (10, 1, 1, 1767), (12, 9, 4, 1772),
    (13, 2, 1, 1779), (12, 4, 1, 1781), (12, 2, 1, 1782), (7, 2, 0, 1814), (10, 7, 1, 1818), (9, 7, 4, 1850),
    (6, 6, 1, 1865), (10, 3, 2, 1891), (11, 5, 1, 1923), (11, 9, 3, 1924), (8, 7, 3, 1979), (17, 5, 2, 1998),
    (11, 7, 3, 2010), (15, 9, 4, 2022), (12, 5, 2, 2059), (5, 4, 4, 2083), (12, 5, 1, 2090), (10, 7, 5, 2099),
    (11, 7, 4, 2100), (8, 6, 5, 2107), (11, 8, 6, 2150), (8, 7, 4, 2157), (11, 7, 1, 2175), (12, 9, 5, 2180),
    (12, 5, 3, 2212), (10, 6, 3, 2242), (7, 5, 5, 2251), (11, 4, 1, 2260), (13, 5, 1, 2260), (11, 8, 1, 2286),
    (13, 4, 1, 2286), (11, 1, 1, 2308), (11, 3, 2, 2316), (11, 5, 4, 2334), (7, 3, 3, 2355), (14, 3, 1, 2356),
    (15, 3, 1, 2356), (8, 3, 3, 2364), (13, 8, 2, 2395), (7, 7, 2, 2404), (8, 1, 0, 2405), (11, 6, 1, 2406),
    (9, 2, 2, 2418), (9, 4, 4, 2450), (12, 3, 2, 2490), (11, 9, 5, 2500), (9, 1, 0, 2502), (15, 11, 3, 2506),
    (11, 8, 3, 2532), (9, 7, 5, 2541), (16, 3, 1, 2548), (8, 5, 5, 2564), (5, 5, 4, 2580), (11, 8, 5, 2581),
    (12, 7, 4, 2587), (7, 6, 5, 2596), (9, 8, 1, 2596), (8, 7, 5, 2602), (11, 6, 3, 2637), (10, 8, 5, 2639),
    (12, 7, 1, 2650), (11, 7, 5, 2658), (9, 7, 6, 2726), (17, 9, 5, 2802), (9, 5, 4, 2804), (11, 7, 6, 2826),
    (13, 8, 7, 2826), (19, 8, 5, 2826), (14, 8, 5, 2838), (11, 9, 6, 2850), (14, 10, 3, 2860), (13, 4, 2, 2863),
    (16, 7, 3, 2870), (20, 7, 3, 2878), (8, 3, 0, 2881), (14, 4, 1, 2890), (17, 7, 4, 2890), (12, 8, 1, 2899),
    (10, 9, 2, 2935), (17, 3, 1, 2956), (18, 3, 1, 2957), (7, 7, 1, 2970), (12, 6, 1, 2979), (15, 9, 5, 2980),
    (12, 9, 1, 2986), (7, 4, 0, 2987), (14, 5, 1, 2990), (13, 3, 2, 2995), (14, 3, 2, 2995), (8, 7, 6, 3019),
    (12, 10, 3, 3034), (13, 5, 3, 3050), (15, 10, 2, 3059), (11, 9, 1, 3060), (11, 10, 2, 3067), (13, 6, 5, 3090),
    (10, 5, 4, 3130), (13, 4, 3, 3138), (12, 1, 1, 3139), (13, 10, 1, 3140), (13, 6, 4, 3147), (9, 8, 6, 3151),
    (10, 9, 7, 3151), (12, 7, 3, 3155), (15, 7, 4, 3157), (13, 6, 2, 3169), (19, 3, 1, 3172), (13, 7, 1, 3181),
    (16, 7, 4, 3188), (10, 7, 3, 3214), (14, 11, 7, 3219), (13, 8, 1, 3234), (18, 7, 3, 3276), (17, 11, 2, 3308),
    (14, 5, 2, 3315), (17, 8, 6, 3322), (15, 7, 5, 3356), (6, 5, 0, 3366), (15, 7, 6, 3366), (11, 8, 7, 3382),
    (11, 4, 2, 3386), (15, 5, 3, 3386), (20, 3, 1, 3396), (13, 8, 6, 3399), (12, 9, 2, 3406), (13, 10, 2, 3406),
    (13, 7, 2, 3423), (11, 9, 4, 3429), (13, 10, 3, 3430), (17, 12, 8, 3430), (9, 8, 5, 3450), (15, 8, 2, 3450),
    (17, 15, 6, 3450), (21, 10, 3, 3450), (12, 7, 5, 3460), (13, 7, 5, 3470), (15, 9, 1, 3493), (12, 10, 1, 3535),
    (10, 7, 6, 3563), (15, 12, 4, 3594), (14, 8, 1, 3595), (15, 7, 2, 3611), (17, 2, 1, 3618), (15, 2, 1, 3628),
    (21, 3, 1, 3628), (9, 8, 3, 3630), (14, 2, 1, 3635), (10, 6, 5, 3654), (15, 6, 1, 3654), (15, 9, 8, 3654),
    (10, 8, 7, 3681), (10, 4, 3, 3682), (14, 7, 4, 3691), (10, 9, 1, 3702), (11, 8, 4, 3705), (15, 5, 1, 3716),
    (12, 4, 3, 3723), (14, 11, 2, 3738), (15, 5, 2, 3742), (15, 3, 2, 3746), (15, 8, 6, 3762), (7, 7, 4, 3772),
    (13, 11, 5, 3820), (17, 8, 5, 3834), (14, 6, 1, 3842), (13, 1, 1, 3847), (18, 11, 8, 3849), (14, 11, 3, 3852),
    (16, 5, 2, 3859), (22, 3, 1, 3868), (13, 11, 1, 3876), (13, 9, 7, 3876), (15, 7, 3, 3877), (14, 11, 1, 3906),
    (15, 12, 2, 3910), (11, 9, 2, 3916), (23, 9, 4, 3930), (11, 2, 2, 3932), (13, 9, 1, 3947), (11, 3, 0, 3966),
    (13, 9, 6, 3979), (13, 6, 1, 4006), (17, 6, 4, 4083), (12, 11, 2, 4084),
)  # fmt: skip
#: Up to this F² the directions are complete; a larger ball may be kept although another one includes it.
EXACT_LIMIT = 4100


def signed_directions(generators: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return all rotations and reflections of the generators, and which generator each one came from.

    Parameters
    ----------
    generators : ndarray of int, shape (n, 3)

    Returns
    -------
    directions : ndarray of int, shape (m, 3)
    source : ndarray of int, shape (m,)
    """
    signs = np.array([[1 - 2 * (bits >> axis & 1) for axis in range(3)] for bits in range(8)])
    orders = np.array([(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)])
    directions: list[NDArray[np.int64]] = []
    source: list[int] = []
    for index, generator in enumerate(generators):
        turned = np.unique((generator[orders][:, None, :] * signs[None]).reshape(-1, 3), axis=0)
        directions.append(turned)
        source += [index] * len(turned)
    return np.concatenate(directions), np.array(source)


@njit(cache=True)
def inclusion_table(g0: int, g1: int, g2: int, limit: int) -> NDArray[np.int32]:
    r"""Return T_g for F² = 0 ... ``limit``: 1 + the largest |q - g|² of a voxel q with |q|² < F².

    The components of g must not rise: then the farthest q of a radius is opposite to g and sorted like it, so a 48th of
    the ball is enough.
    """
    farthest = np.zeros(limit + 1, np.int32)
    a = 0
    while a * a <= limit:
        for b in range(a + 1):
            if a * a + b * b > limit:
                break
            for c in range(b + 1):
                square = a * a + b * b + c * c
                if square > limit:
                    break
                reach = (a + g0) ** 2 + (b + g1) ** 2 + (c + g2) ** 2
                farthest[square] = max(farthest[square], reach)
        a += 1
    table = np.zeros(limit + 1, np.int32)
    largest = 0
    for square in range(limit):
        largest = max(largest, farthest[square])
        table[square + 1] = largest + 1
    return table


def ball_directions(limit: int) -> list[tuple[int, int, int, int]]:
    """Grow the set of directions, ball by ball, until every ball with F² up to ``limit`` has its centre alone as axis.

    Returns
    -------
    list of (g0, g1, g2, F²)
        The directions in the order in which they are needed.
    """
    size = int(limit**0.5) + 3
    index = np.arange(size, dtype=np.int64)
    squares = index[:, None, None] ** 2 + index[:, None] ** 2 + index**2
    found: list[tuple[int, int, int, int]] = []
    tables: list[NDArray[np.int32]] = []
    for square in np.unique(squares[squares < limit]):
        # The smallest F² that gives this ball; the map of an octant is that of the whole ball.
        ball = np.ascontiguousarray(squares <= square)
        span = int(square**0.5) + 2
        distance = _octant_distance(ball[:span, :span, :span])
        while True:
            generators = np.array([entry[:3] for entry in found], dtype=np.int64).reshape(-1, 3)
            stacked = np.array(tables, dtype=np.int32).reshape(len(found), limit + 1)
            directions, source = signed_directions(generators) if found else (generators, np.zeros(0, np.int64))
            stray = _stray_axis_point(distance, directions, source, stacked)
            if stray[0] < 0:
                break
            found.append((*stray, int(square) + 1))
            tables.append(inclusion_table(*stray, limit))
    return found


def _octant_distance(ball: NDArray[np.bool_]) -> NDArray[np.int32]:
    out = np.empty(ball.shape, np.int32)
    far = np.int32(3 * ball.shape[0] ** 2)
    one = np.int32(1)
    scan_rows(ball, one, far, False, out)
    scan_envelopes(out.transpose(1, 0, 2), one, far, False)
    scan_envelopes(out, one, far, False)
    return out


@njit(cache=True)
def _stray_axis_point(
    distance: NDArray[np.int32],
    directions: NDArray[np.int64],
    source: NDArray[np.int64],
    tables: NDArray[np.int32],
) -> tuple[int, int, int]:
    """Return the point nearest to the centre, the centre apart, that no direction finds included; or -1s."""
    n = distance.shape[0]
    best, answer = 1 << 60, (-1, -1, -1)
    for a in range(n):
        for b in range(a + 1):
            for c in range(b + 1):
                square = a * a + b * b + c * c
                own = distance[a, b, c]
                if square == 0 or own == 0 or square >= best:
                    continue
                included = False
                for d in range(len(directions)):
                    i, j, k = abs(a + directions[d, 0]), abs(b + directions[d, 1]), abs(c + directions[d, 2])
                    if i < n and j < n and k < n and distance[i, j, k] >= tables[source[d], own]:
                        included = True
                        break
                if not included:
                    best, answer = square, (a, b, c)
    return answer
