"""Rock volumes from files: raw with a header or a shape in the name, TIFF, npy, npz, zarr; also inside gz and zip.

Which value is pore and how large a voxel is are never guessed; a MetaImage header may state the voxel.
"""

from __future__ import annotations

import gzip
import zipfile
from collections.abc import Collection, Sequence
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import GeofitError, InputError
from geofit.data.files import is_file
from geofit.data.given import arguments_checked
from geofit.data.messages import Untranslated, message
from geofit.io.volume_raw import read_meta_image, shape_and_type
from geofit.io.volume_tiff import read_tiff, read_tiff_folder
from geofit.pores.memory import check_memory
from geofit.pores.volume import RockVolume, VolumeError

__all__ = ["RAW", "TIFF", "damaged_volume", "is_zarr", "missing_volume", "read_volume", "read_voxels"]

TIFF = (".tif", ".tiff")
RAW = (".raw", ".bin", ".dat")
#: Bytes that are unpacked before memory is looked at again.
_PART = 1 << 26
#: What can be read, for messages.
KINDS = "raw, mhd, mha, tif, npy, npz, zarr, also as .gz or in a .zip"


@arguments_checked
def read_volume(
    path: str | PathLike[str],
    *,
    pore: Any | Collection[Any] | None = None,
    voxel: float | Sequence[float] | None = None,
    shape: Sequence[int] | None = None,
    dtype: str | None = None,
    name: str | None = None,
) -> RockVolume:
    """Read a rock volume.

    Parameters
    ----------
    path : path
        A file, a folder of TIFF slices, or a zarr store.
    pore : value or collection of values
        Which voxels are pore; see :class:`geofit.pores.volume.RockVolume`.
    voxel : float or three floats
        Edge length of a voxel in metres, in the order of the axes of the array. May be left out if the header states it
        (MetaImage: in millimetres).
    shape : three int, optional
        Voxels along each axis, the slowest first; for raw files whose name does not end like ``_128x128x128``.
    dtype : str, optional
        Type of a raw file's values, such as "uint8" or "<u2"; by default what the file's size gives for the shape.
    name : str, optional
        Which array of an npz or zarr file, or which file of a zip archive, if there are several.

    Returns
    -------
    RockVolume

    Raises
    ------
    InputError
        If the file is missing, damaged, of an unknown kind, or its shape is unknown.
    VolumeError
        If the label or the voxel size is missing, or the labels leave a doubt; the message lists labels and shares.

    Notes
    -----
    Formats: ``docs/formats_in.md``.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "rock_2x3x4.raw").write_bytes(bytes(range(2)) * 12)
    ...     read_volume(Path(folder) / "rock_2x3x4.raw", pore=0, voxel=5e-6).porosity
    0.5
    """
    values, stated = read_voxels(path, shape=shape, dtype=dtype, name=name)
    try:
        return RockVolume(values, pore=pore, voxel=stated if voxel is None else voxel)
    except VolumeError as error:
        raise VolumeError(
            message("io.file-and-reason", "{file}: {reason}", file=Path(path).name, reason=error.message)
        ) from None


def read_voxels(
    path: str | PathLike[str],
    *,
    shape: Sequence[int] | None = None,
    dtype: str | None = None,
    name: str | None = None,
) -> tuple[NDArray[Any], tuple[float, float, float] | None]:
    """Return the values of a volume's voxels as stored, and the voxel edges in metres if the file states them."""
    path = Path(path)
    if not path.exists():
        raise missing_volume(path)
    if not path.is_dir() and not is_file(path):
        raise InputError(
            message("io.not-a-file", "It is a pipe or a device, not a file"),
            message("io.name-a-file", "Name a file."),
            file=str(path),
        )
    try:
        if path.is_dir():
            return _read_folder(path, name), None
        check_memory(path.stat().st_size, message("io.reading-file", "Reading {file}", file=path.name))
        return _read_bytes(path, path.name, None, shape, dtype, name)
    except GeofitError:
        raise
    except Exception:  # each library that unpacks has errors of its own
        raise damaged_volume(path) from None


def missing_volume(path: Path) -> InputError:
    """Return the error for a volume that does not exist."""
    return InputError(
        message("io.no-such-file", "the file or folder does not exist"),
        message("data.check-path", "Check the path."),
        file=str(path),
    )


def damaged_volume(path: Path) -> InputError:
    """Return the error for a volume that its library cannot read: what that reports is for programmers."""
    if not path.exists():
        return missing_volume(path)
    packed = path.suffix.lower() in (".gz", ".zip")
    if path.is_dir():
        what = message("io.folder-not-volume", "the folder holds no volume that can be read")
    elif not path.stat().st_size:
        what = message("io.volume-empty", "the file is empty")
    else:
        what = message(
            "io.file-damaged-incomplete",
            "the file is damaged, incomplete or not of the format that its ending states: {ending}",
            ending=Untranslated("".join(path.suffixes[-2:]) if packed else path.suffix),
        )
    return InputError(
        what, message("io.export-volume", "Export the volume as one of: {kinds}.", kinds=KINDS), file=str(path)
    )


