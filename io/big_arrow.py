"""Columns of a large text without exceptions, read by pyarrow where it is installed (extra ``scale``).

It reads numbers as Python does, each as the nearest double. What it refuses, or reads as a number that is none here,
is read by :mod:`geofit.io.big_cells`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.labels import Labels

__all__ = ["read_plain"]

Floats = NDArray[np.float64]

#: Bytes from which on pyarrow is imported, which takes a tenth of a second, and up to which its memory is spared.
ARROW_FROM, ARROW_TO = 16_000_000, 128_000_000
#: Bytes that it reads at a time.
BLOCK = 1 << 22


def read_plain(
    body: memoryview, rows: int, sep: str, width: int, numbers: Sequence[int], words: Sequence[int], decimal: str
) -> dict[int, Floats | Labels]:
    """Return columns of rows that have exactly their cells and no quotes; nothing where pyarrow cannot tell.

    Parameters
    ----------
    body : memoryview
        The rows, UTF-8.
    rows : int
        How many there are.
    sep : str
        Separator.
    width : int
        Number of columns.
    numbers, words : sequence of int
        Columns of numbers, and of words.
    decimal : str
        Decimal mark.
    """
    if not ARROW_FROM <= len(body) <= ARROW_TO:
        return {}
    try:
        import pyarrow as pa
        from pyarrow import csv
    except ImportError:
        return {}
    types: dict[str, Any] = {str(j): pa.float64() for j in numbers}
    types |= {str(j): pa.dictionary(pa.int32(), pa.string()) for j in words}
    values = {j: np.empty(rows) for j in numbers}
    labels: dict[int, list[Labels]] = {j: [] for j in words}
    at = 0
    try:
        # Piece by piece: a table of the whole would be held beside the columns that are made from it.
        for batch in csv.open_csv(
            pa.BufferReader(pa.py_buffer(body)),
            csv.ReadOptions(column_names=[str(j) for j in range(width)], block_size=BLOCK),
            csv.ParseOptions(delimiter=sep, quote_char=False, double_quote=False, ignore_empty_lines=False),
            csv.ConvertOptions(
                column_types=types,
                include_columns=list(types),
                null_values=[],
                strings_can_be_null=False,
                decimal_point=decimal,
            ),
        ):
            for j in numbers:
                values[j][at : at + batch.num_rows] = batch.column(str(j)).to_numpy()
            for j in words:
                part = batch.column(str(j))
                labels[j].append(Labels(np.array(part.indices), tuple(part.dictionary.to_pylist())))
            at += batch.num_rows
    except (pa.ArrowInvalid, ValueError):
        return {}  # a row is not plain, or there are more than were counted
    if at != rows:
        return {}
    plain: dict[int, Floats | Labels] = {j: column for j, column in values.items() if np.isfinite(column).all()}
    return plain | {j: Labels.concatenate(parts) for j, parts in labels.items()}
