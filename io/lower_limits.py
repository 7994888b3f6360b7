"""Interval tables with lower limits only: the upper limit of a layer is the lower one of the row above."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.io.rows import Rows

__all__ = ["tops_from_above"]

Floats = NDArray[np.float64]

#: Where more of the steps from row to row go up, the table is in another order than that of depth.
MOST_BACK = 0.2


def tops_from_above(rows: Rows, hole: Sequence[str], base: Floats, collars: Container[str]) -> Floats:
    """Return the depth (n,) of the upper limits, 0 at the first row of a hole; what is taken is listed.

    A row without a code still ends the one below it. In a table that is in order of depth a step back is an error
    of one of its two rows, and neither is used; a table that is in no such order is sorted. A row whose row above
    gives no limit is not used, nor one below a row whose hole is misspelt.
    """
    rows.journal.add(
        "note",
        rows.file,
        message(
            "io.upper-limits-taken-from-above",
            "There are lower limits only; upper limits were taken from the row above, 0 at the first row of a hole",
        ),
        message("io.state-upper-limits", "If there are upper limits, state columns = { from = ... }."),
        column=rows.table.header[rows.columns["to"]],
    )
    holes, stray = _rows_of_holes(hole, collars)
    known = np.isfinite(base)
    known[stray] = False
    steps = [pair for members in holes.values() for pair in pairwise(i for i in members if known[i])]
    back = [(i, k) for i, k in steps if base[k] < base[i]]
    if len(back) > MOST_BACK * len(steps):
        _sort(rows, holes, base, known, len(back), len(steps))
    else:
        for i, k in back:
            reason = message(
                "io.lower-limit-contradicts",
                "The lower limit of row {last} lies above that of row {first}; one of the two is wrong",
                first=rows.line[i],
                last=rows.line[k],
            )
            for wrong in (i, k):
                known[wrong] = False
                if rows.ok[wrong]:
                    rows.reject(wrong, "to", reason, message("io.correct-depth", "Correct the depth."))
    top = np.full(len(base), np.nan)
    for members in holes.values():
        top[members[0]] = 0.0
        for above, i in pairwise(members):
            if known[above]:
                top[i] = base[above]
            elif rows.ok[i]:
                reason = message(
                    "io.upper-limit-unknown",
                    "The upper limit is not known: row {row}, the one above, gives none",
                    row=rows.line[above],
                )
                rows.reject(i, "from", reason, message("io.correct-row", "Correct that row."))
    return top


def _rows_of_holes(hole: Sequence[str], collars: Container[str]) -> tuple[dict[str, list[int]], list[int]]:
    """Return the rows of each hole that has a collar, and which of them stand among them under a name of no hole."""
    times = Counter(hole)
    holes: dict[str, list[int]] = {}
    stray: list[int] = []
    last, between = "", list[int]()
    for i, name in enumerate(hole):
        if name in collars:
            if between and name == last:
                holes[name] += between
                stray += between
            holes.setdefault(name, []).append(i)
            last, between = name, []
        elif not name or times[name] == 1:
            between.append(i)
    return holes, stray


def _sort(
    rows: Rows, holes: Mapping[str, list[int]], base: Floats, known: NDArray[np.bool_], back: int, steps: int
) -> None:
    """Put the rows of each hole in order of depth; a row without a depth may lie anywhere in its hole."""
    rows.journal.add(
        "warning",
        rows.file,
        message(
            "io.rows-out-of-order",
            "The rows are not in order of depth ({back} of {steps} steps within a hole go up); those of each hole were "
            "sorted by depth",
            back=back,
            steps=steps,
        ),
        message("io.state-measure-elevation", 'If the limits are elevations, state measure = "elevation".'),
        column=rows.table.header[rows.columns["to"]],
    )
    for members in holes.values():
        if not known[members].all():
            known[members] = False
        members.sort(key=lambda i: (bool(np.isfinite(base[i])), base[i]))
