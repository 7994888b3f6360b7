"""Regular grids: ESRI ASCII, Surfer 6 ASCII and GeoTIFF."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.messages import message
from geofit.data.site import Ground
from geofit.io.extra import need

__all__ = ["write_esri", "write_geotiff", "write_surfer"]

Floats = NDArray[np.float64]

#: What the formats write where there is no value.
ESRI_BLANK, SURFER_BLANK = "-9999", "1.70141e+38"


def write_esri(grid: Ground, path: str | PathLike[str]) -> None:
    """Write an ESRI ASCII grid, values to 1e-4; nan is NODATA (-9999).

    Raises
    ------
    InputError
        If the cells are not square, or no cell has a value.
    """
    step = _square(grid, path)
    west, south = grid.x[0] - step / 2, grid.y[0] - step / 2
    head = [
        f"ncols {len(grid.x)}",
        f"nrows {len(grid.y)}",
        f"xllcorner {_digits(west)}",
        f"yllcorner {_digits(south)}",
        f"cellsize {_digits(step)}",
        f"NODATA_value {ESRI_BLANK}",
    ]
    with replacing(path) as part:
        part.write_text("\n".join([*head, *_rows(grid.z[::-1], ESRI_BLANK), ""]), encoding="ascii", newline="\n")


def write_surfer(grid: Ground, path: str | PathLike[str]) -> None:
    """Write a Surfer 6 ASCII grid (DSAA), values to 1e-4; nan is Surfer's blank value.

    Raises
    ------
    InputError
        If no cell has a value.
    """
    _valued(grid, path)
    head = [
        "DSAA",
        f"{len(grid.x)} {len(grid.y)}",
        f"{_digits(grid.x[0])} {_digits(grid.x[-1])}",
        f"{_digits(grid.y[0])} {_digits(grid.y[-1])}",
        f"{np.nanmin(grid.z):.4f} {np.nanmax(grid.z):.4f}",
    ]
    with replacing(path) as part:
        part.write_text("\n".join([*head, *_rows(grid.z, SURFER_BLANK), ""]), encoding="ascii", newline="\n")


def write_geotiff(grid: Ground, path: str | PathLike[str], crs: str = "") -> None:
    """Write a GeoTIFF of doubles, deflated; nan is the no-data value.

    Parameters
    ----------
    grid : Ground
        Values at cell centres.
    path : path
        The file.
    crs : str
        Coordinate system as rasterio reads it ("EPSG:32648", WKT); empty: none in the file.

    Raises
    ------
    MissingDependencyError
        If rasterio is not installed.
    InputError
        If the cells are not square, no cell has a value, or the coordinate system is unknown.
    """
    rasterio = need("rasterio", "gis", message("io.package-missing-for-format", "Writing {format}", format="GeoTIFF"))
    step = _square(grid, path)
    transform = rasterio.Affine(step, 0, grid.x[0] - step / 2, 0, -step, grid.y[-1] + step / 2)
    try:
        system = rasterio.crs.CRS.from_user_input(crs) if crs else None
    except rasterio.errors.CRSError:
        raise InputError(
            message("io.written-crs-unknown", "The coordinate system is unknown to PROJ"),
            message("io.give-epsg-or-none", "Give one as EPSG:number, or none: --crs ''."),
            file=str(path),
            value=crs,
        ) from None
    profile = {
        "driver": "GTiff", "count": 1, "dtype": "float64", "height": len(grid.y), "width": len(grid.x),
        "transform": transform, "crs": system, "nodata": np.nan, "compress": "deflate",
    }  # fmt: skip
    with rasterio.MemoryFile() as whole:
        with whole.open(**profile) as file:
            file.write(grid.z[::-1], 1)
        with replacing(path) as part:
            part.write_bytes(whole.read())


def _rows(values: Floats, blank: str) -> list[str]:
    return [" ".join(blank if np.isnan(v) else f"{v:.4f}" for v in row.tolist()) for row in values]


def _digits(value: float) -> str:
    return f"{float(value):.9f}".rstrip("0").rstrip(".")


def _valued(grid: Ground, path: str | PathLike[str]) -> None:
    if not np.isfinite(grid.z).any():
        raise InputError(
            message("io.grid-without-value", "No cell of the grid has a value"),
            message("io.choose-smaller-cells", "Choose a cell size below the surface's size."),
            file=str(path),
        )


def _square(grid: Ground, path: str | PathLike[str]) -> float:
    _valued(grid, path)
    steps = np.concatenate([np.diff(grid.x), np.diff(grid.y)])
    if np.ptp(steps) > 1e-6 * steps.mean():
        raise InputError(
            message(
                "io.cells-not-square",
                "The cells are from {least:g} to {most:g} m wide; the format needs square cells",
                least=steps.min(),
                most=steps.max(),
            ),
            message("io.sample-with-one-step", "Sample the surface on a grid with one step."),
            file=str(path),
        )
    return float(steps.mean())
