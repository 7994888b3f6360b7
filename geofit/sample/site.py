"""The sample site: observe the truth as an exploration campaign would, and write its files."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import geofit.sample.tables as tables
from geofit.data.site import Ground
from geofit.sample.body_holes import write_bodies
from geofit.sample.holes import Adit, Borehole, drill_adits, drill_boreholes
from geofit.sample.mapping import map_outcrops, pick_lines
from geofit.sample.observations import Observations
from geofit.sample.sections import CROSS_SECTIONS, SampleDrawing, draw_points, empty_drawings
from geofit.sample.truth import BOUNDARY, HORIZONS
from geofit.sample.truth import ground as true_ground

__all__ = ["CORE_POINTS", "POINTS", "observe", "write_site"]

Floats = NDArray[np.float64]

#: Points of the horizon "T2-T1" (paper, sec. 3.2: n = 597), and how many of them lie in the dense core.
POINTS, CORE_POINTS = 597, 440

_CELL = 20.0
#: Points that each cross section and each longitudinal section shows.
_DRAWN = {"T3-T2": (24, 10), "W": (24, 12), "F1": (16, 0), "M1": (24, 0)}
_LONGITUDINAL_POINTS = 16
_OUTCROP_SPACING = {"T3-T2": 34.0, "T2-T1": 17.0, "F1": 15.0}
_PICKS = {"T3-T2": 60, "W": 108}


@dataclass(frozen=True)
class Campaign:
    """All that was observed."""

    ground: Ground
    boreholes: list[Borehole]
    adits: list[Adit]
    drawings: list[SampleDrawing]
    outcrops: dict[str, Floats]
    picks: dict[str, Floats]
    observations: Observations


def observe() -> Campaign:
    """Return the campaign; the same at every call.

    Raises
    ------
    AssertionError
        If the points of T2-T1 are not as many as in the paper.
    """
    ground, observations = _ground(), Observations()
    boreholes = drill_boreholes(ground, CROSS_SECTIONS, observations)
    outside = {hole.name for hole in boreholes if hole.name[2] in "WE"}
    adits = drill_adits(ground, observations)
    drawings = empty_drawings()
    outcrops = {name: map_outcrops(name, gap, ground, observations) for name, gap in _OUTCROP_SPACING.items()}

    peripheral = sum(len(h.contacts.get("T2-T1", ())) for h in boreholes if h.name in outside)
    central = observations.count("T2-T1", "borehole", "adit") - peripheral
    rng = np.random.default_rng(45)
    for name in HORIZONS:
        across, along = _DRAWN.get(name, (0, _LONGITUDINAL_POINTS))
        shares = [across] * len(CROSS_SECTIONS) + [along] * (len(drawings) - len(CROSS_SECTIONS))
        if name == "T2-T1":
            rest = CORE_POINTS - central - sum(shares)
            shares[: len(CROSS_SECTIONS)] = [(rest + i) // len(CROSS_SECTIONS) for i in range(len(CROSS_SECTIONS))]
        for drawing, n in zip(drawings, shares, strict=True):
            if n:
                draw_points(drawing, name, n, observations, rng)
    counts = _PICKS | {"T2-T1": POINTS - CORE_POINTS - peripheral - len(outcrops["T2-T1"])}
    picks = {name: pick_lines(name, counts[name], observations) for name in HORIZONS if name in counts}
    if observations.count("T2-T1") != POINTS:
        raise AssertionError(f"T2-T1 has {observations.count('T2-T1')} points instead of {POINTS}.")
    return Campaign(ground, boreholes, adits, drawings, outcrops, picks, observations)


def _ground() -> Ground:
    """Return the survey of the ground: centres of 20 m cells around the study area, to the centimetre."""
    low = np.floor(BOUNDARY.min(axis=0) / 100.0) * 100.0 - 100.0
    high = np.ceil(BOUNDARY.max(axis=0) / 100.0) * 100.0 + 100.0
    x = np.arange(low[0] + _CELL / 2, high[0], _CELL)
    y = np.arange(low[1] + _CELL / 2, high[1], _CELL)
    return Ground(x, y, np.round(true_ground(*np.meshgrid(x, y)), 2))


def write_site(folder: str | os.PathLike[str]) -> dict[str, int]:
    """Write the sample site; the same bytes at every call.

    Parameters
    ----------
    folder : path
        Where ``site.toml``, ``bodies.toml`` and the files that they name go; created if missing. Files of the same
        names are replaced.

    Returns
    -------
    dict of str to int
        The number of points of each horizon.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_site(folder)["T2-T1"]
    597
    """
    campaign = observe()
    folder = Path(folder)
    (folder / "sections").mkdir(parents=True, exist_ok=True)
    tables.write_boundary(folder / "boundary.csv")
    tables.write_ground(folder / "ground.asc", campaign.ground, _CELL)
    tables.write_boreholes(folder, campaign.boreholes)
    tables.write_adits(folder, campaign.adits)
    for drawing in campaign.drawings:
        tables.write_section(folder / tables.section_file(drawing), drawing)
    tables.write_outcrops(folder / "outcrops.csv", campaign.outcrops)
    tables.write_picks(folder / "geophysics.csv", campaign.picks, campaign.boreholes)
    tables.write_site_file(folder / "site.toml", campaign.drawings)
    write_bodies(folder)
    return {name: campaign.observations.count(name) for name in HORIZONS}
