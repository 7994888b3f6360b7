"""From a rock volume to its pore network (step 3 of Huang et al. 2007, with a merge tree in place of the slaves)."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.data.progress import Progress, tell
from geofit.pores import slabs
from geofit.pores.balls import MaximalBalls, maximal_balls
from geofit.pores.distance import Border, border_walls
from geofit.pores.memory import check_memory
from geofit.pores.network import FaceThroats, PoreNetwork, Pores, Throats
from geofit.pores.packed import PackedSpace, slots, unpacked
from geofit.pores.slabs import Slices, packed_distances
from geofit.pores.volume import RockVolume, VolumeError

__all__ = ["DEFAULT_R_MIN", "DEFAULT_TAU", "Hierarchy", "pore_network"]

Hierarchy = Literal["merge-tree", "paper"]

#: Settled on Berea sandstone: they give the counts and radii of its published maximal-ball network.
DEFAULT_R_MIN = 1.25
DEFAULT_TAU = 0.85

#: Memory of a network: bytes for each pore voxel (distances, basins, order of flooding, windows), for each voxel of the
#: bits, for each voxel of the basins that a whole volume hands on, and for each voxel of the slab available.
_PORE, _VOXEL, _WHOLE, _SLAB = 32, 0.2, 4, 6


@arguments_checked
def pore_network(
    volume: Slices,
    balls: MaximalBalls | None = None,
    *,
    r_min: float = DEFAULT_R_MIN,
    tau: float = DEFAULT_TAU,
    border: Border = "open",
    hierarchy: Hierarchy = "merge-tree",
    progress: Progress | None = None,
) -> PoreNetwork:
    """Return the pores and throats of a rock volume.

    Parameters
    ----------
    volume : RockVolume or SlicedVolume
        The pore space. A large one is worked through in slabs; the network is the same.
    balls : MaximalBalls, optional
        Of this volume with this border. Only ``hierarchy="paper"`` needs them, and computes them if they are absent;
        the merge tree works on the distance map that they come from.
    r_min : float
        Radius of the smallest ball that may be a pore, unless it is alone; in voxels, not in metres.
    tau : float
        Share of the narrower pore's radius: a wider place is not a throat, and the two are one pore.
    border : "closed", "open" or three of them
        Whether the sample's faces stop a ball. Open by default: the rock goes on there, and so do its pores.
    hierarchy : {"merge-tree", "paper"}
        The article's super balls and slaves, or the merge tree of the narrow places.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    PoreNetwork
        If any pore is connected to a face of the sample, those that are not are listed in ``dropped``. Of a
        SlicedVolume it has no ``pore_of``.

    Raises
    ------
    VolumeError
        If a parameter is out of its range, or the memory does not suffice.

    Notes
    -----
    Super balls, slaves and throats: Huang et al. (2007). The merge tree joins the basins of the distance map in the
    order of their widest connection; see :mod:`geofit.pores.merge_tree`.

    Examples
    --------
    >>> grains = np.ones((9, 9, 20))
    >>> grains[1:8, 1:8, 1:8] = grains[1:8, 1:8, 12:19] = grains[4, 4] = 0
    >>> network = pore_network(RockVolume(grains, pore=0, voxel=1e-6))
    >>> len(network.pores), len(network.throats), network.percolates
    (2, 1, (False, False, True))
    """
    from geofit.pores import basins, merge_tree

    if not (r_min >= 0 and 0 < tau <= 2):
        raise VolumeError(
            message(
                "pores.ball-settings-unusable",
                "r_min={r_min} and tau={tau} are not usable. r_min is a radius in voxels and not negative; tau is a "
                "ratio between 0 and 2.",
                r_min=r_min,
                tau=tau,
            )
        )
    if hierarchy not in ("merge-tree", "paper"):
        raise VolumeError(
            message(
                "pores.hierarchy-unknown",
                "hierarchy={name} is unknown. Give 'merge-tree' or 'paper'.",
                name=repr(hierarchy),
            )
        )
    border_walls(border)
    size, whole = int(np.prod(volume.shape)), isinstance(volume, RockVolume)
    check_memory(
        int(_PORE * size * volume.porosity + _VOXEL * size + _WHOLE * size * whole + _SLAB * min(size, slabs.VOXELS)),
        message("pores.network-of-voxels", "The network of {count} voxels", count=size),
    )
    if volume.porosity == 1:
        border = "closed"
    tell(progress, "distance", 0.0)
    space, reach2 = packed_distances(volume, border, progress)
    levels, values, by_edges, by_corners = basins.levels_of(reach2, volume.edges)
    del reach2
    radius_at = np.sqrt(values.astype(np.float64)) - 0.5
    tell(progress, "basins", 0.2)
    label, peaks = basins.flood(space, levels, by_edges, by_corners)
    radius = radius_at[levels[slots(space, peaks)]]
    tell(progress, "merging", 0.7)
    if hierarchy == "paper":
        from geofit.pores.paper_hierarchy import super_balls

        if balls is None:
            balls = maximal_balls(volume, border=border)
        pore = super_balls(balls, space, label, len(peaks))
    else:
        pairs, saddle = merge_tree.saddles(space, levels, label, len(peaks), by_edges, by_corners, basins.OFFSETS)
        pore = merge_tree.merge(pairs - 1, radius_at[saddle], radius, r_min, tau)
    first = np.full(int(pore.max()) + 1, len(pore))
    np.minimum.at(first, pore, np.arange(len(pore)))
    label = (pore + 1).astype(np.int32)[label - 1]
    tell(progress, "throats", 0.8)
    settings = {"r_min": r_min, "tau": tau, "border": border, "hierarchy": hierarchy}
    return _assembled(volume, space, label, levels, radius_at, peaks[first], settings)


def _assembled(
    volume: Slices,
    space: PackedSpace,
    pore_of: NDArray[np.int32],
    levels: NDArray[np.int32],
    radius_at: NDArray[np.float64],
    peaks: NDArray[np.int64],
    settings: dict[str, Any],
) -> PoreNetwork:
    """Measure pores and windows, and leave out what no face of the sample reaches."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    from geofit.pores.sections import measure_sections
    from geofit.pores.spots import own_saddle, widest_balls
    from geofit.pores.windows import inner_windows, outer_windows

    count = len(peaks)
    inner, outer = inner_windows(space, pore_of, levels, count), outer_windows(space, pore_of, levels)
    faces = np.zeros((count, 6), dtype=bool)
    faces[outer.first, outer.second] = True
    links = coo_array((np.ones(len(inner.first)), (inner.first, inner.second)), shape=(count, count))
    parts, part = connected_components(links, directed=False)
    part_faces = np.zeros((parts, 6), dtype=bool)
    for face in range(6):
        part_faces[part[faces[:, face]], face] = True
    percolates = tuple(bool((part_faces[:, 2 * a] & part_faces[:, 2 * a + 1]).any()) for a in range(3))
    kept = np.asarray(part_faces.any(axis=1))[part]
    if not kept.any():
        kept[:] = True

    edges = np.array(volume.edges)
    own = own_saddle(inner, space, pore_of, levels, radius_at, edges)
    centre = np.stack(np.unravel_index(peaks, volume.shape), axis=1).astype(np.int32)
    size = np.bincount(pore_of, minlength=count + 1)[1:] * edges.prod()
    radius = radius_at[levels[slots(space, peaks)]]
    number = np.cumsum(kept) - 1

    free = np.zeros((count, 3))
    inscribed = np.maximum(widest_balls(centre.astype(float), free, space, edges) - 0.5, radius)
    sections = measure_sections(inner, space, pore_of, edges, radius_at, in_faces=False)
    use = kept[inner.first] & own
    to_centre = np.stack(
        [np.linalg.norm((sections.middle - centre[end]) * edges, axis=1) for end in (inner.first, inner.second)], axis=1
    )
    throats = Throats(
        np.stack([number[inner.first], number[inner.second]], axis=1)[use].astype(np.int32),
        sections.radius[use],
        sections.inscribed[use],
        sections.area[use],
        sections.perimeter[use],
        to_centre[use],
        sections.middle[use],
        sections.conductance[use],
    )
    sections = measure_sections(outer, space, pore_of, edges, radius_at, in_faces=True)
    to_face = np.linalg.norm((sections.middle - centre[outer.first]) * edges, axis=1)
    use = kept[outer.first]
    face_throats = FaceThroats(
        number[outer.first][use].astype(np.int32),
        outer.second[use].astype(np.int32),
        sections.radius[use],
        sections.inscribed[use],
        sections.area[use],
        sections.perimeter[use],
        to_face[use],
        sections.middle[use],
        sections.conductance[use],
    )
    for table in (throats, face_throats):
        for array in vars(table).values():
            array.flags.writeable = False
    pore_of = np.where(kept, number + 1, 0).astype(np.int32)[pore_of - 1]
    return PoreNetwork(
        _pores((centre, radius, inscribed, size, faces), kept),
        throats,
        face_throats,
        _pores((centre, radius, inscribed, size, faces), ~kept),
        (percolates[0], percolates[1], percolates[2]),
        volume.shape,
        volume.voxel,
        settings,
        unpacked(space, pore_of) if isinstance(volume, RockVolume) else None,
    )


def _pores(columns: tuple[NDArray[Any], ...], kept: NDArray[np.bool_]) -> Pores:
    chosen = [column[kept] for column in columns]
    for column in chosen:
        column.flags.writeable = False
    return Pores(*chosen)