def _read_folder(path: Path, name: str | None) -> NDArray[Any]:
    if is_zarr(path):
        from geofit.io.volume_zarr import open_zarr

        return np.asarray(open_zarr(path, name)[...])
    return read_tiff_folder(path)


def is_zarr(path: Path) -> bool:
    """Return whether a folder is a zarr store."""
    return path.suffix == ".zarr" or any((path / file).exists() for file in (".zarray", "zarr.json", ".zgroup"))


def _read_bytes(
    path: Path,
    file: str,
    data: bytes | None,
    shape: Sequence[int] | None,
    dtype: str | None,
    name: str | None,
) -> tuple[NDArray[Any], tuple[float, float, float] | None]:
    """Read the file ``file``, which is ``path`` itself or ``data`` unpacked from it."""
    kind = Path(file).suffix.lower()
    if kind == ".gz":
        with gzip.open(path if data is None else BytesIO(data)) as stream:
            return _read_bytes(path, file[:-3], _unpacked(stream, path), shape, dtype, name)
    if kind == ".zip":
        return _read_zip(path, data, shape, dtype, name)
    source: Any = path if data is None else BytesIO(data)
    if kind in TIFF:
        return read_tiff(source, path.name), None
    if kind in (".npy", ".npz"):
        with path.open("rb") if data is None else BytesIO(data) as stream:  # numpy leaves a damaged file open
            return _numbers(np.load(stream, allow_pickle=False), name, path), None
    if kind in (".mhd", ".mha"):
        return read_meta_image(path, data)
    if kind in RAW:
        raw = np.frombuffer(data, np.uint8) if data is not None else np.fromfile(path, np.uint8)
        found, stored = shape_and_type(file, raw.size, shape, dtype, path)
        return raw.view(stored).reshape(found), None
    raise InputError(
        message("io.volume-ending-unknown", "files ending in '{ending}' cannot be read as a rock volume", ending=kind),
        message("io.export-volume", "Export the volume as one of: {kinds}.", kinds=KINDS),
        file=str(path),
    )


def _numbers(loaded: Any, name: str | None, path: Path) -> NDArray[Any]:
    """Return a numpy array, or the chosen one of an archive of them (npz)."""
    if isinstance(loaded, np.ndarray):
        return loaded
    arrays = [one for one in loaded.files if f"{one}.npy" in loaded.zip.namelist()]
    return np.asarray(loaded[_one_of(arrays, name, path)])


def _unpacked(stream: gzip.GzipFile, path: Path) -> bytes:
    """Return what a stream unpacks to, as long as it fits into memory: a small file may unpack to any length."""
    parts, size = [], 0
    while part := stream.read(_PART):
        size += len(part)
        check_memory(2 * size, message("io.reading-file", "Reading {file}", file=path.name))
        parts.append(part)
    return b"".join(parts)


def _read_zip(
    path: Path, data: bytes | None, shape: Sequence[int] | None, dtype: str | None, name: str | None
) -> tuple[NDArray[Any], tuple[float, float, float] | None]:
    with zipfile.ZipFile(path if data is None else BytesIO(data)) as archive:
        known = (*TIFF, *RAW, ".npy", ".npz", ".gz", ".mha")
        files = [entry for entry in archive.namelist() if Path(entry).suffix.lower() in known]
        chosen = _one_of(files, name, path)
        check_memory(archive.getinfo(chosen).file_size, message("io.reading-file", "Reading {file}", file=path.name))
        return _read_bytes(path, chosen, archive.read(chosen), shape, dtype, name)


def _one_of(names: list[str], wanted: str | None, path: Path) -> str:
    """Return the only name, or the wanted one."""
    if wanted is not None and wanted in names:
        return wanted
    if wanted is None and len(names) == 1:
        return names[0]
    if not names:
        raise InputError(
            message("io.volume-unreadable", "the archive contains no volume"),
            message("io.export-volume", "Export the volume as one of: {kinds}.", kinds=KINDS),
            file=str(path),
        )
    raise InputError(
        message(
            "io.several-volumes",
            "it has {count} volumes: {names}",
            count=len(names),
            names=", ".join(sorted(names)[:8]),
        ),
        message(
            "io.name-volume",
            "Leave one in the file, or name it: --name {example} of geofit pores and metaballs, "
            "name='{example}' in Python.",
            example=Untranslated(sorted(names)[0]),
        ),
        file=str(path),
    )
