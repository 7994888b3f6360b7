"""The application that commands register with. Everything heavy is imported inside the commands."""

from __future__ import annotations

from typing import Annotated

import typer

from geofit import __version__

__all__ = ["app"]

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
