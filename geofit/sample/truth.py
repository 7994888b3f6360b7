"""The fictional site as it "really" is: ground and horizons whose every point is known.

Everything is defined in the site's own axes ``(s, t)``: ``s`` metres downstream along the valley, ``t``
metres across it towards the left bank. Map coordinates (easting, northing) go in and come out.

``horizon_truth(name)`` gives what a test needs to score a fit; its class says in which sense the horizon is a
height: over the map (:class:`MapTruth`), over its best plane (:class:`PlaneTruth`), or none
(:class:`FoldTruth`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import SettingsError
from geofit.data.messages import message

__all__ = [
    "BOUNDARY",
    "CORE",
    "HORIZONS",
    "FoldTruth",
    "MapTruth",
    "PlaneTruth",
    "fault_at",
    "ground",
    "horizon_truth",
    "in_study_area",
    "to_map",
    "to_site",
]

Floats = NDArray[np.float64]

#: Map coordinates of (s, t) = (0, 0), metres; azimuth of the valley (downstream), degrees.
ORIGIN = (500180.0, 3101160.0)
AZIMUTH = 102.0
#: Rectangle of the dense core in (s, t): first, last; right bank, left bank.
CORE = (790.0, 1210.0, -648.0, 648.0)
#: Names of the horizons, as the site file lists them.
HORIZONS = ("T3-T2", "T2-T1", "W", "F1", "M1")

_DOWN = np.array([np.sin(np.radians(AZIMUTH)), np.cos(np.radians(AZIMUTH))])
_LEFT = np.array([-_DOWN[1], _DOWN[0]])


def to_map(s: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Return easting and northing of site coordinates."""
    return ORIGIN[0] + s * _DOWN[0] + t * _LEFT[0], ORIGIN[1] + s * _DOWN[1] + t * _LEFT[1]


def to_site(x: Floats | float, y: Floats | float) -> tuple[Floats, Floats]:
    """Return site coordinates ``(s, t)`` of easting and northing."""
    dx, dy = np.asarray(x, float) - ORIGIN[0], np.asarray(y, float) - ORIGIN[1]
    return dx * _DOWN[0] + dy * _DOWN[1], dx * _LEFT[0] + dy * _LEFT[1]


_CORNERS = np.array(
    [[10, -560], [380, -690], [1420, -700], [1960, -520], [1990, 410], [1560, 690], [240, 680], [0, 470]]
)
#: Corners of the study area, (k, 2) easting and northing, counter-clockwise, not closed.
BOUNDARY: Floats = np.column_stack(to_map(_CORNERS[:, 0], _CORNERS[:, 1])).round(1)


def in_study_area(x: Floats | float, y: Floats | float) -> NDArray[np.bool_]:
    """Tell which map places lie in the study area (crossing-number rule)."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    odd = np.zeros(x.shape, bool)
    for (xa, ya), (xb, yb) in zip(BOUNDARY, np.roll(BOUNDARY, -1, axis=0), strict=True):
        if ya != yb:
            odd ^= ((ya > y) != (yb > y)) & (x < xa + (y - ya) * (xb - xa) / (yb - ya))
    return odd


class _Waves:
    """A sum of plane waves with a given root mean square; amplitudes fall with the wavelength's power 1.5."""

    def __init__(self, seed: int, rms: float, shortest: float, longest: float, number: int = 40) -> None:
        rng = np.random.default_rng(seed)
        length = shortest * (longest / shortest) ** rng.uniform(0, 1, number)
        azimuth, self.phase = rng.uniform(0, 2 * np.pi, (2, number))
        amplitude = (length / longest) ** 1.5 * rng.normal(0, 1, number)
        self.amplitude = amplitude * rms / np.sqrt((amplitude**2).sum() / 2)
        self.kx, self.ky = 2 * np.pi / length * np.cos(azimuth), 2 * np.pi / length * np.sin(azimuth)

    def __call__(self, a: Floats, b: Floats) -> Floats:
        a, b = np.broadcast_arrays(np.asarray(a, float), np.asarray(b, float))
        phase = np.multiply.outer(a, self.kx) + np.multiply.outer(b, self.ky) + self.phase
        return np.asarray(np.sin(phase) @ self.amplitude)


