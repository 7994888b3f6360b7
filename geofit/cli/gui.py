"""``geofit gui``: the desktop application."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import with_exit_code

__all__ = ["gui"]


@app.command()
@with_exit_code
def gui(
    file: Annotated[Path | None, typer.Argument(metavar="[FILE]", help="site.toml or project.geofit to open.")] = None,
) -> int:
    """Open the desktop application. Exit code 2: it cannot start, and what is missing is reported."""
    from importlib.metadata import entry_points

    # The windows are found by their entry point: no module of a lower floor imports them.
    window = next(iter(entry_points(group="gui_scripts", name="geofit-gui")))
    return int(window.load()([] if file is None else [str(file)]))
