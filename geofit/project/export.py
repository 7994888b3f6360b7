"""The work of ``geofit export`` and ``geofit section``: surfaces from files to other files."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError, SettingsError
from geofit.data.files import file_stems
from geofit.data.messages import message
from geofit.sampling.contours import contours
from geofit.sampling.cut import CutLine, cut, section_line
from geofit.sampling.grids import deviation_grid, elevation_grid, thickness_grid
from geofit.surfaces.mesh_surface import MeshSurface
from geofit.surfaces.patch_surface import PatchSurface
from geofit.surfaces.protocol import Surface

if TYPE_CHECKING:
    from geofit.data.points import PointSet
    from geofit.data.site import Ground, Hole

__all__ = ["FORMATS", "Format", "Request", "export", "read_line", "read_surfaces", "section", "uncut"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Format:
    """A format: what its writer ``module.function`` (in geofit) takes, and whether it states the CRS."""

    takes: Literal["surfaces", "meshes", "contours", "grid", "vtp", "measured", "site"]
    module: str
    function: str
    crs: bool = False


#: Formats by the word after ``--to``.
FORMATS: dict[str, Format] = {
    "step": Format("surfaces", "cad.step", "write_step"),
    "iges": Format("surfaces", "cad.export", "write_iges"),
    "brep": Format("surfaces", "cad.export", "write_brep"),
    "dxf": Format("contours", "io.export.dxf", "write_contours_dxf"),
    "dxf-mesh": Format("meshes", "io.export.dxf", "write_mesh_dxf"),
    "gpkg": Format("contours", "io.export.geopackage", "write_contours_gpkg", crs=True),
    "ifc": Format("site", "io.export.ifc", "write_ifc", crs=True),
    "landxml": Format("meshes", "io.export.landxml", "write_landxml"),
    "tsurf": Format("meshes", "io.export.tsurf", "write_tsurf"),
    "geoh5": Format("measured", "io.export.geoh5", "write_geoh5"),
    "omf": Format("measured", "io.export.omf", "write_omf"),
    "asc": Format("grid", "io.export.grids", "write_esri"),
    "grd": Format("grid", "io.export.grids", "write_surfer"),
    "tif": Format("grid", "io.export.grids", "write_geotiff", crs=True),
    "vtp": Format("vtp", "io.export.vtk", "write_vtp"),
    "vtm": Format("measured", "io.export.vtk", "write_vtm"),
    "obj": Format("meshes", "io.export.triangles", "write_obj"),
    "ply": Format("meshes", "io.export.triangles", "write_ply"),
    "stl": Format("meshes", "io.export.triangles", "write_stl"),
    "glb": Format("meshes", "io.export.triangles", "write_glb"),
}


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is wanted of an export.

    ``tolerance``: largest distance in metres of triangles and lines from the surface. ``interval``: metres
    between contours, ``cell``: metres between grid nodes; None: chosen from the size. ``value``: what a grid
    holds. ``points``: data points by horizon, for deviations. ``holes``, ``site``: boreholes and adits, and the
    site's title, for formats that have them. ``crs``: label of the coordinate system.
    """

    tolerance: float = 0.05
    interval: float | None = None
    cell: float | None = None
    value: str = "elevation"
    points: Mapping[str, PointSet] | None = None
    holes: Sequence[Hole] = ()
    site: str = "site"
    crs: str = ""


Surfaces = Mapping[str, Surface]


