"""``geofit section``: surfaces cut along a line."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import print_json, print_table, say, with_exit_code
from geofit.cli.options import SURFACE_FILES, Json, Out, Tolerance

__all__ = ["section"]


@app.command()
@with_exit_code
def section(
    surfaces: Annotated[list[Path], typer.Argument(metavar="SURFACE...", help=f"Files: {SURFACE_FILES}.")],
    line: Annotated[str, typer.Option(help="x0,y0,x1,y1 (further corners may follow), or a table with x and y; m.")],
    out: Out,
    tolerance: Tolerance = 0.05,
    as_json: Json = False,
) -> int:
    """Cut every horizon along a line: drawing (DXF), table (CSV) and picture (PNG)."""
    from geofit.io.surface_files import read_surfaces
    from geofit.project.section import read_line
    from geofit.project.section import section as cut

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


def _span(values: Any) -> str:
    return f"{values.min():.1f} .. {values.max():.1f}"
