"""``geofit check``: points measured against a surface from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import list_issues, print_counts, print_json, print_results, with_exit_code
from geofit.cli.options import SURFACE_FILES, Crs, Decimal, Json, SectionColumn, Sep, SurfaceColumn, Unit, X, Y, Z
from geofit.cli.sources import pick, read_source

__all__ = ["check"]


@app.command()
@with_exit_code
def check(
    surface: Annotated[Path, typer.Argument(metavar="SURFACE", help=f"A surface: {SURFACE_FILES}.")],
    points: Annotated[Path, typer.Argument(metavar="POINTS.csv", help="Table of points, m.")],
    epsilon: Annotated[float, typer.Option(help="Control error for sigma, m.")] = 0.5,
    horizon: Annotated[str | None, typer.Option(help="Name of the horizon, where the files hold several.")] = None,
    x: X = None,
    y: Y = None,
    z: Z = None,
    surface_column: SurfaceColumn = None,
    section: SectionColumn = None,
    unit: Unit = None,
    sep: Sep = None,
    decimal: Decimal = None,
    crs: Crs = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the residual table; none: not written.")] = None,
    as_json: Json = False,
) -> int:
    """Measure points against the surface in a CAD file or GOCAD TSurf, ours or any other."""
    from geofit.data.settings import FitSettings
    from geofit.fitting.judge import judge
    from geofit.io.surface_files import read_surfaces
    from geofit.report.result import HorizonResult

    settings = FitSettings(epsilon=epsilon)
    columns = {
        "x": x,
        "y": y,
        "z": z,
        "surface": surface_column,
        "section": section,
        "unit": unit,
        "sep": sep,
        "decimal": decimal,
        "crs": crs,
    }
    site = read_source(points, columns, None)
    list_issues(site.issues, out)
    print_counts(site.counts)
    name, found = pick("horizon", site.horizons, horizon, points)
    _, shape = pick("surface", read_surfaces(surface), name if horizon else None, surface)
    result = HorizonResult(judge(shape, found, settings, name), site)
    if out is not None:
        from geofit.data.files import file_stems, folder_for
        from geofit.report.tables import write_residuals

        write_residuals(result, folder_for(out) / f"{file_stems([name])[name]}_residuals.csv")
    if as_json:
        from geofit.report.schema import horizon_document

        print_json(horizon_document(result))
    else:
        print_results([result])
    return 0 if result.accuracy.passed else 1
