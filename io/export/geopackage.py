"""Contours as GeoPackage."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from io import BytesIO
from os import PathLike

import numpy as np

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.legible import legible_keys
from geofit.data.messages import message
from geofit.io.extra import need
from geofit.sampling.contours import ContourLine

__all__ = ["write_contours_gpkg"]


def write_contours_gpkg(
    contours: Mapping[str, Sequence[ContourLine]], path: str | PathLike[str], crs: str = ""
) -> None:
    """Write a layer ``contours`` of lines with the fields ``horizon`` and ``elevation``.

    Parameters
    ----------
    contours : mapping of str to sequence of Contour
        Contours by horizon.
    path : path
        The file.
    crs : str
        Coordinate system ("EPSG:32648", WKT); empty: none in the file.

    Raises
    ------
    MissingDependencyError
        If pyogrio is not installed.
    InputError
        If there is no contour, or the file cannot be written.
    """
    pyogrio = need("pyogrio", "gis", message("io.package-missing-for-format", "Writing {format}", format="GeoPackage"))
    import shapely

    rows = [(name, contour) for name, lines in legible_keys(contours).items() for contour in lines]
    if not rows:
        raise InputError(
            message("io.no-contour", "There is no contour to write"),
            message("io.choose-smaller-interval", "Choose a smaller interval."),
            file=str(path),
        )
    geometry = shapely.to_wkb(np.array([shapely.LineString(contour.line) for _, contour in rows]))
    fields = [
        np.array([name for name, _ in rows], object),
        np.array([contour.elevation for _, contour in rows]),
    ]
    # Otherwise GDAL writes the time into the file.
    pyogrio.set_gdal_config_options({"OGR_CURRENT_DATE": "2000-01-01T00:00:00.000Z"})
    try:
        # In memory: of a full disk the library tells in many ways.
        whole = BytesIO()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "'crs' was not provided")
            pyogrio.raw.write(
                whole, geometry, fields, ["horizon", "elevation"],
                layer="contours", driver="GPKG", geometry_type="LineString", crs=crs or None,
            )  # fmt: skip
    except (pyogrio.errors.DataSourceError, pyogrio.errors.CRSError) as error:
        raise InputError(
            message("data.file-not-written", "The file cannot be written: {error}", error=error),
            message("io.check-path-and-system", "Check the path; give the system as EPSG:number, or none: --crs ''."),
            file=str(path),
        ) from None
    else:
        with replacing(path) as part:
            part.write_bytes(whole.getvalue())
    finally:
        pyogrio.set_gdal_config_options({"OGR_CURRENT_DATE": None})
