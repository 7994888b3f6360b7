"""Numbers that programs write where there is none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import message
from geofit.io.journal import Journal

__all__ = ["blank_nodes", "is_no_data"]

Floats = NDArray[np.float64]

#: Marks of tables, those that grids have too, and the least of the huge ones (1e30, 1.70141e38, 3.4028235e38).
_MARKS = (-9999.0, -99999.0, -999.25, -999999.0)
_GRID_MARKS = (*_MARKS, -32767.0, -32768.0)
_HUGE = 1e30


def is_no_data(values: Floats) -> NDArray[np.bool_]:
    """Return which numbers mark that there is none.

    Examples
    --------
    >>> is_no_data(np.array([12.5, -9999.0, -3.4028235e38, np.nan])).tolist()
    [False, True, True, False]
    """
    return np.asarray(np.isin(values, _MARKS) | (np.abs(values) >= _HUGE))


def blank_nodes(z: Floats, file: str, journal: Journal) -> None:
    """Turn huge nodes of a grid into nan; warn of nodes that are another mark, which the grid itself does not name."""
    z[np.abs(z) >= _HUGE] = np.nan
    for mark in _GRID_MARKS:
        if count := int((z == mark).sum()):
            journal.add(
                "warning",
                file,
                message(
                    "io.nodes-look-blank",
                    "Nodes that are {mark:g}, which often means no data: {count}; they count as elevations",
                    mark=mark,
                    count=count,
                ),
                message(
                    "io.state-no-data-value",
                    "If they have no data, save the grid with {mark:g} as its no-data value.",
                    mark=mark,
                ),
            )
