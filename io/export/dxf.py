"""DXF (R2010) in map coordinates: contours, triangles and section cuts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from typing import TYPE_CHECKING, Any

from geofit.data.files import file_stems, replacing
from geofit.data.given import arguments_checked
from geofit.data.lengths import LengthUnit
from geofit.geometry.mesh import Mesh
from geofit.sampling.contours import ContourLine
from geofit.sampling.cut import CutLine

if TYPE_CHECKING:
    from ezdxf.document import Drawing

__all__ = ["drawing_of", "write_contours_dxf", "write_mesh_dxf", "write_section_dxf"]

#: Colour indices of AutoCAD for the horizons in turn: apart from each other on white and on black.
COLOURS = (30, 84, 150, 14, 200, 42, 120, 220)
#: DXF codes of the units of a drawing.
UNITS: dict[LengthUnit, int] = {"m": 6, "ft": 2, "ft-us": 21}


def write_contours_dxf(contours: Mapping[str, Sequence[ContourLine]], path: str | PathLike[str]) -> None:
    """Write contours as 2D polylines that carry their elevation, one layer a horizon."""
    with _drawing(path, list(contours)) as (document, layers):
        space = document.modelspace()
        for name, lines in contours.items():
            for contour in lines:
                corners = contour.line[:-1] if contour.closed else contour.line
                space.add_lwpolyline(
                    corners.tolist(),
                    close=contour.closed,
                    dxfattribs={"layer": layers[name], "elevation": contour.elevation},
                )


def write_mesh_dxf(meshes: Mapping[str, Mesh], path: str | PathLike[str]) -> None:
    """Write triangles as 3DFACE, which every CAD program reads, one layer a horizon."""
    with _drawing(path, list(meshes)) as (document, layers):
        space = document.modelspace()
        for name, mesh in meshes.items():
            attributes = {"layer": layers[name]}
            for corners in mesh.xyz[mesh.triangles].tolist():
                space.add_3dface([*corners, corners[2]], dxfattribs=attributes)


@arguments_checked
def write_section_dxf(cuts: Mapping[str, Sequence[CutLine]], path: str | PathLike[str], *, drawn: bool = True) -> None:
    """Write a section as DXF, one layer a horizon.

    Parameters
    ----------
    cuts : mapping of str to sequence of CutLine
        What :func:`geofit.cut_section` returned, by horizon; metres.
    path : path
        The file, usually ``*.dxf``.
    drawn : bool
        Whether it is a drawing, x the distance along the section and y the elevation; else 3D polylines in map
        coordinates.

    Raises
    ------
    OSError
        If the file cannot be written.

    Notes
    -----
    ``docs/formats_out.md``, "Sections".
    """
    with _drawing(path, list(cuts)) as (document, layers):
        space = document.modelspace()
        for name, lines in cuts.items():
            for line in lines:
                attributes = {"layer": layers[name]}
                if drawn:
                    corners = zip(line.distance.tolist(), line.xyz[:, 2].tolist(), strict=True)
                    space.add_lwpolyline(list(corners), dxfattribs=attributes)
                else:
                    space.add_polyline3d(line.xyz.tolist(), dxfattribs=attributes)


@contextmanager
def _drawing(path: str | PathLike[str], names: list[str]) -> Iterator[tuple[Drawing, dict[str, str]]]:
    """Give a drawing in metres with a layer for each name; it is written when the block ends without an error."""
    layers = file_stems(names)
    with drawing_of(path, list(layers.values())) as document:
        yield document, layers


@contextmanager
def drawing_of(path: str | PathLike[str], layers: Sequence[str], unit: LengthUnit = "m") -> Iterator[Drawing]:
    """Give a drawing in a unit with layers; it is written when the block ends without an error."""
    import ezdxf

    options: Any = ezdxf.options
    before = options.write_fixed_meta_data_for_testing
    # Otherwise the time of writing and a random identifier are written in the header.
    options.write_fixed_meta_data_for_testing = True
    try:
        document = ezdxf.new("R2010", units=UNITS[unit])
        for k, layer in enumerate(layers):
            document.layers.add(layer, color=COLOURS[k % len(COLOURS)])
        yield document
        with replacing(path) as part:
            document.saveas(part)
    finally:
        options.write_fixed_meta_data_for_testing = before
