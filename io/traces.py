"""Traces of horizons on the geological map, draped on the ground where they state no elevation."""

from __future__ import annotations

import numpy as np

from geofit.errors import InputError
from geofit.io.axes import Region, check_axes
from geofit.io.columns import TRACES
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.rows import read_rows
from geofit.io.source import Source
from geofit.points import PointSet
from geofit.site import Ground

__all__ = ["load_traces"]


def load_traces(
    source: Source,
    ground: Ground | None,
    horizons: HorizonNames,
    journal: Journal,
    region: Region | None = None,
) -> dict[str, PointSet]:
    """Read outcrop points, kind "outcrop"; a point without elevation and off the ground's grid is listed.

    Raises
    ------
    InputError
        If elevations are missing and there is no ground.
    """
    rows = read_rows(source, TRACES, journal)
    horizon = horizons.of(rows)
    x, y = rows.places()
    z = rows.numbers("z", required=False, no_data=True)
    check_axes(rows, x, y, region)
    blank = np.flatnonzero(np.isnan(z) & rows.ok)
    if blank.size and ground is None:
        raise InputError(
            f"{blank.size} points have no elevation and the site has no ground to drape them on",
            "Add a column z, or a [ground] table to the site file.",
            file=source.name,
            row=int(rows.line[blank[0]]),
        )
    if blank.size and ground is not None:
        z[blank] = ground.elevation(x[blank], y[blank])
        for i in blank[np.isnan(z[blank])].tolist():
            rows.reject(i, "x", "The point lies off the ground's grid", "Extend the grid or add its elevation.")
    rows.close()
    return horizons.split(rows, horizon, np.column_stack([x, y, z]), kind="outcrop")
