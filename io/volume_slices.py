"""Rock volumes that stay on the disk, read slice by slice: raw, npy, MetaImage, TIFF, folders of slices, zarr."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError, InputError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.io.volume_raw import map_meta_image, shape_and_type
from geofit.io.volume_tiff import slice_files
from geofit.io.volume_zarr import open_zarr
from geofit.io.volumes import RAW, TIFF, damaged_volume, is_zarr, missing_volume
from geofit.pores.sliced import SlicedVolume, Voxels

__all__ = ["map_voxels", "open_volume", "sliceable"]


class _TiffPages:
    """Pages of a TIFF file, or files of one slice each, as slices along axis 0."""

    def __init__(self, files: list[Path]) -> None:
        from PIL import Image

        with Image.open(files[0]) as image:
            self._pages = getattr(image, "n_frames", 1) if len(files) == 1 else 1
            width, height = image.size
        self._files = files
        self.shape = (len(files) * self._pages, height, width)

    def __getitem__(self, slices: slice) -> NDArray[Any]:
        from geofit.io.volume_tiff import read_pages

        first, end, _ = slices.indices(self.shape[0])
        if len(self._files) == 1:
            return read_pages(self._files[0], self._files[0].name, range(first, end))
        found = [read_pages(file, file.name, range(1))[0] for file in self._files[first:end]]
        for file, slice_ in zip(self._files[first:end], found, strict=True):
            if slice_.shape != self.shape[1:]:
                raise InputError(
                    message(
                        "io.slice-size-differs",
                        "its size differs from that of the first slice, {first}",
                        first=self._files[0].name,
                    ),
                    message("io.export-slices-alike", "Export all slices with the same size."),
                    file=str(file),
                )
        return np.stack(found)


@arguments_checked
def open_volume(
    path: str | PathLike[str],
    *,
    pore: Any | Collection[Any] | None = None,
    voxel: float | Sequence[float] | None = None,
    shape: Sequence[int] | None = None,
    dtype: str | None = None,
    name: str | None = None,
) -> SlicedVolume:
    """Open a rock volume without reading it into memory.

    Parameters
    ----------
    path : path
        A raw, npy, mhd, mha or TIFF file, a folder of TIFF slices, or a zarr store. Packed files (gz, zip, npz) have to
        be unpacked first.
    pore : value or collection of values
        Which voxels are pore; see :class:`geofit.RockVolume`.
    voxel : float or three floats
        Edge length of a voxel in metres; may be left out if the header states it.
    shape : three int, optional
        Voxels along each axis, the slowest first; for raw files.
    dtype : str, optional
        Type of a raw file's values.
    name : str, optional
        Which array of a zarr store, if there are several.

    Returns
    -------
    SlicedVolume
        For :func:`geofit.pore_network` and :func:`geofit.maximal_balls`, which work through it slab by slab; edges in
        metres.

    Raises
    ------
    InputError
        If the file is missing, packed, damaged, of an unknown kind, or its shape is unknown.
    VolumeError
        As for :func:`read_volume`.

    Notes
    -----
    Formats: ``docs/formats_in.md``.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "rock_2x3x4.raw").write_bytes(bytes(range(2)) * 12)
    ...     open_volume(Path(folder) / "rock_2x3x4.raw", pore=0, voxel=5e-6).porosity
    0.5
    """
    path = Path(path)
    if not path.exists():
        raise missing_volume(path)
    with _readable(path):
        values, stated = _voxels(path, shape, dtype, name)
        return SlicedVolume(values, pore=pore, voxel=stated if voxel is None else voxel)


def sliceable(path: Path) -> bool:
    """Return whether :func:`map_voxels` can read a volume: a file of one array, which is never packed."""
    return path.suffix.lower() in (*RAW, ".npy") and path.is_file()


def map_voxels(path: Path) -> Voxels:
    """Return the values of a volume's voxels, which stay on the disk until slices are asked for.

    Raises
    ------
    InputError
        If the file is missing or damaged, or its shape is unknown.
    """
    with _readable(path):
        return _voxels(path, None, None, None)[0]


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except GeofitError:
        raise
    except Exception:  # each library that maps a file has errors of its own
        raise damaged_volume(path) from None


def _voxels(
    path: Path, shape: Sequence[int] | None, dtype: str | None, name: str | None
) -> tuple[Voxels, tuple[float, float, float] | None]:
    kind = path.suffix.lower()
    if path.is_dir():
        return (open_zarr(path, name) if is_zarr(path) else _TiffPages(slice_files(path))), None
    if kind in TIFF:
        return _TiffPages([path]), None
    if kind == ".npy":
        found = np.load(path, mmap_mode="r", allow_pickle=False)
        if not isinstance(found, np.ndarray):  # an archive of arrays with the ending of one
            raise damaged_volume(path)
        return found, None
    if kind in (".mhd", ".mha"):
        return map_meta_image(path)
    if kind in RAW:
        edges, stored = shape_and_type(path.name, path.stat().st_size, shape, dtype, path)
        return np.memmap(path, stored, "r", shape=edges), None
    raise InputError(
        message(
            "io.not-slice-by-slice",
            "files ending in '{ending}' cannot be read slice by slice",
            ending=kind,
        ),
        message("io.unpack-volume", "Unpack the file, or convert it to raw, npy, tif or zarr."),
        file=str(path),
    )
