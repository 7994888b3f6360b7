"""Where a body may lie: the distance between holes, the reach of the data, the box, ground that counts as outside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import BodyData
from geofit.bodies.settings import BodySettings

__all__ = ["Region", "hole_spacing", "region_of"]

Floats = NDArray[np.float64]

#: Mean distance of a place to the nearest line of a square grid of parallel holes, in distances between holes:
#: (sqrt(2) + asinh(1)) / 6.
MEAN_GAP = 0.3826
#: The least |value| asked of a sample never exceeds this share of the distance between holes. Chosen on planted
#: ellipsoids, tori and pairs of bodies, where it left the volumes without bias (benchmarks/bodies.py).
BOUND = 0.1
#: Reach of the data in distances between holes, and margin of the box in reaches. Holes at random places leave gaps
#: of twice the distance that a grid of as many would have: with 1.5 a fifth of such bodies were closed within them.
REACH = 2.0
MARGIN = 1.1
#: Nodes of the raster of closing samples, along the longest side and in all.
NODES = 40
#: Data next to a contact among which one of another hole is looked for.
NEIGHBOURS = 200


@dataclass(frozen=True, eq=False)
class Region:
    """Box and scales of a body, in map coordinates and metres.

    ``spacing`` is the typical distance between holes, ``reach`` the distance from contacts and inside samples beyond
    which ground counts as outside, ``closing`` (k, 3) places there, ``bound`` the largest |value| asked of a sample.
    """

    lower: Floats
    upper: Floats
    spacing: float
    reach: float
    bound: float
    closing: Floats


def hole_spacing(data: BodyData) -> float | None:
    """Return the distance between holes, metres, from contacts to the nearest data of another hole; None without names.

    Twice the median: holes at random places lie at half of one over the root of their density from their nearest
    neighbour (Clark & Evans, Ecology 35, 1954), and a square grid of that density has its distance in full.
    """
    from scipy.spatial import cKDTree

    names = np.concatenate([data.hole, data.inside_hole, data.outside_hole])
    if len(np.unique(names)) < 3 or not len(data.contacts) or (data.hole == "").any():
        return None
    xyz = np.concatenate([data.contacts, data.inside, data.outside]) - data.contacts[0]
    some = np.arange(0, len(data.contacts), -(-len(data.contacts) // 1000))
    far, near = map(np.asarray, cKDTree(xyz).query(xyz[some], k=min(NEIGHBOURS, len(xyz))))
    other = names[near] != data.hole[some, None]
    # Where all neighbours are of the own hole, the farthest of them is nearer than the next hole.
    gap = np.where(other, far, np.inf).min(axis=1)
    return 2.0 * float(np.median(np.where(np.isfinite(gap), gap, far[:, -1])))


def region_of(
    contacts: Floats, inside: Floats, outside: Floats, settings: BodySettings, known: float | None = None
) -> Region:
    """Return the region of a body from its data (n, 3), (m, 3), (k, 3) in map coordinates.

    ``known`` is the distance between holes where they have names; otherwise the gaps between the data show it.
    """
    from scipy.spatial import cKDTree

    own = np.concatenate([contacts, inside])
    origin = own.mean(axis=0)
    lower, upper = own.min(axis=0), own.max(axis=0)
    tree = cKDTree(np.concatenate([own, outside]) - origin)
    # Half of each side more: a body that few holes hit is still among the holes that miss it.
    size = upper - lower
    places = lower - size / 4 + _halton(2000) * size * 1.5
    gap = np.asarray(tree.query(places - origin)[0])
    spacing = float(gap.mean()) / MEAN_GAP if known is None else known
    reach = REACH * spacing if settings.reach is None else settings.reach
    margin = max(MARGIN * reach, 0.05 * float(size.max()))
    if settings.box is None:
        low, high = lower - margin, upper + margin
    else:
        low, high = np.array(settings.box[0]), np.array(settings.box[1])
    closing = np.zeros((0, 3))
    if settings.closed:
        step = max(reach / 2, float((high - low).max()) / NODES)
        counts = np.maximum(2, np.ceil((high - low) / step).astype(int) + 1)
        nodes = np.stack(
            np.meshgrid(*[np.linspace(low[i], high[i], counts[i]) for i in range(3)], indexing="ij"), axis=-1
        ).reshape(-1, 3)
        closing = nodes[cKDTree(own - origin).query(nodes - origin)[0] > reach]
        if len(outside) and len(closing):
            # Where a logged interval is as near as a quarter of the reach, the log itself states what is there.
            closing = closing[cKDTree(outside - origin).query(closing - origin)[0] > reach / 4]
    return Region(low, high, spacing, reach, BOUND * spacing, closing)


def _halton(count: int) -> Floats:
    """Return (count, 3) evenly scattered places in the unit cube (Halton's sequence, bases 2, 3, 5)."""
    places = np.empty((count, 3))
    for axis, base in enumerate((2, 3, 5)):
        index, scale, column = np.arange(1, count + 1), 1.0, np.zeros(count)
        while index.any():
            scale /= base
            column += scale * (index % base)
            index = index // base
        places[:, axis] = column
    return places
