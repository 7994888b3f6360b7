"""Words of many points as integer codes into a table: 4 bytes a point, however long the words are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.legible import legible

__all__ = ["Labels"]


@dataclass(frozen=True, eq=False)
class Labels:
    """One word for each of n points.

    Parameters
    ----------
    codes : (n,) array of int32
        Index into the table.
    table : tuple of str
        The different words, in the order of their first appearance; it may hold words that no code names.

    Examples
    --------
    >>> labels = Labels.of(["B1", "B2", "B1"])
    >>> labels.codes.tolist(), labels.table
    ([0, 1, 0], ('B1', 'B2'))
    """

    codes: NDArray[np.int32]
    table: tuple[str, ...]

    @classmethod
    def of(cls, words: ArrayLike) -> Labels:
        """Return the codes of (n,) words."""
        table: dict[str, int] = {}
        # One long word among many would make an array of them as long as all together.
        plain = isinstance(words, (list, tuple)) and all(isinstance(word, str) for word in words)
        texts: Sequence[str] = words if plain else np.asarray(words, dtype=np.str_).tolist()  # type: ignore[assignment]
        codes = np.fromiter((table.setdefault(word, len(table)) for word in texts), np.int32, len(texts))
        # Halves of characters, from names in a broken encoding, could be written into no file.
        return cls(codes, tuple(table)).renamed([legible(word) for word in table])

    @classmethod
    def same(cls, word: str, n: int) -> Labels:
        """Return one word for all of n points: its code is held once."""
        return cls(np.broadcast_to(np.int32(0), (n,)), (legible(word),))

    def __post_init__(self) -> None:
        self.codes.setflags(write=False)

    def __len__(self) -> int:
        return len(self.codes)

    def __getitem__(self, index: slice | NDArray[np.integer] | NDArray[np.bool_]) -> Labels:
        """Return the labels of some of the points."""
        picked = np.atleast_1d(self.codes[index])
        if len(self.table) == 1 and self.codes.strides == (0,):
            return Labels.same(self.table[0], len(picked))
        return Labels(picked.copy() if isinstance(index, slice) else picked, self.table)

    def word(self, index: int) -> str:
        """Return the word of one point."""
        return self.table[int(self.codes[index])]

    def renamed(self, words: Sequence[str]) -> Labels:
        """Return labels whose table has other words, equal ones as one."""
        if list(words) == list(self.table):
            return self
        table: dict[str, int] = {}
        codes = np.fromiter((table.setdefault(word, len(table)) for word in words), np.int32, len(words))
        return Labels(codes[self.codes], tuple(table)) if len(words) else self

    def words(self) -> NDArray[np.str_]:
        """Return the words themselves, (n,); one word for all is held once."""
        if len(self.table) <= 1:
            return np.broadcast_to(np.array(self.table[0] if self.table else "", dtype=np.str_), (len(self),))
        words = np.array(self.table or ("",), dtype=np.str_)[self.codes]
        words.setflags(write=False)
        return words

    @classmethod
    def concatenate(cls, parts: Sequence[Labels]) -> Labels:
        """Join labels, in order."""
        table: dict[str, int] = {}
        codes = []
        for part in parts:
            own = np.array([table.setdefault(word, len(table)) for word in part.table] or [0], np.int32)
            codes.append(own[part.codes])
        return cls(np.concatenate([np.empty(0, np.int32), *codes]), tuple(table))
