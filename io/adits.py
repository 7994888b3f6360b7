"""Adits: polylines in space, and contacts at a chainage along them."""

from __future__ import annotations

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.site import Hole
from geofit.io.adit_dxf import draw_adits, drawn_contacts
from geofit.io.axes import Region, check_axes
from geofit.io.columns import ADIT_CONTACTS, ADIT_PATH
from geofit.io.horizons import HorizonNames
from geofit.io.journal import Journal
from geofit.io.polyline import along, chainage, named_lines
from geofit.io.rows import read_rows
from geofit.io.source import Source

__all__ = ["load_adit_contacts", "load_adits"]

#: A contact at the face may lie this far beyond the surveyed end, metres.
END_TOLERANCE = 0.01


def load_adits(source: Source, journal: Journal, region: Region | None = None) -> tuple[Hole, ...]:
    """Read adit paths: rows of one adit are its corners in order; an adit of one corner is listed. Or a DXF."""
    if source.path.suffix.casefold() == ".dxf":
        return draw_adits(source, journal, region)
    rows = read_rows(source, ADIT_PATH, journal)
    (x, y), z = rows.places(), rows.numbers("z", no_data=True)
    check_axes(rows, x, y, region)
    lines = named_lines(rows, "adit", np.column_stack([x, y, z]), "Adit")
    adits = [Hole(adit, "adit", chainage(xyz), xyz) for adit, xyz in lines.items()]
    rows.close()
    if not adits:
        raise InputError(
            message("io.no-usable-adit", "No adit has two usable corners"),
            message("io.see-listed-rows", "See the listed rows."),
            file=source.name,
        )
    return tuple(adits)


def load_adit_contacts(
    source: Source, adits: tuple[Hole, ...], horizons: HorizonNames, journal: Journal
) -> dict[str, PointSet]:
    """Read contacts along adits, kind "adit"; a chainage beyond the adit is listed."""
    if source.path.suffix.casefold() == ".dxf":
        return drawn_contacts(source, adits, horizons, journal)
    rows = read_rows(source, ADIT_CONTACTS, journal)
    name, s = rows.text("adit"), rows.numbers("chainage")
    horizon = horizons.of(rows)
    paths = {adit.name: adit for adit in adits}
    name = rows.require_known("adit", name, paths, "adit path table")
    xyz = np.zeros((len(rows), 3))
    for i in np.flatnonzero(rows.ok).tolist():
        adit = paths[name[i]]
        length = float(adit.depth[-1])
        if not 0 <= s[i] <= length + END_TOLERANCE:
            rows.reject(
                i,
                "chainage",
                message(
                    "io.chainage-off-adit",
                    "The chainage is not on adit {adit}, which is {length:.2f} m long",
                    adit=name[i],
                    length=length,
                ),
                message("io.correct-chainage", "Correct the chainage, or complete the adit's path."),
            )
            continue
        xyz[i] = along(adit.xyz, s[i : i + 1])[0]
    rows.close()
    return horizons.split(rows, horizon, xyz, kind="adit", hole=name)
