"""Options and arguments that several commands share: one name, one help text."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class LanguageCode(StrEnum):
    """Languages of the report."""

    EN = "en"
    ZH = "zh"


class Across(StrEnum):
    """Interpolation of the core across its sections."""

    CUBIC = "cubic"
    LINEAR = "linear"


class SeamChoice(StrEnum):
    """How patches meet."""

    TANGENT = "tangent"
    POSITION = "position"


class DipsChoice(StrEnum):
    """What measured dips are for."""

    CHECK = "check"
    FIT = "fit"


class FrameChoice(StrEnum):
    """In which frame a surface is a height field."""

    AUTO = "auto"
    MAP = "map"
    BEST_PLANE = "best-plane"
    SECTIONS = "sections"


Out = Annotated[Path, typer.Option(help="Folder for the results; created if missing.")]
Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON on stdout instead of a table.")]
Report = Annotated[bool, typer.Option("--report", help="Write NAME_report.html and NAME_report.pdf, too.")]
Lang = Annotated[LanguageCode, typer.Option(help="Language of the report: English or Chinese.")]
X = Annotated[str | None, typer.Option("--x", help="CSV: column of the easting, m. Default: found by its header.")]
Y = Annotated[str | None, typer.Option("--y", help="CSV: column of the northing, m.")]
Z = Annotated[str | None, typer.Option("--z", help="CSV: column of the elevation, m.")]
SurfaceColumn = Annotated[str | None, typer.Option("--surface", help="CSV: column of the horizon's name.")]
SectionColumn = Annotated[str | None, typer.Option("--section", help="CSV: column of the section's name.")]
Unit = Annotated[
    str | None,
    typer.Option(
        help="CSV: unit of all lengths: m, ft, ft-us (US survey foot), km, cm, mm. Default: as headers mark, else m."
    ),
]
LengthUnit = Annotated[
    str | None,
    typer.Option(
        "--unit",
        help="Unit of all lengths of tables, drawings, grids and GeoJSON: m, ft, ft-us (US survey foot), km, cm, mm. "
        "Default: as headers mark, else m.",
    ),
]
Sep = Annotated[str | None, typer.Option(help="CSV: separator: one character, 'tab' or 'space'. Default: found.")]
Decimal = Annotated[str | None, typer.Option(help="CSV: decimal mark, '.' or ','. Default: found.")]
Crs = Annotated[
    str | None,
    typer.Option("--crs", help="CSV: grid of the site, EPSG:number; longitude and latitude are projected to it."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        help="Fit side by side: local (processes), tcp://host:port of a Dask scheduler, or the file that it writes."
    ),
]
Workers = Annotated[int | None, typer.Option(min=1, help="Local processes. Default: one a processor.")]
Tolerance = Annotated[float, typer.Option(help="Largest distance of triangles and lines from the surface, m.")]
Author = Annotated[
    str | None, typer.Option(help="Who answers for STEP files. Default: [report] of the site file, if there is one.")
]
Organisation = Annotated[
    str | None, typer.Option(help="Organisation in STEP files. Default: [report] of the site file, if there is one.")
]
Certificate = Annotated[
    bool, typer.Option("--certificate", help="Write FILE_certificate.pdf: what was read back from each STEP file.")
]
OriginChoice = Annotated[
    str,
    typer.Option(
        metavar="ORIGIN",
        help="Zero of STEP files: map, local (a round place below the data), datum ([site] datum of the site file), or "
        "E,N,Z of the project datum, m. The file states the offset.",
    ),
]
FORMATS = (
    "step, iges, brep, dxf (contours), dxf-mesh, ifc, landxml, tsurf, geoh5, omf, vtp, vtm, obj, ply, stl, glb, "
    "gpkg (contours), asc, grd, tif (grids)"
)
SURFACE_FILES = "STEP, IGES, BREP or GOCAD TSurf (.ts), ours or any other"
FROM_SITE = "Default: the site file's, else"