_SPURS = _Waves(11, 0.10, 350.0, 900.0)
_RIDGES = _Waves(12, 4.0, 260.0, 700.0)
_CONTACT = _Waves(21, 9.0, 220.0, 1200.0)
_THICKNESS = _Waves(22, 6.0, 300.0, 1200.0)
_WEATHERING = _Waves(23, 3.0, 200.0, 800.0)
_FAULT = _Waves(35, 8.0, 160.0, 420.0)
#: Side gullies: bank (+1 left, -1 right), s of the mouth, drift of s per metre up the bank, half width.
_GULLIES = (
    (1, 520.0, -0.25, 75.0),
    (1, 1095.0, 0.20, 80.0),
    (-1, 300.0, 0.15, 85.0),
    (-1, 1480.0, 0.3, 80.0),
)


def river(s: Floats) -> Floats:
    """Return the river axis, t as a function of s."""
    return 32.0 * np.sin(2 * np.pi * s / 1500.0 + 0.6)


def _valley(s: Floats, t: Floats, gullies: float) -> Floats:
    """Height above the river bed; ``gullies`` scales the depth of the side gullies."""
    across = t - river(s)
    soft = np.sqrt(across**2 + 60.0**2) - 60.0
    rise = 310.0 * (1 - np.exp(-((soft / 410.0) ** 1.5)))
    share = np.ones_like(rise)
    for bank, mouth, drift, width in _GULLIES:
        up = bank * across
        reach = 1 / (1 + np.exp(-(up - 70.0) / 30.0))
        share = share - gullies * 0.22 * reach * np.exp(-(((s - mouth - drift * up) / width) ** 2))
    return rise * (share + _SPURS(s, t)) + _RIDGES(s, t) * (rise / 310.0)


def _bed(s: Floats) -> Floats:
    return 1500.0 - 0.010 * s


def ground(x: Floats, y: Floats) -> Floats:
    """Return the ground elevation at map coordinates, metres; arrays broadcast."""
    s, t = to_site(x, y)
    return _bed(s) + _valley(s, t, 1.0)


def overburden(x: Floats, y: Floats) -> Floats:
    """Return the thickness of the loose cover, metres: river gravel in the floor, talus on the slopes."""
    s, t = to_site(x, y)
    return 3.5 + 13.0 * np.exp(-(((t - river(s)) / 60.0) ** 2)) + 0.3 * _WEATHERING(t, s)


def _lower_contact(x: Floats, y: Floats) -> Floats:
    """T2 on T1: dips downstream, flattening, and gently to the right bank."""
    s, t = to_site(x, y)
    return 1414.0 + 146.0 * np.exp(-s / 700.0) + 0.035 * t + _CONTACT(s, t)


def _upper_contact(x: Floats, y: Floats) -> Floats:
    """T3 on T2: conformable, T2 being 60 to 100 m thick."""
    s, t = to_site(x, y)
    return _lower_contact(x, y) + 80.0 + 0.012 * (s - 1000.0) + _THICKNESS(s, t)


def _weathering_limit(x: Floats, y: Floats) -> Floats:
    """Lower limit of moderately weathered rock: follows the ground, deeper under spurs than gullies."""
    s, t = to_site(x, y)
    height = _valley(s, t, 0.85)
    return _bed(s) + height - (29.0 + 0.05 * height + _WEATHERING(s, t))


@dataclass(frozen=True)
class MapTruth:
    """A horizon that is a height over the map.

    ``height(x, y)`` is its elevation in metres at easting and northing; arrays broadcast.
    """

    name: str
    height: Callable[[Floats, Floats], Floats]

    def offset(self, xyz: Floats) -> Floats:
        """Return (n,) metres by which (n, 3) points lie above the horizon, measured vertically."""
        return xyz[:, 2] - self.height(xyz[:, 0], xyz[:, 1])

    def places(self, n: int = 10_000, *, core: bool = False, seed: int = 2011) -> Floats:
        """Return (n, 3) points of the horizon, even over the area or the core, where it is not eroded."""
        rng = np.random.default_rng(seed)
        s0, s1, t0, t1 = CORE if core else (_CORNERS.min(0)[0], _CORNERS.max(0)[0], -700.0, 700.0)
        found = np.empty((0, 3))
        while len(found) < n:
            x, y = to_map(rng.uniform(s0, s1, 2 * n), rng.uniform(t0, t1, 2 * n))
            z = self.height(x, y)
            keep = in_study_area(x, y) & (z < ground(x, y))
            found = np.concatenate([found, np.column_stack([x, y, z])[keep]])
        return found[:n]


