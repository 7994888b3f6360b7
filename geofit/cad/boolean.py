"""Solids joined, cut and intersected by OpenCASCADE: bodies with sharp creases.

OpenCASCADE is imported inside the functions: it takes seconds to load.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.cad.faces import free_edges
from geofit.data.errors import StitchError
from geofit.data.messages import message

__all__ = ["common", "fused", "half_space", "subtract_solid"]

Floats = NDArray[np.float64]


def half_space(point: Floats, normal: Floats, size: float) -> Any:
    """Return a cube of a side behind a plane, its face on the plane around the point."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    axes = gp_Ax2(gp_Pnt(*point.tolist()), gp_Dir(*(-normal).tolist()))
    along, across = (np.array([d.X(), d.Y(), d.Z()]) for d in (axes.XDirection(), axes.YDirection()))
    corner = point - size / 2 * (along + across)
    axes.SetLocation(gp_Pnt(*corner.tolist()))
    return BRepPrimAPI_MakeBox(axes, size, size, size).Solid()


def fused(shapes: Sequence[Any]) -> Any:
    """Return what is in any of the solids."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    return _folded(BRepAlgoAPI_Fuse, shapes)


def common(shapes: Sequence[Any]) -> Any:
    """Return what is in all solids."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common

    return _folded(BRepAlgoAPI_Common, shapes)


def subtract_solid(shape: Any, other: Any) -> Any:
    """Return what is in the first solid and not in the other."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    return _folded(BRepAlgoAPI_Cut, [shape, other])


def _folded(operation: Any, shapes: Sequence[Any]) -> Any:
    """Return the result of an operation on solids, one after the other.

    Raises
    ------
    StitchError
        If OpenCASCADE fails, or its result is not a valid closed solid.
    """
    from OCP.BRepCheck import BRepCheck_Analyzer

    result = shapes[0]
    for other in shapes[1:]:
        builder = operation(result, other)
        builder.Build()
        result = builder.Shape() if builder.IsDone() else None
        if result is None or not BRepCheck_Analyzer(result).IsValid() or free_edges(result):
            raise StitchError(
                message(
                    "cad.creases-not-made",
                    "OpenCASCADE cannot join or cut the parts of the body along its creases. Write triangles instead.",
                )
            )
    return result
