"""``geofit import``: files to a site file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, print_counts, print_issues, print_json, print_table, say, with_exit_code
from geofit.cli.options import Json, LengthUnit
from geofit.data.errors import InputError
from geofit.data.files import refuse_inputs
from geofit.data.messages import message

__all__ = ["import_"]


@app.command(name="import")
@with_exit_code
def import_(
    files: Annotated[list[Path], typer.Argument(metavar="FILES...", help="Tables, drawings, maps, grids of one site.")],
    site: Annotated[Path, typer.Option(metavar="OUT.toml", help="The site file; mapping and issues go with it.")],
    mapping: Annotated[Path | None, typer.Option(help="Mapping (TOML) of columns that a guess would miss.")] = None,
    crs: Annotated[str, typer.Option(help="Coordinate system of the site, EPSG:number; degrees are projected.")] = "",
    unit: LengthUnit = None,
    base: Annotated[list[str] | None, typer.Option(help="Code whose base is a horizon; may be repeated.")] = None,
    top: Annotated[list[str] | None, typer.Option(help="Code whose top is a horizon; may be repeated.")] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace an existing site file, and the mapping next to it.")
    ] = False,
    as_json: Json = False,
) -> int:
    """Recognise files and bind them in a site file. Exit code 1: no horizon yet, 2: no row can be used."""
    from dataclasses import asdict, astuple

    from geofit.io.mapping import load_mappings
    from geofit.project.importing import import_files, issue_file_of, mapping_file_of

    written = (site, mapping_file_of(site))
    refuse_inputs((*written, issue_file_of(site)))
    if site.suffix.casefold() != ".toml":
        raise InputError(
            message("cli.site-file-not-toml", "The name of a site file must end in .toml; others are read as tables"),
            message("cli.name-site-toml", "Write --site {name}.", name=str(site / "site.toml")),
            file=str(site),
        )
    if not force:
        _refuse_existing(written)
    mappings = load_mappings(mapping) if mapping is not None else ()
    with listening() as progress:
        found = import_files(
            files,
            site,
            mappings=mappings,
            crs=crs,
            unit=unit,
            base=tuple(base or ()),
            top=tuple(top or ()),
            progress=progress,
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


def _refuse_existing(files: Iterable[Path]) -> None:
    """Refuse to replace a site file or a mapping: somebody may have written or corrected it by hand."""
    for file in files:
        if file.exists():
            raise InputError(
                message("cli.import-file-exists", "The file already exists and may have been edited by hand"),
                message("cli.name-other-site-file", "Name another site file, or replace it with --force."),
                file=str(file),
            )
