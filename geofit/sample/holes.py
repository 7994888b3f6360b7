"""Boreholes and adits: where they are, how they run, and what they meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.site import Ground
from geofit.sample.observations import Observations, errors_of
from geofit.sample.paths import Path, borehole_path, crossings, polyline_path
from geofit.sample.truth import AZIMUTH, HORIZONS, fault_at, horizon_truth, overburden, to_map

__all__ = ["Adit", "Borehole", "drill_adits", "drill_boreholes"]

Floats = NDArray[np.float64]

#: t of the core's vertical boreholes, metres: on the odd and on the even cross sections. Each section has an
#: inclined one besides, which starts in the hanging wall of the fault, so far from its outcrop.
_ON_ODD = (-450.0, -200.0, 10.0, 400.0)
_ON_EVEN = (-320.0, -35.0, 300.0)
_TO_FAULT = (48.0, 66.0)
_WEST = (
    (90, -300), (150, 120), (180, 400), (260, -120), (330, 300), (400, -420), (430, 60), (520, -220),
    (560, 420), (640, 130), (690, -380),
)  # fmt: skip
_EAST = (
    (1300, 240), (1330, -330), (1400, -20), (1460, 450), (1500, -430), (1560, 130), (1620, -150),
    (1680, 360), (1740, -400), (1780, 60), (1830, -180), (1860, 300), (1900, -20),
)  # fmt: skip
#: Holes for the weathering limit only, which end above the lower contact.
_SHALLOW = ("ZK104", "ZK301", "ZK504", "ZK701")
_DEVIATED = ("ZK304", "ZK401", "ZK501", "ZKW04", "ZKW09", "ZKE06")
#: Old holes of which no survey is left; the tables take them for vertical, as they are.
_UNSURVEYED = ("ZKW02", "ZKW07", "ZKE03")
_FOLD_FLOOR = 1288.0
#: Adits: name, s of the portal, t of the portal (the sign is the bank).
_ADITS = (("PD1", 907.0, 122.0), ("PD2", 1087.0, 152.0), ("PD3", 966.0, -152.0), ("PD4", 1147.0, -150.0))


@dataclass(frozen=True)
class Borehole:
    """A hole as its tables will hold it.

    ``survey`` (k, 3) has no rows for a hole that is known to be vertical; ``cover`` is the depth to rock,
    ``bottom_rock`` the stratum at the hole's end, ``contacts`` the depths at which each horizon is met.
    """

    name: str
    collar: Floats
    depth: float
    survey: Floats
    path: Path
    cover: float
    bottom_rock: str
    contacts: dict[str, list[float]]


@dataclass(frozen=True)
class Adit:
    """An adit: (k, 3) nodes from the portal on, and (chainage, horizon) of what it meets."""

    name: str
    nodes: Floats
    contacts: list[tuple[float, str]]


def drill_boreholes(ground: Ground, sections: Floats, observations: Observations) -> list[Borehole]:
    """Return the boreholes: on each cross section (``sections`` is their s) and outside."""
    rng = np.random.default_rng(41)
    holes = []
    for i, s in enumerate(sections):
        to_fault = fault_at(s) - _TO_FAULT[i % 2]
        for j, t in enumerate((*(_ON_EVEN if i % 2 else _ON_ODD), to_fault)):
            side = 1 if i == 0 else -1 if i == len(sections) - 1 else rng.choice([-1, 1])
            s_hole, t_hole = s + side * rng.uniform(0.5, 4.0), t + rng.uniform(-14, 14)
            name = f"ZK{i + 1}{j + 1:02d}"
            bottom = _FOLD_FLOOR if abs(t) < 50 and 0 < i < len(sections) - 1 else None
            holes.append(_drill(name, s_hole, t_hole, t == to_fault, bottom, ground, observations, rng))
    for side, places in (("W", _WEST), ("E", _EAST)):
        for j, (s, t) in enumerate(places):
            s, t = np.array([s, t]) + rng.uniform(-15, 15, 2)
            holes.append(_drill(f"ZK{side}{j + 1:02d}", s, t, False, None, ground, observations, rng))
    return holes


def _drill(
    name: str,
    s: float,
    t: float,
    inclined: bool,
    bottom: float | None,
    ground: Ground,
    observations: Observations,
    rng: np.random.Generator,
) -> Borehole:
    """Drill one hole: vertical or inclined to the left bank; ``bottom`` is an elevation to reach."""
    x, y = (np.round(c, 2) for c in to_map(np.array(s), np.array(t)))
    collar = np.array([x, y, np.round(ground.elevation(x, y), 2)])
    azimuth, dip = (AZIMUTH - 90.0, 66.0) if inclined else (0.0, 90.0)
    straight = borehole_path(collar, np.array([[0.0, azimuth, dip]]))
    margin = rng.uniform(12.0, 28.0)
    if name in _SHALLOW:
        depth = 62.0 + margin
    elif bottom is not None:
        depth = collar[2] - bottom + margin / 4
    else:
        targets = ("T2-T1", "F1") if inclined else ("T2-T1",)
        ends = [at for target in targets for at in crossings(straight, 350.0, horizon_truth(target).offset)]
        depth = max(ends, default=60.0) + margin
    depth = round(float(depth), 1)
    if inclined or bottom is not None or name in _DEVIATED:
        survey = _survey(azimuth if inclined else rng.uniform(0, 360), dip, depth, rng)
    else:
        survey = np.array([[0.0, 0.0, 90.0], [depth, 0.0, 90.0]])
    path = borehole_path(collar, survey)
    cover = round(max(1.2, float(overburden(x, y)) + rng.normal(0, 0.4)) / np.sin(np.radians(dip)), 1)
    contacts: dict[str, list[float]] = {}
    for horizon in HORIZONS:
        met = [
            round(at + float(errors_of(rng, "borehole", 1)[0]), 2)
            for at in crossings(path, depth - 1.5, horizon_truth(horizon).offset)
            if at > cover + 0.5
        ]
        if met:
            contacts[horizon] = met
        for at in met:
            observations.add(horizon, "borehole", path(np.array([at]))[0])
    end = path(np.array([depth]))
    bottom_rock = "T3" if horizon_truth("T3-T2").offset(end)[0] > 0 else "T2"
    if horizon_truth("T2-T1").offset(end)[0] < 0:
        bottom_rock = "T1"
    if name in _UNSURVEYED:
        survey = survey[:0]
    return Borehole(name, collar, depth, survey, path, cover, bottom_rock, contacts)


def _survey(azimuth: float, dip: float, depth: float, rng: np.random.Generator) -> Floats:
    """Return (k, 3) stations every 30 m and at the end of the hole, wandering as drill strings do."""
    at = np.append(np.arange(0.0, depth - 5.0, 30.0), depth)
    steep = dip > 85.0
    lift = rng.uniform(0.5, 1.0) if steep else rng.uniform(-0.5, 0.5)
    dips = dip - (0.3 if steep else 0.0) - lift * np.arange(len(at)) + rng.normal(0, 0.15, len(at))
    turn = azimuth + rng.uniform(-0.8, 0.8) * np.arange(len(at)) + rng.normal(0, 0.3, len(at))
    return np.column_stack([at, np.round(turn % 360, 1), np.round(np.minimum(dips, 89.9), 1)])


def drill_adits(ground: Ground, observations: Observations) -> list[Adit]:
    """Return the adits: from a portal on the slope into the bank, rising by 0.5 %, with a bend."""
    rng = np.random.default_rng(42)
    adits = []
    for name, s, t in _ADITS:
        inward = np.sign(t)
        along = np.array([0.0, 35.0, 80.0, 130.0, 180.0, 235.0])
        sway = np.concatenate([[0.0], np.cumsum(rng.uniform(-0.08, 0.16, 5) * np.diff(along))])
        x, y = (np.round(c, 2) for c in to_map(s + sway, t + inward * along))
        portal = float(ground.elevation(x[0], y[0]))
        path = polyline_path(np.column_stack([x, y, np.round(portal + 0.005 * along, 2)]))
        length = float(np.hypot(np.diff(x), np.diff(y)).sum())
        contacts = []
        for horizon in HORIZONS:
            for at in crossings(path, length, horizon_truth(horizon).offset):
                at = round(at + float(errors_of(rng, "adit", 1)[0]), 2)
                if at > 6.0 and observations.is_clear(horizon, path(np.array([at]))[0]):
                    contacts.append((at, horizon))
                    observations.add(horizon, "adit", path(np.array([at]))[0])
        nodes = np.column_stack([x, y, np.round(portal + 0.005 * along, 2)])
        adits.append(Adit(name, nodes, sorted(contacts)))
    return adits
