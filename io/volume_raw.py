"""Raw volumes: shape and type from the caller, the file's name or its size; MetaImage headers (mhd, mha)."""

from __future__ import annotations

import math
import re
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import is_file
from geofit.data.messages import Untranslated, message

__all__ = ["map_meta_image", "read_meta_image", "shape_and_type"]

#: A header is shorter than this, bytes.
_HEADER = 100_000
_SIZES = {1: "u1", 2: "<u2", 4: "<f4", 8: "<f8"}
_META_TYPES = {
    "MET_UCHAR": "u1", "MET_CHAR": "i1", "MET_USHORT": "u2", "MET_SHORT": "i2", "MET_UINT": "u4", "MET_INT": "i4",
    "MET_FLOAT": "f4", "MET_DOUBLE": "f8",
}  # fmt: skip


def shape_and_type(
    file: str, size: int, shape: Sequence[int] | None, dtype: str | None, path: Path
) -> tuple[tuple[int, int, int], np.dtype[Any]]:
    """Return shape and type of a raw file of ``size`` bytes.

    The shape is the caller's, else one in the name (``rock_400x400x300.raw``, slowest axis first; ``rock_400.raw`` for
    a cube), else a cube whose voxels have one byte.

    Raises
    ------
    InputError
        If there is no shape, or it does not fit the size.
    """
    remedy = message(
        "io.state-shape-and-type",
        "State the shape, slowest axis first: --shape 200,200,100, in Python shape and dtype.",
    )
    if not size:
        raise InputError(
            message("io.volume-empty", "the file is empty"),
            message("io.export-volume-again", "Export the volume again."),
            file=str(path),
        )
    found: tuple[int, ...] | None = None if shape is None else tuple(int(n) for n in shape)
    if found is None:
        three = re.search(r"(\d+)[xX](\d+)[xX](\d+)", file)
        one = re.search(r"(?:^|[_-])(\d+)(?:\D*$)", Path(file).stem)
        edge = round(size ** (1 / 3))
        if three is not None:
            found = tuple(int(three[n]) for n in (1, 2, 3))
        elif one is not None and size % max(int(one[1]), 1) ** 3 == 0 and size // max(int(one[1]), 1) ** 3 in _SIZES:
            found = (int(one[1]),) * 3
        elif edge**3 == size:
            found = (edge,) * 3
        else:
            raise InputError(
                message("io.raw-without-shape", "a raw file of {size} bytes does not state its shape", size=size),
                remedy,
                file=str(path),
            )
    if len(found) != 3 or min(found) < 1:
        raise InputError(
            message("io.shape-not-volume", "the shape {shape} is not that of a volume", shape=found),
            remedy,
            file=str(path),
        )
    count = found[0] * found[1] * found[2]
    stored = np.dtype(dtype) if dtype is not None else np.dtype(_SIZES.get(size // count, "u1"))
    if count * stored.itemsize != size:
        raise InputError(
            message(
                "io.raw-size-differs",
                "the file has {size} bytes; {shape} voxels, {bytes} byte(s) each, need {need}",
                size=size,
                shape=" x ".join(map(str, found)),
                bytes=stored.itemsize,
                need=count * stored.itemsize,
            ),
            remedy,
            file=str(path),
        )
    return (found[0], found[1], found[2]), stored


def read_meta_image(path: Path, data: bytes | None) -> tuple[NDArray[Any], tuple[float, float, float] | None]:
    """Read a MetaImage: a text header, then the voxels in the same file (mha) or in the raw file that it names (mhd).

    The header counts the fastest axis first, and states the spacing in millimetres.
    """
    content = path.read_bytes() if data is None else data
    header, end, stored, sizes = _meta_header(content, path)
    local = header["ElementDataFile"]
    voxels = content[end:] if local.upper() == "LOCAL" else _beside(path, local).read_bytes()
    if header.get("CompressedData", "").lower() == "true":
        # One byte more than the header states is enough to see that it is wrong.
        voxels = zlib.decompressobj().decompress(voxels, max(math.prod(sizes), 0) * stored.itemsize + 1)
    found, _ = shape_and_type(local, len(voxels), sizes[::-1], stored.str, path)
    return np.frombuffer(voxels, stored).reshape(found), _meta_edges(header)


def map_meta_image(path: Path) -> tuple[NDArray[Any], tuple[float, float, float] | None]:
    """Map the voxels of a MetaImage into memory instead of reading them; see :func:`read_meta_image`."""
    with path.open("rb") as stream:
        header, end, stored, sizes = _meta_header(stream.read(_HEADER), path)
    if header.get("CompressedData", "").lower() == "true":
        raise InputError(
            message("io.volume-compressed", "its voxels are compressed and cannot be read slice by slice"),
            message("io.save-uncompressed", "Save the image without compression."),
            file=str(path),
        )
    local = header["ElementDataFile"]
    inside = local.upper() == "LOCAL"
    file, offset = (path, end) if inside else (_beside(path, local), 0)
    found, _ = shape_and_type(local, file.stat().st_size - offset, sizes[::-1], stored.str, path)
    return np.memmap(file, stored, "r", offset, found), _meta_edges(header)


def _meta_edges(header: dict[str, str]) -> tuple[float, float, float] | None:
    spacing = [float(word) for word in header.get("ElementSpacing", header.get("ElementSize", "")).split()]
    return (spacing[2] / 1000, spacing[1] / 1000, spacing[0] / 1000) if len(spacing) == 3 else None


def _meta_header(content: bytes, path: Path) -> tuple[dict[str, str], int, np.dtype[Any], list[int]]:
    """Return the entries of a header, where the voxels begin, their type, and their number along each axis."""
    header: dict[str, str] = {}
    end = 0
    while "ElementDataFile" not in header:
        stop = content.find(b"\n", end)
        key, equals, value = content[end : stop if stop >= 0 else len(content)].decode("latin-1").partition("=")
        if (stop < 0 and not equals) or len(header) > 100:
            raise InputError(
                message("io.volume-header-without-file", "its header has no line ElementDataFile"),
                message("io.export-volume-again", "Export the volume again."),
                file=str(path),
            )
        header[key.strip()] = value.strip()
        end = stop + 1 if stop >= 0 else len(content)
    order = (
        ">" if header.get("BinaryDataByteOrderMSB", header.get("ElementByteOrderMSB", "")).lower() == "true" else "<"
    )
    kind = _META_TYPES.get(header.get("ElementType", ""))
    sizes = [int(word) for word in header.get("DimSize", "").split()]
    if kind is None or len(sizes) != 3:
        raise InputError(
            message(
                "io.volume-header-incomplete",
                "its header states no usable ElementType and DimSize of three numbers",
            ),
            message("io.export-volume-scalar", "Export the volume as a scalar image with three axes."),
            file=str(path),
        )
    return header, end, np.dtype(order + kind), sizes


def _beside(path: Path, name: str) -> Path:
    """Return a file in the header's folder: a header from a stranger reads nothing elsewhere."""
    place = path.parent / name
    if re.search(r"[/\\:\0]", name) or not is_file(place):
        raise InputError(
            message("io.volume-header-names-file", "its header names the file '{name}'", name=Untranslated(name)),
            message(
                "io.put-raw-file-by-header", "Put the raw file into the header's folder, and name it without a path."
            ),
            file=str(path),
        )
    return place
