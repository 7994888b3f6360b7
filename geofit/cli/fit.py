"""``geofit fit``: horizons from a site file or a table to surfaces and reports."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import guarded, listening
from geofit.cli.options import (
    FROM_SITE,
    Across,
    Crs,
    Decimal,
    Frame,
    Json,
    Out,
    Seam,
    SectionColumn,
    Sep,
    SurfaceColumn,
    X,
    Y,
    Z,
)
from geofit.cli.running import run_site
from geofit.cli.sources import read_source

__all__ = ["fit"]


@app.command()
@guarded
def fit(
    source: Annotated[Path, typer.Argument(metavar="SITE_OR_CSV", help="site.toml, or a table of points.")],
    out: Out,
    horizon: Annotated[list[str] | None, typer.Option(help="Fit this horizon only; may be repeated.")] = None,
    epsilon: Annotated[float | None, typer.Option(help=f"Control error for sigma, m. {FROM_SITE} 0.5.")] = None,
    x: X = None,
    y: Y = None,
    z: Z = None,
    surface: SurfaceColumn = None,
    section: SectionColumn = None,
    sep: Sep = None,
    decimal: Decimal = None,
    crs: Crs = None,
    boundary: Annotated[
        Path | None, typer.Option(help="Study area: table of corners (x, y) in order, or GeoJSON polygon; m.")
    ] = None,
    interior_tolerance: Annotated[
        float | None, typer.Option(help=f"Largest distance wanted in the periphery, m. {FROM_SITE} 0.1.")
    ] = None,
    boundary_tolerance: Annotated[
        float | None, typer.Option(help=f"Largest gap between patches, m. {FROM_SITE} 0.01.")
    ] = None,
    across: Annotated[
        Across | None,
        typer.Option(help=f"Interpolation of the core across its sections. {FROM_SITE} cubic."),
    ] = None,
    seam: Annotated[
        Seam | None,
        typer.Option(help=f"Patches share the tangent plane, or the edge only. {FROM_SITE} tangent."),
    ] = None,
    core: Annotated[
        str | None,
        typer.Option(help=f"Interpolated region: auto, all, none, or a file with a polygon. {FROM_SITE} auto."),
    ] = None,
    frame: Annotated[
        Frame | None,
        typer.Option(help=f"Height over the map, over the best plane, or through section lines. {FROM_SITE} auto."),
    ] = None,
    smoothing: Annotated[
        str | None, typer.Option(help=f"Weight of the bending energy: auto, or a number. {FROM_SITE} auto.")
    ] = None,
    robust: Annotated[
        bool | None,
        typer.Option("--robust", help=f"Peripheral points that their neighbours deny take no part. {FROM_SITE} not."),
    ] = None,
    strict: Annotated[
        bool | None,
        typer.Option(
            "--strict", help=f"Meet each peripheral point within the tolerance where knots allow. {FROM_SITE} not."
        ),
    ] = None,
    max_iterations: Annotated[int | None, typer.Option(help=f"Cap of the refinement steps. {FROM_SITE} 20.")] = None,
    max_control_points: Annotated[
        int | None, typer.Option(help=f"Cap of the control points. {FROM_SITE} 40 a data point, 15 with a core.")
    ] = None,
    conflict_distance: Annotated[
        float | None, typer.Option(help=f"Points nearer than this are one place, m. {FROM_SITE} 0.01.")
    ] = None,
    apart: Annotated[
        bool,
        typer.Option("--repair", help="Push horizons of the site's order apart where they cross; exact points stay."),
    ] = False,
    bands: Annotated[
        bool,
        typer.Option("--bands", help="Write NAME_upper90.step and NAME_lower90.step: 90 % of the rock between them."),
    ] = False,
    as_json: Json = False,
) -> int:
    """Fit horizons, check them, and write STEP, reports, tables and pictures."""
    from geofit.data.settings import FitSettings

    given = {
        "epsilon": epsilon,
        "interior_tolerance": interior_tolerance,
        "boundary_tolerance": boundary_tolerance,
        "across": across and across.value,
        "seam": seam and seam.value,
        "core": _core(core),
        "frame": frame and frame.value,
        "smoothing": _smoothing(smoothing),
        "robust": robust,
        "strict": strict,
        "max_iterations": max_iterations,
        "max_control_points": max_control_points,
        "conflict_distance": conflict_distance,
    }
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    columns = {"x": x, "y": y, "z": z, "surface": surface, "section": section, "sep": sep, "decimal": decimal}
    columns["crs"] = crs
    FitSettings(**changes)  # a bad value is told before files are read
    with listening() as progress:
        site = read_source(source, columns, boundary)
        return run_site(site, out, tuple(horizon or ()), changes, as_json, progress, apart=apart, bands=bands)


def _core(text: str | None) -> str | tuple[tuple[float, float], ...] | None:
    if text is None or text in ("auto", "all", "none"):
        return text
    from geofit.io.boundary import read_boundary

    return tuple((float(x), float(y)) for x, y in read_boundary(Path(text)))


def _smoothing(text: str | None) -> str | float | None:
    if text is None or text == "auto":
        return text
    try:
        return float(text)
    except ValueError:
        return text  # refused by the settings, which name what they take
