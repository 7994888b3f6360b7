"""Surfaces to files of any format that geofit writes; the ending of the file names the format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, runtime_checkable

from geofit.data.errors import InputError, SettingsError
from geofit.data.files import file_stems, folder_for
from geofit.data.given import SURFACES, arguments_checked, require_kind
from geofit.data.legible import legible, legible_keys
from geofit.data.messages import Message, Untranslated, message
from geofit.sampling.contours import contours
from geofit.sampling.grids import deviation_grid, elevation_grid, thickness_grid
from geofit.surfaces.protocol import Surface

if TYPE_CHECKING:
    from geofit.cad.step_origin import Origin
    from geofit.data.points import PointSet
    from geofit.data.site import Ground, Hole

__all__ = ["FORMATS", "Format", "format_of", "need_patches", "renamed", "untrimmed", "write_surface"]

Surfaces = Mapping[str, Surface]


@runtime_checkable
class _Drawable(Protocol):
    """What every surface has, and nothing else that a caller may take for one."""

    def triangulate(self, tolerance: float = 0.05) -> Any:
        """As :meth:`Surface.triangulate`."""


@dataclass(frozen=True)
class Format:
    """A format: what its writer ``module.function`` (in geofit) takes, its endings, and what it can state.

    The first format with an ending is the one that the ending represents; the others have to be named.
    """

    takes: Literal["surfaces", "meshes", "contours", "grid", "vtp", "measured", "site"]
    module: str
    function: str
    endings: tuple[str, ...]
    crs: bool = False
    unit: bool = False


#: Every format by its name: the word after ``--to`` of the command line.
FORMATS: dict[str, Format] = {
    "step": Format("surfaces", "cad.step", "write_step", (".step", ".stp"), unit=True),
    "iges": Format("surfaces", "cad.export", "write_iges", (".igs", ".iges")),
    "brep": Format("surfaces", "cad.export", "write_brep", (".brep", ".brp")),
    "dxf": Format("contours", "io.export.dxf", "write_contours_dxf", (".dxf",)),
    "dxf-mesh": Format("meshes", "io.export.dxf", "write_mesh_dxf", (".dxf",)),
    "gpkg": Format("contours", "io.export.geopackage", "write_contours_gpkg", (".gpkg",), crs=True),
    "ifc": Format("site", "io.export.ifc", "write_ifc", (".ifc",), crs=True),
    "landxml": Format("meshes", "io.export.landxml", "write_landxml", (".xml", ".landxml")),
    "tsurf": Format("meshes", "io.export.tsurf", "write_tsurf", (".ts",)),
    "geoh5": Format("measured", "io.export.geoh5", "write_geoh5", (".geoh5",)),
    "omf": Format("measured", "io.export.omf", "write_omf", (".omf",)),
    "asc": Format("grid", "io.export.grids", "write_esri", (".asc",)),
    "grd": Format("grid", "io.export.grids", "write_surfer", (".grd",)),
    "tif": Format("grid", "io.export.grids", "write_geotiff", (".tif", ".tiff"), crs=True),
    "vtp": Format("vtp", "io.export.vtk", "write_vtp", (".vtp",)),
    "vtm": Format("measured", "io.export.vtk", "write_vtm", (".vtm",)),
    "obj": Format("meshes", "io.export.triangles", "write_obj", (".obj",)),
    "ply": Format("meshes", "io.export.triangles", "write_ply", (".ply",)),
    "stl": Format("meshes", "io.export.triangles", "write_stl", (".stl",)),
    "glb": Format("meshes", "io.export.triangles", "write_glb", (".glb",)),
}


@dataclass(frozen=True, kw_only=True)
class _Options:
    """The keyword arguments of :func:`write_surface`."""

    tolerance: float
    unit: str
    origin: Origin
    crs: str
    interval: float | None
    cell: float | None
    value: str
    points: Mapping[str, PointSet]
    holes: Sequence[Hole]
    site: str
    ground: Ground | None


@arguments_checked
def write_surface(
    surfaces: Surface | Surfaces,
    path: str | PathLike[str],
    *,
    format: str = "",
    tolerance: float = 0.05,
    unit: Literal["m", "mm"] = "m",
    origin: Origin = "map",
    crs: str = "",
    interval: float | None = None,
    cell: float | None = None,
    value: str = "elevation",
    points: Mapping[str, PointSet] | None = None,
    holes: Sequence[Hole] = (),
    site: str = "site",
    ground: Ground | None = None,
) -> list[Path]:
    """Write surfaces in a format of :data:`FORMATS`.

    Each keyword means the same in every format; a format that has no use for one ignores it, except
    ``unit`` and ``origin``.

    Parameters
    ----------
    surfaces : Surface or mapping of str to Surface
        One surface, or surfaces by the names that the file gives them. Map coordinates, metres.
    path : path
        The file; its folder is created if missing. Formats that hold one surface a file write
        ``NAME_SURFACE.ending`` where there are several.
    format : str
        Name of the format; empty: chosen by the ending of ``path``.
    tolerance : float
        Largest distance of triangles and lines from the surface, metres.
    unit : {"m", "mm"}
        Unit of length in the file, for STEP. All other formats are in metres.
    origin : {"map", "local"} or (3,) array_like
        Zero of the file, for STEP: that of the map; a round place below the data; or the project datum in map
        coordinates, metres. The file states the offset.
    crs : str
        Label of the coordinate system, for instance "EPSG:32648", for formats that state it.
    interval : float, optional
        Vertical distance between contours, metres; chosen from the relief if not given.
    cell : float, optional
        Distance between grid nodes, metres; chosen from the extent if not given.
    value : {"elevation", "deviation", "thickness"}
        Values of a grid, metres: elevation of a surface, deviation of ``points`` from it, or the thickness
        between two surfaces, the upper one first, below the ``ground``.
    points : mapping of str to PointSet, optional
        Data points by surface, for deviations; the names may differ where there is one of each.
    holes : sequence of Hole
        Boreholes and adits, for IFC.
    site : str
        Title of the site, for IFC.
    ground : Ground, optional
        The ground, for thickness: what lies above it does not count.

    Returns
    -------
    list of Path
        The files that were written.

    Raises
    ------
    ArgumentError
        If what is given is not a surface.
    InputError
        If the format is unknown, or cannot represent these surfaces.
    SettingsError
        If an option is out of its range.
    StitchError
        If the patches of a surface do not form one valid shell (STEP, IGES, BREP).
    MissingDependencyError
        If the format needs a package that is not installed; the message gives the install line.

    Notes
    -----
    What each format represents, and how exactly: ``docs/formats_out.md``.

    Examples
    --------
    >>> import geofit, tempfile
    >>> fit = geofit.fit_horizon(geofit.PointSet([[0, 0, 1.0], [9, 0, 2.0], [0, 9, 3.0], [9, 9, 4.0]]), name="T1")
    >>> [file.name for file in write_surface(fit, tempfile.mkdtemp() + "/T1.obj", tolerance=0.1)]
    ['T1.obj']
    """
    out = Path(path)
    given: Surfaces = surfaces if isinstance(surfaces, Mapping) else {getattr(surfaces, "name", ""): surfaces}
    for name, surface in given.items():
        require_kind(f"surfaces[{name!r}]" if given is surfaces else "surfaces", surface, _Drawable, SURFACES)
    if not given:
        raise InputError(
            message("data.no-surface", "No surface to write"),
            message("data.give-a-horizon", "Give at least one horizon."),
            file=str(out),
        )
    to = format or format_of(out)
    chosen = _format(to)
    if unit != "m" and not chosen.unit:
        raise SettingsError(
            message(
                "io.unit-not-for-format",
                "unit is '{unit}'; {format} files are in metres. Use STEP, or leave it out.",
                unit=unit,
                format=to,
            )
        )
    if not chosen.unit and not (isinstance(origin, str) and origin == "map"):
        raise SettingsError(
            message(
                "io.origin-not-for-format",
                "{format} files have no origin of their own: they are in map coordinates. Use STEP, or leave it out.",
                format=to,
            )
        )
    given = legible_keys(given)
    if chosen.takes in ("surfaces", "site"):
        need_patches(given, to, out)
    options = _Options(
        tolerance=tolerance, unit=unit, origin=origin, crs=crs, interval=interval, cell=cell, value=value,
        points=legible_keys(points or {}), holes=holes, site=legible(site),
        ground=ground,
    )  # fmt: skip
    folder_for(out.parent)
    return _write(given, chosen, out, options)


def format_of(path: str | PathLike[str]) -> str:
    """Return the name of the format that a file's ending represents.

    Parameters
    ----------
    path : path
        The file; upper or lower case.

    Returns
    -------
    str
        A key of :data:`FORMATS`.

    Raises
    ------
    InputError
        If no format has this ending.

    Notes
    -----
    Formats and endings: ``docs/formats_out.md``.
    """
    ending = Path(path).suffix.casefold()
    for name, one in FORMATS.items():
        if ending in one.endings:
            return name
    known = [ending for one in FORMATS.values() for ending in one.endings]
    raise InputError(
        message("io.ending-unknown", "No format has the ending '{ending}'", ending=ending),
        message(
            "io.name-format-or-ending", "Name the format, or give a file that ends in {names}.", names=", ".join(known)
        ),
        file=str(path),
    )


def untrimmed(surfaces: Surfaces, format: str) -> list[Message]:
    """Return a sentence for each surface whose trim loops a format cannot represent.

    Parameters
    ----------
    surfaces : mapping of str to Surface
        Surfaces by name.
    format : str
        A key of :data:`FORMATS`.

    Returns
    -------
    list of Message
        Empty for formats of triangles, grids and lines, which end where the surface ends.

    Raises
    ------
    InputError
        If the format is unknown.

    Notes
    -----
    The formats of NURBS patches: ``docs/formats_out.md``, "Exact geometry".
    """
    if _format(format).takes not in ("surfaces", "site"):
        return []
    return [
        message(
            "io.trimmed-faces-not-held",
            "{name}: its faces end at holes or curves that {format} does not represent: the file has whole patches",
            name=name,
            format=format,
        )
        for name, surface in surfaces.items()
        if any(surface.loops) and surface.outline is None
    ]


def renamed(surfaces: Surfaces, format: str) -> list[Message]:
    """Return a warning for each surface whose name a format cannot write, with the name that the file has instead.

    Parameters
    ----------
    surfaces : mapping of str to Surface
        Surfaces by name.
    format : str
        A key of :data:`FORMATS`.

    Returns
    -------
    list of Message
        Empty but for IGES, whose names are ASCII.
    """
    if format != "iges":
        return []
    from geofit.cad.iges_names import iges_names

    return [
        message(
            "io.name-not-ascii",
            "{name}: IGES names are ASCII; in the file it is '{plain}'",
            name=Untranslated(name),
            plain=Untranslated(plain),
        ).with_severity("warning")
        for name, plain in iges_names(surfaces).items()
        if name and plain != name
    ]


def _format(name: str) -> Format:
    if name not in FORMATS:
        raise InputError(
            message("io.format-unknown", "There is no format '{to}'", to=name),
            message("io.known-formats", "Choose one of: {names}.", names=", ".join(FORMATS)),
        )
    return FORMATS[name]


def _write(surfaces: Surfaces, chosen: Format, out: Path, options: _Options) -> list[Path]:
    """Make of the surfaces what the format takes, and hand it to its writer."""
    write = getattr(import_module(f"geofit.{chosen.module}"), chosen.function)
    more: dict[str, Any] = {"crs": options.crs} if chosen.crs else {}
    if chosen.unit:
        more |= {"unit": options.unit, "origin": options.origin}
    if chosen.takes == "grid":
        grids = _grids(surfaces, out, options)
        for file, grid in grids:
            write(grid, file, **more)
        return [file for file, _ in grids]
    if chosen.takes == "surfaces":
        write(surfaces, out, **more)
        return [out]
    if chosen.takes == "site":
        write(surfaces, out, holes=options.holes, site=options.site, tolerance=options.tolerance, **more)
        return [out]
    if chosen.takes == "contours":
        step, tolerance = options.interval, options.tolerance
        write({name: contours(one, step, tolerance=tolerance) for name, one in surfaces.items()}, out, **more)
        return [out]
    meshes = {name: surface.triangulate(options.tolerance) for name, surface in surfaces.items()}
    if chosen.takes == "meshes":
        origin = write(meshes, out)
        return [out] if origin is None else [out, out.with_name(out.name + ".origin.txt")]
    measured = {name: (points, surfaces[name].distance(points.xyz)) for name, points in _points(surfaces, options)}
    if chosen.takes == "measured":
        write(meshes, out, measured)
        return [out]
    files = _files(surfaces, out)
    for name, mesh in meshes.items():
        write(mesh, files[name], *measured.get(name, ()))
    return list(files.values())


def need_patches(surfaces: Surfaces, to: str, out: Path) -> None:
    """Refuse triangles where a format holds NURBS."""
    meshes = [name for name, surface in surfaces.items() if not surface.patches]
    if meshes:
        others = [name for name, one in FORMATS.items() if one.takes not in ("surfaces", "site")]
        raise InputError(
            message(
                "io.mesh-not-for-nurbs",
                "'{name}' is a triangle mesh; {to} stores NURBS surfaces, so it would have to be fitted first",
                name=meshes[0],
                to=to,
            ),
            message(
                "io.fit-vertices-first",
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


def _points(surfaces: Surfaces, options: _Options) -> list[tuple[str, PointSet]]:
    """Return the horizons that have data points; where there is one of each, names need not agree."""
    points = options.points
    if len(points) == len(surfaces) == 1:
        return list(zip(surfaces, points.values(), strict=True))
    return [(name, points[name]) for name in surfaces if name in points]


def _grids(surfaces: Surfaces, out: Path, options: _Options) -> list[tuple[Path, Ground]]:
    if options.value == "thickness":
        if len(surfaces) != 2:
            raise InputError(
                message(
                    "io.thickness-needs-two",
                    "Thickness lies between two horizons; given: {count}",
                    count=len(surfaces),
                ),
                message("io.name-upper-lower", "Name the upper one, then the lower."),
            )
        upper, lower = surfaces.values()
        return [(out, thickness_grid(upper, lower, options.cell, options.ground))]
    files = _files(surfaces, out)
    if options.value == "elevation":
        return [(files[name], elevation_grid(surface, options.cell)) for name, surface in surfaces.items()]
    if options.value != "deviation":
        raise SettingsError(
            message(
                "io.grid-kind-unknown",
                "A grid of '{kind}' is unknown; choose elevation, deviation or thickness.",
                kind=options.value,
            )
        )
    data = dict(_points(surfaces, options))
    missing = [name for name in surfaces if name not in data]
    if missing:
        raise InputError(
            message("io.no-points", "There are no points of '{name}'", name=missing[0]),
            message("io.give-points-option", "Give them with --points."),
        )
    return [(files[name], deviation_grid(surfaces[name], data[name], options.cell)) for name in surfaces]
