"""``geofit info``: what is in a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import print_counts, print_issues, print_json, print_table, with_exit_code
from geofit.cli.options import Json
from geofit.cli.sources import read_source

if TYPE_CHECKING:
    from geofit.project.describe import Value

__all__ = ["info"]


@app.command()
@with_exit_code
def info(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="site.toml, a table of any kind, or a surface (STEP ...).")
    ],
    as_json: Json = False,
) -> int:
    """Say what is in a file."""
    from geofit.io.surface_files import is_surface_file
    from geofit.project.describe import describe_site, describe_surfaces, describe_tables

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
    if rows is None and _may_be_tables(file) and (rows := describe_tables(file) or None):
        header = ("table", "kind", "confidence", "rows", "columns")
    elif rows is None:
        site = read_source(file, {}, None)
        header = ("horizon", "points", "kinds", "west..east, m", "south..north, m", "z, m")
        rows, issues = describe_site(site), site.issues
        print_counts(site.counts)
    if as_json:
        print_json([dict(zip(header, row, strict=True)) for row in rows])
    else:
        print_table(
            header,
            [[_text(value) for value in row] for row in rows],
            left=(0, 1, 4) if header[0] == "table" else (0, 2),
        )
        print_issues(issues)
    return 0


def _text(value: Value) -> str:
    match value:
        case None:
            return "–"
        case low, high:
            return f"{low:.1f} .. {high:.1f}"
        case float():
            return f"{value:.2f}"
    return str(value)


def _may_be_tables(file: Path) -> bool:
    """Whether a file may hold tables other than points: no site file and no cloud."""
    from geofit.io.clouds import is_cloud

    return file.suffix.casefold() != ".toml" and not is_cloud(file)
