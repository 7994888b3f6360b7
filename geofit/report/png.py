"""Pixels as PNG (ISO/IEC 15948), for pictures that are drawn: flat colours and repeated rows."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

__all__ = ["png_of"]


def png_of(pixels: NDArray[np.uint8]) -> bytes:
    """Return (height, width, 3) pixels, red, green and blue, as PNG.

    No row is filtered: what filters do for photographs, they undo for flat colours.
    """
    tall, wide, _ = pixels.shape
    rows = np.zeros((tall, 1 + 3 * wide), np.uint8)
    rows[:, 1:] = pixels.reshape(tall, -1)
    chunks = (
        (b"IHDR", struct.pack(">2I5B", wide, tall, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows.tobytes(), 6)),
        (b"IEND", b""),
    )
    packed = (
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)
