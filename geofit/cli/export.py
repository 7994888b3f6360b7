"""``geofit export``: surfaces in other formats."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import print_issues, print_json, print_table, say, with_exit_code
from geofit.cli.options import (
    FORMATS,
    SURFACE_FILES,
    Author,
    Certificate,
    Decimal,
    Json,
    LanguageCode,
    Organisation,
    OriginChoice,
    SectionColumn,
    Sep,
    SurfaceColumn,
    Tolerance,
    Unit,
    X,
    Y,
    Z,
)
from geofit.cli.signing import read_origin, signed_by
from geofit.cli.sources import read_source
from geofit.data.errors import InputError
from geofit.data.messages import Message, Untranslated, message

if TYPE_CHECKING:
    from geofit.data.site import Site
    from geofit.project.step_files import Signed
    from geofit.surfaces.mesh_surface import MeshSurface
    from geofit.surfaces.patch_surface import PatchSurface

__all__ = ["export"]


@app.command()
@with_exit_code
def export(
    surfaces: Annotated[list[Path], typer.Argument(metavar="SURFACE...", help=f"Files: {SURFACE_FILES}.")],
    to: Annotated[str, typer.Option(help=f"Format: {FORMATS}.")],
    out: Annotated[Path, typer.Option(help="The file; horizons get one each where the format holds one.")],
    points: Annotated[
        Path | None,
        typer.Option(
            metavar="SITE_OR_CSV",
            help="site.toml or table of points: deviations, sigma of STEP; a site's holes, ground and CRS.",
        ),
    ] = None,
    x: X = None,
    y: Y = None,
    z: Z = None,
    surface: SurfaceColumn = None,
    section: SectionColumn = None,
    unit: Unit = None,
    sep: Sep = None,
    decimal: Decimal = None,
    value: Annotated[str, typer.Option(help="What a grid holds: elevation, deviation or thickness.")] = "elevation",
    tolerance: Tolerance = 0.05,
    interval: Annotated[float | None, typer.Option(help="Metres between contours. Default: chosen.")] = None,
    cell: Annotated[float | None, typer.Option(help="Metres between grid nodes. Default: chosen.")] = None,
    author: Author = None,
    organisation: Organisation = None,
    certificate: Certificate = False,
    origin: OriginChoice = "map",
    lang: Annotated[LanguageCode, typer.Option(help="Language of the certificate.")] = LanguageCode.EN,
    crs: Annotated[str | None, typer.Option(help="Coordinate system, EPSG:number. Default: the site's.")] = None,
    as_json: Json = False,
) -> int:
    """Write horizons in other formats."""
    from geofit.io.export.write import renamed, untrimmed, write_surface
    from geofit.io.surface_files import read_surfaces

    zero = read_origin(origin)
    columns = {"x": x, "y": y, "z": z, "surface": surface, "section": section, "unit": unit}
    site = _points(points, {**columns, "sep": sep, "decimal": decimal}, crs)
    given = read_surfaces(surfaces)
    for sentence in (*untrimmed(given, to), *renamed(given, to), *_without_points(given, site, to)):
        say(sentence)
    signed = signed_by(site, author, organisation, zero, certificate=lang.value if certificate else "")
    if to == "step":
        files = _write_step(given, out, site, signed)
    else:
        _only_step(("--author", author), ("--organisation", organisation), ("--certificate", certificate),
                   ("--origin", origin != "map"))  # fmt: skip
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
            crs=_system(site, to) if crs is None else crs,
            ground=site.ground if site else None,
        )
        if value == "thickness" and (site is None or site.ground is None):
            say(
                message(
                    "cli.thickness-without-ground",
                    "No ground is given (--points site.toml): what lies above it counts in the thickness",
                )
            )
    if as_json:
        print_json({"files": [str(file) for file in files]})
    else:
        print_table(("file", "bytes"), [(str(file), str(file.stat().st_size)) for file in files])
    return 0


def _points(file: Path | None, columns: dict[str, str | None], crs: str | None) -> Site | None:
    """Read what --points names; of a table, longitude and latitude are projected to ``crs``."""
    if file is None:
        for name, column in columns.items():
            if column is not None:
                raise InputError(
                    message("cli.option-for-points", "{option} describes the table of --points", option=f"--{name}"),
                    message("cli.give-points-table", "Give the table with --points, or leave {option} out.",
                            option=f"--{name}"),
                )  # fmt: skip
        return None
    site = read_source(file, columns if file.suffix.casefold() == ".toml" else {**columns, "crs": crs}, None)
    print_issues(site.issues)
    return site


def _system(site: Site | None, to: str) -> str:
    """Return the coordinate system that a file states; GeoPackage and GeoTIFF have no place for a mere label."""
    from geofit.io.crs import is_code

    label = "" if site is None else site.crs
    if not label or is_code(label) or to not in ("gpkg", "tif"):
        return label
    say(
        message(
            "cli.label-is-no-system",
            "The site's coordinate system '{crs}' is a label: the file states none. Give one with --crs EPSG:number",
            crs=Untranslated(label),
        )
    )
    return ""


def _without_points(surfaces: Mapping[str, Any], site: Site | None, to: str) -> list[Message]:
    """Return a warning for each surface of whose name the given points have no horizon, in formats that use points."""
    from geofit.io.export.write import FORMATS as KNOWN

    if site is None or len(site.horizons) == len(surfaces) == 1:
        return []
    if to != "step" and KNOWN[to].takes not in ("measured", "vtp"):
        return []
    return [
        message(
            "cli.export-without-points",
            "{name}: no horizon of --points has this name: the file has no deviations and no sigma of it",
            name=Untranslated(name),
        ).with_severity("warning")
        for name in surfaces
        if name not in site.horizons
    ]


def _only_step(*options: tuple[str, str | bool | None]) -> None:
    """Refuse what other formats than STEP cannot state, where it was given."""
    for name, given in options:
        if given:
            raise InputError(
                message("cli.option-for-step", "{option} is for STEP files", option=name),
                message("cli.export-to-step", "Leave it out, or give --to step."),
            )


def _write_step(
    surfaces: Mapping[str, PatchSurface | MeshSurface], out: Path, site: Site | None, signed: Signed
) -> list[Path]:
    """Write STEP; surfaces whose points are known state sigma, epsilon and the hash of the points."""
    from geofit.data.files import folder_for
    from geofit.fitting.judge import judge
    from geofit.io.export.write import need_patches
    from geofit.project.step_files import write_step_files

    need_patches(surfaces, "step", out)
    known = {} if site is None else dict(site.horizons)
    if len(known) == len(surfaces) == 1:
        known = dict(zip(surfaces, known.values(), strict=True))
    settings = {} if site is None else site.settings
    judged = {
        name: judge(surface, known[name], settings.get(name), name)
        for name, surface in surfaces.items()
        if name in known
    }
    for name, one in judged.items():
        for note in one.accuracy.notes if one.accuracy is not None else ():
            say(f"{name}: {note}")
    measured = {**surfaces, **judged}
    folder_for(out.parent)
    (file,) = write_step_files(measured, out, "m", separate=False, signed=signed, progress=lambda *_: True)
    return [file.path] if file.certificate is None else [file.path, file.certificate]
