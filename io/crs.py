"""Projection of places from one coordinate system to another (pyproj, extra ``gis``)."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError, MissingDependencyError
from geofit.data.lengths import LENGTH_UNITS, LengthUnit
from geofit.data.messages import message
from geofit.io.extra import need

__all__ = ["WGS84", "is_code", "project_places", "refuse_degrees", "require_grid", "unit_of_grid"]

Floats = NDArray[np.float64]

#: Units that differ by a smaller share are one: the two feet differ by two in a million.
SAME = 1e-8
#: The system of longitudes and latitudes that name no other one.
WGS84 = "EPSG:4326"


def is_code(label: str | None) -> bool:
    """Whether a label names a coordinate system that a program can look up ("EPSG:32650", WKT, PROJ)."""
    text = (label or "").strip()
    return bool(
        re.match(r"(?i)(epsg|esri|ogc|iau)[:_ ]?\w+|\+proj|(PROJ|GEOG|GEOD|COMPOUND|BOUND)\w*CRS\[|PROJCS\[", text)
    )


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
    if before == after:
        return x, y
    if metres and before.is_projected:
        own = before.axis_info[0].unit_conversion_factor
        x, y = x / own, y / own
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
    if not is_code(label):
        return None
    try:
        system = _system(
            need("pyproj", "gis", message("io.need-projection", "Projecting {file}", file="")), label or "", ""
        )
    except (InputError, MissingDependencyError):
        return None
    if not system.is_projected:
        return None
    own = system.axis_info[0].unit_conversion_factor
    return next((unit for unit, metres in LENGTH_UNITS.items() if abs(metres / own - 1) < SAME), None)


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
    except pyproj.exceptions.CRSError as error:
        raise InputError(
            message(
                "io.crs-unknown",
                "The coordinate system '{text}' is unknown: {error}",
                text=text,
                error=error,
            ),
            message("io.give-epsg-code", "Give a code such as EPSG:32650."),
            file=file,
        ) from None
