"""What VTK draws: arrays turned into actors, each with what it needs to be drawn at another size or detail."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from geofit.gui.view3d.colouring import Ramp
from geofit.report.style import rgb

__all__ = ["ActorPart", "coloured", "dots", "lines", "poly", "ramped", "shaded", "triangles"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Colour of places without a value.
UNKNOWN = (0.62, 0.64, 0.66, 1.0)
#: The canvas's sun and lamp (the viewpoint is taken to be above) as unit vectors, with their shares of the light.
AMBIENT = 0.34
LIGHTS = ((np.array([-0.557, 0.501, 0.662]), 0.42), (np.array([-0.3, -0.45, 0.84]), 0.39))


#: The meshes of a net are wide at so many pixels; the faintest that a net is drawn.
WIDE, FAINT = 12.0, 0.15


@dataclass(eq=False)
class ActorPart:
    """An actor; ``detail`` shows whether it belongs to the still picture ("full"), the moving one ("coarse") or both.

    ``width`` and ``size`` are the widths of its lines and points in logical pixels; ``opacity`` times the layer's.
    ``spacing`` is set for a net of so many metres: seen from afar it is drawn fainter, so that it hides nothing.
    """

    actor: Any
    detail: str = "both"
    width: float = 0.0
    size: float = 0.0
    opacity: float = 1.0
    spacing: float = 0.0

    def strength(self, metres: float) -> float:
        """Return how strongly it is drawn where a logical pixel is so many metres, 0 to 1."""
        if not self.spacing:
            return self.opacity
        return self.opacity * min(max(self.spacing / metres / WIDE, FAINT), 1.0)

    def scale(self, pixels: float) -> None:
        """Set how many pixels of the picture a logical pixel has."""
        if self.width:
            self.actor.GetProperty().SetLineWidth(self.width * pixels)
        if self.size:
            self.actor.GetProperty().SetPointSize(self.size * pixels)


def poly(
    points: Floats, *, faces: Ints | None = None, runs: Sequence[Ints] | None = None, normals: Floats | None = None
) -> Any:
    """Return points (n, 3) about the scene's origin as VTK's data: with triangles, lines, or by themselves."""
    data = vtkPolyData()
    place = vtkPoints()
    place.SetData(numpy_to_vtk(np.ascontiguousarray(points, np.float32), deep=True))
    data.SetPoints(place)
    if faces is not None:
        data.SetPolys(_cells([np.asarray(faces, np.int64).ravel()], np.arange(0, 3 * len(faces) + 1, 3)))
    elif runs is not None:
        data.SetLines(_cells(list(runs), np.concatenate([[0], np.cumsum([len(run) for run in runs])])))
    else:
        data.SetVerts(_cells([np.arange(len(points))], np.array([0, len(points)])))
    if normals is not None:
        data.GetPointData().SetNormals(numpy_to_vtk(np.ascontiguousarray(normals, np.float32), deep=True))
    return data


def _cells(numbers: list[Ints], offsets: Ints) -> Any:
    cells = vtkCellArray()
    flat = np.concatenate(numbers) if numbers else np.empty(0, np.int64)
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(offsets, np.int64), deep=True),
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(flat, np.int64), deep=True),
    )
    return cells


def _actor(data: Any, colour: str, nearer: float = 0.0) -> Any:
    """Return an actor in one colour; ``nearer`` draws it in front of what lies in the same place."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetScalarVisibility(False)
    if nearer:
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-nearer, -nearer)
        mapper.SetRelativeCoincidentTopologyPointOffsetParameter(-8.0 * nearer)
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*(c / 255 for c in rgb(colour)))
    return actor


def triangles(data: Any, colour: str) -> Any:
    """Return a shaded actor."""
    actor = _actor(data, colour)
    look = actor.GetProperty()
    look.SetInterpolationToPhong()
    look.SetAmbient(AMBIENT)
    look.SetDiffuse(0.75)
    # Points and lines that lie on a surface stand out of it: the surface is drawn a little farther away.
    mapper = actor.GetMapper()
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.5, 40.0)
    return actor


def lines(data: Any, colour: str, nearer: float = 2.0) -> Any:
    """Return unshaded lines."""
    actor = _actor(data, colour, nearer)
    actor.GetProperty().LightingOff()
    return actor


def dots(data: Any, colour: str, *, balls: bool) -> Any:
    """Return points: small balls, or flat where there are too many for that."""
    actor = _actor(data, colour, 1.0)
    look = actor.GetProperty()
    look.SetRenderPointsAsSpheres(balls)
    look.SetAmbient(0.35)
    if not balls:
        look.LightingOff()
    return actor


def shaded(data: Any, colours: NDArray[np.uint8], normals: Floats) -> Any:
    """Return a surface whose light is in its colours, which software draws twice as fast as light by the pixel."""
    actor = _actor(data, "#000000")
    light = AMBIENT + sum(share * np.clip(normals @ way, 0.0, 1.0) for way, share in LIGHTS)
    coloured(actor, np.clip(colours * np.asarray(light)[:, None], 0, 255).astype(np.uint8))
    actor.GetProperty().LightingOff()
    return actor


def coloured(actor: Any, colours: NDArray[np.uint8]) -> None:
    """Give each point of an actor its own colour."""
    values = numpy_to_vtk(np.ascontiguousarray(colours, np.uint8), deep=True)
    values.SetName("colour")
    mapper = actor.GetMapper()
    mapper.GetInput().GetPointData().SetScalars(values)
    mapper.SetScalarModeToUsePointData()
    mapper.SetColorModeToDirectScalars()
    mapper.SetInterpolateScalarsBeforeMapping(False)
    mapper.SetScalarVisibility(True)


def ramped(actor: Any, values: Floats, colours: Ramp) -> None:
    """Colour an actor by a value at each of its points."""
    table = vtkLookupTable()
    table.SetNumberOfTableValues(len(colours.table))
    opaque = np.full((len(colours.table), 1), 255, np.uint8)
    table.SetTable(numpy_to_vtk(np.hstack([colours.table, opaque]), deep=True))
    table.SetNanColor(*UNKNOWN)
    table.SetRange(colours.low, colours.high)
    array = numpy_to_vtk(np.ascontiguousarray(values, np.float32), deep=True)
    array.SetName("value")
    mapper = actor.GetMapper()
    mapper.GetInput().GetPointData().SetScalars(array)
    mapper.SetLookupTable(table)
    mapper.SetScalarRange(colours.low, colours.high)
    mapper.SetScalarModeToUsePointData()
    mapper.SetColorModeToMapScalars()
    mapper.SetInterpolateScalarsBeforeMapping(True)
    # The colours carry numbers: less shade on them.
    actor.GetProperty().SetAmbient(0.42)
    actor.GetProperty().SetDiffuse(0.62)
    mapper.SetScalarVisibility(True)
