"""The dense core, found by the spacing of the points (paper, sec. 3.2, fig. 3a: D = D1 + D2 + ...)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from geofit.data.messages import Message, message
from geofit.fitting.split import Rectangle, Split, in_rectangle, split_none, widened

__all__ = ["CLOUD", "split_auto"]

Floats = NDArray[np.float64]

#: Neighbours whose distance measures the spacing at a point: more than a section alone gives nearby.
NEIGHBOURS = 8
#: How many times denser than the rest a core must be, points an area; few points need more, since chance
#: alone makes small clusters: CONTRAST + 10 / sqrt(points of the core).
CONTRAST = 2.0
#: Cells along the side of a square as large as the area, by which the part of it that points fill is measured, and how
#: many times: the spacing of the points follows from that part.
CELLS, ROUNDS = 96, 4
#: Fewer points than these make no core worth a patch of its own.
FEWEST = 20
#: More points than these are not interpolated without being asked: they outnumber any sensible control net.
MOST = 2_000
#: A cluster narrower than this share of its length is one section.
LINE = 0.08
#: More points than these are a cloud, not a survey: no core of it is interpolated, and no point of it chased.
CLOUD = 100 * MOST


def split_auto(plane: Floats, area: Rectangle, drawn: NDArray[np.bool_] | None = None) -> Split:
    """Find a dense four-sided core by the spacing of the points.

    The spacing of a point is its distance to the eighth neighbour. The threshold that best separates the
    logarithms of the spacings (Otsu 1979) divides dense from sparse; the largest connected cluster of dense
    points gives the rectangle, and the rectangle must be clearly denser than the rest (:data:`CONTRAST`). ``drawn``
    (n,) marks the points of sections: where the cluster is one line, theirs is the rectangle.
    """
    n = len(plane)
    if n < 2 * FEWEST:
        words = message(
            "fitting.too-few-points-for-core",
            "{n} points are too few to distinguish a dense core from a periphery (40 are needed)",
            n=n,
        )
        return split_none(plane, words)
    if n > CLOUD:
        return _uniform(plane, area, message("fitting.points-are-cloud", "{n} points are a cloud", n=n))
    spacing = np.asarray(KDTree(plane).query(plane, k=min(NEIGHBOURS + 1, n), workers=-1)[0])[:, -1]
    limit = _otsu(np.log(np.maximum(spacing, 1e-9)))
    if limit is None:
        return _uniform(plane, area, message("fitting.points-spread-evenly", "the points are spread evenly"))
    limit = float(np.exp(limit))
    dense = np.flatnonzero(spacing <= limit)
    cluster = dense[_largest_cluster(plane[dense], limit)]
    if len(cluster) < FEWEST:
        return _uniform(
            plane, area, message("fitting.dense-places-too-small", "the dense places contain fewer than 20 points each")
        )
    low, high = _trimmed_box(plane[cluster], float(np.median(spacing[cluster])) / 2)
    # The points of the box, not of the cluster: the edges may be drawn in to one section.
    length, width = extents(plane[cluster][in_rectangle(plane[cluster], (low[0], high[0], low[1], high[1]))])
    if width < LINE * length and drawn is not None and drawn.sum() >= FEWEST:
        # A few sections near to each other; the others are farther apart, and part of the core all the same.
        cluster = np.flatnonzero(drawn)
        limit = float(spacing[cluster].max())
        low, high = plane[cluster].min(axis=0), plane[cluster].max(axis=0)
        length, width = extents(plane[cluster])
    if width < LINE * length:
        return split_none(
            plane,
            message(
                "fitting.dense-points-on-line",
                "the {count} dense points lie along a line {length:.0f} m long and {width:.0f} m wide: "
                "one section makes no core, all points are approximated",
                count=len(cluster),
                length=length,
                width=width,
            ),
        )
    core = widened((low[0], high[0], low[1], high[1]), plane, area)
    inside = in_rectangle(plane, core)
    if inside.all():
        return _uniform(plane, area, message("fitting.dense-points-fill-area", "the dense points fill the area"))
    if inside.sum() > MOST:
        return split_none(plane, _too_many(int(inside.sum())))
    # Sections are drawn where the rock is known best; scattered points are dense only by comparison.
    sections = drawn is not None and 2 * drawn[inside].sum() > inside.sum()
    around = _size(area) - _size(core) if sections else _filled(plane[~inside], area, core)
    contrast = inside.sum() / _size(core) * around / (~inside).sum()
    if contrast < CONTRAST + 10 / np.sqrt(inside.sum()):
        words = message(
            "fitting.densest-part-too-sparse",
            "the densest part is only {contrast:.1f} times as dense as the rest",
            contrast=float(contrast),
        )
        return _uniform(plane, area, words)
    return Split(
        core,
        inside,
        message(
            "fitting.dense-points-fill-core",
            "{count} points with a spacing below {limit:.0f} m fill {width:.0f} m × {length:.0f} m, {contrast:.1f} "
            "times as dense as the rest ({others})",
            count=int(inside.sum()),
            limit=limit,
            width=float(core[1] - core[0]),
            length=float(core[3] - core[2]),
            contrast=float(contrast),
            others=int((~inside).sum()),
        ),
    )


def _uniform(plane: Floats, area: Rectangle, reason: Message) -> Split:
    """No core stands out: the points are all sparse, and approximated."""
    return split_none(
        plane,
        message("fitting.no-dense-core", "no dense core: {reason}; all points are approximated", reason=reason),
    )


def _too_many(n: int) -> Message:
    return message(
        "fitting.dense-points-too-many",
        "{n} dense points would need more control points than data to be interpolated; all points are "
        "approximated (name a smaller core to interpolate it)",
        n=n,
    ).with_severity("warning")


def _otsu(values: Floats) -> float | None:
    """Return the threshold with the largest variance between classes; None if the classes hardly differ."""
    ordered = np.sort(values)
    n = len(ordered)
    below = np.arange(1, n)
    mean_below = np.cumsum(ordered)[:-1] / below
    mean_above = (ordered.sum() - np.cumsum(ordered)[:-1]) / (n - below)
    between = below * (n - below) * (mean_below - mean_above) ** 2
    best = int(np.argmax(between))
    if mean_above[best] - mean_below[best] < np.log(1.4):
        return None
    return float((ordered[best] + ordered[best + 1]) / 2)


def _largest_cluster(plane: Floats, reach: float) -> NDArray[np.bool_]:
    pairs = KDTree(plane).query_pairs(reach, output_type="ndarray")
    n = len(plane)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    largest: NDArray[np.bool_] = np.equal(label, np.argmax(np.bincount(label)))
    return largest


def extents(plane: Floats) -> tuple[float, float]:
    """Return the length and width of a cluster along its principal directions, but for a tenth of outliers."""
    centred = plane - np.median(plane, axis=0)
    turned = centred @ np.linalg.svd(centred, full_matrices=False)[2].T
    length, width = np.quantile(turned, 0.95, axis=0) - np.quantile(turned, 0.05, axis=0)
    return float(length), float(width)


def _trimmed_box(plane: Floats, width: float) -> tuple[Floats, Floats]:
    """Return the bounding box of a cluster, its edges drawn in past outliers.

    An edge moves inwards while the strip next to it, ``width`` metres wide, is less than a third as dense as
    the box.
    """
    low, high = plane.min(axis=0), plane.max(axis=0)
    for _ in range(50):
        moved = False
        size = np.maximum(high - low, 1e-9)
        within = ((plane >= low) & (plane <= high)).all(axis=1)
        density = within.sum() / size.prod()
        for axis in (0, 1):
            strip = min(width, 0.2 * size[axis])
            needed = density * strip * size[1 - axis] / 3
            near_low = within & (plane[:, axis] < low[axis] + strip)
            near_high = within & (plane[:, axis] > high[axis] - strip)
            rest = plane[within, axis]
            if near_low.sum() < needed and (rest >= low[axis] + strip).any():
                low[axis] = rest[rest >= low[axis] + strip].min()
                moved = True
            elif near_high.sum() < needed and (rest <= high[axis] - strip).any():
                high[axis] = rest[rest <= high[axis] - strip].max()
                moved = True
        if not moved:
            break
    return low, high


def _size(rectangle: Rectangle) -> float:
    return max((rectangle[1] - rectangle[0]) * (rectangle[3] - rectangle[2]), 1e-9)


def _filled(plane: Floats, area: Rectangle, core: Rectangle) -> float:
    """Return how much of the area around a core (n, 2) points fill, square metres.

    What lies within a spacing of them or between them; where a circle with a radius of two spacings has room, it is
    empty. Of holes along a river or on two sides of a hill, the area's corners say nothing of how dense they are.
    """
    from scipy.ndimage import distance_transform_edt

    low, extent = np.array([area[0], area[2]]), np.array([area[1] - area[0], area[3] - area[2]])
    cell = np.sqrt(_size(area)) / CELLS
    count = np.maximum(np.ceil(extent / cell).astype(int), 1)
    u, v = (start + cell * (np.arange(k) + 0.5) for start, k in zip(low, count, strict=True))
    around = ~in_rectangle(np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2), core).reshape(count)
    row, column = np.clip((plane - low) / cell, 0, count - 1).astype(int).T
    filled = float(around.sum())
    for _ in range(ROUNDS):
        spacing = np.sqrt(filled / len(plane))
        margin = int(2 * spacing) + 2
        empty = np.ones(count + 2 * margin, bool)
        empty[row + margin, column + margin] = False
        near = distance_transform_edt(empty) <= 2 * spacing
        inner = distance_transform_edt(near)[margin:-margin, margin:-margin] > spacing
        filled = max(float((inner & around).sum()), 1.0)
    return float(filled * cell**2)
