"""A GeoTIFF as the ground (rasterio, extra ``gis``)."""

from __future__ import annotations

import warnings

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.site import Ground
from geofit.io.crs import is_code, list_system
from geofit.io.extra import need
from geofit.io.journal import Journal
from geofit.io.no_data import blank_nodes
from geofit.io.source import Source
from geofit.io.units import map_units

__all__ = ["read_raster"]


def read_raster(source: Source, journal: Journal) -> Ground:
    """Read the first band; cells without data are nan, the places are the cells' centres.

    Raises
    ------
    InputError
        If the raster cannot be read, is turned, or is not in the site's coordinate system.
    MissingDependencyError
        If rasterio is not installed.
    """
    rasterio = need("rasterio", "gis", message("io.reading-raster", "Reading the raster {file}", file=source.name))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a raster without georeference is refused below
            with rasterio.open(source.path, driver="GTiff") as raster:
                band = raster.read(1, masked=True)
                place, crs, bands = raster.transform, raster.crs, raster.count
                scale, offset, height = raster.scales[0], raster.offsets[0], raster.units[0] or ""
    except (rasterio.errors.RasterioError, OSError, ValueError, MemoryError):
        raise InputError(
            message("io.raster-unreadable", "The raster is damaged, incomplete or not a GeoTIFF"),
            message("io.save-as-geotiff", "Open it in a GIS and save it as GeoTIFF."),
            file=source.name,
        ) from None
    if place.is_identity or place.b or place.d or place.a <= 0 or place.e >= 0:
        raise InputError(
            message("io.raster-rotated-or-unplaced", "The raster has no location on the map, or is rotated")
            if not place.is_identity
            else message("io.raster-without-georeference", "The raster has no georeference"),
            message("io.save-north-up", "Save it from a GIS as a GeoTIFF with north up."),
            file=source.name,
        )
    _check_crs(source, crs, journal)
    if min(band.shape) < 2:
        raise InputError(
            message("io.raster-too-small", "The raster has less than 2 x 2 cells"),
            message("io.export-again", "Export it again."),
            file=source.name,
        )
    z = np.ma.filled(np.ma.asarray(band, dtype=np.float64), np.nan)[::-1].copy()
    z[~np.isfinite(z)] = np.nan
    blank_nodes(z, source.name, journal)
    if (scale, offset) != (1.0, 0.0):
        z = scale * z + offset
        journal.add(
            "note",
            source.name,
            message(
                "io.raster-scaled",
                "The raster states a scale of {scale:.10g} and an offset of {offset:.10g}; they are applied",
                scale=scale,
                offset=offset,
            ),
        )
    if np.isnan(z).all():
        raise InputError(
            message("io.raster-without-elevation", "No cell of the raster has an elevation"),
            message("io.check-no-data-value", "Check its no-data value."),
            file=source.name,
        )
    if np.isnan(z).any():
        journal.add(
            "note",
            source.name,
            message(
                "io.cells-without-data",
                "{count} of {total} cells have no data",
                count=int(np.isnan(z).sum()),
                total=z.size,
            ),
        )
    if bands > 1:
        journal.add(
            "warning",
            source.name,
            message(
                "io.raster-of-several-bands",
                "The raster has {count} bands; the first is the elevation",
                count=bands,
            ),
        )
    rows, columns = z.shape
    journal.count(source.name, rows, 0)
    plan, up = map_units(source, str(crs or ""), journal, height)
    x = place.c + place.a * (np.arange(columns) + 0.5)
    y = place.f + place.e * (np.arange(rows)[::-1] + 0.5)
    if crs is not None and not source.target:
        list_system(str(crs), plan * x, plan * y, source.name, journal)
    return Ground(plan * x, plan * y, up * z)


def _check_crs(source: Source, crs: object, journal: Journal) -> None:
    if crs is None:
        return
    journal.add(
        "note",
        source.name,
        message("io.crs-of-raster", "The coordinate system of the raster is {crs}", crs=str(crs)[:120]),
    )
    if getattr(crs, "is_geographic", False):
        raise InputError(
            message(
                "io.raster-in-degrees",
                "The raster is in longitude and latitude ({crs}); metres are needed",
                crs=str(crs)[:60],
            ),
            message("io.warp-to-site-grid", "Warp it to the site's grid (gdalwarp -t_srs EPSG:...)."),
            file=source.name,
        )
    if source.target and is_code(source.target):
        pyproj = need("pyproj", "gis", message("io.reading-raster", "Reading the raster {file}", file=source.name))
        try:
            same = pyproj.CRS.from_user_input(source.target).to_2d() == pyproj.CRS.from_user_input(str(crs)).to_2d()
        except pyproj.exceptions.CRSError:
            return
        if not same:
            raise InputError(
                message(
                    "io.raster-in-other-crs",
                    "The raster is in {crs}, the site in {target}",
                    crs=str(crs)[:60],
                    target=source.target,
                ),
                message("io.warp-to-target", "Warp it (gdalwarp -t_srs {target}).", target=source.target),
                file=source.name,
            )
