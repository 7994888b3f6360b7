"""Projection of places from one coordinate system to another (pyproj, extra ``gis``)."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError, MissingDependencyError
from geofit.data.lengths import LENGTH_UNITS, LengthUnit
from geofit.data.messages import Untranslated, message
from geofit.io.extra import need
from geofit.io.journal import Journal

__all__ = [
    "WGS84",
    "axis_units",
    "is_code",
    "list_system",
    "project_places",
    "refuse_degrees",
    "require_grid",
    "unit_of_grid",
]

Floats = NDArray[np.float64]

#: Units that differ by a smaller share are one: the two feet differ by two in a million.
SAME = 1e-8
#: Two systems are one for a site if its places differ by less, metres: realisations of one datum do.
SAME_PLACE = 5.0
#: How the names of systems begin that a program can look up: codes, PROJ, WKT.
_CODE = re.compile(
    r"(epsg|esri|ogc|iau)[:_ ]?\w+|\+proj|(PROJ|GEOG|GEOD|COMPOUND|BOUND)\w*CRS\[|(PROJCS|GEOGCS|COMPD_CS)\[", re.I
)
#: The system of longitudes and latitudes that name no other one.
WGS84 = "EPSG:4326"


def is_code(label: str | None) -> bool:
    """Whether a label names a coordinate system that a program can look up ("EPSG:32650", WKT, PROJ)."""
    return bool(_CODE.match((label or "").strip()))


def project_places(
    x: Floats, y: Floats, source: str, target: str, file: str, *, metres: bool = False
) -> tuple[Floats, Floats]:
    """Return easting and northing (n,) in metres; nan where a place is outside the projection.

    ``x`` is the easting or longitude, ``y`` the northing or latitude, whatever order the system itself has; in the
    system's own unit, or with ``metres`` in metres, to which marked columns were converted.

    Raises
    ------
    InputError
        If a system is unknown, or the target is not a projected one in metres.
    MissingDependencyError
        If pyproj is not installed.
    """
    pyproj = need("pyproj", "gis", message("io.need-projection", "Projecting {file}", file=file))
    before, after = _system(pyproj, source, file), _system(pyproj, target, file)
    own = before.axis_info[0].unit_conversion_factor if before.is_projected and not metres else 1.0
    if before == after and before.is_projected:
        return own * x, own * y
    units = {axis.unit_name for axis in after.axis_info[:2]}
    if not after.is_projected or units != {"metre"}:
        raise InputError(
            message(
                "io.target-not-projected",
                "The target '{target}' is not a projected system in metres",
                target=target,
            ),
            message("io.name-site-grid", "Name the grid of the site, such as a UTM zone: EPSG:32650."),
            file=file,
        )
    if metres and before.is_projected:
        x, y = (values / before.axis_info[0].unit_conversion_factor for values in (x, y))
    moved = pyproj.Transformer.from_crs(before, after, always_xy=True).transform(x, y)
    east, north = (np.asarray(values, dtype=np.float64).copy() for values in moved)
    lost = ~(np.isfinite(east) & np.isfinite(north))
    east[lost] = north[lost] = np.nan
    return east, north


def unit_of_grid(label: str | None) -> LengthUnit | None:
    """Return the unit in which a projected system counts, "m" or a foot; None where that is not known here.

    Examples
    --------
    >>> unit_of_grid("local grid") is None
    True
    """
    own = axis_units(label)[:1]
    return next((unit for unit, metres in LENGTH_UNITS.items() if own and abs(metres / own[0] - 1) < SAME), None)


def axis_units(label: str | None) -> tuple[float, ...]:
    """Return the metres of one unit of each axis of a projected system, elevation last if it has one; () if unknown.

    Examples
    --------
    >>> axis_units("local grid")
    ()
    """
    if not is_code(label):
        return ()
    try:
        system = _system(
            need("pyproj", "gis", message("io.need-projection", "Projecting {file}", file="")), label or "", ""
        )
    except (InputError, MissingDependencyError):
        return ()
    return tuple(float(axis.unit_conversion_factor) for axis in system.axis_info) if system.is_projected else ()


def list_system(crs: str, x: Floats, y: Floats, file: str, journal: Journal) -> None:
    """Warn of a file whose system gives its places, metres, other coordinates than that of a file before it."""
    x, y = x[np.isfinite(x)], y[np.isfinite(y)]
    if journal.systems.setdefault(crs, file) != file or not (x.size and y.size) or len(journal.systems) < 2:
        return
    try:
        pyproj = need("pyproj", "gis", message("io.need-projection", "Projecting {file}", file=file))
        own = _system(pyproj, crs, file)
        east, north = float(np.median(x)), float(np.median(y))
        differ = next((other for other in journal.systems if _apart(pyproj, own, other, east, north) > SAME_PLACE), "")
    except (InputError, MissingDependencyError):
        return
    if differ:
        reason = message(
            "io.systems-mixed",
            "The coordinate system is {crs}, that of {file} is {other}: the two do not fit together",
            crs=crs[:60],
            file=Untranslated(journal.systems[differ]),
            other=differ[:60],
        )
        remedy = message(
            "io.name-one-system",
            'Name the site\'s system, [site] crs = "EPSG:..." (geofit import: --crs): all are projected to it.',
        )
        journal.add("warning", file, reason, remedy)


def _apart(pyproj: Any, own: Any, other: str, east: float, north: float) -> float:
    """Return how far a place, metres, moves in another system, metres; 0 where that is not known."""
    system = _system(pyproj, other, "")
    if not (own.is_projected and system.is_projected):
        return 0.0
    unit, theirs = (one.axis_info[0].unit_conversion_factor for one in (own, system))
    try:
        there = pyproj.Transformer.from_crs(own, system, always_xy=True).transform(east / unit, north / unit)
    except pyproj.exceptions.ProjError:
        return 0.0
    return float(np.hypot(theirs * there[0] - east, theirs * there[1] - north))


def refuse_degrees(crs: str, file: str) -> None:
    """Refuse places of a geographic system where no projected one is named that they could be brought to.

    Raises
    ------
    InputError
        If the system counts in degrees.
    """
    if crs == WGS84 or _is_geographic(crs):
        raise InputError(
            message(
                "io.places-in-degrees",
                "The places are longitude and latitude ({crs}); easting and northing in metres are needed",
                crs=crs[:60],
            ),
            message(
                "io.project-to-site-grid",
                'Project them to the site\'s grid first, or name the grid: [site] crs = "EPSG:..." '
                "(geofit fit and geofit import: --crs).",
            ),
            file=file,
        )


def require_grid(label: str, file: str) -> None:
    """Refuse a code that names no system, or one of degrees, for a site whose places are metres.

    Raises
    ------
    InputError
        If the code is unknown or counts in degrees; other labels, and any without pyproj, pass.
    """
    if not is_code(label):
        return
    try:
        pyproj = need("pyproj", "gis", message("io.need-projection", "Projecting {file}", file=file))
    except MissingDependencyError:
        return
    if _system(pyproj, label, file).is_geographic:
        raise InputError(
            message(
                "io.target-not-projected",
                "The target '{target}' is not a projected system in metres",
                target=label,
            ),
            message("io.name-site-grid", "Name the grid of the site, such as a UTM zone: EPSG:32650."),
            file=file,
        )


def _is_geographic(crs: str) -> bool:
    """Whether a system counts in degrees; of one that nobody can look up here nothing is known."""
    try:
        return bool(
            _system(
                need("pyproj", "gis", message("io.need-projection", "Projecting {file}", file="")), crs, ""
            ).is_geographic
        )
    except (InputError, MissingDependencyError):
        return False


def _system(pyproj: Any, text: str, file: str) -> Any:
    try:
        return pyproj.CRS.from_user_input(text)
    except pyproj.exceptions.CRSError:
        raise InputError(
            message(
                "io.crs-unknown",
                "The coordinate system '{text}' is unknown",
                text=text,
            ),
            message("io.give-epsg-code", "Give a code such as EPSG:32650."),
            file=file,
        ) from None
