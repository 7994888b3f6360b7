"""A rock volume for looking at: its voxels, the network and surface for a choice of pore values, and their figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.legible import legible
from geofit.data.messages import Untranslated, message
from geofit.data.progress import Progress, tell, within

if TYPE_CHECKING:
    from geofit.pores.network import PoreNetwork
    from geofit.pores.permeability import Permeability
    from geofit.pores.representative import RepresentativeVolume
    from geofit.pores.sliced import SlicedVolume, Voxels
    from geofit.pores.volume import RockVolume

__all__ = ["GreyVolume", "PoreView", "is_large", "open_pores", "pore_view", "read_grey"]

#: Voxels of a volume from which on its network is found slab by slab, without a surface: it would have more triangles
#: than can be looked at.
LARGE = 2 * 10**8


@dataclass(frozen=True, eq=False)
class GreyVolume:
    """Values of voxels as they were read, their histogram, and a threshold where there are more than two values.

    Parameters
    ----------
    name : str
        Name of the file.
    values : (n0, n1, n2) array
        Labels or grey values.
    voxel : tuple of float or None
        Edges of a voxel in metres, where the file states them.
    counts, edges : arrays
        Histogram: voxels in each class, and the n + 1 limits of the classes.
    threshold : float or None
        Otsu's threshold.
    each : tuple of int and array, or None
        The smallest value, and how many voxels have it and each whole number above it; None where these are too many.
    file : path or None
        The file, if another process can read its voxels slice by slice.
    """

    name: str
    values: NDArray[Any]
    voxel: tuple[float, float, float] | None
    counts: NDArray[np.int64]
    edges: NDArray[np.float64]
    threshold: float | None
    each: tuple[int, NDArray[np.int64]] | None = None
    file: Path | None = None

    @property
    def sample(self) -> str:
        """The name of its file without endings."""
        return legible(self.name.split(".")[0]) or "volume"

    def share(self, low: float, high: float) -> float:
        """Return the share of voxels whose values are between two values, both included."""
        if self.each is not None:
            first, counts = self.each
            begin, end = (int(np.clip(at, 0, len(counts))) for at in (np.ceil(low) - first, np.floor(high) + 1 - first))
            return float(counts[begin : max(end, begin)].sum() / counts.sum())
        inside = sum(np.count_nonzero((slice_ >= low) & (slice_ <= high)) for slice_ in self.values)
        return float(inside / self.values.size)


@dataclass(frozen=True, eq=False)
class PoreView:
    """Network and surface of a volume, ready to be drawn; lengths in voxels.

    Parameters
    ----------
    network : PoreNetwork
        Without the pore of each voxel.
    permeability : Permeability
        Of the network.
    porosity, connected : float
        Share of pore voxels, and of those from which a path of pore voxels leads to a face of the sample.
    axes : (n,) array of int
        Along how many axes the pores connected to each pore percolate.
    vertices, triangles : arrays
        Surface of the pores, (m, 3) and (k, 3); none of a volume that is too large for it.
    vertex_pore : (m,) array of int
        The pore at each vertex, counted from 0.
    settling : RepresentativeVolume or None
        Porosity of cubes by their size; None of a volume that is too large for it.
    """

    network: PoreNetwork
    permeability: Permeability
    porosity: float
    connected: float
    axes: NDArray[np.int64]
    vertices: NDArray[np.float32]
    triangles: NDArray[np.int64]
    vertex_pore: NDArray[np.int64]
    settling: RepresentativeVolume | None = None


def read_grey(
    path: Path, shape: Sequence[int] | None = None, dtype: str | None = None, progress: Progress | None = None
) -> GreyVolume:
    """Read a volume to look at it, and propose a threshold.

    Parameters
    ----------
    path : path
    shape : three int, optional
        Voxels along each axis of a raw file, the slowest first.
    dtype : str, optional
        Type of a raw file's values.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    InputError, VolumeError
        As for :func:`geofit.read_volume`, if the file cannot be read or is not a volume.
    """
    from geofit.io.volume_slices import sliceable
    from geofit.io.volumes import read_voxels
    from geofit.pores.threshold import grey_histogram, histogram_of_counts, otsu_of_histogram, value_counts
    from geofit.pores.volume import VolumeError, check_array

    tell(progress, "reading", 0.0)
    values, voxel = read_voxels(path, shape=shape, dtype=dtype)
    try:
        check_array(values)
    except VolumeError as error:  # a window may still show the volume before it
        named = message("project.file-note", "{file}: {reason}", file=Untranslated(path.name), reason=error.message)
        raise VolumeError(named) from None
    tell(progress, "histogram", 0.6)
    if values.dtype == bool:
        values = values.view(np.uint8)
    each = value_counts(values)
    counts, edges = grey_histogram(values) if each is None else histogram_of_counts(*each)
    threshold = otsu_of_histogram(counts, edges) if np.count_nonzero(counts) > 2 else None
    file = path if shape is None and sliceable(path) else None
    return GreyVolume(path.name, values, voxel, counts, edges, threshold, each, file)


def pore_view(
    source: NDArray[Any] | Path,
    low: float,
    high: float,
    voxel: tuple[float, ...],
    progress: Progress | None = None,
) -> PoreView:
    """Return network and surface of the pores whose values are between ``low`` and ``high``, both included.

    Parameters
    ----------
    source : (n0, n1, n2) array or path
        Values of the voxels, or the file that has them; of a large file only slabs are in memory.
    low, high : float
    voxel : tuple of float
        Edges of a voxel in metres.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    InputError
        If the file cannot be read.
    VolumeError
        If no voxel is pore, or the voxel is not a length.
    Cancelled
        If the listener asks to stop; asked at every stage.
    """
    from geofit.pores.components import connectivity
    from geofit.pores.extraction import pore_network
    from geofit.pores.permeability import network_permeability
    from geofit.pores.representative import representative_volume
    from geofit.pores.sliced import SlicedVolume

    volume = open_pores(source, low, high, voxel)
    if isinstance(volume, SlicedVolume):
        network = pore_network(volume, progress=within(progress, 0.1, 0.9))
        tell(progress, "permeability", 0.9)
        flow = network_permeability(network)
        nothing = np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
        # All pores of a network are connected to a face, or none is.
        connected = network.porosity if network.pores.faces.any() else 0.0
        return PoreView(network, flow, volume.porosity, connected, _axes(network), *nothing)
    network = pore_network(volume, progress=within(progress, 0.0, 0.5))
    vertices, triangles, pore = _surface(volume, network, progress)
    tell(progress, "permeability", 0.9)
    flow = network_permeability(network)
    tell(progress, "connectivity", 0.95)
    found = connectivity(volume)
    axes, network = _axes(network), replace(network, pore_of=None)
    settling = representative_volume(volume)
    return PoreView(
        network, flow, found.porosity, found.connected, axes, vertices.astype(np.float32), triangles, pore, settling
    )


def is_large(shape: tuple[int, ...]) -> bool:
    """Whether a volume has so many voxels that it is worked on slab by slab, and gets no surface."""
    return bool(np.prod(shape, dtype=float) >= LARGE)


def open_pores(
    source: NDArray[Any] | Path, low: float, high: float, voxel: tuple[float, ...]
) -> RockVolume | SlicedVolume:
    """Return the voxels whose values are between ``low`` and ``high`` as pores; of a large volume slab by slab.

    Parameters and errors are those of :func:`pore_view`.
    """
    from geofit.io.volume_slices import map_voxels
    from geofit.pores.sliced import SlicedVolume
    from geofit.pores.volume import RockVolume

    values = map_voxels(source) if isinstance(source, Path) else source
    chosen = _Chosen(values, low, high)
    if is_large(chosen.shape):
        return SlicedVolume(chosen, pore=[True], voxel=voxel)
    return RockVolume(chosen[:], pore=[True], voxel=voxel)


class _Chosen:
    """Which voxels have values in a range, slice by slice."""

    def __init__(self, values: Voxels, low: float, high: float) -> None:
        self.shape = tuple(values.shape)
        self._values, self._low, self._high = values, low, high

    def __getitem__(self, slices: slice) -> NDArray[np.bool_]:
        part = np.asarray(self._values[slices])
        return (part >= self._low) & (part <= self._high)


def _surface(
    volume: RockVolume, network: PoreNetwork, progress: Progress | None
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Return vertices in voxels, triangles, and the pore at each vertex."""
    from geofit.pores.surface import pore_surface

    tell(progress, "surface", 0.5)
    surface = pore_surface(volume, network, progress=within(progress, 0.5, 0.6))
    tell(progress, "triangles", 0.6)
    mesh = surface.triangulate()
    vertices = mesh.vertices / volume.unit
    assert network.pore_of is not None
    return vertices, mesh.triangles, _pore_at(vertices / network.edges, network.pore_of)


def _axes(network: PoreNetwork) -> NDArray[np.int64]:
    """Return for each pore along how many axes its cluster connects the faces of the sample."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    first, second = network.throats.pores.T
    count = len(network.pores)
    links = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    clusters, cluster = connected_components(links, directed=False)
    touched = np.zeros((clusters, 6), bool)
    for face in range(6):
        touched[cluster[network.pores.faces[:, face]], face] = True
    return np.asarray((touched[:, ::2] & touched[:, 1::2]).sum(axis=1)[cluster], np.int64)


def _pore_at(places: NDArray[np.float64], pore_of: NDArray[np.int32]) -> NDArray[np.int64]:
    """Return the pore of the voxels round each place (m, 3) on a wall: the one with the smallest number, the widest."""
    most = np.iinfo(np.int32).max
    found = np.full(len(places), most, np.int64)
    size = np.array(pore_of.shape) - 1
    for corner in np.ndindex(2, 2, 2):
        at = np.clip(np.floor(places - 0.5).astype(np.int64) + corner, 0, size)
        number = pore_of[at[:, 0], at[:, 1], at[:, 2]].astype(np.int64)
        found = np.minimum(found, np.where(number > 0, number, most))
    return np.where(found == most, 1, found) - 1