@dataclass(frozen=True, eq=False)
class PlaneTruth:
    """A steep horizon that is a height over its best plane and over no map.

    ``axes`` (3, 3) has the unit vectors along strike (u), up the dip (v) and normal to the plane (w) as rows;
    ``origin`` (3,) is in map coordinates; ``height(u, v)`` is w in metres.
    """

    name: str
    origin: Floats
    axes: Floats
    height: Callable[[Floats, Floats], Floats]

    def local(self, xyz: Floats) -> Floats:
        """Return (n, 3) coordinates (u, v, w) of map points."""
        return np.asarray((xyz - self.origin) @ self.axes.T)

    def point(self, u: Floats, v: Floats, off: Floats | float = 0.0) -> Floats:
        """Return (n, 3) map points of the horizon, ``off`` metres away from it along the plane's normal."""
        return np.asarray(self.origin + np.column_stack([u, v, self.height(u, v) + off]) @ self.axes)

    def offset(self, xyz: Floats) -> Floats:
        """Return (n,) metres by which (n, 3) points lie off the horizon along the plane's normal."""
        u, v, w = self.local(xyz).T
        return np.asarray(w - self.height(u, v))

    def places(self, n: int = 10_000, *, core: bool = False, seed: int = 2011) -> Floats:
        """Return (n, 3) points, even over what the sections show of it (``core`` alters nothing)."""
        rng = np.random.default_rng(seed)
        found = np.empty((0, 3))
        while len(found) < n:
            xyz = self.point(rng.uniform(-300, 300, 4 * n), rng.uniform(-330, 150, 4 * n))
            s, _ = to_site(xyz[:, 0], xyz[:, 1])
            drawn = (xyz[:, 2] > FAULT_BOTTOM) & (xyz[:, 2] < ground(xyz[:, 0], xyz[:, 1]) - 3.0)
            found = np.concatenate([found, xyz[drawn & (s > CORE[0]) & (s < CORE[1])]])
        return found[:n]


@dataclass(frozen=True)
class FoldTruth:
    """An overturned fold: two limbs and a hinge, a height over no plane.

    ``point(s, p)`` is the map point at ``s`` metres downstream and at ``p`` along the profile: -1 at the end
    of the lower, overturned limb, 0 at the hinge, 1 at the end of the upper limb.
    """

    name: str

    def point(self, s: Floats, p: Floats) -> Floats:
        """Return (n, 3) map points of the horizon."""
        s, p = np.broadcast_arrays(np.asarray(s, float), np.asarray(p, float))
        t, z = _fold_profile(s, p)
        return np.column_stack([*to_map(s, t), z])

    def project(self, xyz: Floats) -> tuple[Floats, Floats, Floats]:
        """Return s, p and the signed orthogonal distance in metres, each (n,), of (n, 3) map points.

        The nearest of 401 points of the profile at the same ``s`` starts a Gauss-Newton iteration. The sign
        is positive inside the fold. Beyond the profile's ends p stops at -1 or 1.
        """
        s, t = to_site(xyz[:, 0], xyz[:, 1])
        z = xyz[:, 2]
        grid = np.linspace(-1.0, 1.0, 401)
        tg, zg = _fold_profile(s[:, None], grid[None, :])
        p = grid[((tg - t[:, None]) ** 2 + (zg - z[:, None]) ** 2).argmin(axis=1)]
        place, target = s.copy(), np.column_stack([s, t, z])
        for _ in range(12):
            here, ds, dp = _fold_derivatives(place, p)
            gap = target - here
            ss, sp, pp = (ds * ds).sum(1), (ds * dp).sum(1), (dp * dp).sum(1)
            rs, rp = (ds * gap).sum(1), (dp * gap).sum(1)
            determinant = ss * pp - sp**2
            place = place + (pp * rs - sp * rp) / determinant
            p = np.clip(p + (ss * rp - sp * rs) / determinant, -1.0, 1.0)
        here, ds, dp = _fold_derivatives(place, p)
        gap, normal = target - here, np.cross(ds, dp)
        sign = np.where((gap * normal).sum(1) < 0, -1.0, 1.0)
        return place, p, sign * np.sqrt((gap**2).sum(1))

    def offset(self, xyz: Floats) -> Floats:
        """Return (n,) signed orthogonal distances of (n, 3) points, metres."""
        return self.project(xyz)[2]

    def places(self, n: int = 10_000, *, core: bool = False, seed: int = 2011) -> Floats:
        """Return (n, 3) points between the first and the last section (``core`` alters nothing)."""
        rng = np.random.default_rng(seed)
        return self.point(rng.uniform(CORE[0], CORE[1], n), rng.uniform(-1.0, 1.0, n))


