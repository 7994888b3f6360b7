"""Holes that pass a horizon's surface and have no contact of it: there the horizon is not where the surface is.

It may have pinched out or been eroded, lie deeper than the hole ends, or its contact may be missing in the log. A fit
knows contacts only: what a hole did not meet does not bend the surface, and sigma does not show it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Check
from geofit.data.logs import IntervalLog
from geofit.data.messages import message, some_of
from geofit.data.site import Hole, Site
from geofit.fitting.horizon_fit import HorizonFit

__all__ = ["CONTACTS", "check_holes"]

Floats = NDArray[np.float64]

#: Name of the check.
CONTACTS = "contacts"
#: Places of a hole's path at which its height above the surface is taken.
PLACES = 200
#: Holes that the check names, and places that it lists.
NAMED, LISTED = 5, 20


def check_holes(surface: HorizonFit, site: Site, horizon: str = "") -> Check | None:
    """Look for holes that pass through a surface without a contact of its horizon.

    Parameters
    ----------
    surface : HorizonFit
        The fit, a height field over the map.
    site : Site
        Its ``holes``, their interval tables and the points of its horizons.
    horizon : str
        Name of the horizon where the surface is one block of it.

    Returns
    -------
    Check or None
        How many holes pass it by more than the interior tolerance. None where the surface is not a height field over
        the map, or no contact of the horizon is from the interval log of a hole.

    Notes
    -----
    Only holes of the interval tables that give contacts of the horizon count, and only as far as they are logged. Where
    a hole passes the surface within the uppermost interval of its log and others follow, or above a contact of a
    horizon that ``site.order`` places above this one (an unconformity), the horizon was eroded before what lies there
    was deposited, or never was there: that is reported, not a failure.
    """
    name = horizon or surface.name
    own = site.horizons.get(name, surface.points)
    paths = {hole.name: hole for hole in site.holes}
    met = {hole for hole in own.hole.tolist() if hole in paths}
    if surface.frame != "map" or not surface.patches or not met:
        return None
    files = {str(file) for file, hole in zip(own.file.tolist(), own.hole.tolist(), strict=True) if hole in met}
    logs = [log for campaign in site.boreholes for log in campaign.logs if log.file in files]
    if not logs:
        return None
    asked = {hole for log in logs for hole in log.hole.tolist()} & set(paths)
    tracks = [_track(paths[hole]) for hole in sorted(asked - met)]
    # All holes at once: a call for each takes longer than its places.
    places = np.concatenate([np.empty((0, 4)), *(track for _, track in tracks)])
    height = np.split(
        places[:, 2] - surface.elevation(places[:, 0], places[:, 1]),
        np.cumsum([len(track) for _, track in tracks])[:-1],
    )
    least, cut = surface.settings.interior_tolerance, _lowest_above(site, name)
    passed = [
        found
        for (hole, track), over in zip(tracks, height, strict=False)
        if (found := _pass_of(hole, track, over, _logged(logs, hole), least, cut.get(hole, np.inf))) is not None
    ]
    if not passed:
        text = message("site.holes-have-contacts", "each hole that passes the surface has a contact of the horizon")
        return Check(CONTACTS, True, 0.0, 0.0, "1", text)
    wrong = [one for one in passed if not one.covered]
    named = sorted(wrong or passed, key=lambda one: -one.far)
    figures = {
        "count": len(named),
        "total": len(asked),
        "names": some_of([one.hole for one in named], NAMED),
        "far": named[0].far,
    }
    if wrong:
        text = message(
            "site.holes-without-contact",
            "holes that pass the surface and have no contact of the horizon: {count} of {total} ({names}), which go on "
            "for up to {far:.1f} m; the horizon is deeper there, has pinched out or is eroded, or its contact is not "
            "in the log",
            **figures,
        )
    else:
        text = message(
            "site.holes-pass-cover",
            "holes that pass the surface within the uppermost interval of their log, or above a horizon that the order "
            "places above this one, and have no contact of the horizon: {count} of {total} ({names}); it is eroded "
            "there or has pinched out",
            **figures,
        )
    return Check(CONTACTS, False if wrong else None, float(len(named)), 0.0, "1", text,
                 tuple(one.place for one in named[:LISTED]))  # fmt: skip


@dataclass(frozen=True)
class _Pass:
    """Where a hole passes the surface, how far it goes on, metres, and whether that is in what covers the horizon."""

    hole: str
    place: tuple[float, float, float]
    far: float
    covered: bool


def _lowest_above(site: Site, horizon: str) -> dict[str, float]:
    """Return the elevation of the lowest contact, in each hole, of the horizons that the order places above one."""
    above = site.order[: site.order.index(horizon)] if horizon in site.order else ()
    found: dict[str, float] = {}
    for points in (site.horizons[name] for name in above if name in site.horizons):
        for hole, z in zip(points.hole.tolist(), points.xyz[:, 2].tolist(), strict=True):
            found[hole] = min(z, found.get(hole, np.inf))
    return found


def _logged(logs: Sequence[IntervalLog], hole: str) -> Floats:
    """Return the (k, 2) depths of a hole's intervals, metres, from its collar down."""
    rows = [np.column_stack([log.top[mine], log.base[mine]]) for log in logs if (mine := log.hole == hole).any()]
    depths = np.concatenate(rows)
    return np.asarray(depths[np.argsort(depths[:, 0], kind="stable")])


def _track(hole: Hole) -> tuple[str, Floats]:
    """Return the name of a hole, and (k, 4) x, y, z and depth of places along it."""
    depth = np.union1d(hole.depth, np.linspace(hole.depth[0], hole.depth[-1], PLACES))
    return hole.name, np.column_stack([*(np.interp(depth, hole.depth, hole.xyz[:, k]) for k in range(3)), depth])


def _pass_of(hole: str, track: Floats, height: Floats, logged: Floats, least: float, cut: float) -> _Pass | None:
    """Return where a logged hole passes the surface and goes on for more than ``least`` metres; None if it does not.

    ``height`` (k,) is that of the places of its track above the surface, ``cut`` the elevation of a horizon that cuts
    this one off in the hole.
    """
    depth = track[:, 3]
    known = np.isfinite(height)
    for k in np.flatnonzero(known[:-1] & known[1:] & (height[:-1] * height[1:] < 0)).tolist():
        share = height[k] / (height[k] - height[k + 1])
        at = depth[k] + share * (depth[k + 1] - depth[k])
        if not ((logged[:, 0] <= at) & (at <= logged[:, 1])).any():
            continue
        end = min(float(depth[-1]), float(logged[:, 1].max()))
        beyond = known & (np.sign(height) == np.sign(height[k + 1])) & (depth > at) & (depth <= end)
        far = float(np.abs(height[beyond]).max(initial=0.0))
        if far > least:
            x, y, z, _ = (track[k] + share * (track[k + 1] - track[k])).tolist()
            return _Pass(hole, (x, y, z), far, bool(at <= logged[0, 1] < end or z >= cut - least))
    return None
