"""``geofit export``: surfaces in other formats."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import print_issues, print_json, print_table, say, with_exit_code
from geofit.cli.options import FORMATS, SURFACE_FILES, Json, Tolerance
from geofit.cli.sources import read_source

__all__ = ["export"]


@app.command()
@with_exit_code
def export(
    surfaces: Annotated[list[Path], typer.Argument(metavar="SURFACE...", help=f"Files: {SURFACE_FILES}.")],
    to: Annotated[str, typer.Option(help=f"Format: {FORMATS}.")],
    out: Annotated[Path, typer.Option(help="The file; horizons get one each where the format holds one.")],
    points: Annotated[
        Path | None,
        typer.Option(metavar="SITE_OR_CSV", help="site.toml or table of points: deviations; a site's holes and CRS."),
    ] = None,
    value: Annotated[str, typer.Option(help="What a grid holds: elevation, deviation or thickness.")] = "elevation",
    tolerance: Tolerance = 0.05,
    interval: Annotated[float | None, typer.Option(help="Metres between contours. Default: chosen.")] = None,
    cell: Annotated[float | None, typer.Option(help="Metres between grid nodes. Default: chosen.")] = None,
    crs: Annotated[str | None, typer.Option(help="Coordinate system, EPSG:number. Default: the site's.")] = None,
    as_json: Json = False,
) -> int:
    """Write horizons in other formats."""
    from geofit.io.export.write import untrimmed, write_surface
    from geofit.io.surface_files import read_surfaces

    site = None if points is None else read_source(points, {}, None)
    if site is not None:
        print_issues(site.issues)
    given = read_surfaces(surfaces)
    for sentence in untrimmed(given, to):
        say(sentence)
    files = write_surface(
        given,
        out,
        format=to,
        tolerance=tolerance,
        interval=interval,
        cell=cell,
        value=value,
        points=site.horizons if site else None,
        holes=site.holes if site else (),
        site=site.name if site else surfaces[0].stem,
        crs=crs if crs is not None else site.crs if site else "",
    )
    if as_json:
        print_json({"files": [str(file) for file in files]})
    else:
        print_table(("file", "bytes"), [(str(file), str(file.stat().st_size)) for file in files])
    return 0
