"""``geofit fit``: horizons from a site file or a table to surfaces and reports."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, with_exit_code
from geofit.cli.options import (
    FROM_SITE,
    Across,
    Author,
    Certificate,
    Crs,
    Decimal,
    DipsChoice,
    FrameChoice,
    Json,
    Organisation,
    OriginChoice,
    Out,
    Scheduler,
    SeamChoice,
    SectionColumn,
    Sep,
    SurfaceColumn,
    Unit,
    Workers,
    X,
    Y,
    Z,
)
from geofit.cli.running import run_site
from geofit.cli.signing import read_origin, signed_by
from geofit.cli.sources import read_source
from geofit.data.setting_texts import SETTINGS

__all__ = ["fit"]


def _help(setting: str, default: str) -> str:
    text = SETTINGS[setting]
    return f"{text.about}{f' In {text.unit}.' if text.unit else ''} {FROM_SITE} {default}."


@app.command()
@with_exit_code
def fit(
    source: Annotated[
        Path,
        typer.Argument(metavar="SITE_OR_CSV", help="site.toml, a table of points, or a cloud (LAS, LAZ, Parquet)."),
    ],
    out: Out,
    horizon: Annotated[list[str] | None, typer.Option(help="Fit this horizon only; may be repeated.")] = None,
    epsilon: Annotated[float | None, typer.Option(help=_help("epsilon", "0.5"))] = None,
    x: X = None,
    y: Y = None,
    z: Z = None,
    surface: SurfaceColumn = None,
    section: SectionColumn = None,
    unit: Unit = None,
    sep: Sep = None,
    decimal: Decimal = None,
    crs: Crs = None,
    boundary: Annotated[
        Path | None, typer.Option(help="Study area: table of corners (x, y) in order, or GeoJSON polygon; m.")
    ] = None,
    interior_tolerance: Annotated[float | None, typer.Option(help=_help("interior_tolerance", "0.1"))] = None,
    boundary_tolerance: Annotated[float | None, typer.Option(help=_help("boundary_tolerance", "0.01"))] = None,
    across: Annotated[
        Across | None,
        typer.Option(help=_help("across", "cubic")),
    ] = None,
    seam: Annotated[
        SeamChoice | None,
        typer.Option(help=_help("seam", "tangent")),
    ] = None,
    core: Annotated[
        str | None,
        typer.Option(help=f"auto, all, none, or a file with a polygon. {_help('core', 'auto')}"),
    ] = None,
    frame: Annotated[
        FrameChoice | None,
        typer.Option(help=_help("frame", "auto")),
    ] = None,
    smoothing: Annotated[str | None, typer.Option(help=f"auto, or a number. {_help('smoothing', 'auto')}")] = None,
    robust: Annotated[
        bool | None,
        typer.Option("--robust", help=f"Leave outliers out of the fit. {_help('robust', 'not')}"),
    ] = None,
    strict: Annotated[
        bool | None, typer.Option("--strict", help=f"Meet every point where knots allow. {_help('strict', 'not')}")
    ] = None,
    max_iterations: Annotated[int | None, typer.Option(help=_help("max_iterations", "20"))] = None,
    max_control_points: Annotated[int | None, typer.Option(help=_help("max_control_points", "automatic"))] = None,
    dips: Annotated[DipsChoice | None, typer.Option(help=_help("dips", "check"))] = None,
    orientations: Annotated[
        Path | None,
        typer.Option(help="Tables and clouds: measured dips to compare with the surface (x, y, z, dip, azimuth)."),
    ] = None,
    dip_accuracy: Annotated[float | None, typer.Option(help=_help("dip_accuracy", "5"))] = None,
    coincidence_distance: Annotated[float | None, typer.Option(help=_help("coincidence_distance", "0.01"))] = None,
    separate: Annotated[
        bool,
        typer.Option("--separate", help="Separate horizons of the site's order where they cross; exact points stay."),
    ] = False,
    bands: Annotated[
        bool,
        typer.Option("--bands", help="Write NAME_upper90.step and NAME_lower90.step: 90 % of the rock between them."),
    ] = False,
    author: Author = None,
    organisation: Organisation = None,
    certificate: Certificate = False,
    origin: OriginChoice = "map",
    stream: Annotated[
        bool,
        typer.Option("--stream", help="Read the table as a cloud, never whole; tables above 512 MB always are."),
    ] = False,
    scheduler: Scheduler = None,
    workers: Workers = None,
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
        "dips": dips and dips.value,
        "dip_accuracy": dip_accuracy,
        "coincidence_distance": coincidence_distance,
    }
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    columns = {"x": x, "y": y, "z": z, "surface": surface, "section": section, "sep": sep, "decimal": decimal}
    columns |= {"crs": crs, "unit": unit}
    FitSettings(**changes)  # bad values are reported before files are read
    zero = read_origin(origin)
    from geofit.io.clouds import is_cloud

    if source.suffix.casefold() != ".toml" and (stream or is_cloud(source)):
        from geofit.cli.cloud import fit_cloud_file

        # What a cloud has no use for is refused, not ignored.
        used = (("--separate", separate), ("--bands", bands), ("--crs", crs), ("--dips", dips == DipsChoice.FIT))
        only = [word for word, given in used if given]
        signed = signed_by(None, author, organisation, zero, certificate="en" if certificate else "")
        return fit_cloud_file(
            source,
            out,
            columns,
            horizon,
            boundary,
            changes,
            only,
            scheduler or "local",
            workers,
            as_json,
            signed,
            orientations,
        )
    with listening() as progress:
        site = read_source(source, columns, boundary, orientations)
        where = scheduler or ("local" if workers else None)
        names = tuple(horizon or ())
        return run_site(
            site,
            out,
            names,
            changes,
            as_json,
            progress,
            separate=separate,
            bands=bands,
            scheduler=where,
            workers=workers,
            signed=signed_by(site, author, organisation, zero, certificate="en" if certificate else ""),
        )


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