def export(surfaces: Surfaces, to: str, out: Path, request: Request | None = None) -> list[Path]:
    """Write surfaces in a format of :data:`FORMATS`; return the files.

    Formats that hold one horizon a file give ``NAME_HORIZON.ending`` where there are several.

    Raises
    ------
    InputError
        If the format is unknown, or cannot hold these surfaces.
    SettingsError
        If a setting is out of its range.
    MissingDependencyError
        If the format needs a package that is not installed; the message holds the install line.
    """
    if to not in FORMATS:
        raise InputError(
            message("export.no-format", "There is no format '{to}'", to=to),
            message("export.known-formats", "Choose one of: {names}.", names=", ".join(FORMATS)),
        )
    if not surfaces:
        raise InputError(
            message("export.no-surface-write", "No surface to write"),
            message("export.give-least-horizon", "Give at least one horizon."),
            file=str(out),
        )
    chosen, wanted = FORMATS[to], request or Request()
    if chosen.takes in ("surfaces", "site"):
        _need_patches(surfaces, to, out)
    write = getattr(import_module(f"geofit.{chosen.module}"), chosen.function)
    out.parent.mkdir(parents=True, exist_ok=True)
    more = {"crs": wanted.crs} if chosen.crs else {}
    if chosen.takes == "grid":
        grids = _grids(surfaces, out, wanted)
        for file, grid in grids:
            write(grid, file, **more)
        return [file for file, _ in grids]
    if chosen.takes == "surfaces":
        write(surfaces, out)
        return [out]
    if chosen.takes == "site":
        write(surfaces, out, holes=wanted.holes, site=wanted.site, tolerance=wanted.tolerance, **more)
        return [out]
    if chosen.takes == "contours":
        step, tolerance = wanted.interval, wanted.tolerance
        write({name: contours(one, step, tolerance=tolerance) for name, one in surfaces.items()}, out, **more)
        return [out]
    meshes = {name: surface.triangulate(wanted.tolerance) for name, surface in surfaces.items()}
    if chosen.takes == "meshes":
        origin = write(meshes, out)
        return [out] if origin is None else [out, out.with_name(out.name + ".origin.txt")]
    measured = {name: (points, surfaces[name].distance(points.xyz)) for name, points in _points(surfaces, wanted)}
    if chosen.takes == "measured":
        write(meshes, out, measured)
        return [out]
    files = _files(surfaces, out)
    for name, mesh in meshes.items():
        write(mesh, files[name], *measured.get(name, ()))
    return list(files.values())


def read_surfaces(files: Sequence[Path]) -> dict[str, PatchSurface | MeshSurface]:
    """Read the horizons of surface files; names that stand in several files get the file's name before them."""
    from geofit.io.surface_files import read_surface_file

    found: dict[str, PatchSurface | MeshSurface] = {}
    for file in files:
        for name, surface in read_surface_file(file).items():
            unique = name if name not in found else f"{file.stem} {name}"
            if unique in found:
                raise InputError(
                    message("export.file-given-twice", "The file is given twice"),
                    message("export.name-file-once", "Name each file once."),
                    file=str(file),
                )
            found[unique] = replace(surface, name=unique)
    return found


def section(
    surfaces: Surfaces, line: Floats, out: Path, tolerance: float = 0.05
) -> tuple[dict[str, list[CutLine]], list[Path]]:
    """Cut every horizon along a line in plan; write drawing, 3D lines, table and picture into a folder.

    Raises
    ------
    InputError
        If the line meets no horizon.
    SettingsError
        If the line has fewer than two different corners.
    """
    from geofit.io.export.dxf import write_section_dxf
    from geofit.io.export.section_csv import write_section_csv
    from geofit.report.section import write_section_picture

    corners = section_line(line)
    cuts = {name: cut(surface, corners, tolerance=tolerance) for name, surface in surfaces.items()}
    if not any(cuts.values()):
        raise InputError(
            message(
                "export.section-line-meets-no",
                "The section line from {first} to {last} meets no horizon",
                first=corners[0].tolist(),
                last=corners[-1].tolist(),
            ),
            message("export.give-surfaces-map-coordinates", "Give it in the surfaces' map coordinates, metres."),
        )
    out.mkdir(parents=True, exist_ok=True)
    files = [out / name for name in ("section.dxf", "section_3d.dxf", "section.csv", "section.png")]
    write_section_dxf(cuts, files[0])
    write_section_dxf(cuts, files[1], drawn=False)
    write_section_csv(cuts, files[2])
    write_section_picture(cuts, corners, files[3])
    return cuts, files


def read_line(text: str) -> Floats:
    """Read a section's line: a file with its corners, or ``x0,y0,x1,y1`` (and further corners).

    Raises
    ------
    InputError
        If there is no such file, a corner cannot be read, or the text is no list of coordinates.
    """
    words = text.replace(";", ",").split(",")
    try:
        values = [float(word) for word in words]
    except ValueError:
        return _line_file(Path(text))
    if len(values) < 4 or len(values) % 2 or not all(map(math.isfinite, values)):
        raise InputError(
            message(
                "export.numbers-given-section-line", "Numbers given for the section line: {count}", count=len(values)
            ),
            message("export.give-x0-y0-x1", "Give x0,y0,x1,y1, metres; further corners add two numbers each."),
            value=text,
        )
    return np.array(values).reshape(-1, 2)


