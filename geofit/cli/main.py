"""The command line: ``geofit demo | fit | report | check | info | import | export | section | gui``.

Exit codes: 0 every sigma < epsilon; 1 some verdict FAIL; 2 bad input or usage; 130 stopped.
Everything heavy is imported inside the commands, so that ``geofit --help`` answers at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from geofit import __version__
from geofit.cli.console import (
    guarded,
    listening,
    print_counts,
    print_issues,
    print_json,
    print_results,
    print_table,
    say,
)
from geofit.data.errors import InputError
from geofit.data.messages import Verbatim, message

if TYPE_CHECKING:
    from geofit.data.languages import Language
    from geofit.data.progress import Progress
    from geofit.data.settings import FitSettings
    from geofit.data.site import Site

__all__ = ["app", "main"]

app = typer.Typer(
    name="geofit",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="NURBS surfaces of geological horizons: fitted, checked against a tolerance, stitched, written "
    "as STEP. "
    "Exit codes: 0 every sigma < epsilon, 1 some verdict FAIL, 2 bad input or usage.",
)


class _Language(StrEnum):
    EN = "en"
    ZH = "zh"


class _Across(StrEnum):
    CUBIC = "cubic"
    LINEAR = "linear"


class _Seam(StrEnum):
    TANGENT = "tangent"
    POSITION = "position"


class _Frame(StrEnum):
    AUTO = "auto"
    MAP = "map"
    BEST_PLANE = "best-plane"
    SECTIONS = "sections"


_Out = Annotated[Path, typer.Option(help="Folder for the results; made if it is not there.")]
_Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON on stdout instead of a table.")]
_X = Annotated[str | None, typer.Option("--x", help="CSV: column of the easting, m. Default: found by its header.")]
_Y = Annotated[str | None, typer.Option("--y", help="CSV: column of the northing, m.")]
_Z = Annotated[str | None, typer.Option("--z", help="CSV: column of the elevation, m.")]
_SurfaceColumn = Annotated[str | None, typer.Option("--surface", help="CSV: column of the horizon's name.")]
_SectionColumn = Annotated[str | None, typer.Option("--section", help="CSV: column of the section's name.")]
_Sep = Annotated[str | None, typer.Option(help="CSV: separator: one character, 'tab' or 'space'. Default: found.")]
_Decimal = Annotated[str | None, typer.Option(help="CSV: decimal mark, '.' or ','. Default: found.")]
_Tolerance = Annotated[float, typer.Option(help="Largest distance of triangles and lines from the surface, m.")]
_FORMATS = (
    "step, iges, brep, dxf (contours), dxf-mesh, ifc, landxml, tsurf, geoh5, omf, vtp, vtm, obj, ply, stl, glb, "
    "gpkg (contours), asc, grd, tif (grids)"
)
_SURFACE_FILES = "STEP, IGES, BREP or GOCAD TSurf (.ts), ours or any other"
_FROM_SITE = "Default: the site file's, else"


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"geofit {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    pass


@app.command()
@guarded
def demo(
    out: _Out = Path("demo_out"),
    robust: Annotated[
        bool, typer.Option("--robust", help="Peripheral points that their neighbours deny take no part.")
    ] = False,
    as_json: _Json = False,
) -> int:
    """Fit every horizon of the sample site, a fictional dam site."""
    from geofit.io.site_file import read_site

    site_file = _sample(out)
    with listening() as progress:
        site = read_site(site_file)
        return _deliver(site, out, (), {"robust": True} if robust else {}, as_json, progress)


@app.command()
@guarded
def fit(
    source: Annotated[Path, typer.Argument(metavar="SITE_OR_CSV", help="site.toml, or a table of points.")],
    out: _Out,
    horizon: Annotated[list[str] | None, typer.Option(help="Fit this horizon only; may be repeated.")] = None,
    epsilon: Annotated[float | None, typer.Option(help=f"Control error for sigma, m. {_FROM_SITE} 0.5.")] = None,
    x: _X = None,
    y: _Y = None,
    z: _Z = None,
    surface: _SurfaceColumn = None,
    section: _SectionColumn = None,
    sep: _Sep = None,
    decimal: _Decimal = None,
    boundary: Annotated[
        Path | None, typer.Option(help="Study area: table of corners (x, y) in order, or GeoJSON polygon; m.")
    ] = None,
    interior_tolerance: Annotated[
        float | None, typer.Option(help=f"Largest distance wanted in the periphery, m. {_FROM_SITE} 0.1.")
    ] = None,
    boundary_tolerance: Annotated[
        float | None, typer.Option(help=f"Largest gap between patches, m. {_FROM_SITE} 0.01.")
    ] = None,
    across: Annotated[
        _Across | None,
        typer.Option(help=f"Interpolation of the core across its sections. {_FROM_SITE} cubic."),
    ] = None,
    seam: Annotated[
        _Seam | None,
        typer.Option(help=f"Patches share the tangent plane, or the edge only. {_FROM_SITE} tangent."),
    ] = None,
    core: Annotated[
        str | None,
        typer.Option(help=f"Interpolated region: auto, all, none, or a file with a polygon. {_FROM_SITE} auto."),
    ] = None,
    frame: Annotated[
        _Frame | None,
        typer.Option(help=f"Height over the map, over the best plane, or through section lines. {_FROM_SITE} auto."),
    ] = None,
    smoothing: Annotated[
        str | None, typer.Option(help=f"Weight of the bending energy: auto, or a number. {_FROM_SITE} auto.")
    ] = None,
    robust: Annotated[
        bool | None,
        typer.Option("--robust", help=f"Peripheral points that their neighbours deny take no part. {_FROM_SITE} not."),
    ] = None,
    max_iterations: Annotated[int | None, typer.Option(help=f"Cap of the refinement steps. {_FROM_SITE} 20.")] = None,
    max_control_points: Annotated[
        int | None, typer.Option(help=f"Cap of the control points. {_FROM_SITE} ten a data point.")
    ] = None,
    conflict_distance: Annotated[
        float | None, typer.Option(help=f"Points nearer than this are one place, m. {_FROM_SITE} 0.01.")
    ] = None,
    apart: Annotated[
        bool,
        typer.Option("--repair", help="Push horizons of the site's order apart where they cross; exact points stay."),
    ] = False,
    bands: Annotated[
        bool,
        typer.Option("--bands", help="Write NAME_upper90.step and NAME_lower90.step: 90 % of the rock between them."),
    ] = False,
    as_json: _Json = False,
) -> int:
    """Fit horizons, check them, and write STEP, reports, tables and pictures."""
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
        "max_iterations": max_iterations,
        "max_control_points": max_control_points,
        "conflict_distance": conflict_distance,
    }
    changes = {name: value for name, value in given.items() if value is not None}
    columns = {"x": x, "y": y, "z": z, "surface": surface, "section": section, "sep": sep, "decimal": decimal}
    _settings(changes)  # a bad value is told before files are read
    with listening() as progress:
        site = _read(source, columns, boundary)
        return _deliver(site, out, tuple(horizon or ()), changes, as_json, progress, apart=apart, bands=bands)


@app.command()
@guarded
def report(
    site: Annotated[Path, typer.Argument(metavar="SITE", help="site.toml of a site.")],
    out: _Out,
    lang: Annotated[_Language, typer.Option(help="Language of the report: English or Chinese.")] = _Language.EN,
    as_json: _Json = False,
) -> int:
    """Fit every horizon of a site and write its accuracy report (HTML, PDF, JSON) with the surfaces it is about."""
    from geofit.data.languages import language

    with listening() as progress:
        return _deliver(_read(site, {}, None), out, (), {}, as_json, progress, language(lang.value), pdf=True)


@app.command()
@guarded
def check(
    surface: Annotated[Path, typer.Argument(metavar="SURFACE", help=f"A surface: {_SURFACE_FILES}.")],
    points: Annotated[Path, typer.Argument(metavar="POINTS.csv", help="Table of points, m.")],
    epsilon: Annotated[float, typer.Option(help="Control error for sigma, m.")] = 0.5,
    horizon: Annotated[str | None, typer.Option(help="Name of the horizon, where the files hold several.")] = None,
    x: _X = None,
    y: _Y = None,
    z: _Z = None,
    surface_column: _SurfaceColumn = None,
    section: _SectionColumn = None,
    sep: _Sep = None,
    decimal: _Decimal = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the residual table; none: not written.")] = None,
    as_json: _Json = False,
) -> int:
    """Measure points against the surface in a CAD file or GOCAD TSurf, ours or any other."""
    from geofit.checks.imported import check_given
    from geofit.data.accuracy import plain
    from geofit.io.surface_files import read_surface_file
    from geofit.report.result import HorizonResult

    settings = _settings({"epsilon": epsilon})
    columns = {
        "x": x,
        "y": y,
        "z": z,
        "surface": surface_column,
        "section": section,
        "sep": sep,
        "decimal": decimal,
    }
    site = _read(points, columns, None)
    print_issues(site.issues)
    print_counts(site.counts)
    name, found = _pick("horizon", site.horizons, horizon, points)
    _, shape = _pick("surface", read_surface_file(surface), name if horizon else None, surface)
    result = HorizonResult(check_given(shape, found, settings, name), site)
    if out is not None:
        from geofit.data.files import file_stems
        from geofit.report.tables import write_residuals

        out.mkdir(parents=True, exist_ok=True)
        write_residuals(result, out / f"{file_stems([name])[name]}_residuals.csv")
    if as_json:
        print_json(_summary(plain(result.accuracy), name))
    else:
        print_results([result])
    return 0 if result.accuracy.passed else 1


@app.command()
@guarded
def info(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="site.toml, table of points or a surface (STEP ...).")],
    as_json: _Json = False,
) -> int:
    """Say what is in a file."""
    from geofit.io.surface_files import is_surface_file
    from geofit.project.describe import describe_site, describe_surfaces

    rows = describe_surfaces(file) if is_surface_file(file) else None
    header: tuple[str, ...] = (
        "surface",
        "patches",
        "control points",
        "west..east, m",
        "south..north, m",
        "z, m",
    )
    issues: tuple[Any, ...] = ()
    if rows is None:
        site = _read(file, {}, None)
        header = ("horizon", "points", "kinds", "west..east, m", "south..north, m", "z, m")
        rows, issues = describe_site(site), site.issues
        print_counts(site.counts)
    if as_json:
        print_json([dict(zip(header, row, strict=True)) for row in rows])
    else:
        print_table(header, rows, left=(0, 2))
        print_issues(issues)
    return 0


@app.command(name="import")
@guarded
def import_(
    files: Annotated[list[Path], typer.Argument(metavar="FILES...", help="Tables, drawings, maps, grids of one site.")],
    site: Annotated[Path, typer.Option(metavar="OUT.toml", help="The site file to write; mapping and issues beside.")],
    mapping: Annotated[Path | None, typer.Option(help="Mapping (TOML) of columns that a guess would miss.")] = None,
    crs: Annotated[str, typer.Option(help="Coordinate system of the site, EPSG:number; degrees are projected.")] = "",
    base: Annotated[list[str] | None, typer.Option(help="Code whose base is a horizon; may be repeated.")] = None,
    top: Annotated[list[str] | None, typer.Option(help="Code whose top is a horizon; may be repeated.")] = None,
    as_json: _Json = False,
) -> int:
    """Recognise files and bind them in a site file. Exit code 1: no horizon yet, 2: no row can be used."""
    from dataclasses import asdict, astuple

    from geofit.io.mapping import load_mappings
    from geofit.project.importing import import_files

    mappings = load_mappings(mapping) if mapping is not None else ()
    with listening() as progress:
        found = import_files(
            files, site, mappings=mappings, crs=crs, base=tuple(base or ()), top=tuple(top or ()), progress=progress
        )
    print_issues(found.issues, str(found.issue_file))
    print_counts(found.counts)
    sizes = {name: len(points) for name, points in found.site.horizons.items()}
    if as_json:
        places = {"site": found.site_file, "mapping": found.mapping_file, "issues": found.issue_file}
        counts = [asdict(count) for count in found.counts]
        print_json({**{key: str(file) for key, file in places.items()}, "horizons": sizes, "files": counts})
    else:
        print_table(("file", "rows", "used", "listed"), [tuple(map(str, astuple(count))) for count in found.counts])
        print_table(("horizon", "points"), [(name, str(size)) for name, size in sizes.items()])
    if not sizes:
        say("The site has no horizon yet: add intervals, sections, traces or picks.")
    say(f"Site file: {found.site_file}. Kinds and columns, to be corrected by hand: {found.mapping_file}")
    return found.exit_code


@app.command()
@guarded
def export(
    surfaces: Annotated[list[Path], typer.Argument(metavar="SURFACE...", help=f"Files: {_SURFACE_FILES}.")],
    to: Annotated[str, typer.Option(help=f"Format: {_FORMATS}.")],
    out: Annotated[Path, typer.Option(help="The file; horizons get one each where the format holds one.")],
    points: Annotated[
        Path | None,
        typer.Option(metavar="SITE_OR_CSV", help="site.toml or table of points: deviations; a site's holes and CRS."),
    ] = None,
    value: Annotated[str, typer.Option(help="What a grid holds: elevation, deviation or thickness.")] = "elevation",
    tolerance: _Tolerance = 0.05,
    interval: Annotated[float | None, typer.Option(help="Metres between contours. Default: chosen.")] = None,
    cell: Annotated[float | None, typer.Option(help="Metres between grid nodes. Default: chosen.")] = None,
    crs: Annotated[str | None, typer.Option(help="Coordinate system, EPSG:number. Default: the site's.")] = None,
    as_json: _Json = False,
) -> int:
    """Write horizons in other formats."""
    from geofit.project.export import Request, read_surfaces, uncut
    from geofit.project.export import export as write

    site = None if points is None else _read(points, {}, None)
    if site is not None:
        print_issues(site.issues)
    request = Request(
        tolerance=tolerance,
        interval=interval,
        cell=cell,
        value=value,
        points=site.horizons if site else None,
        holes=site.holes if site else (),
        site=site.name if site else surfaces[0].stem,
        crs=crs if crs is not None else site.crs if site else "",
    )
    given = read_surfaces(surfaces)
    for sentence in uncut(given, to):
        say(sentence)
    files = write(given, to, out, request)
    if as_json:
        print_json({"files": [str(file) for file in files]})
    else:
        print_table(("file", "bytes"), [(str(file), str(file.stat().st_size)) for file in files])
    return 0


@app.command()
@guarded
def section(
    surfaces: Annotated[list[Path], typer.Argument(metavar="SURFACE...", help=f"Files: {_SURFACE_FILES}.")],
    line: Annotated[str, typer.Option(help="x0,y0,x1,y1 (further corners may follow), or a table with x and y; m.")],
    out: _Out,
    tolerance: _Tolerance = 0.05,
    as_json: _Json = False,
) -> int:
    """Cut every horizon along a line: drawing (DXF), table (CSV) and picture (PNG)."""
    from geofit.project.export import read_line, read_surfaces
    from geofit.project.export import section as cut

    given = read_surfaces(surfaces)
    cuts, files = cut(given, read_line(line), out, tolerance)
    rows = [(name, i, one) for name, lines in cuts.items() for i, one in enumerate(lines, 1)]
    if as_json:
        lengths = [{"horizon": n, "line": i, "distance": one.distance[[0, -1]].tolist()} for n, i, one in rows]
        print_json({"files": [str(file) for file in files], "lines": lengths})
    else:
        header = ("horizon", "line", "along, m", "z, m")
        print_table(header, [(n, str(i), _span(one.distance), _span(one.xyz[:, 2])) for n, i, one in rows])
        say(f"Drawing, table and picture: {out}")
    return 0


@app.command()
@guarded
def gui(
    file: Annotated[Path | None, typer.Argument(metavar="[FILE]", help="site.toml or project.geofit to open.")] = None,
) -> int:
    """Open the desktop application. Exit code 2: it cannot start, and what is missing is said."""
    from geofit.gui.app import start

    return start(file)


def _span(values: Any) -> str:
    return f"{values.min():.1f} .. {values.max():.1f}"


def _deliver(
    site: Site,
    out: Path,
    horizons: tuple[str, ...],
    changes: dict[str, Any],
    as_json: bool,
    progress: Progress | None,
    language: Language | None = None,
    *,
    pdf: bool = False,
    apart: bool = False,
    bands: bool = False,
) -> int:
    from geofit.data.accuracy import plain
    from geofit.data.languages import EN
    from geofit.project.run import deliver
    from geofit.report.result import horizon_data

    print_issues(site.issues, str(out / "import_issues.csv"))
    print_counts(site.counts)
    delivery = deliver(
        site, out, horizons, changes, progress, language=language or EN, pdf=pdf, apart=apart, bands=bands
    )
    if as_json:
        print_json(
            {
                "out": str(out),
                "horizons": [horizon_data(result) for result in delivery.results],
                "orders": [plain(order) for order in delivery.orders],
                "cuts": [plain(cut) for cut in delivery.cuts],
                "contradictions": [plain(one) for one in delivery.contradictions],
                "failures": {name: reason.as_data() for name, reason in delivery.failures.items()},
            }
        )
    elif delivery.results:
        print_results(delivery.results)
    for order in delivery.orders:
        if order.check().passed is False:
            say(f"Order: {order.check().text}")
    for sentence in (*(one.text for one in delivery.contradictions), *(cut.text for cut in delivery.cuts)):
        say(sentence)
    for warning in delivery.warnings:
        say(warning)
    for name, text in delivery.failures.items():
        say(f"geofit: {name}: {text}")
    if delivery.results:
        pages = f"{out / 'report.html'}{', .pdf' if pdf else ''}"
        say(f"Report: {pages} and .json; surfaces and tables beside it")
    return delivery.exit_code


def _sample(out: Path) -> Path:
    """Find the sample site of the checkout, or make one now."""
    for root in (Path.cwd(), Path(__file__).resolve().parents[2]):
        if (root / "sample_data" / "site.toml").is_file():
            return root / "sample_data" / "site.toml"
    from geofit.sample import write_site

    write_site(out / "sample_data")
    return out / "sample_data" / "site.toml"


def _read(source: Path, columns: dict[str, str | None], boundary: Path | None) -> Site:
    from dataclasses import replace

    from geofit.data.site import Site
    from geofit.io.boundary import read_boundary
    from geofit.io.picks import read_points
    from geofit.io.site_file import read_site

    area = None if boundary is None else read_boundary(boundary)
    if source.suffix.casefold() == ".toml":
        given = [f"--{name}" for name, value in columns.items() if value is not None]
        if given:
            raise InputError(
                message("cli.option-for-tables", "{option} is for tables of points", option=given[0]),
                message("cli.site-file-names-columns", "A site file names its own columns."),
                file=str(source),
            )
        site = read_site(source)
        return site if area is None else replace(site, boundary=area)
    picks = read_points(
        source,
        x=columns.get("x"),
        y=columns.get("y"),
        z=columns.get("z"),
        surface=columns.get("surface"),
        section=columns.get("section"),
        sep=columns.get("sep"),
        decimal=columns.get("decimal"),
    )
    return Site(
        name=source.stem,
        horizons=picks.horizons,
        boundary=area,
        issues=picks.issues,
        counts=picks.counts,
        inputs=picks.inputs,
    )


def _settings(changes: dict[str, Any]) -> FitSettings:
    from geofit.data.settings import FitSettings

    return FitSettings(**changes)


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


def _pick(kind: str, found: Mapping[str, Any], wanted: str | None, file: Path) -> tuple[str, Any]:
    if len(found) == 1 and (wanted is None or kind == "surface"):
        return next(iter(found.items()))
    if wanted is not None and wanted in found:
        return wanted, found[wanted]
    reason = (
        message("cli.not-in-file", "There is no {kind} '{name}'", kind=kind, name=Verbatim(wanted))
        if wanted
        else message(
            "cli.several-in-file",
            "Found in the file, where one is needed: {count} × {kind}",
            count=len(found),
            kind=kind,
        )
    )
    remedy = message("cli.choose-with-horizon", "Choose with --horizon: {names}.", names=", ".join(found))
    raise InputError(reason, remedy, file=str(file))


def _summary(accuracy: dict[str, Any], name: str) -> dict[str, Any]:
    accuracy.pop("residuals")
    accuracy.pop("patch")
    return {
        "horizon": name,
        "verdict": "PASS" if accuracy["passed"] else "FAIL",
        **accuracy,
        "version": __version__,
    }


def main() -> None:
    """Run the command line."""
    app()