def _fold_profile(s: Floats, p: Floats) -> tuple[Floats, Floats]:
    """Return t and z: limbs that part from the hinge and close again, tilted, plunging and swaying with s."""
    along = s - 1000.0
    reach = 128.0 + 12.0 * np.sin(along / 95.0)
    opening = 92.0 + 8.0 * np.cos(along / 120.0 + 0.5)
    back, up = -reach * p**2, opening * p * (1.0 - 0.55 * p**2)
    tilt = np.radians(16.0 + 5.0 * np.sin(along / 150.0))
    hinge_t = 25.0 + 0.05 * along + 9.0 * np.sin(along / 80.0 + 1.0)
    hinge_z = 1362.0 - 0.06 * along + 5.0 * np.sin(along / 110.0)
    return (
        hinge_t + back * np.cos(tilt) - up * np.sin(tilt),
        hinge_z + back * np.sin(tilt) + up * np.cos(tilt),
    )


def _fold_derivatives(s: Floats, p: Floats) -> tuple[Floats, Floats, Floats]:
    """Return (n, 3) points (s, t, z) of the fold and their derivatives by s and p (central differences)."""

    def at(a: Floats, b: Floats) -> Floats:
        return np.column_stack([a, *_fold_profile(a, b)])

    ds = (at(s + 1e-3, p) - at(s - 1e-3, p)) / 2e-3
    dp = (at(s, p + 1e-5) - at(s, p - 1e-5)) / 2e-5
    return at(s, p), ds, dp


#: Dip of the fault's best plane in degrees, and the elevation down to which the sections draw it.
FAULT_DIP = 77.0
FAULT_BOTTOM = 1330.0


_FAULT_STRIKE = AZIMUTH - 12.0
_FAULT_T, _FAULT_Z = 168.0, 1530.0


def fault_at(s: float) -> float:
    """Return t where the fault's best plane passes through the left bank at the elevation 1530 m."""
    return _FAULT_T + (s - 1000.0) * float(np.tan(np.radians(AZIMUTH - _FAULT_STRIKE)))


def _fault() -> PlaneTruth:
    """Strikes 12 degrees off the valley along the left bank and dips under the river."""
    strike = np.radians(_FAULT_STRIKE)
    along = np.array([np.sin(strike), np.cos(strike), 0.0])
    left = np.array([-along[1], along[0], 0.0])
    dip = np.radians(FAULT_DIP)
    up = np.cos(dip) * left + np.array([0.0, 0.0, np.sin(dip)])
    x, y = to_map(np.array(1000.0), np.array(_FAULT_T))
    return PlaneTruth(
        "F1", np.array([float(x), float(y), _FAULT_Z]), np.array([along, up, np.cross(along, up)]), _FAULT
    )


_TRUTHS: dict[str, MapTruth | PlaneTruth | FoldTruth] = {
    "T3-T2": MapTruth("T3-T2", _upper_contact),
    "T2-T1": MapTruth("T2-T1", _lower_contact),
    "W": MapTruth("W", _weathering_limit),
    "F1": _fault(),
    "M1": FoldTruth("M1"),
}


def horizon_truth(name: str) -> MapTruth | PlaneTruth | FoldTruth:
    """Return the truth of one horizon of the sample site.

    Parameters
    ----------
    name : str
        One of :data:`HORIZONS`.

    Returns
    -------
    MapTruth, PlaneTruth or FoldTruth
        ``places(n, core=False)`` gives (n, 3) points on the true horizon where a fit is to be scored,
        ``offset(xyz)`` states how far (n, 3) points lie off it.

    Raises
    ------
    SettingsError
        If the site has no such horizon.

    Examples
    --------
    >>> truth = horizon_truth("T2-T1")
    >>> bool(abs(truth.offset(truth.places(100))).max() < 1e-9)
    True
    """
    if name not in _TRUTHS:
        raise SettingsError(
            message(
                "sample.horizon-unknown",
                "The sample site has no horizon {name!r}; choose one of {names}.",
                name=name,
                names=", ".join(HORIZONS),
            )
        )
    return _TRUTHS[name]
