"""The application that commands register with. Everything heavy is imported inside the commands."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from geofit import __version__

__all__ = ["app"]


class _Commands(TyperGroup):
    """The commands; wrong usage is a document on stdout, too, where ``--json`` is given."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except Exception as error:
            # The base of wrong usage, which typer does not export, has moved between its releases.
            if "--json" in sys.argv and hasattr(error, "format_message"):
                _print_usage(error.format_message(), getattr(error, "ctx", None) or ctx)
            raise


def _print_usage(problem: str, where: Any) -> None:
    from geofit.cli.console import print_error
    from geofit.data.errors import InputError
    from geofit.data.messages import message

    reason = message("cli.wrong-usage", "{problem}", problem=problem)
    help_ = message("cli.see-help", "{command} --help lists what it takes.", command=where.command_path)
    print_error(InputError(reason, help_), 2)


app = typer.Typer(
    name="geofit",
    cls=_Commands,
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