def _line_file(path: Path) -> Floats:
    from geofit.io.columns import BOUNDARY
    from geofit.io.journal import Journal
    from geofit.io.rows import read_rows
    from geofit.io.source import as_source

    if not path.is_file():
        raise InputError(
            message("import.file-missing", "There is no such file"),
            message("export.give-file-columns-x0", "Give a file with columns x and y, or x0,y0,x1,y1."),
            file=str(path),
        )
    journal = Journal()
    rows = read_rows(as_source(path), BOUNDARY, journal)
    corners = np.column_stack(rows.places())
    rows.close()
    bad = [issue for issue in journal.issues if issue.severity == "error"]
    if bad:
        raise InputError(bad[0].reason, bad[0].remedy, file=str(path), row=bad[0].row, value=bad[0].value)
    return np.asarray(corners[:, :2])


def uncut(surfaces: Surfaces, to: str) -> list[str]:
    """Return a sentence for each surface whose faces end at loops that a format's NURBS patches do not follow."""
    if to not in FORMATS or FORMATS[to].takes not in ("surfaces", "site"):
        return []
    return [
        f"{name}: its faces end at holes or curves that {to} does not follow here; it holds the patches whole"
        for name, surface in surfaces.items()
        if any(surface.loops) and surface.outline is None
    ]


def _need_patches(surfaces: Surfaces, to: str, out: Path) -> None:
    """Refuse triangles where a format holds NURBS."""
    meshes = [name for name, surface in surfaces.items() if not surface.patches]
    if meshes:
        others = [name for name, one in FORMATS.items() if one.takes not in ("surfaces", "site")]
        raise InputError(
            message(
                "export.triangle-mesh-holds-nurbs",
                "'{name}' is a triangle mesh; {to} holds NURBS surfaces, which would have to be fitted",
                name=meshes[0],
                to=to,
            ),
            message(
                "export.fit-vertices-geofit-fit",
                "Fit its vertices (geofit fit), or choose one of: {names}.",
                names=", ".join(others),
            ),
            file=str(out),
        )


def _files(surfaces: Surfaces, out: Path) -> dict[str, Path]:
    """Return a file for each horizon: ``out`` itself if there is one."""
    if len(surfaces) == 1:
        return dict.fromkeys(surfaces, out)
    return {name: out.with_name(f"{out.stem}_{stem}{out.suffix}") for name, stem in file_stems(surfaces).items()}


def _points(surfaces: Surfaces, request: Request) -> list[tuple[str, PointSet]]:
    """Return the horizons that have data points; where there is one of each, names need not agree."""
    points = request.points or {}
    if len(points) == len(surfaces) == 1:
        return list(zip(surfaces, points.values(), strict=True))
    return [(name, points[name]) for name in surfaces if name in points]


def _grids(surfaces: Surfaces, out: Path, request: Request) -> list[tuple[Path, Ground]]:
    if request.value == "thickness":
        if len(surfaces) != 2:
            raise InputError(
                message(
                    "export.thickness-lies-two-horizons",
                    "Thickness lies between two horizons; given: {count}",
                    count=len(surfaces),
                ),
                message("export.name-upper-lower", "Name the upper one, then the lower."),
            )
        upper, lower = surfaces.values()
        return [(out, thickness_grid(upper, lower, request.cell))]
    files = _files(surfaces, out)
    if request.value == "elevation":
        return [(files[name], elevation_grid(surface, request.cell)) for name, surface in surfaces.items()]
    if request.value != "deviation":
        raise SettingsError(
            message(
                "export.grid-unknown-choose-elevation",
                "A grid of '{kind}' is unknown; choose elevation, deviation or thickness.",
                kind=request.value,
            )
        )
    data = dict(_points(surfaces, request))
    missing = [name for name in surfaces if name not in data]
    if missing:
        raise InputError(
            message("export.no-points", "There are no points of '{name}'", name=missing[0]),
            message("export.give-points", "Give them with --points."),
        )
    return [(files[name], deviation_grid(surfaces[name], data[name], request.cell)) for name in surfaces]
