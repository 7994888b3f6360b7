"""Large text as its lines: bytes are held once, and a line is decoded when it is looked at."""

from __future__ import annotations

import codecs
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from geofit.io.sniff import HEAD, decimal_of_groups, decode, find_decimal

__all__ = ["BIG", "BigText", "big_text"]

#: Bytes from which on a text is held as bytes: a list of its lines would take ten times as much.
BIG = 4_000_000
#: Bytes that are worked on together: they stay in the processor's cache.
PIECE = 1 << 20
#: Lines that share an encoding error are read back as they were written.
_ERRORS = "surrogatepass"


class BigText(Sequence[str]):
    r"""Lines of a text, as ``text.split("\n")`` gives them.

    Parameters
    ----------
    data : bytes
        UTF-8 with "\n" alone at the ends of lines. A missing one is added to the last line.
    """

    def __init__(self, data: bytes) -> None:
        self.data = data if data.endswith(b"\n") else data + b"\n"

    @cached_property
    def starts(self) -> NDArray[np.integer[Any]]:
        """First byte of each line, and of what would follow the last one."""
        data = np.frombuffer(self.data, np.uint8)
        kind = np.uint32 if len(data) < 2**32 - 1 else np.int64
        pieces = range(0, len(data), PIECE)
        count = sum(int(np.count_nonzero(data[k : k + PIECE] == 10)) for k in pieces)
        starts: NDArray[np.integer[Any]] = np.zeros(count + 2, kind)
        at = 1
        for k in pieces:
            ends = np.flatnonzero(data[k : k + PIECE] == 10)
            starts[at : at + len(ends)] = ends + (k + 1)
            at += len(ends)
        starts[-1] = len(data) + 1
        return starts

    @cached_property
    def _head(self) -> list[str]:
        end = self.data.rfind(b"\n", 0, PIECE) + 1
        return self.data[:end].decode("utf-8", _ERRORS).split("\n")[:-1]

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> list[str]: ...
    def __getitem__(self, index: int | slice) -> str | list[str]:
        """Return a line, or a list of them."""
        if isinstance(index, slice):
            if index.step is None and index.stop is not None and 0 <= index.stop <= len(self._head):
                return self._head[index]
            return [self[i] for i in range(*index.indices(len(self)))]
        if 0 <= index < len(self._head):
            return self._head[index]
        index += len(self) if index < 0 else 0
        if index < 0:
            raise IndexError(index)
        start, end = self.starts.item(index), self.starts.item(index + 1)
        return self.data[start : end - 1].decode("utf-8", _ERRORS)

    def some(self, indices: NDArray[np.int64]) -> list[str]:
        """Return some lines, in order; quick where they follow each other."""
        if len(indices) and indices[-1] - indices[0] + 1 == len(indices):
            return self[int(indices[0]) : int(indices[-1]) + 1]
        return [self[index] for index in indices.tolist()]

    def pieces(self) -> Iterator[tuple[int, int]]:
        """Yield runs of whole lines, first and one beyond the last, of about a piece each."""
        first = 0
        while first < len(self):
            # A key of another type would have the whole array turned to it.
            stop = self.starts.dtype.type(min(int(self.starts[first]) + PIECE, int(self.starts[-1])))
            last = int(np.searchsorted(self.starts, stop, side="right")) - 1
            last = min(max(last, first + 1), len(self))
            yield first, last
            first = last

    def bytes_of(self, first: int, last: int) -> NDArray[np.uint8]:
        """Return the bytes of a run of lines, each with its end."""
        stop = min(int(self.starts[last]), len(self.data))
        return np.frombuffer(self.data, np.uint8)[int(self.starts[first]) : stop]

    def decimal(self, sep: str) -> str:
        """Return the decimal mark that most fractions of the text have (:func:`geofit.io.sniff.find_decimal`)."""
        head = self.data[:HEAD].decode("utf-8", "replace")
        if sep == ",":
            return find_decimal(head, sep)
        if mark := decimal_of_groups(head):
            return mark
        from geofit.io.cell_loops import count_fractions

        commas, points = count_fractions(np.frombuffer(self.data, np.uint8))
        return "," if commas > points else "."


def big_text(data: bytes, name: str, encoding: str | None) -> tuple[BigText, str]:
    """Return the lines of a file and its encoding, as :func:`geofit.io.sniff.decode` finds it.

    Raises
    ------
    InputError
        If the file is not a text.
    """
    if encoding is None and _plain(data):
        codec = "utf-8"
    else:
        text, codec = decode(data, name, encoding)
        data = text.encode("utf-8", _ERRORS)
        del text
    # One byte is sought ten times as fast as two.
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if b"\0" in data:
        data = data.replace(b"\0", b"")
    return BigText(data), codec


def _plain(data: bytes) -> bool:
    """Whether the bytes are UTF-8 without a mark of byte order, told without a second copy of them."""
    if data.startswith((codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE, b"PK\x03\x04")) or b"\0" in data:
        return False
    if data.isascii():
        return True
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        for start in range(0, len(data), PIECE):
            decoder.decode(data[start : start + PIECE], final=start + PIECE >= len(data))
    except UnicodeDecodeError:
        return False
    return True
