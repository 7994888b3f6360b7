"""``geofit export``: surfaces in other formats."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import print_issues, print_json, print_table, say, with_exit_code
from geofit.cli.options import (
    FORMATS,
    SURFACE_FILES,
    Author,
    Certificate,
    Json,
    LanguageCode,
    Organisation,
    OriginChoice,
    Tolerance,
)
from geofit.cli.signing import read_origin, signed_by
from geofit.cli.sources import read_source
from geofit.data.errors import InputError
from geofit.data.messages import message

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
    site = None if points is None else read_source(points, {}, None)
    if site is not None:
        print_issues(site.issues)
    given = read_surfaces(surfaces)
    for sentence in (*untrimmed(given, to), *renamed(given, to)):
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
            crs=crs if crs is not None else site.crs if site else "",
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
